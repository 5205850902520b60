"""Rates and values between samples: slopes of fitted polynomials, and linear interpolation."""

from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.trials.arrays import Samples

LARGEST_ORDER = 3
"""Order of the polynomials whose slopes are the rates, unless there are too few samples."""
SMALLEST_HALF_WIDTH = 2
"""Samples on each side of the middle of a window at least."""
LARGEST_UNEVENNESS = 1e-3
"""Deviation of the times from an even grid up to which they count as even, in steps."""

Columns: TypeAlias = Float[np.ndarray, "n_samples n_columns"]


def differentiate_signal(
    time: Samples, signal: Float[np.ndarray, "n ..."], window: float
) -> Float[np.ndarray, "n ..."]:
    """Compute the slope of a signal: that of the cubic polynomial fitted over a window around each moment.

    This is a Savitzky-Golay filter, exact for cubic polynomials even at both ends, where the window
    is one-sided. It damps what is faster than about 1 / window. Unevenly spaced samples are first
    interpolated onto an even grid.

    Args:
        time: Times of the samples [s], strictly increasing.
        signal: Values at the samples.
        window: Length of the window [s]; it covers at least five samples, or all of them if there
            are fewer.

    Source:
        Savitzky and Golay, Analytical Chemistry 36 (1964) 1627.
    """
    n_samples = time.size
    if n_samples < 2:
        return np.zeros_like(signal)
    step = float(time[-1] - time[0]) / (n_samples - 1)
    half_width = max(round(0.5 * window / step), SMALLEST_HALF_WIDTH)
    width = min(2 * half_width + 1, n_samples)
    values = signal.reshape(n_samples, -1)
    even_time = time[0] + step * np.arange(n_samples)
    is_even = bool(np.max(np.abs(even_time - time)) < LARGEST_UNEVENNESS * step)
    if is_even:
        slope = _slope_per_sample(values, width) / step
    else:
        even_values = interpolate_columns(even_time, time, values)
        even_slope = _slope_per_sample(even_values, width) / step
        slope = interpolate_columns(time, even_time, even_slope)
    return slope.reshape(signal.shape)


def _slope_per_sample(values: Columns, width: int) -> Columns:
    """Compute the slopes of the columns per sample, with windows of `width` samples."""
    half_width = width // 2
    order = min(LARGEST_ORDER, width - 1)
    offsets = np.arange(width) - 0.5 * (width - 1)  # from the middle of the window, in samples
    coefficients_from_values = np.linalg.pinv(np.vander(offsets, order + 1, increasing=True))
    powers = np.arange(1, order + 1)
    slopes_from_coefficients = powers * offsets[:, np.newaxis] ** (powers - 1)
    # One row for each place in a window where the slope is wanted.
    weights = slopes_from_coefficients @ coefficients_from_values[1:]
    windows = np.lib.stride_tricks.sliding_window_view(values, width, axis=0)
    begin = weights[:half_width] @ values[:width]
    middle = windows @ weights[half_width]
    end = weights[half_width + 1 :] @ values[-width:]
    return np.concatenate((begin, middle, end))


def interpolate_columns(
    times: Float[np.ndarray, "*times"], sample_times: Samples, values: Columns
) -> Float[np.ndarray, "*times n_columns"]:
    """Interpolate linearly between known values, column by column; a column without known values stays nan.

    Args:
        times: Times at which values are wanted [s].
        sample_times: Times of the samples, increasing [s].
        values: Values at the samples; nan where unknown.
    """
    interpolated = np.full((*times.shape, values.shape[1]), np.nan)
    for i, column in enumerate(values.T):
        is_known = np.isfinite(column)
        if is_known.any():
            interpolated[..., i] = np.interp(times, sample_times[is_known], column[is_known])
    return interpolated
