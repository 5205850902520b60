"""The offset of the cameras' clock from ours, from the smallest latency of their frames."""

from typing import NamedTuple

CLOCK_WINDOW = 5.0
"""Window in which the smallest latency of the cameras is found [s]."""


class ClockState(NamedTuple):
    """What is known about another clock: smallest differences in this window and the one before."""

    smallest: float
    """Smallest difference since the window began, own clock minus the other [s]."""
    before: float
    """Smallest difference in the window before [s]."""
    began: float
    """Time at which the window began, own clock [s]."""

    @property
    def offset(self) -> float:
        """Own clock minus the other, including the smallest latency [s]."""
        return min(self.smallest, self.before)


def update_clock(
    state: ClockState | None, arrival: float, stamp: float, window: float = CLOCK_WINDOW
) -> ClockState:
    """Update what is known about the difference of two clocks with one more frame.

    A frame is never early: its arrival on our own clock minus its stamp is the offset plus a
    latency >= 0. The smallest difference of the last seconds is the best estimate; it includes the
    smallest latency. Older ones are forgotten: clocks drift, and the cameras' clock may jump when
    their computer stalls or the measurement is restarted.

    Args:
        state: State returned by the last call; None: nothing is known.
        arrival: Arrival time of the frame, own clock [s].
        stamp: Timestamp of the frame, the other clock [s].
        window: Shortest time for which a smallest latency counts; the longest is twice this [s].
    """
    difference = arrival - stamp
    if state is None or arrival - state.began >= 2.0 * window:
        return ClockState(smallest=difference, before=difference, began=arrival)
    if arrival - state.began >= window:
        return ClockState(smallest=difference, before=state.smallest, began=arrival)
    return state._replace(smallest=min(state.smallest, difference))
