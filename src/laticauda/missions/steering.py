"""What a behaviour wants, and the helm that makes an offset of the gait from it."""

import math
from dataclasses import dataclass

from laticauda.missions.estimate import Estimate
from laticauda.values import quantity, value_class
from laticauda.values.angles import wrapped


@dataclass(frozen=True, kw_only=True)
class Steering:
    """What a behaviour wants until the next control instant; one of course, heading and offset."""

    course: float | None = None
    """Direction over ground [rad]."""
    heading: float | None = None
    """Direction in which the body points [rad]."""
    offset: float | None = None
    """Offset of the gait itself, positive to the left [rad]."""
    turn_rate: float = 0.0
    """How fast the wanted direction turns, which the helm adds at once [rad/s]."""
    pitch_offset: float = 0.0
    """Offset of the pitch joints, positive down [rad]."""
    effort: float = 1.0
    """Share of the gait's amplitude, 0: the joints rest [-]."""
    pace: float = 1.0
    """Share of the gait's frequency [-]."""
    thrusts: tuple[float, ...] | None = None
    """Thrust of every driven thruster; None: its own [N]."""


@value_class
class Helm:
    """Turns what a behaviour wants into an offset of the gait, and points upstream by the crab angle."""

    gain: float = quantity("", "Offset per error of the heading", gt=0.0, default=0.5)
    max_offset: float = quantity(
        "rad", "Largest offset to either side", gt=0.0, default=math.radians(16.0)
    )
    offset_per_turn: float = quantity(
        "s", "Offset per rate at which the wanted direction turns", ge=0.0, default=0.9
    )
    swim_speed: float = quantity("m/s", "Speed through the water", gt=0.0, default=0.2)
    max_crab_angle: float = quantity(
        "rad", "Largest angle upstream", gt=0.0, le=0.5 * math.pi, default=math.radians(50.0)
    )

    def offset_of(self, steering: Steering, estimate: Estimate) -> float:
        """Return the offset [rad].

        Args:
            steering: What the behaviour wants.
            estimate: What the robot believes.
        """
        if steering.offset is not None:
            return self._limit(steering.offset)
        if steering.course is not None:
            heading_ref = steering.course + self.crab_angle(steering.course, estimate.current)
        elif steering.heading is not None:
            heading_ref = steering.heading
        else:
            return 0.0
        error = wrapped(heading_ref - estimate.heading)
        return self._limit(self.gain * error + self.offset_per_turn * steering.turn_rate)

    def crab_angle(self, course: float, current: tuple[float, float]) -> float:
        """Return how far to the left of a course the body must point, so that the current does not carry it off [rad].

        Args:
            course: Direction over ground [rad].
            current: Velocity of the water [m/s].
        """
        to_left = current[1] * math.cos(course) - current[0] * math.sin(course)
        sine = min(max(to_left / self.swim_speed, -1.0), 1.0)
        angle = -math.asin(sine)
        return min(max(angle, -self.max_crab_angle), self.max_crab_angle)

    def _limit(self, offset: float) -> float:
        """Return an offset within its limit [rad]."""
        return min(max(offset, -self.max_offset), self.max_offset)
