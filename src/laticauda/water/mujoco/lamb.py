"""Added mass and inertia of ellipsoids, by Lamb's integrals."""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

N_NODES = 200
"""Nodes of Gauss' rule."""
EQUAL_AXES = 1e-12
"""Relative difference of squared half-axes up to which they count as equal [-]."""


class EllipsoidShares(NamedTuple):
    """Added mass and inertia of an ellipsoid in unbounded water, relative to the displaced mass."""

    mass: np.ndarray
    """k_i = alpha_i / (2 - alpha_i), per axis [-]."""
    inertia: np.ndarray
    """Added inertia over the displaced mass, per axis [m^2]."""


def lamb(half_size: Sequence[float]) -> EllipsoidShares:
    """Return added mass and inertia of an ellipsoid in unbounded water, relative to the displaced mass.

    Args:
        half_size: Half-axes [m].

    References:
        H. Lamb, Hydrodynamics, 6th ed., Cambridge 1932, art. 114 and 115.
    """
    a = np.asarray(half_size, dtype=float)
    alpha = _alpha(a)
    inertia = np.zeros(3)
    for i in range(3):
        j = (i + 1) % 3
        k = (i + 2) % 3
        b = a[j] ** 2
        c = a[k] ** 2
        if abs(b - c) > EQUAL_AXES * (b + c):
            gap = alpha[k] - alpha[j]
            inertia[i] = 0.2 * (b - c) ** 2 * gap / (2.0 * (b - c) + (b + c) * -gap)
    return EllipsoidShares(mass=alpha / (2.0 - alpha), inertia=inertia)


def _alpha(a: np.ndarray) -> np.ndarray:
    """Return alpha_i = abc int_0^inf dt / ((a_i^2 + t) Delta).

    With t = s^2 x^2 / (1 - x)^2 for Gauss' rule on (0, 1).
    """
    node, weight = _gauss_rule()
    x = 0.5 * (node + 1.0)
    scale = float(np.prod(a)) ** (2.0 / 3.0)
    t = scale * (x / (1.0 - x)) ** 2
    dt = scale * 2.0 * x / (1.0 - x) ** 3 * 0.5 * weight
    squares = a[:, np.newaxis] ** 2
    delta = np.sqrt(np.prod(squares + t, axis=0))
    return np.prod(a) * np.sum(dt / ((squares + t) * delta), axis=1)


@cache
def _gauss_rule() -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights of Gauss' rule on (-1, 1), which take longer than all the rest."""
    return np.polynomial.legendre.leggauss(N_NODES)
