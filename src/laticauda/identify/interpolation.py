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
    step = (time[-1] - time[0]) / (time.size - 1)
    position = (moments - time[0]) / step
    first = np.clip(np.floor(position).astype(int) - 1, 0, max(time.size - _N_POINTS, 0))
    s = position - first  # in steps, from the first of the nearest samples
    n_points = min(_N_POINTS, time.size)
    of_one_moment = (-1, *[1] * (values.ndim - 1))
    total = 0.0
    for j in range(n_points):
        lagrange_factors = [(s - k) / (j - k) for k in range(n_points) if k != j]
        weight = np.prod(lagrange_factors, axis=0)
        total = total + weight.reshape(of_one_moment) * values[first + j]
    return np.asarray(total)
