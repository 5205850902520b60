"""Series of measured values: running medians, jumps, and how far values have spread."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

MEDIAN_LENGTH = 7
"""Camera frames in a running median: up to three wrong ones among them do not count."""
LONGEST_GAP = 0.3
"""Longest gap between two samples that still belong together [s]."""

Series: TypeAlias = Float[np.ndarray, "n_samples ..."]


@dataclass(frozen=True)
class Jumps:
    """Jumps of a series: by how much its median changes from one window to the next."""

    times: Float[np.ndarray, " n_jumps"]
    """When each was known: at the last sample of the second window [s]."""
    sizes: Float[np.ndarray, "n_jumps ..."]
    """Their sizes, without sign; nan across a gap."""


def running_median(values: ArrayLike, length: int = MEDIAN_LENGTH) -> Series:
    """Return the running median over `length` samples: single wrong ones do not count."""
    samples = np.asarray(values, float)
    half = length // 2
    padded = np.concatenate((samples[:half], samples, samples[-half:]))
    windows = np.lib.stride_tricks.sliding_window_view(padded, length, axis=0)
    return np.median(windows, axis=-1)


def jumps_of(
    times: Float[np.ndarray, " n_samples"],
    values: Series,
    *,
    longest: float,
    length: int = MEDIAN_LENGTH,
) -> Jumps:
    """Return the jumps between neighboring windows of `length` samples.

    Args:
        times: Times of the samples [s].
        values: The series.
        longest: Longest time that two windows may span together [s]; jumps over more are nan.
        length: Samples in a window.
    """
    half = length // 2
    medians = running_median(values, length)[half:-half]
    sizes = np.abs(medians[length:] - medians[:-length])
    ends = times[2 * length - 1 :]
    spans = ends - times[: 1 - 2 * length]
    return Jumps(times=ends, sizes=np.where(spans < longest, sizes.T, np.nan).T)


def swing_of(values: Float[np.ndarray, "n_cycles n_points"]) -> Float[np.ndarray, " n_cycles"]:
    """Return the root mean square of every cycle, after removing its mean and slope."""
    phase = np.linspace(-1.0, 1.0, values.shape[1])
    trend = np.polynomial.polynomial.polyfit(phase, values.T, 1)
    swing = values - np.polynomial.polynomial.polyval(phase, trend)
    return np.sqrt(np.mean(swing**2, axis=1))


def range_so_far(values: Float[np.ndarray, " n_values"]) -> Float[np.ndarray, " n_values"]:
    """Return the range that a series has covered up to each value."""
    return np.maximum.accumulate(values) - np.minimum.accumulate(values)
