"""Identifiability: directions in the space of the unknowns along which the predictions hardly change."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.identify.unknowns import ResolvedUnknown

LIMIT = 0.5
"""Relative standard deviation above which a combination counts as not seen by the data [-]."""
_FLAT = 1e-13  # eigenvalues below this fraction of the largest are rounding errors
_PART = (
    0.25  # members of a combination below this fraction of its largest one are left out of its name
)
_HARDLY = 0.1  # members of a direction below this fraction of its length hardly take part in it
_ALIKE = 0.2  # exponents that differ by less than this fraction of the largest are called equal,
_ABOUT = 0.5  # and about equal if none is below this fraction of the largest


@dataclass(frozen=True, kw_only=True, eq=False)
class Direction:
    """One eigenvector of the information: a combination of the unknowns."""

    weights: Float[np.ndarray, " n_unknowns"]
    """Unit vector of weights of the unknowns: of their logarithms, or in units of their sizes on a linear scale [-]."""
    sigma: float
    """Standard deviation of the combination given the data; inf if they do not see it at all [-]."""
    is_seen: bool
    """Whether its uncertainty moves no unknown by more than the limit."""
    name: str
    """The combination in words: which unknowns are multiplied and divided."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Identifiability:
    """What data can say about unknowns near given values, without any prior."""

    directions: tuple[Direction, ...]
    """Directions, from the best seen to the worst seen."""
    sigma: Float[np.ndarray, " n_unknowns"]
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
    information: Float[np.ndarray, "n n"],
    unknowns: Sequence[ResolvedUnknown],
    *,
    limit: float = LIMIT,
) -> Identifiability:
    """Analyze the eigenvalues and eigenvectors of the information, relative to the sizes of the unknowns.

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
    strength, vectors = strengths(scaled)
    ranges = np.array([np.ptp(unknown.ends) for unknown in unknowns]) / sizes
    with np.errstate(divide="ignore"):
        sigma = 1.0 / np.sqrt(strength)
        reach = np.min(ranges[:, np.newaxis] / np.abs(vectors), axis=0)
    directions = tuple(
        Direction(
            weights=_oriented(vectors[:, j]),
            sigma=float(sigma[j]),
            is_seen=bool(sigma[j] * np.max(np.abs(vectors[:, j])) < limit),
            name=combination_of(vectors[:, j], unknowns),
        )
        for j in reversed(range(len(unknowns)))
    )
    return Identifiability(
        directions=directions,
        sigma=deviations(strength, vectors, reach),
        without_effect=tuple(
            unknown.name for unknown, row in zip(unknowns, scaled, strict=True) if not row.any()
        ),
        limit=limit,
    )


def strengths(
    information: Float[np.ndarray, "n n"],
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, "n n"]]:
    """Return the eigenvalues of an information matrix, 0 for rounding errors, and its eigenvectors as columns.

    Args:
        information: Information, in units of the sizes of the unknowns.
    """
    eigenvalues, vectors = np.linalg.eigh(0.5 * (information + information.T))
    return np.where(
        eigenvalues > _FLAT * max(float(eigenvalues[-1]), 0.0), eigenvalues, 0.0
    ), vectors


def deviations(
    eigenvalues: Float[np.ndarray, " n"],
    vectors: Float[np.ndarray, "n n"],
    reach: Float[np.ndarray, " n"] | float = np.inf,
) -> Float[np.ndarray, " n"]:
    """Return the square roots of the diagonal of the inverse; inf for unknowns in a direction with eigenvalue 0.

    Args:
        eigenvalues: Eigenvalues of the information.
        vectors: Its eigenvectors, as columns.
        reach: Distance along each eigenvector to the end of a range; it bounds unknowns that hardly
            take part.
    """
    share = vectors**2
    takes_part = (share > 1e-8) | (
        eigenvalues > 0.0
    )  # smaller shares are rounding errors of the eigenvectors
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(takes_part, share / eigenvalues, 0.0)
        led = np.where(share > _HARDLY**2, np.inf, share * np.square(reach))
    return np.sqrt(np.sum(np.fmin(own, led), axis=1))


def marginal(
    information: Float[np.ndarray, "n n"], keep: Sequence[int]
) -> Float[np.ndarray, "n_kept n_kept"]:
    """Return the information about some unknowns while all others stay unknown too: a Schur complement.

    Args:
        information: Information about all unknowns.
        keep: Indices of the unknowns to keep.
    """
    rest = [k for k in range(len(information)) if k not in keep]
    between = information[np.ix_(list(keep), rest)]
    hidden = np.linalg.pinv(information[np.ix_(rest, rest)], hermitian=True)
    return information[np.ix_(list(keep), list(keep))] - between @ hidden @ between.T


def combination_of(weights: Float[np.ndarray, " n"], unknowns: Sequence[ResolvedUnknown]) -> str:
    """Describe a combination of unknowns in words.

    Args:
        weights: Weights of their coordinates, in units of their sizes; of any norm.
        unknowns: The unknowns, in the same order.
    """
    weights = _oriented(weights / np.linalg.norm(weights))
    greatest = np.max(np.abs(weights))
    order: list[int] = np.argsort(-np.abs(weights), kind="stable").tolist()
    members = [k for k in order if abs(weights[k]) >= _PART * greatest]
    names = [f"`{unknowns[k].name}`" for k in members]
    if len(members) == 1:
        return names[0]
    if not all(unknowns[k].is_log for k in members):
        terms = " ".join(
            f"{weights[k]:+.2g} {name}" for k, name in zip(members, names, strict=True)
        )
        return f"the combination {terms}"
    if min(weights[members]) > _ABOUT * greatest:
        about = "" if np.ptp(weights[members]) < _ALIKE * greatest else "about "
        return f"{about}the common scale of {', '.join(names[:-1])} and {names[-1]}"
    powers = [f"{abs(weights[k]) / greatest:.2g}" for k in members]
    factors = [
        name if power == "1" else f"{name}^{power}"
        for name, power in zip(names, powers, strict=True)
    ]
    over, under = (
        [one for k, one in zip(members, factors, strict=True) if weights[k] * s > 0]
        for s in (1, -1)
    )
    below = f"({' '.join(under)})" if len(under) > 1 else "".join(under)
    return f"the ratio {' '.join(over)} / {below}" if under else f"the product {' '.join(over)}"


def _oriented(vector: np.ndarray) -> np.ndarray:
    """Return the vector with the sign that makes its largest component positive."""
    return vector * np.sign(vector[np.argmax(np.abs(vector))])
