"""Interpolation of logs, also of those that carry a derivative, at the times of a measurement."""

import numpy as np
from jaxtyping import Float

_N_POINTS = 4
"""Samples through which a cubic is laid."""


def interpolated(
    time: Float[np.ndarray, " n"], values: np.ndarray, moments: Float[np.ndarray, " m"]
) -> np.ndarray:
    """Interpolate evenly spaced samples at other times, by the cubic through the four nearest ones.

    Args:
        time: Times of the samples, at least four [s].
        values: The samples, time first; may be complex.
        moments: Times at which to interpolate [s].
    """
    step = (time[-1] - time[0]) / max(time.size - 1, 1)
    if not step > 0.0:  # the run failed at once
        return np.full((moments.size, *values.shape[1:]), np.nan, values.dtype)
    position = (moments - time[0]) / step
    n_points = min(_N_POINTS, time.size)
    # A moment lies between the second and the third of its samples, but for those at the ends.
    index_before = np.floor(position).astype(int)
    first = np.clip(index_before - 1, 0, time.size - n_points)
    s = position - first
    total = 0.0
    for j in range(n_points):
        # The polynomial of Lagrange that is 1 at sample j, and 0 at the others.
        factors = [(s - k) / (j - k) for k in range(n_points) if k != j]
        weight = np.prod(factors, axis=0)
        total = total + _along_first_axis(weight, values.ndim) * values[first + j]
    return np.asarray(total)


def _along_first_axis(weight: np.ndarray, n_axes: int) -> np.ndarray:
    """Return a weight for each moment in a shape that multiplies samples with so many axes."""
    return weight.reshape(-1, *[1] * (n_axes - 1))
