"""Where the hinges go that stand for the bending of a plate, and how stiff they are.

A plate that is clamped at its root and free at its end stores the energy of its bending moment M,

    U = integral of M(s)^2 / (2 E I) ds,        s = 0 at the root, 1 at the free end.

Rigid pieces with a hinge at each s_j store sum of M(s_j)^2 D_j / (2 E I) if hinge j has the stiffness E I / D_j: they
stand for the plate as a quadrature rule stands for the integral. At a free end neither moment nor shear force is left,
so M goes as (1 - s)^2 there whatever the load, and the integrand as (1 - s)^4. The rule for that is the Gauss-Jacobi
rule of weight (1 - s)^4: exact for (1 - s)^4 times any polynomial up to degree 2 m - 1, with m hinges.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

MOST_HINGES = 6
_FREE_END = 4  # the power of (1 - s)


@dataclass(frozen=True, kw_only=True)
class Hinge:
    """A passive hinge in place of the bending of a part of a plate."""

    position: float
    """Distance from the root [m]."""
    length: float
    """D, the length of plate whose bending it stands for [m]."""
    stiffness: float
    """k = E I / D [N m/rad]."""
    damping: float
    """d = eta I / D [N m s/rad]."""


@dataclass(frozen=True, kw_only=True)
class Piece:
    """A part of the plate that stays rigid."""

    begin: float
    """Distance of its head end from the root [m]."""
    end: float
    """Distance of its tail end from the root [m]."""
    mass: float
    """[kg]."""
    hinge: Hinge | None
    """The passive hinge at its head end; None at the root."""

    @property
    def length(self) -> float:
        """[m]."""
        return self.end - self.begin


@lru_cache(maxsize=MOST_HINGES)
def hinge_rule(n: int) -> tuple[tuple[float, float], ...]:
    """Where n hinges go, and the length that each stands for, as shares of the plate's length, root first.

    Golub and Welsch, Math. Comput. 23, 1969: the nodes are the eigenvalues of a symmetric matrix of the polynomials'
    recurrence, here of the Jacobi polynomials with the parameters 4 and 0.

    Args:
        n: Number of hinges.
    """
    k, power = np.arange(n), _FREE_END
    middle = -(power**2) / ((2.0 * k + power) * (2.0 * k + power + 2.0))
    k = k[1:]
    beside = 2.0 * k * (k + power) / ((2.0 * k + power) * np.sqrt((2.0 * k + power) ** 2 - 1.0))
    node, vector = np.linalg.eigh(np.diag(middle) + np.diag(beside, 1) + np.diag(beside, -1))
    place = 0.5 * (1.0 + node)
    share = vector[0] ** 2 / (power + 1.0) / (1.0 - place) ** power
    return tuple((float(s), float(d)) for s, d in zip(place, share, strict=True))
