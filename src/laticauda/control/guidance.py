"""Guidance: from the distance to the path to the heading that leads back to it.

Each law is `init` and `step` with an explicit state. The heading is in world axes, and the number that is nearest to
the heading that the robot has, so that no law ever asks for a turn around the circle.
"""

import math
from typing import Generic, TypeVar

from laticauda.angles import wrap_to_pi
from laticauda.control.frames import PathFrame
from laticauda.extensions import Extensible
from laticauda.quantities import quantity, value

State = TypeVar("State")


class Guidance(Extensible, Generic[State], group="guidance"):
    """What turns a position beside the path into the heading to take; one's own is a class below this one."""

    def init(self) -> State:
        """The state at the start."""
        raise NotImplementedError

    def step(
        self, state: State, frame: PathFrame, heading: float, dt: float, is_saturated: bool
    ) -> tuple[State, float]:
        """The heading to take.

        Args:
            state: As the last call returned it, or `init`.
            frame: The position seen from the path.
            heading: Theta of the robot [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.

        Returns:
            The state now, and theta_ref in world axes, within half a turn of `heading` [rad].
        """
        raise NotImplementedError


@value
class LineOfSight(Guidance[None]):
    """Head for the point of the path that is the look-ahead distance ahead.

        theta_ref = path_tangential_angle - atan(cross_track_error / look_ahead_distance)

    Equation (7) of the paper, for a path of any direction. A steady current across the path leaves a steady error.

    Raises:
        ValueError: If the look-ahead distance is not positive.

    Example:
        >>> frame = PathFrame(
        ...     along_track_distance=0.0, cross_track_error=1.0, path_tangential_angle=0.0, curvature=0.0, remaining=9.0
        ... )
        >>> law = LineOfSight(look_ahead_distance=1.0)
        >>> round(math.degrees(law.step(law.init(), frame, 0.0, 0.05, False)[1]))
        -45
    """

    look_ahead_distance: float = quantity("m", "Delta; smaller is steeper", gt=0.0)

    def init(self) -> None:
        """No state."""

    def step(self, state: None, frame: PathFrame, heading: float, dt: float, is_saturated: bool) -> tuple[None, float]:
        """The heading to take; arguments as for `Guidance`."""
        return None, _aimed(frame, frame.cross_track_error / self.look_ahead_distance, heading)


@value
class IntegralLineOfSight(Guidance[float]):
    """Line of sight that learns the drift: an integral of the error takes a steady current off.

        theta_ref = path_tangential_angle - atan((e + sigma y) / Delta)
        y' = Delta e / ((e + sigma y)^2 + Delta^2)

    Far from the path y hardly grows, so it does not wind up on the way; and it does not grow at all while the offset is
    at its limit, where asking for more changes nothing.

    Raises:
        ValueError: If the look-ahead distance is not positive, or the gain is negative.
    """

    look_ahead_distance: float = quantity("m", "Delta", gt=0.0)
    integral_gain: float = quantity("m/s", "sigma; 0 gives `LineOfSight`", ge=0.0)

    def init(self) -> float:
        """The integral y, 0 [s]."""
        return 0.0

    def step(
        self, state: float, frame: PathFrame, heading: float, dt: float, is_saturated: bool
    ) -> tuple[float, float]:
        """The integral [s] and the heading to take; arguments as for `Guidance`."""
        delta, error = self.look_ahead_distance, frame.cross_track_error
        if not is_saturated:
            aim = error + self.integral_gain * state
            state += dt * delta * error / (aim * aim + delta * delta)
        return state, _aimed(frame, (error + self.integral_gain * state) / delta, heading)


def _aimed(frame: PathFrame, slope: float, heading: float) -> float:
    """The direction that leads to the path with a slope, as a number within half a turn of `heading` [rad]."""
    return heading + wrap_to_pi(frame.path_tangential_angle - math.atan(slope) - heading)
