"""How far predictions are from the measured speeds of Table 1, beside null models that know no physics.

A null model is fitted to the very rows that it is then scored on, by least squares of the logarithm, so its error is
also given for rows that were left out of the fit.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.trial.null_models import NULL_MODELS, Row, Values, design, fit, left_out, mape


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
    settings = [Row(gait=case.gait, has_fin=case.group.has_fin) for case in rows]
    groups = sorted({row.group for row in settings})
    for name in NULL_MODELS:
        columns, known = design(name, settings, groups)
        target = np.log(measured) - known
        fitted = np.exp(columns @ fit(columns, target) + known)
        others = [np.exp(left_out(columns, target, by) + known) for by in (np.arange(group.size), group)]
        found.append(_score(name, columns.shape[1], measured, fitted, group, others))
    return tuple(found)


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
