"""Heading: what counts as the heading of a body that undulates, and the offset that turns it."""

from bisect import bisect_right
from operator import itemgetter
from typing import TypeAlias

from laticauda.angles import wrap_to_pi
from laticauda.errors import BadArgument
from laticauda.quantities import quantity, value

_ROUNDING = 1e-9  # [s]: two control instants are never that close


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

    gain: float = quantity("", "k", gt=0.0)
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
        last, before, integral = state[-1]
        step = time - last
        if step <= _ROUNDING:
            raise BadArgument("time", f"must grow from step to step, got {last} s and then {time} s")
        integral += 0.5 * step * (before + heading)
        begin = max(time - self.window, state[0][0])
        oldest = max(bisect_right(state, begin + _ROUNDING, key=itemgetter(0)) - 1, 0)  # the last one not inside
        seen = (*state[oldest:], (time, heading, integral))
        return seen, (integral - _integral_at(seen, begin)) / (time - begin)


def _integral_at(window: HeadingWindow, time: float) -> float:
    """The integral between the first two headings of a window [rad s]."""
    (begin, first, integral), (end, second, _) = window[:2]
    share = (time - begin) / (end - begin)
    heading = first + share * (second - first)
    return integral + 0.5 * (time - begin) * (first + heading)
