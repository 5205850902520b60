"""Designs in words: what each chosen trial contributes, and what swimming trials would miss."""

from collections.abc import Sequence

import numpy as np

from laticauda.identify.combinations import describe_combination
from laticauda.identify.identifiability import LIMIT, Information
from laticauda.identify.selection import FAINT
from laticauda.identify.trial_information import deviations_after
from laticauda.identify.unknowns import ResolvedUnknown

_CLEAR_SHRINKAGE = 0.9
"""Ratio of standard deviations up to which a trial is said to shrink one [-]."""
_INFINITE = 1e9
"""Stands for an infinite standard deviation where two are compared [-]."""
_UNKNOWN = 10.0
"""Relative standard deviation above which an unknown is called unknown [-]."""
_WHOLE_PERCENT = 0.99
"""Relative standard deviation from which on percents are rounded to whole ones [-]."""


def describe_contribution(
    unknowns: Sequence[ResolvedUnknown], known: Information, added: Information
) -> str:
    """Describe in words what a trial would contribute.

    Args:
        unknowns: The unknowns.
        known: Information before the trial, in units of the sizes of the unknowns.
        added: Information of the trial, in the same units.
    """
    before, after = deviations_after(known), deviations_after(known + added)
    shares = [
        f"`{unknown.name}` ({format_share(before[k])} before, {format_share(after[k])} after)"
        for k, unknown in enumerate(unknowns)
        if before[k] >= LIMIT > after[k]
    ]
    if shares:
        return f"makes identifiable {' and '.join(shares)}"
    ratios = np.ones(len(unknowns))
    np.divide(after, before, out=ratios, where=np.isfinite(before) & (before > 0.0))
    k = int(np.argmin(ratios))
    if ratios[k] <= _CLEAR_SHRINKAGE:
        change = f"from {format_share(before[k])} to {format_share(after[k])}"
        return f"shrinks most `{unknowns[k].name}`, {change}"
    weights = _most_improved_combination(known, added)
    return f"adds information on {describe_combination(weights, unknowns)}"


def _most_improved_combination(known: Information, added: Information) -> np.ndarray:
    """Return the weights of the combination about which a trial adds most to what is known.

    In coordinates z = R^T x, with R R^T the known information, all combinations are known equally
    well. There, it is the eigenvector of the added information with the largest eigenvalue.
    """
    root = np.linalg.cholesky(known + FAINT * np.eye(len(known)))
    half_transformed = np.linalg.solve(root, added)
    added_in_z = np.linalg.solve(root, half_transformed.T)
    _, vectors = np.linalg.eigh(added_in_z)
    most_added = vectors[:, -1]  # eigenvalues come in ascending order
    return root @ most_added


def describe_missed(
    names: Sequence[str], n_trials: int, swimming: np.ndarray, after: np.ndarray
) -> str:
    """Describe in numbers what straight trials contribute.

    Args:
        names: Names of the unknowns.
        n_trials: Number of trials.
        swimming: Standard deviations after so many swimming trials [-].
        after: Standard deviations after so many trials of any kind [-].
    """
    with np.errstate(invalid="ignore"):
        ratios = np.where(np.isfinite(swimming), swimming, _INFINITE) / after
    k = int(np.argmax(ratios))
    return (
        f"After the best {n_trials} swimming trials, `{names[k]}` is {format_share(swimming[k])}; "
        f"after these {n_trials}, {format_share(after[k])}."
    )


def format_share(deviation: float) -> str:
    """Format a relative standard deviation as text.

    Args:
        deviation: Relative standard deviation [-].
    """
    if not np.isfinite(deviation) or deviation > _UNKNOWN:
        return "unknown"
    if deviation >= _WHOLE_PERCENT:
        return f"{100.0 * deviation:.0f} %"
    return f"{100.0 * deviation:.2g} %"
