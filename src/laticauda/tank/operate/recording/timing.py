"""Punctuality of the loop: when its ticks were due, when they began, and when all had been sent."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.values import BadArgument

Durations: TypeAlias = Float[np.ndarray, " n_ticks"]
PERCENTILES = {"median": 50.0, "p99": 99.0, "p99_9": 99.9, "largest": 100.0}
"""Percentiles of a summary, by the ends of their names [%]."""
COUNTS = ("ticks", "interval", "missed")
"""Figures of every summary, also of one without ticks."""
SPREADS = tuple(
    f"{name}_{percentile}"
    for name in ("lateness", "latency")
    for percentile in ("median", "p99_9", "largest")
)
"""Figures of a summary with ticks that are put into its sentence."""


@dataclass(frozen=True)
class Tick:
    """One tick of the loop."""

    due: float
    """Time at which it was due [s]."""
    began: float
    """Time at which it began [s]."""
    sent: float
    """Time at which its last frame had been handed to the bus [s]."""

    @property
    def time(self) -> float:
        """Time at which it began [s]."""
        return self.began


@dataclass(frozen=True, kw_only=True)
class Timing:
    """Punctuality of the ticks of one operation."""

    times: Float[np.ndarray, "n_ticks 3"]
    """For each tick, when it was due, when it began, and when its last frame had been handed to the
    bus [s]."""
    interval: float
    """Nominal time between two ticks [s]."""

    @property
    def due(self) -> Durations:
        """Times at which ticks were due [s]."""
        return self.times[:, 0]

    @property
    def began(self) -> Durations:
        """Times at which ticks began [s]."""
        return self.times[:, 1]

    @property
    def sent(self) -> Durations:
        """Times at which the last frames of ticks had been handed to the bus [s]."""
        return self.times[:, 2]

    @property
    def period(self) -> Durations:
        """Time from the beginning of a tick to that of the next [s]."""
        return np.diff(self.began)

    @property
    def lateness(self) -> Durations:
        """Time from when a tick was due until it began [s]."""
        return self.began - self.due

    @property
    def latency(self) -> Durations:
        """Time from when a tick was due until its last frame was sent [s]."""
        return self.sent - self.due

    @property
    def missed(self) -> int:
        """Number of ticks that were not finished when the next was due [-]."""
        return int(np.count_nonzero(self.latency > self.interval))

    def summary(self) -> dict[str, float | int]:
        """Return percentiles of period, lateness and latency, the ticks and missed deadlines."""
        figures: dict[str, float | int] = {
            "ticks": len(self.times),
            "interval": self.interval,
            "missed": self.missed,
        }
        for name in ("period", "lateness", "latency"):
            durations: Durations = getattr(self, name)
            if not durations.size:
                continue
            for percentile, share in PERCENTILES.items():
                figures[f"{name}_{percentile}"] = float(np.percentile(durations, share))
        return figures


def describe_punctuality(timing: Mapping[str, float | int]) -> str:
    """Return the summary of a `Timing` as a sentence.

    Args:
        timing: `Timing.summary`, or the `timing` of a result in JSON.

    Raises:
        BadArgument: `timing` lacks one of the figures that the sentence needs.
    """
    _check_figures(timing, COUNTS)
    interval = _milliseconds(timing["interval"])
    ticks = f"{timing['ticks']} ticks of {interval} ms, {timing['missed']} missed"
    if timing["ticks"] == 0:
        return ticks
    _check_figures(timing, SPREADS)
    lateness = _describe_spread(timing, "lateness")
    latency = _describe_spread(timing, "latency")
    return f"{ticks}; late by {lateness}; all sent after {latency}"


def _check_figures(timing: Mapping[str, float | int], names: tuple[str, ...]) -> None:
    missing = [name for name in names if name not in timing]
    if missing:
        raise BadArgument(
            "timing",
            f"must hold {', '.join(missing)}, as `Timing.summary` does, "
            f"got {', '.join(timing) or 'no figures'}",
        )


def _describe_spread(timing: Mapping[str, float | int], name: str) -> str:
    median = _milliseconds(timing[f"{name}_median"])
    almost_all = _milliseconds(timing[f"{name}_p99_9"])
    largest = _milliseconds(timing[f"{name}_largest"])
    return f"{median} ms (median), {almost_all} (99.9 %), {largest} at most"


def _milliseconds(duration: float) -> str:
    return f"{1e3 * duration:.2f}"
