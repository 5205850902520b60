"""The task of a gait: the speed that is asked for, with the least power."""

import math
from dataclasses import dataclass

import numpy as np

from laticauda.cosim.gym.swimming import Numbers, Range, Sight, Step, Swimming, settle, settle_ends
from laticauda.errors import BadArgument, not_negative, positive


@dataclass(frozen=True, kw_only=True)
class Efficiency(Swimming):
    """Swim at the speed that is asked for with the least power, in still water; the actions are the gait.

        r = -h (((u - v)/v_1)^2 + P/P_1)

    u is what the center of mass covers in the interval along the mean heading, divided by the interval.

    Raises:
        ValueError: If a field is out of its range, or the amplitude could take a joint beyond its limit.
    """

    amplitudes: tuple[float, float] = (0.0, math.radians(45.0))
    """What may be asked for [rad]."""
    frequencies: tuple[float, float] = (0.0, math.radians(130.0))
    """The same [rad/s]."""
    phase_shifts: tuple[float, float] = (math.radians(10.0), math.radians(70.0))
    """The same [rad]."""
    speeds: tuple[float, float] = (0.03, 0.15)
    """Between which every episode draws the speed v that is asked for [m/s]."""
    speed_tolerance: float = 0.02
    """v_1: error of the speed that costs 1 per second [m/s]."""
    power_unit: float = 10.0
    """P_1: power that costs 1 per second [W]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        super().__post_init__()
        settle_ends(self, "rad", "amplitudes", "phase_shifts")
        settle_ends(self, "rad/s", "frequencies")
        settle_ends(self, "m/s", "speeds")
        for name, unit in (("amplitudes", "rad"), ("frequencies", "rad/s"), ("speeds", "m/s")):
            low, high = getattr(self, name)
            not_negative(f"{name}[0]", low, unit)
            positive(f"{name}[1]", high, unit)
        settle(self, positive, "m/s", "speed_tolerance")
        settle(self, positive, "W", "power_unit")
        self._refuse_amplitude()

    def _refuse_amplitude(self) -> None:
        chain = self.plant.robot
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
            Sight(name="speed_ref", unit=0.1),
            Sight(name="speed", unit=0.1),
            Sight(name="velocity_across", unit=0.1),
            Sight(name="heading_rate"),
            Sight(name="power", unit=self.power_unit),
            Sight(name="sin_phase"),
            Sight(name="cos_phase"),
            Sight(name="amplitude", unit=self.amplitudes[1]),
            Sight(name="frequency", unit=self.frequencies[1]),
            Sight(name="phase_shift"),
        )

    def speed(self, step: Step) -> Numbers:
        """u of `step` [m/s]."""
        heading = 0.5 * (step.before.heading + step.after.heading)
        x, y = step.after.x - step.before.x, step.after.y - step.before.y
        return (np.cos(heading) * x + np.sin(heading) * y) / step.interval

    def see(self, step: Step) -> tuple[Numbers, ...]:
        """The quantities of `sights` after `step`."""
        now = step.after
        return (
            step.drawn["speed_ref"],
            self.speed(step),
            step.velocity[1],
            now.heading_rate,
            step.power,
            np.sin(now.phase),
            np.cos(now.phase),
            now.amplitude,
            now.frequency,
            now.phase_shift,
        )

    def reward(self, step: Step) -> Numbers:
        """What error of the speed and power cost in `step`."""
        error = (self.speed(step) - step.drawn["speed_ref"]) / self.speed_tolerance
        return -step.interval * (error * error + step.power / self.power_unit)
