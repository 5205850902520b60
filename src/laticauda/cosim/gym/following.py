"""The task that line of sight has: follow a line in a current."""

import math
from dataclasses import dataclass

import numpy as np

from laticauda.control.path_following import refuse_offset
from laticauda.cosim.gym.swimming import Numbers, Range, Sight, Step, Swimming, current_draws, log_square, settle
from laticauda.errors import not_negative, positive


@dataclass(frozen=True, kw_only=True)
class PathFollowing(Swimming):
    """Follow the x axis, in a current that is not seen; the action is what steering adds, as for line of sight.

        r = (x(t + h) - x(t)) / v_1 - h (ln(1 + (e/e_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its limit.
    """

    max_offset: float = math.radians(20.0)
    """Largest offset to either side [rad]."""
    max_cross_track_error: float = 1.0
    """At the start, to either side [m]."""
    max_heading: float = math.radians(60.0)
    """The same [rad]."""
    max_current: float = 0.06
    """Fastest water of an episode, in any direction [m/s]."""
    cross_track_tolerance: float = 0.1
    """e_1 [m]."""
    speed_unit: float = 0.1
    """v_1: speed along the path that is worth 1 per second [m/s]."""
    power_unit: float = 100.0
    """P_1: power that costs 1 per second [W]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        super().__post_init__()
        settle(self, positive, "rad", "max_offset")
        settle(self, not_negative, "m", "max_cross_track_error")
        settle(self, not_negative, "rad", "max_heading")
        settle(self, not_negative, "m/s", "max_current")
        settle(self, positive, "m", "cross_track_tolerance")
        settle(self, positive, "m/s", "speed_unit")
        settle(self, positive, "W", "power_unit")
        refuse_offset(self.plant.robot, self.gait, self.max_offset)

    @property
    def actions(self) -> tuple[Range, ...]:
        """The offset."""
        return (Range(name="offset", low=-self.max_offset, high=self.max_offset),)

    @property
    def draws(self) -> tuple[Range, ...]:
        """Where an episode begins, in which water."""
        return (
            Range(name="y", low=-self.max_cross_track_error, high=self.max_cross_track_error),
            Range(name="heading", low=-self.max_heading, high=self.max_heading),
            *current_draws(self.max_current),
        )

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Place beside the path, heading to it, velocity over ground; phase and offset of the gait."""
        return (
            Sight(name="cross_track_error"),
            Sight(name="sin_heading"),
            Sight(name="cos_heading"),
            Sight(name="heading_rate"),
            Sight(name="velocity_along", unit=0.1),
            Sight(name="velocity_across", unit=0.1),
            Sight(name="sin_phase"),
            Sight(name="cos_phase"),
            Sight(name="offset", unit=self.max_offset),
        )

    def see(self, step: Step) -> tuple[Numbers, ...]:
        """The quantities of `sights` after `step`."""
        now = step.after
        return (
            now.y,
            np.sin(now.heading),
            np.cos(now.heading),
            now.heading_rate,
            *step.velocity,
            np.sin(now.phase),
            np.cos(now.phase),
            now.offset,
        )

    def reward(self, step: Step) -> Numbers:
        """Progress along the path, less what distance from it and power cost in `step`."""
        progress = (step.after.x - step.before.x) / self.speed_unit
        error = log_square(step.after.y, self.cross_track_tolerance)
        return progress - step.interval * (error + step.power / self.power_unit)
