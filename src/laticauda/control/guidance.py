"""Guidance and heading: from the distance to the path to the heading that leads back, and to the offset that turns.

Each law of guidance is `init` and `step` with an explicit state. The heading is in world axes, and the number that is
nearest to the heading that the robot has, so that no law ever asks for a turn around the circle.
"""

import math
from bisect import bisect_right
from operator import itemgetter
from typing import Generic, TypeAlias, TypeVar

from laticauda.angles import wrap_to_pi
from laticauda.control.frames import PathFrame
from laticauda.errors import BadArgument
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
        """The heading to take [rad].

        Args:
            state: None.
            frame: The position seen from the path.
            heading: Theta of the robot [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.
        """
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
        """The integral [s] and the heading to take [rad].

        Args:
            state: The integral, as the last call returned it, or `init` [s].
            frame: The position seen from the path.
            heading: Theta of the robot [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.
        """
        delta, error = self.look_ahead_distance, frame.cross_track_error
        if not is_saturated:
            aim = error + self.integral_gain * state
            state += dt * delta * error / (aim * aim + delta * delta)
        return state, _aimed(frame, (error + self.integral_gain * state) / delta, heading)


def _aimed(frame: PathFrame, slope: float, heading: float) -> float:
    """The direction that leads to the path with a slope, as a number within half a turn of `heading` [rad]."""
    return heading + wrap_to_pi(frame.path_tangential_angle - math.atan(slope) - heading)


# ---- heading: what counts as that of a body that undulates, and the offset that turns it -----------------------------

ROUNDING = 1e-9
"""Two control instants are never that close [s]."""


@value
class HeadingController:
    """The offset of all joints that turns the robot towards a heading, in proportion to the error.

        phi_0 = k (theta_ref - theta), within +-max_offset

    Equation (8) of the paper; the error is wrapped, so the robot turns the short way.

    Raises:
        ValueError: If a field is not positive.

    Example:
        >>> HeadingController(gain=0.4, max_offset=0.35).offset(heading_ref=0.5, heading=0.0)
        (0.2, False)
    """

    gain: float = quantity("", "k, offset per heading error", gt=0.0)
    max_offset: float = quantity("rad", "Largest offset to either side", gt=0.0)

    def offset(self, *, heading_ref: float, heading: float) -> tuple[float, bool]:
        """The offset to ask for.

        Args:
            heading_ref: theta_ref [rad].
            heading: theta [rad].

        Returns:
            phi_0, positive to turn left [rad], and whether it is at its limit.
        """
        asked = self.gain * wrap_to_pi(heading_ref - heading)
        if abs(asked) > self.max_offset:
            return (self.max_offset if asked > 0.0 else -self.max_offset), True
        return asked, False


HeadingWindow: TypeAlias = tuple[tuple[float, float, float], ...]
"""Headings of the last window, oldest first: time [s], heading [rad], its integral since the first of all [rad s]."""


@value
class HeadingEstimate:
    """The heading as the mean over the time that just passed.

    The mean link angle (6) carries the ripple of the gait. A window of one gait period takes the ripple off, and lags
    by half of it; a window of 0 gives (6) as it is. Until a whole window has passed, the mean is over what there is.

    Raises:
        ValueError: If the window is negative.
    """

    window: float = quantity("s", "How far back the mean goes; the gait's period, 0 for no mean", ge=0.0, default=0.0)

    def init(self) -> HeadingWindow:
        """Nothing seen yet."""
        return ()

    def step(self, state: HeadingWindow, time: float, heading: float) -> tuple[HeadingWindow, float]:
        """Take in one more heading.

        The headings need not come at equal distances; between them the heading is taken as a straight line.

        Args:
            state: As the last call returned it, or `init`.
            time: Of the heading, later than the last one [s].
            heading: Theta, unwrapped [rad].

        Returns:
            The window now, and the mean over it [rad].
        """
        if self.window == 0.0 or not state:
            return ((time, heading, 0.0),), heading
        last = state[-1][0]
        if time - last <= ROUNDING:
            raise BadArgument("time", f"must grow from step to step, got {last} s and then {time} s")
        begin = max(time - self.window, state[0][0])
        oldest = max(bisect_right(state, begin + ROUNDING, key=itemgetter(0)) - 1, 0)  # the last one not inside
        seen = (*state[oldest:], (time, heading, grown(state[-1], time, heading)))
        return seen, mean_over(seen, begin)


def grown(last: tuple[float, float, float], time: float, heading: float) -> float:
    """The integral of the heading one heading later [rad s].

    Args:
        last: Time, heading and integral before.
        time: Now [s].
        heading: Now [rad].
    """
    begin, before, integral = last
    return integral + 0.5 * (time - begin) * (before + heading)


def mean_over(window: HeadingWindow, begin: float) -> float:
    """The mean heading from a time between the first two of a window to the last one [rad].

    Args:
        window: Two headings or more.
        begin: That time [s].
    """
    (t, first, _), (end, second, _), (time, _, integral) = window[0], window[1], window[-1]
    there = first + (begin - t) / (end - t) * (second - first)
    return (integral - grown(window[0], begin, there)) / (time - begin)
