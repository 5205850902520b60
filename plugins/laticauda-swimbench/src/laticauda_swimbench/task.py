"""What all SwimBench scenarios share: a policy's observations and actions, and the value of its swimming."""

import math
from dataclasses import replace

from laticauda.control import refuse_offset
from laticauda.values import quantity, value_class
from laticauda_gym.swimming import Numbers, Range, Sight, Step, Swimming, ranges
from laticauda_gym.tasks import BESIDE_THE_PATH, PHASE, check_ends

_UNIT_POWER = 100.0  # observed as 1 [W]


@value_class
class Swim(Swimming):
    """Swim along the x axis, close to it and with little energy; the actions are the gait and the steering.

        J = 1/T sum_n [ k(y_n) (x_n - x_(n-1)) - E_n / F ],    k(y) = 1 / (1 + (y/y_1)^2)

    The sum is over the intervals between actions: x, y is the center of mass at the end of each, E
    the energy that the motors took. J is a speed: the cost of the energy is subtracted from the
    progress, at a price F in joules per meter. The reward of an interval is its term of the sum, so
    a return is J T.

    Raises:
        ValueError: If a field is out of its range, or gait and offset could take a joint beyond its
            limit.
    """

    amplitudes: tuple[float, float] = quantity(
        "rad", "Smallest and largest that may be asked for", ge=0.0
    )
    frequencies: tuple[float, float] = quantity(
        "rad/s", "Smallest and largest that may be asked for", ge=0.0
    )
    phase_shifts: tuple[float, float] = quantity(
        "rad", "Smallest and largest that may be asked for"
    )
    max_offset: float = quantity("rad", "Largest offset to either side", gt=0.0)
    max_distance: float = quantity(
        "m", "Largest distance from the line at the start, to either side", ge=0.0
    )
    max_heading: float = quantity("rad", "Largest heading at the start, to either side", ge=0.0)
    max_current: float = quantity(
        "m/s", "Largest current of an episode, in any direction", ge=0.0, default=0.0
    )
    tolerance: float = quantity(
        "m", "y_1, distance from the line at which progress counts half", gt=0.0
    )
    price: float = quantity("J/m", "F, energy that is worth as much as a meter", gt=0.0)

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        super().__post_init__()
        check_ends(self, "amplitudes", "frequencies", "phase_shifts")
        refuse_offset(
            self.scenario.robot, replace(self.gait, amplitude=self.amplitudes[1]), self.max_offset
        )

    @property
    def actions(self) -> tuple[Range, ...]:
        """Amplitude, frequency, phase shift and offset."""
        return ranges(
            amplitude=self.amplitudes,
            frequency=self.frequencies,
            phase_shift=self.phase_shifts,
            offset=(-self.max_offset, self.max_offset),
        )

    @property
    def draws(self) -> tuple[Range, ...]:
        """Start and water of an episode."""
        y, heading = self.max_distance, self.max_heading
        start = ranges(y=(-y, y), heading=(-heading, heading))
        if self.flow is not None:
            return start + self.flow_draws
        return start + ranges(
            current_speed=(0.0, self.max_current), current_direction=(-math.pi, math.pi)
        )

    @property
    def sights(self) -> tuple[Sight, ...]:
        """What cameras or a filter, the power meter, and the robot's own gait provide: nothing about the water."""
        return (
            *BESIDE_THE_PATH,
            Sight(name="power", of=lambda step: step.power, unit=_UNIT_POWER),
            *PHASE,
            Sight(name="amplitude", of=lambda step: step.after.amplitude, unit=self.amplitudes[1]),
            Sight(name="frequency", of=lambda step: step.after.frequency, unit=self.frequencies[1]),
            Sight(
                name="phase_shift",
                of=lambda step: step.after.phase_shift,
                unit=self.phase_shifts[1],
            ),
            Sight(name="offset", of=lambda step: step.after.offset, unit=self.max_offset),
        )

    def reward(self, step: Step) -> Numbers:
        """Return the term of `step` in J T [m]."""
        near = 1.0 / (1.0 + (step.after.y / self.tolerance) ** 2)
        return near * (step.after.x - step.before.x) - step.interval * step.power / self.price
