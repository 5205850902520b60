"""Between the samples of a measured log: gaps that are filled, and rates."""

import numpy as np
from jaxtyping import Bool, Float

from laticauda.errors import BadArgument
from laticauda.trial.arrays import Samples

Columns = Float[np.ndarray, "n_samples n_columns"]

ORDER = 3  # of the polynomials that are fitted


def filled(
    name: str, time: Samples, signal: Float[np.ndarray, " n_samples"], longest: float
) -> tuple[Samples, Bool[np.ndarray, " n_samples"]]:
    """A signal without gaps: straight lines where values are missing.

    Args:
        name: What the signal is called, for the message.
        time: Of the samples [s].
        signal: Values; nan where there is none.
        longest: Time over which values may be missing [s].

    Returns:
        The values, and which of them were missing.

    Raises:
        ValueError: If values are missing over a longer time, or at an end.
    """
    lost = ~np.isfinite(signal)
    if not np.any(lost):
        return signal, lost
    known = np.flatnonzero(~lost)
    advice = "cut it off by `start` and `stop`, or fill it by hand"
    if not known.size:
        raise BadArgument(name, f"must hold numbers, and it holds none from {time[0]:g} s to {time[-1]:g} s")
    if lost[0] or lost[-1]:
        end, at = ("begins", time[known[0]]) if lost[0] else ("ends", time[known[-1]])
        raise BadArgument(name, f"must hold numbers at both ends, and it {end} at {at:.6g} s; {advice}")
    steps = np.diff(time[known])
    gap = int(np.argmax(np.where(np.diff(known) > 1, steps, 0.0)))
    if steps[gap] > longest * (1.0 + 1e-9):
        begin, end = time[known[gap]], time[known[gap + 1]]
        raise BadArgument(
            name,
            f"must have no gap longer than `longest_gap` = {longest:g} s, got one of {steps[gap]:.4g} s "
            f"from {begin:.6g} s to {end:.6g} s; {advice}",
        )
    return np.interp(time, time[known], signal[known]), lost


def rate(
    time: Samples, signal: Float[np.ndarray, "n_samples ..."], window: float
) -> Float[np.ndarray, "n_samples ..."]:
    """The slope of a signal: of the cubic polynomial that fits it best over a window around each moment.

    A Savitzky-Golay filter, exact for cubic polynomials also at both ends, where the window is one-sided. It damps what
    is faster than about 1 / window. Samples that are not evenly spaced are first interpolated onto ones that are.

    Args:
        time: Of the samples [s], strictly increasing.
        signal: Values at the samples.
        window: Length of the window [s]; at least five samples are taken, or all there are.

    Source:
        Savitzky and Golay, Analytical Chemistry 36 (1964) 1627.
    """
    n = time.size
    if n < 2:
        return np.zeros_like(signal)
    step = float(time[-1] - time[0]) / (n - 1)
    even = time[0] + step * np.arange(n)
    flat = signal.reshape(n, -1)
    is_even = bool(np.max(np.abs(even - time)) < 1e-3 * step)
    values = flat if is_even else _interpolated(even, time, flat)
    width = 2 * max(round(0.5 * window / step), 2) + 1
    slope = _slopes(values, min(width, n)) / step
    if not is_even:
        slope = _interpolated(time, even, slope)
    return slope.reshape(signal.shape)


def _interpolated(at: Samples, time: Samples, values: Columns) -> Columns:
    found = np.empty((at.size, values.shape[1]))
    for i in range(values.shape[1]):
        found[:, i] = np.interp(at, time, values[:, i])
    return found


def _slopes(values: Columns, width: int) -> Columns:
    """Slopes per sample, with windows of `width` samples."""
    n, before = len(values), width // 2
    order = min(ORDER, width - 1)
    at = np.arange(width, dtype=np.float64)
    fit = np.linalg.pinv(np.vander(at - 0.5 * (width - 1), order + 1, increasing=True))  # values -> coefficients
    powers = np.arange(1, order + 1)

    def weights(where: float) -> Float[np.ndarray, " width"]:
        return (powers * (where - 0.5 * (width - 1)) ** (powers - 1)) @ fit[1:]

    slope = np.empty_like(values)
    windows = np.lib.stride_tricks.sliding_window_view(values, width, axis=0)
    slope[before : before + len(windows)] = windows @ weights(before)
    for k in range(before):
        slope[k] = weights(k) @ values[:width]
    for k in range(before + len(windows), n):
        slope[k] = weights(k - n + width) @ values[-width:]
    return slope
