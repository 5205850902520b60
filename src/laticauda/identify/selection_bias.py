"""Bias of numbers that were published because they were the best of several."""

import math

import numpy as np

from laticauda.values import check_whole_number

_REACH = 10.0
"""Range of the integral on either side of 0, in standard deviations [-]."""
_N_POINTS = 4001
"""Points of the integral [-]."""


def mean_of_the_greatest(n: int) -> float:
    """Return the mean maximum of n independent standard normal numbers [-].

    It is 0, 0.564, 0.846, 1.029 for n = 1 to 4.

    Of n settings that are truly equally good, the one that is measured best appears in the table.
    Its noise is the maximum of n. With the distribution function F and the density f of the
    standard normal distribution,

        E[max] = n integral x f(x) F(x)^(n-1) dx

    Args:
        n: Number of settings, at least 1.

    Raises:
        ValueError: If n is not a whole number >= 1.
    """
    check_whole_number("n", n, 1)
    if n == 1:
        return 0.0
    x = np.linspace(-_REACH, _REACH, _N_POINTS)
    step = x[1] - x[0]
    density = np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    probability_below = np.array([_normal_distribution(point) for point in x])
    integral = np.sum(x * density * probability_below ** (n - 1))
    return float(n * integral * step)


def _normal_distribution(x: float) -> float:
    """Return the distribution function F of the standard normal distribution."""
    return 0.5 * math.erfc(-x / math.sqrt(2.0))
