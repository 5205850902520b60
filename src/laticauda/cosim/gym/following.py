"""The task that line of sight has: follow a line in a current."""

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
    log_square,
)
from laticauda.cosim.gym.swimming import Swimming
from laticauda.quantities import quantity, value


@value
class PathFollowing(Swimming):
    """Follow the x axis, in a current that is not seen; the action is what steering adds, as for line of sight.

        r = (x(t + h) - x(t)) / v_1 - h (ln(1 + (e/e_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its limit.
    """

    max_offset: float = quantity("rad", "Largest offset to either side", gt=0.0, default=math.radians(20.0))
    max_cross_track_error: float = quantity("m", "At the start, to either side", ge=0.0, default=1.0)
    max_heading: float = quantity("rad", "At the start, to either side", ge=0.0, default=math.radians(60.0))
    max_current: float = quantity("m/s", "Fastest water of an episode, in any direction", ge=0.0, default=0.06)
    cross_track_tolerance: float = quantity("m", "e_1", gt=0.0, default=0.1)
    speed_unit: float = quantity("m/s", "v_1, speed along the path that is worth 1 per second", gt=0.0, default=0.1)
    power_unit: float = quantity("W", "P_1, power that costs 1 per second", gt=0.0, default=100.0)

    def __post_init__(self) -> None:
        """Check what goes together."""
        super().__post_init__()
        refuse_offset(self.scenario.robot, self.gait, self.max_offset)

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
            Sight(name="cross_track_error", of=lambda step: step.after.y),
            Sight(name="sin_heading", of=lambda step: np.sin(step.after.heading)),
            Sight(name="cos_heading", of=lambda step: np.cos(step.after.heading)),
            HEADING_RATE,
            ALONG,
            ACROSS,
            *PHASE,
            Sight(name="offset", of=lambda step: step.after.offset, unit=self.max_offset),
        )

    def reward(self, step: Step) -> Numbers:
        """Progress along the path, less what distance from it and power cost in `step`."""
        progress = (step.after.x - step.before.x) / self.speed_unit
        error = log_square(step.after.y, self.cross_track_tolerance)
        return progress - step.interval * (error + step.power / self.power_unit)
