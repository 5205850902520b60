"""Combinations of unknowns in words: which of them are multiplied, divided or scaled together."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify.unknowns import ResolvedUnknown

_PART = 0.25
"""Members below this fraction of the largest one are left out of the name [-]."""
_ALIKE = 0.2
"""Exponents that differ by less than this fraction of the largest are called equal [-]."""
_ABOUT = 0.5
"""Exponents are called about equal if none is below this fraction of the largest [-]."""


class _Member(NamedTuple):
    """An unknown that takes part in a combination."""

    name: str
    """Its name, in backticks."""
    weight: float
    """Its weight, relative to the largest one [-]."""

    @property
    def factor(self) -> str:
        """It as a factor of a product, with its exponent."""
        exponent = f"{abs(self.weight):.2g}"
        if exponent == "1":
            return self.name
        return f"{self.name}^{exponent}"


def describe_combination(
    weights: Float[np.ndarray, " n"], unknowns: Sequence[ResolvedUnknown]
) -> str:
    """Describe a combination of unknowns in words.

    Args:
        weights: Weights of their coordinates, in units of their sizes; of any norm.
        unknowns: The unknowns, in the same order.
    """
    unit_weights = oriented(weights / np.linalg.norm(weights))
    largest = np.max(np.abs(unit_weights))
    by_size: list[int] = np.argsort(-np.abs(unit_weights), kind="stable").tolist()
    indices = [k for k in by_size if abs(unit_weights[k]) >= _PART * largest]
    names = [f"`{unknowns[k].name}`" for k in indices]
    if len(indices) == 1:
        return names[0]
    if not all(unknowns[k].is_log for k in indices):
        return _describe_sum(names, unit_weights[indices])
    if min(unit_weights[indices]) > _ABOUT * largest:
        spread = float(np.ptp(unit_weights[indices]))
        return _describe_common_scale(names, are_alike=bool(spread < _ALIKE * largest))
    members = [
        _Member(name=name, weight=float(unit_weights[k] / largest))
        for k, name in zip(indices, names, strict=True)
    ]
    return _describe_product(members)


def _describe_sum(names: Sequence[str], weights: np.ndarray) -> str:
    terms = [f"{weight:+.2g} {name}" for name, weight in zip(names, weights, strict=True)]
    return f"the combination {' '.join(terms)}"


def _describe_common_scale(names: Sequence[str], are_alike: bool) -> str:
    scale = f"the common scale of {', '.join(names[:-1])} and {names[-1]}"
    if are_alike:
        return scale
    return f"about {scale}"


def _describe_product(members: Sequence[_Member]) -> str:
    numerator = [member.factor for member in members if member.weight > 0.0]
    denominator = [member.factor for member in members if member.weight < 0.0]
    if not denominator:
        return f"the product {' '.join(numerator)}"
    divisor = denominator[0]
    if len(denominator) > 1:
        divisor = f"({' '.join(denominator)})"
    return f"the ratio {' '.join(numerator)} / {divisor}"


def oriented(vector: np.ndarray) -> np.ndarray:
    """Return the vector with the sign that makes its largest component positive.

    Args:
        vector: Vector of weights.
    """
    return vector * np.sign(vector[np.argmax(np.abs(vector))])
