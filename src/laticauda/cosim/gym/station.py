"""The task of an underwater vehicle that waits: stay where you are, in a current."""

import math
from dataclasses import dataclass

import numpy as np

from laticauda.control.path_following import refuse_offset
from laticauda.cosim.gym.swimming import (
    Numbers,
    Range,
    Sight,
    Step,
    Swimming,
    current_draws,
    in_body_axes,
    log_square,
    settle,
    settle_ends,
)
from laticauda.errors import not_negative, positive


@dataclass(frozen=True, kw_only=True)
class StationKeeping(Swimming):
    """Stay at the origin in a current that is not seen; the actions are what steering adds, and the frequency.

        r = -h (ln(1 + (d/d_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its limit.
    """

    max_offset: float = math.radians(20.0)
    """Largest offset to either side [rad]."""
    frequencies: tuple[float, float] = (0.0, math.radians(130.0))
    """What may be asked for [rad/s]."""
    max_distance: float = 1.0
    """At the start, along each axis [m]."""
    max_current: float = 0.06
    """Fastest water of an episode, in any direction [m/s]."""
    distance_tolerance: float = 0.2
    """d_1 [m]."""
    power_unit: float = 100.0
    """P_1: power that costs 1 per second [W]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        super().__post_init__()
        settle(self, positive, "rad", "max_offset")
        settle_ends(self, "rad/s", "frequencies")
        not_negative("frequencies[0]", self.frequencies[0], "rad/s")
        positive("frequencies[1]", self.frequencies[1], "rad/s")
        settle(self, not_negative, "m", "max_distance")
        settle(self, not_negative, "m/s", "max_current")
        settle(self, positive, "m", "distance_tolerance")
        settle(self, positive, "W", "power_unit")
        refuse_offset(self.plant.robot, self.gait, self.max_offset)

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
            Sight(name="origin_along"),
            Sight(name="origin_across"),
            Sight(name="velocity_along", unit=0.1),
            Sight(name="velocity_across", unit=0.1),
            Sight(name="heading_rate"),
            Sight(name="sin_phase"),
            Sight(name="cos_phase"),
            Sight(name="frequency", unit=self.frequencies[1]),
            Sight(name="offset", unit=self.max_offset),
        )

    def see(self, step: Step) -> tuple[Numbers, ...]:
        """The quantities of `sights` after `step`."""
        now = step.after
        return (
            *in_body_axes(now, -now.x, -now.y),
            *step.velocity,
            now.heading_rate,
            np.sin(now.phase),
            np.cos(now.phase),
            now.frequency,
            now.offset,
        )

    def reward(self, step: Step) -> Numbers:
        """What distance and power cost in `step`."""
        distance = log_square(np.hypot(step.after.x, step.after.y), self.distance_tolerance)
        return -step.interval * (distance + step.power / self.power_unit)
