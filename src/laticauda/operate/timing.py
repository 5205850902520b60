"""How punctual the loop was: period and latency of every tick, and the deadlines that it missed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

Times = Float[np.ndarray, " n_ticks"]
SPREAD = ("median", "p99", "largest")


class Tick(NamedTuple):
    """One tick of the loop."""

    due: float
    """When it was to begin [s]."""
    began: float
    """When it began [s]."""
    sent: float
    """When its last frame had been handed to the bus [s]."""

    @property
    def time(self) -> float:
        """When it began [s]."""
        return self.began


@dataclass(frozen=True, kw_only=True, eq=False)
class Timing:
    """The ticks of one operation."""

    due: Times
    """When each was to begin [s]."""
    began: Times
    """When it began [s]."""
    sent: Times
    """When its last frame had been handed to the bus [s]."""
    interval: float
    """Between two ticks, as asked for [s]."""

    @property
    def period(self) -> Times:
        """From the begin of a tick to that of the next [s]."""
        return np.diff(self.began)

    @property
    def latency(self) -> Times:
        """From when a tick was due until its last frame was sent [s]."""
        return self.sent - self.due

    @property
    def missed(self) -> int:
        """Ticks that were not over when the next was due [-]."""
        return int(np.count_nonzero(self.latency > self.interval))

    def summary(self) -> dict[str, float | int]:
        """Median, 99th percentile and largest of period and latency, the ticks and the missed deadlines."""
        found: dict[str, float | int] = {"ticks": int(self.due.size), "interval": self.interval, "missed": self.missed}
        for name in ("period", "latency"):
            values: Times = getattr(self, name)
            if values.size:
                numbers = np.percentile(values, (50.0, 99.0, 100.0)).tolist()
                found |= {f"{name}_{of}": number for of, number in zip(SPREAD, numbers, strict=True)}
        return found


def timing_of(ticks: Sequence[Tick], interval: float) -> Timing:
    """The ticks of an operation together.

    Args:
        ticks: In their order.
        interval: Between two of them, as asked for [s].
    """
    due, began, sent = np.array(ticks).T if ticks else np.zeros((3, 0))
    return Timing(due=due, began=began, sent=sent, interval=interval)
