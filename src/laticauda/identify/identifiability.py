"""Identifiability: directions in which the unknowns can move with hardly any effect."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify.combinations import describe_combination, oriented
from laticauda.identify.unknowns import ResolvedUnknown

LIMIT = 0.5
"""Relative standard deviation above which a combination counts as not seen by the data [-]."""
_FLAT = 1e-13
"""Eigenvalues below this fraction of the largest are rounding errors [-]."""
_HARDLY = 0.1
"""Members of a direction below this fraction of its length hardly take part in it [-]."""
_NO_SHARE = 1e-8
"""Squared components of eigenvectors below this are rounding errors [-]."""

Information = Float[np.ndarray, "n n"]
"""Information about some unknowns: the inverse of the covariance that it would leave."""


class Spectrum(NamedTuple):
    """Eigenvalues and eigenvectors of an information matrix."""

    eigenvalues: Float[np.ndarray, " n"]
    """Eigenvalues, least first; 0 for rounding errors."""
    vectors: Float[np.ndarray, "n n"]
    """Eigenvectors, as columns."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Direction:
    """One eigenvector of the information: a combination of the unknowns."""

    weights: Float[np.ndarray, " n_unknowns"]
    """Unit vector of weights of the unknowns [-].

    They are weights of logarithms, or in units of the sizes on a linear scale.
    """
    deviation: float
    """Standard deviation of the combination given the data; inf if they do not see it [-]."""
    is_seen: bool
    """Whether its uncertainty moves no unknown by more than the limit."""
    name: str
    """The combination in words: which unknowns are multiplied and divided."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Identifiability:
    """What data can say about unknowns near given values, without any prior."""

    directions: tuple[Direction, ...]
    """Directions, from the best seen to the worst seen."""
    deviations: Float[np.ndarray, " n_unknowns"]
    """Standard deviation of each unknown, relative to its value or its size; inf if unseen [-]."""
    without_effect: tuple[str, ...]
    """Unknowns on which no measured number depends."""
    limit: float
    """Relative standard deviation above which a combination counts as not seen [-]."""

    @property
    def unseen(self) -> tuple[Direction, ...]:
        """The directions that the data do not see."""
        return tuple(direction for direction in self.directions if not direction.is_seen)

    @property
    def words(self) -> tuple[str, ...]:
        """A sentence for each unseen direction."""
        return tuple(f"The data do not see {direction.name}." for direction in self.unseen)


def analyze_identifiability(
    information: Information, unknowns: Sequence[ResolvedUnknown], *, limit: float = LIMIT
) -> Identifiability:
    """Analyze the eigenvalues and eigenvectors of the information, in units of the sizes.

    With the Jacobian J of the residuals (in standard deviations) with respect to x = ln q, or to q
    in units of its size, the information is F = J^T J. An eigenvector w with eigenvalue e is a
    combination whose standard deviation is 1/sqrt(e).

    Args:
        information: F of the data alone.
        unknowns: The unknowns, in the order of F.
        limit: Relative standard deviation above which a combination counts as not seen [-].
    """
    sizes = np.array([unknown.size for unknown in unknowns])
    scaled = information * np.outer(sizes, sizes)
    spectrum = compute_spectrum(scaled)
    weights = np.abs(spectrum.vectors)
    ranges = np.array([np.ptp(unknown.ends) for unknown in unknowns]) / sizes
    with np.errstate(divide="ignore"):
        # inf along a direction that the data do not see, whose eigenvalue is 0
        deviation_along = 1.0 / np.sqrt(spectrum.eigenvalues)
        # How far one can go along a direction until the first unknown has crossed its range: inf
        # for unknowns without a range, and for those that do not move along it.
        reach = np.min(ranges[:, np.newaxis] / weights, axis=0)
    directions: list[Direction] = []
    for j in reversed(range(len(unknowns))):
        vector = spectrum.vectors[:, j]
        direction = Direction(
            weights=oriented(vector),
            deviation=float(deviation_along[j]),
            is_seen=bool(deviation_along[j] * np.max(weights[:, j]) < limit),
            name=describe_combination(vector, unknowns),
        )
        directions.append(direction)
    without_effect = [
        unknown.name for unknown, row in zip(unknowns, scaled, strict=True) if not row.any()
    ]
    return Identifiability(
        directions=tuple(directions),
        deviations=compute_deviations(spectrum, reach),
        without_effect=tuple(without_effect),
        limit=limit,
    )


def compute_spectrum(information: Information) -> Spectrum:
    """Return the eigenvalues of an information matrix, 0 for rounding errors, and its eigenvectors.

    Args:
        information: Information, in units of the sizes of the unknowns.
    """
    eigenvalues, vectors = np.linalg.eigh(0.5 * (information + information.T))
    is_rounding = eigenvalues <= _FLAT * max(float(eigenvalues[-1]), 0.0)
    return Spectrum(eigenvalues=np.where(is_rounding, 0.0, eigenvalues), vectors=vectors)


def compute_deviations(
    spectrum: Spectrum, reach: Float[np.ndarray, " n"] | None = None
) -> Float[np.ndarray, " n"]:
    """Return the standard deviation of every unknown: the roots of the diagonal of the inverse.

    The inverse is a sum over the directions: one with the unit vector w and the eigenvalue e adds
    w_k^2 / e to the variance of unknown k. It is inf for unknowns in a direction that nobody sees
    (e = 0). An unknown that hardly takes part in such a direction is still known: along it, one can
    only go as far as the ranges of the other unknowns allow, and that moves this one by little.

    Args:
        spectrum: Eigenvalues and eigenvectors of the information.
        reach: Distance along each eigenvector to the end of a range; None: there are no ranges.
    """
    if reach is None:
        reach = np.full(spectrum.eigenvalues.size, np.inf)
    variances_by_direction: list[np.ndarray] = []
    for j, eigenvalue in enumerate(spectrum.eigenvalues):
        squared_components = spectrum.vectors[:, j] ** 2
        variances = _variances_along(squared_components, eigenvalue, reach[j])
        variances_by_direction.append(variances)
    variance_of_unknowns = np.sum(np.stack(variances_by_direction, axis=1), axis=1)
    return np.sqrt(variance_of_unknowns)


def _variances_along(
    squared_components: Float[np.ndarray, " n"], eigenvalue: float, reach: float
) -> Float[np.ndarray, " n"]:
    """Return what one direction adds to the variance of every unknown."""
    if eigenvalue > 0.0:
        variances = squared_components / eigenvalue
    else:
        takes_part = squared_components > _NO_SHARE
        variances = np.where(takes_part, np.inf, 0.0)
    if math.isinf(reach):
        return variances
    hardly_takes_part = squared_components <= _HARDLY**2
    variances_within_range = squared_components * reach**2
    bounded = np.minimum(variances, variances_within_range)
    return np.where(hardly_takes_part, bounded, variances)


def marginal(information: Information, keep: Sequence[int]) -> Float[np.ndarray, "n_kept n_kept"]:
    """Return the information about some unknowns while all others stay unknown (Schur complement).

    Args:
        information: Information about all unknowns.
        keep: Indices of the unknowns to keep.
    """
    kept = list(keep)
    removed = [k for k in range(len(information)) if k not in keep]
    between = information[np.ix_(kept, removed)]
    inverse_of_removed = np.linalg.pinv(information[np.ix_(removed, removed)], hermitian=True)
    return information[np.ix_(kept, kept)] - between @ inverse_of_removed @ between.T
