"""What the data do not see: directions in the space of the unknowns along which the predictions hardly change."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.identify.unknowns import ResolvedUnknown

LIMIT = 0.5
"""A combination whose standard deviation is more than this share of itself counts as not seen [-]."""
_FLAT = 1e-13  # eigenvalues below this share of the greatest are rounding
_PART = 0.25  # members of a combination below this share of its greatest one are left out of its name
_HARDLY = 0.1  # members of a direction below this share of its length are those that hardly take part
_ALIKE = 0.2  # exponents that differ by less than this share are called equal,
_ABOUT = 0.5  # and about equal if none is less than this share of the greatest


@dataclass(frozen=True, kw_only=True, eq=False)
class Direction:
    """One eigenvector of the information: a combination of the unknowns."""

    weights: Float[np.ndarray, " n_unknowns"]
    """Of the unknowns, of length 1: of their logarithms, or in their sizes on a linear scale [-]."""
    sigma: float
    """Standard deviation of the combination as the data have it, inf if they do not see it at all [-]."""
    is_seen: bool
    """Whether no unknown is more uncertain than the limit for it."""
    name: str
    """The combination in words: what is multiplied and divided."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Identifiability:
    """What data can say about unknowns near some values of them, without any prior."""

    directions: tuple[Direction, ...]
    """From the one seen best to the one seen worst."""
    sigma: Float[np.ndarray, " n_unknowns"]
    """Of each unknown: its standard deviation, as a share of it or of its size; inf if unseen [-]."""
    without_effect: tuple[str, ...]
    """Unknowns that no number depends on."""
    limit: float
    """What counts as not seen [-]."""

    @property
    def unseen(self) -> tuple[Direction, ...]:
        """The directions that the data do not see."""
        return tuple(direction for direction in self.directions if not direction.is_seen)

    @property
    def words(self) -> tuple[str, ...]:
        """A sentence for each of them."""
        return tuple(f"The data do not see {direction.name}." for direction in self.unseen)


def identifiability(
    information: Float[np.ndarray, "n n"], unknowns: Sequence[ResolvedUnknown], *, limit: float = LIMIT
) -> Identifiability:
    """Eigenvalues and eigenvectors of the information, in shares of the unknowns.

    With the Jacobian J of the residuals (in standard deviations) to x = ln q, or to q in its size, the information is
    F = J^T J. The eigenvector w with the eigenvalue e stands for a combination that the data know to 1/sqrt(e).

    Args:
        information: F, of the data alone.
        unknowns: In its order.
        limit: A combination whose standard deviation is more than this share of itself counts as not seen [-].
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
        without_effect=tuple(unknown.name for unknown, row in zip(unknowns, scaled, strict=True) if not row.any()),
        limit=limit,
    )


def strengths(information: Float[np.ndarray, "n n"]) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, "n n"]]:
    """Eigenvalues of an information, 0 where they are rounding, and its eigenvectors, a column each.

    Args:
        information: In the sizes of the unknowns.
    """
    eigenvalues, vectors = np.linalg.eigh(0.5 * (information + information.T))
    return np.where(eigenvalues > _FLAT * max(float(eigenvalues[-1]), 0.0), eigenvalues, 0.0), vectors


def deviations(
    eigenvalues: Float[np.ndarray, " n"],
    vectors: Float[np.ndarray, "n n"],
    reach: Float[np.ndarray, " n"] | float = np.inf,
) -> Float[np.ndarray, " n"]:
    """Square roots of the diagonal of the inverse; inf for what an eigenvalue of 0 takes part in.

    Args:
        eigenvalues: Of the information.
        vectors: Its eigenvectors, a column each.
        reach: How far one can go along each before a range ends: what hardly takes part moves no further with it.
    """
    share = vectors**2
    takes_part = (share > 1e-8) | (eigenvalues > 0.0)  # less is rounding of the eigenvectors
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(takes_part, share / eigenvalues, 0.0)
        led = np.where(share > _HARDLY**2, np.inf, share * np.square(reach))
    return np.sqrt(np.sum(np.fmin(own, led), axis=1))


def marginal(information: Float[np.ndarray, "n n"], keep: Sequence[int]) -> Float[np.ndarray, "n_kept n_kept"]:
    """Information about some unknowns where all others stay unknown too: a Schur complement.

    Args:
        information: About all.
        keep: Numbers of those that count.
    """
    rest = [k for k in range(len(information)) if k not in keep]
    between = information[np.ix_(list(keep), rest)]
    hidden = np.linalg.pinv(information[np.ix_(rest, rest)], hermitian=True)
    return information[np.ix_(list(keep), list(keep))] - between @ hidden @ between.T


def combination_of(weights: Float[np.ndarray, " n"], unknowns: Sequence[ResolvedUnknown]) -> str:
    """A combination of unknowns in words.

    Args:
        weights: Of their coordinates, in their sizes; any length.
        unknowns: In this order.
    """
    weights = _oriented(weights / np.linalg.norm(weights))
    greatest = np.max(np.abs(weights))
    order: list[int] = np.argsort(-np.abs(weights), kind="stable").tolist()
    members = [k for k in order if abs(weights[k]) >= _PART * greatest]
    names = [f"`{unknowns[k].name}`" for k in members]
    if len(members) == 1:
        return names[0]
    if not all(unknowns[k].is_log for k in members):
        terms = " ".join(f"{weights[k]:+.2g} {name}" for k, name in zip(members, names, strict=True))
        return f"the combination {terms}"
    if min(weights[members]) > _ABOUT * greatest:
        about = "" if np.ptp(weights[members]) < _ALIKE * greatest else "about "
        return f"{about}the common scale of {', '.join(names[:-1])} and {names[-1]}"
    powers = [f"{abs(weights[k]) / greatest:.2g}" for k in members]
    factors = [name if power == "1" else f"{name}^{power}" for name, power in zip(names, powers, strict=True)]
    over, under = ([one for k, one in zip(members, factors, strict=True) if weights[k] * s > 0] for s in (1, -1))
    below = f"({' '.join(under)})" if len(under) > 1 else "".join(under)
    return f"the ratio {' '.join(over)} / {below}" if under else f"the product {' '.join(over)}"


def _oriented(vector: np.ndarray) -> np.ndarray:
    """With its greatest member positive."""
    return vector * np.sign(vector[np.argmax(np.abs(vector))])
