"""What being the best of many does to a measured number: it is too great, by an amount that can be computed."""

import math

import numpy as np

from laticauda.errors import whole


def mean_of_the_greatest(n: int) -> float:
    """Mean of the greatest of n independent standard normal numbers: 0, 0.564, 0.846, 1.029 for n = 1 to 4 [-].

    Of n settings that are equally good in truth, the one that is measured best stands in the table. Its noise is the
    greatest of n. With the distribution function F and the density f of the standard normal,

        E[max] = n integral x f(x) F(x)^(n-1) dx

    Args:
        n: How many, at least 1.

    Raises:
        ValueError: If it is no whole number >= 1.
    """
    whole("n", n, 1)
    if n == 1:
        return 0.0
    x = np.linspace(-10.0, 10.0, 4001)
    density = np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    share = np.array([0.5 * math.erfc(-value / math.sqrt(2.0)) for value in x])
    return float(n * np.sum(x * density * share ** (n - 1)) * (x[1] - x[0]))
