"""The task of a gait: the speed that is asked for, with the least power."""

import math

import numpy as np

from laticauda.cosim.gym.steps import ACROSS, HEADING_RATE, PHASE, Numbers, Range, Sight, Step
from laticauda.cosim.gym.swimming import Swimming, check_ends
from laticauda.errors import BadArgument
from laticauda.quantities import quantity, value


@value
class Efficiency(Swimming):
    """Swim at the speed that is asked for with the least power, in still water; the actions are the gait.

        r = -h (((u - v)/v_1)^2 + P/P_1)

    u is what the center of mass covers in the interval along the mean heading, divided by the interval.

    Raises:
        ValueError: If a field is out of its range, or the amplitude could take a joint beyond its limit.
    """

    amplitudes: tuple[float, float] = quantity(
        "rad", "What may be asked for", ge=0.0, default=(0.0, math.radians(45.0))
    )
    frequencies: tuple[float, float] = quantity(
        "rad/s", "What may be asked for", ge=0.0, default=(0.0, math.radians(130.0))
    )
    phase_shifts: tuple[float, float] = quantity(
        "rad", "What may be asked for", default=(math.radians(10.0), math.radians(70.0))
    )
    speeds: tuple[float, float] = quantity(
        "m/s", "Between which every episode draws the speed v that is asked for", ge=0.0, default=(0.03, 0.15)
    )
    speed_tolerance: float = quantity("m/s", "v_1, error of the speed that costs 1 per second", gt=0.0, default=0.02)
    power_unit: float = quantity("W", "P_1, power that costs 1 per second", gt=0.0, default=10.0)

    def __post_init__(self) -> None:
        """Check what goes together."""
        super().__post_init__()
        check_ends(self, "rad", "amplitudes", "phase_shifts")
        check_ends(self, "rad/s", "frequencies")
        check_ends(self, "m/s", "speeds")
        chain = self.scenario.robot.planar()
        for i, (joint, g) in enumerate(zip(chain.joints, self.gait.joint_envelope(chain.n_links), strict=True)):
            room = joint.limit - abs(self.gait.offset)
            if abs(g) * self.amplitudes[1] > room:
                raise BadArgument(
                    "amplitudes[1]",
                    f"must be <= {room / abs(g):.4g} rad, or joint {i} goes beyond its limit of "
                    f"{joint.limit:.4g} rad; got {self.amplitudes[1]}",
                )

    @property
    def actions(self) -> tuple[Range, ...]:
        """Amplitude, frequency, phase shift."""
        return (
            Range(name="amplitude", low=self.amplitudes[0], high=self.amplitudes[1]),
            Range(name="frequency", low=self.frequencies[0], high=self.frequencies[1]),
            Range(name="phase_shift", low=self.phase_shifts[0], high=self.phase_shifts[1]),
        )

    @property
    def draws(self) -> tuple[Range, ...]:
        """The speed asked for."""
        return (Range(name="speed_ref", low=self.speeds[0], high=self.speeds[1]),)

    @property
    def sights(self) -> tuple[Sight, ...]:
        """The speed asked for and the speed there is, the power, and the gait as the generator has it."""
        return (
            Sight(name="speed_ref", of=lambda step: step.drawn["speed_ref"], unit=0.1),
            Sight(name="speed", of=_speed, unit=0.1),
            ACROSS,
            HEADING_RATE,
            Sight(name="power", of=lambda step: step.power, unit=self.power_unit),
            *PHASE,
            Sight(name="amplitude", of=lambda step: step.after.amplitude, unit=self.amplitudes[1]),
            Sight(name="frequency", of=lambda step: step.after.frequency, unit=self.frequencies[1]),
            Sight(name="phase_shift", of=lambda step: step.after.phase_shift),
        )

    def reward(self, step: Step) -> Numbers:
        """What error of the speed and power cost in `step`."""
        error = (_speed(step) - step.drawn["speed_ref"]) / self.speed_tolerance
        return -step.interval * (error * error + step.power / self.power_unit)


def _speed(step: Step) -> Numbers:
    """u of a step [m/s]."""
    heading = 0.5 * (step.before.heading + step.after.heading)
    x, y = step.after.x - step.before.x, step.after.y - step.before.y
    return (np.cos(heading) * x + np.sin(heading) * y) / step.interval
