"""How far predictions are from the measured speeds of Table 1, beside null models that know no physics.

A null model is fitted to the very rows that it is then scored on, by least squares of the logarithm, so its error is
also given for rows that were left out of the fit.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.studies.efficiency import Case, EfficiencyStudy

Values = Float[np.ndarray, " n_rows"]
Design = Float[np.ndarray, "n_rows n_parameters"]


@dataclass(frozen=True, kw_only=True)
class Score:
    """Mean absolute percentage errors (MAPE) of one predictor of the speeds of Table 1."""

    name: str
    """The predictor."""
    n_fitted: int | None
    """How many numbers are fitted to these very rows; None: none is fitted here [-]."""
    overall: float
    """Over all measured rows [%]."""
    by_group: tuple[float, ...]
    """By group of the settings [%]."""
    leave_one_out: float | None
    """Each row predicted from all others; None where nothing is fitted here [%]."""
    leave_one_group_out: float | None
    """Each group predicted from all others; None where that cannot be done [%]."""


def mape(measured: Float[np.ndarray, " _"], predicted: Float[np.ndarray, " _"]) -> float:
    """Mean absolute percentage error, 100 mean |predicted - measured| / measured [%].

    Args:
        measured: All > 0.
        predicted: In the same unit.

    Raises:
        ValueError: If there is no value, the numbers of values differ, or a measured one is not > 0.
    """
    if measured.size == 0 or measured.shape != predicted.shape:
        raise ValueError(f"`predicted` must have {measured.size} values, at least 1, got {predicted.size}.")
    if not np.all(measured > 0.0):
        raise ValueError(f"`measured` must be > 0, got {np.min(measured)}.")
    return 100.0 * float(np.mean(np.abs(predicted - measured) / measured))


def scores(study: EfficiencyStudy) -> tuple[Score, ...]:
    """The errors of the models of the study, then those of the null models.

    Args:
        study: What `run_efficiency` returned.
    """
    rows = study.measured
    measured = np.array([case.measured_velocity for case in rows], dtype=float)
    group = np.array([study.settings.groups.index(case.group) for case in rows])
    found = [
        _score(name, None, measured, np.array([case.forward_velocity[i] for case in rows]), group)
        for i, name in enumerate(study.models)
    ]
    for name, build in NULL_MODELS.items():
        design, known = build(rows)
        target = np.log(measured) - known
        fitted = np.exp(design @ _fit(design, target) + known)
        left_out = [np.exp(_left_out(design, target, by) + known) for by in (np.arange(group.size), group)]
        found.append(_score(name, design.shape[1], measured, fitted, group, left_out))
    return tuple(found)


# ---- null models: columns that are fitted to log v, and what is added to them ------------------------------------


def _constant_per_group(rows: Sequence[Case]) -> tuple[Design, Values]:
    groups = sorted({case.group.name for case in rows})
    columns = [[float(case.group.name == name) for name in groups] for case in rows]
    return np.array(columns), np.zeros(len(rows))


def _constant_fin_eel(rows: Sequence[Case]) -> tuple[Design, Values]:
    columns = [(1.0, float(case.group.has_fin), float(case.gait.kind == "eel_like")) for case in rows]
    return np.array(columns), np.zeros(len(rows))


def _constant_stride(rows: Sequence[Case]) -> tuple[Design, Values]:
    design, _ = _constant_per_group(rows)
    return design, np.log([case.gait.frequency for case in rows])


NULL_MODELS: dict[str, Callable[[Sequence[Case]], tuple[Design, Values]]] = {
    "constant per group": _constant_per_group,
    "constant + fin + eel": _constant_fin_eel,
    "constant stride per group": _constant_stride,
}
"""Speeds without physics: one number per group; a number and two factors; one distance per cycle and group."""


def _fit(design: Design, target: Values) -> Float[np.ndarray, " n_parameters"]:
    return np.linalg.lstsq(design, target)[0]


def _left_out(design: Design, target: Values, by: np.ndarray) -> Values:
    """Each row predicted from the rows with another number in `by`; nan where they do not suffice."""
    found = np.full(target.size, np.nan)
    for number in np.unique(by):
        out = by == number
        if np.linalg.matrix_rank(design[~out]) == design.shape[1]:
            found[out] = design[out] @ _fit(design[~out], target[~out])
    return found


def _score(
    name: str,
    n_fitted: int | None,
    measured: Values,
    predicted: Values,
    group: np.ndarray,
    left_out: Sequence[Values] = (),
) -> Score:
    one, one_group = [mape(measured, values) if np.all(np.isfinite(values)) else None for values in left_out] or (
        None,
        None,
    )
    return Score(
        name=name,
        n_fitted=n_fitted,
        overall=mape(measured, predicted),
        by_group=tuple(mape(measured[group == i], predicted[group == i]) for i in np.unique(group)),
        leave_one_out=one,
        leave_one_group_out=one_group,
    )
