"""The task of an underwater vehicle that waits: stay where you are, in a current."""

import math

import numpy as np

from laticauda.control.path_following import refuse_offset
from laticauda.cosim.gym.steps import (
    ACROSS,
    ALONG,
    HEADING_RATE,
    PHASE,
    Numbers,
    Range,
    Sight,
    Step,
    current_draws,
    in_body_axes,
    log_square,
)
from laticauda.cosim.gym.swimming import Swimming, check_ends
from laticauda.quantities import quantity, value


@value
class StationKeeping(Swimming):
    """Stay at the origin in a current that is not seen; the actions are what steering adds, and the frequency.

        r = -h (ln(1 + (d/d_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its limit.
    """

    max_offset: float = quantity("rad", "Largest offset to either side", gt=0.0, default=math.radians(20.0))
    frequencies: tuple[float, float] = quantity(
        "rad/s", "What may be asked for", ge=0.0, default=(0.0, math.radians(130.0))
    )
    max_distance: float = quantity("m", "At the start, along each axis", ge=0.0, default=1.0)
    max_current: float = quantity("m/s", "Fastest water of an episode, in any direction", ge=0.0, default=0.06)
    distance_tolerance: float = quantity("m", "d_1", gt=0.0, default=0.2)
    power_unit: float = quantity("W", "P_1, power that costs 1 per second", gt=0.0, default=100.0)

    def __post_init__(self) -> None:
        """Check what goes together."""
        super().__post_init__()
        check_ends(self, "rad/s", "frequencies")
        refuse_offset(self.scenario.robot, self.gait, self.max_offset)

    @property
    def actions(self) -> tuple[Range, ...]:
        """Offset and frequency."""
        return (
            Range(name="offset", low=-self.max_offset, high=self.max_offset),
            Range(name="frequency", low=self.frequencies[0], high=self.frequencies[1]),
        )

    @property
    def draws(self) -> tuple[Range, ...]:
        """Where an episode begins, in which water."""
        return (
            Range(name="x", low=-self.max_distance, high=self.max_distance),
            Range(name="y", low=-self.max_distance, high=self.max_distance),
            Range(name="heading", low=-math.pi, high=math.pi),
            *current_draws(self.max_current),
        )

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Where the origin is seen, velocity over ground; phase, frequency and offset of the gait."""
        return (
            Sight(name="origin_along", of=lambda step: _origin(step)[0]),
            Sight(name="origin_across", of=lambda step: _origin(step)[1]),
            ALONG,
            ACROSS,
            HEADING_RATE,
            *PHASE,
            Sight(name="frequency", of=lambda step: step.after.frequency, unit=self.frequencies[1]),
            Sight(name="offset", of=lambda step: step.after.offset, unit=self.max_offset),
        )

    def reward(self, step: Step) -> Numbers:
        """What distance and power cost in `step`."""
        distance = log_square(np.hypot(step.after.x, step.after.y), self.distance_tolerance)
        return -step.interval * (distance + step.power / self.power_unit)


def _origin(step: Step) -> tuple[Numbers, Numbers]:
    return in_body_axes(step.after, -step.after.x, -step.after.y)
