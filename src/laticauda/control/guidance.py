"""Guidance and heading: from the distance to the path to the heading that leads back to it.

Each guidance law consists of `init` and `step` with an explicit state. The reference heading is in
world axes and within half a turn of the robot's heading, so that no law ever asks for a full turn.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeAlias, TypeVar

import numpy as np

from laticauda.control.frames import PathFrame
from laticauda.values import BadArgument, Extensible, quantity, value_class, wrap_to_pi

if TYPE_CHECKING:
    from laticauda.control.vector_guidance import VectorGuidance

State = TypeVar("State")


class Guidance(Extensible, Generic[State], group="guidance"):
    """Guidance law: turns a position relative to the path into a reference heading.

    Custom laws subclass this class.
    """

    def init(self) -> State:
        """Return the initial state."""
        raise NotImplementedError

    def step(
        self, state: State, frame: PathFrame, heading: float, dt: float, is_saturated: bool
    ) -> tuple[State, float]:
        """Return the reference heading.

        Args:
            state: State returned by the last call or by `init`.
            frame: Position relative to the path.
            heading: Theta of the robot [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.

        Returns:
            The new state, and theta_ref in world axes, within half a turn of `heading` [rad].
        """
        raise NotImplementedError

    @classmethod
    def vectorize(cls, laws: Sequence[Any]) -> "VectorGuidance | None":
        """Return one object that computes many laws of this class; None: they are called one by one.

        It stands for `init` and `step`; a subclass that changes these is not asked.

        Args:
            laws: Laws of this class, one for each robot.
        """
        del laws
        return None


@value_class
class LineOfSight(Guidance[None]):
    """Line-of-sight guidance: head for the point of the path one look-ahead distance ahead.

        theta_ref = path_tangential_angle - atan(cross_track_error / look_ahead_distance)

    Equation (7) of the paper, for a path in any direction. A steady current across the path leaves
    a steady error.

    Raises:
        ValueError: If the look-ahead distance is not positive.

    Example:
        >>> frame = PathFrame(
        ...     along_track_distance=0.0,
        ...     cross_track_error=1.0,
        ...     path_tangential_angle=0.0,
        ...     curvature=0.0,
        ...     remaining=9.0,
        ... )
        >>> law = LineOfSight(look_ahead_distance=1.0)
        >>> round(math.degrees(law.step(law.init(), frame, 0.0, 0.05, False)[1]))
        -45
    """

    look_ahead_distance: float = quantity("m", "Delta; smaller means a steeper approach", gt=0.0)

    def init(self) -> None:
        """Return None: the law has no state."""

    def step(
        self, state: None, frame: PathFrame, heading: float, dt: float, is_saturated: bool
    ) -> tuple[None, float]:
        """Return the reference heading [rad].

        Args:
            state: None.
            frame: Position relative to the path.
            heading: Theta of the robot [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.
        """
        slope = frame.cross_track_error / self.look_ahead_distance
        return None, _approach_path(frame, slope, heading)

    @classmethod
    def vectorize(cls, laws: Sequence[Any]) -> "VectorGuidance":
        """Return one object that computes many of these laws.

        Args:
            laws: The laws, one for each robot.
        """
        from laticauda.control.vector_guidance import LinesOfSight

        look_ahead_distance = np.array([law.look_ahead_distance for law in laws])
        return LinesOfSight(look_ahead_distance, np.zeros(len(laws)))


@value_class
class IntegralLineOfSight(Guidance[float]):
    """Line-of-sight guidance with integral action, which removes the error of a steady current.

        theta_ref = path_tangential_angle - atan((e + sigma y) / Delta)
        y' = Delta e / ((e + sigma y)^2 + Delta^2)

    Far from the path y hardly grows, so it does not wind up during the approach; it does not grow
    at all while the offset is at its limit, where a larger command has no effect.

    Raises:
        ValueError: If the look-ahead distance is not positive, or the gain is negative.
    """

    look_ahead_distance: float = quantity("m", "Delta", gt=0.0)
    integral_gain: float = quantity("m/s", "sigma; 0 gives `LineOfSight`", ge=0.0)

    def init(self) -> float:
        """Return the initial integral y, 0 [s]."""
        return 0.0

    def step(
        self, state: float, frame: PathFrame, heading: float, dt: float, is_saturated: bool
    ) -> tuple[float, float]:
        """Return the integral [s] and the reference heading [rad].

        Args:
            state: Integral returned by the last call or by `init` [s].
            frame: Position relative to the path.
            heading: Theta of the robot [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.
        """
        delta = self.look_ahead_distance
        error = frame.cross_track_error
        if not is_saturated:
            aim = error + self.integral_gain * state
            state += dt * delta * error / (aim * aim + delta * delta)
        slope = (error + self.integral_gain * state) / delta
        return state, _approach_path(frame, slope, heading)

    @classmethod
    def vectorize(cls, laws: Sequence[Any]) -> "VectorGuidance":
        """Return one object that computes many of these laws.

        Args:
            laws: The laws, one for each robot.
        """
        from laticauda.control.vector_guidance import LinesOfSight

        look_ahead_distance = np.array([law.look_ahead_distance for law in laws])
        return LinesOfSight(look_ahead_distance, np.array([law.integral_gain for law in laws]))


def _approach_path(frame: PathFrame, slope: float, heading: float) -> float:
    """Return the direction that approaches the path with a slope [rad].

    It is within half a turn of `heading`.
    """
    return heading + wrap_to_pi(frame.path_tangential_angle - math.atan(slope) - heading)


# ---- heading: its estimate for an undulating body, and the offset that turns it ------------------

ROUNDING = 1e-9
"""Smaller than the time between any two control instants [s]."""


@value_class
class HeadingController:
    """Proportional heading controller: the joints' offset that turns the robot toward a heading.

        phi_0 = k (theta_ref - theta), within +-max_offset

    Equation (8) of the paper; the error is wrapped, so the robot takes the shorter turn.

    Raises:
        ValueError: If a field is not positive.

    Example:
        >>> HeadingController(gain=0.4, max_offset=0.35).offset(heading_ref=0.5, heading=0.0)
        (0.2, False)
    """

    gain: float = quantity("", "k, offset per heading error", gt=0.0)
    max_offset: float = quantity("rad", "Largest offset to either side", gt=0.0)

    def offset(self, *, heading_ref: float, heading: float) -> tuple[float, bool]:
        """Return the offset to command.

        Args:
            heading_ref: theta_ref [rad].
            heading: theta [rad].

        Returns:
            phi_0, positive to turn left [rad], and whether it is at its limit.
        """
        offset = self.gain * wrap_to_pi(heading_ref - heading)
        if offset > self.max_offset:
            return self.max_offset, True
        if offset < -self.max_offset:
            return -self.max_offset, True
        return offset, False


class HeadingSample(NamedTuple):
    """Heading at one time, with what a mean over any window needs."""

    time: float
    """Its time [s]."""
    heading: float
    """Theta, unwrapped [rad]."""
    integral: float
    """Integral of the heading from the very first sample to this one [rad s]."""


HeadingWindow: TypeAlias = tuple[HeadingSample, ...]
"""Headings in the window, oldest first; the first one is at or before the start of the window."""


@value_class
class HeadingEstimate:
    """Heading as the mean over the most recent time window.

    The mean link angle (6) contains the ripple of the gait. A window of one gait period removes the
    ripple and lags by half a period; a window of 0 gives (6) unchanged. Until a whole window has
    passed, the mean covers the time so far.

    Raises:
        ValueError: If the window is negative.
    """

    window: float = quantity(
        "s", "Averaging time; the gait's period, or 0 for no mean", ge=0.0, default=0.0
    )

    def init(self) -> HeadingWindow:
        """Return an empty window."""
        return ()

    def step(
        self, state: HeadingWindow, time: float, heading: float
    ) -> tuple[HeadingWindow, float]:
        """Add one heading and return the mean.

        The headings need not be equally spaced in time; they are interpolated linearly.

        Args:
            state: Window returned by the last call or by `init`.
            time: Time of the heading, later than the last one [s].
            heading: Theta, unwrapped [rad].

        Returns:
            The new window, and the mean over it [rad].
        """
        if self.window == 0.0 or not state:
            return (HeadingSample(time, heading, 0.0),), heading
        last = state[-1]
        if time - last.time <= ROUNDING:
            rule = "must increase from step to step"
            raise BadArgument("time", f"{rule}, got {last.time} s and then {time} s")
        begin = max(time - self.window, state[0].time)
        n_before = bisect_right(state, begin + ROUNDING, key=attrgetter("time"))
        last_before = max(n_before - 1, 0)
        latest = HeadingSample(time, heading, extend_integral(last, time, heading))
        window = (*state[last_before:], latest)
        return window, compute_mean_heading(window, begin)


def extend_integral(last: HeadingSample, time: float, heading: float) -> float:
    """Return the integral of the heading, extended by one heading [rad s].

    Args:
        last: Previous heading.
        time: Current time [s].
        heading: Current heading [rad].
    """
    return last.integral + 0.5 * (time - last.time) * (last.heading + heading)


def compute_mean_heading(window: HeadingWindow, begin: float) -> float:
    """Return the mean heading from a time between the first two headings to the last one [rad].

    Args:
        window: Two or more headings.
        begin: Time at which the mean starts [s].
    """
    first = window[0]
    second = window[1]
    last = window[-1]
    share = (begin - first.time) / (second.time - first.time)
    heading_at_begin = first.heading + share * (second.heading - first.heading)
    integral_at_begin = extend_integral(first, begin, heading_at_begin)
    return (last.integral - integral_at_begin) / (last.time - begin)
