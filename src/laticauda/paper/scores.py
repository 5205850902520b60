"""Errors of predicted speeds against Tables 1 and 2, also of null models without physics.

The null models are fitted to Table 1 by least squares of the logarithm. There they are scored on
the same rows to which they are fitted, so their errors are also given for rows that were left out
of the fit; Table 2 is predicted without a further fit.
The energy per meter is computed here too.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.paper.efficiency import Case, EfficiencyStudy
from laticauda.paper.measured import read_efficiency_trials
from laticauda.paper.path_following import FollowingCase, FollowingRun, PathFollowingStudy
from laticauda.scenarios import loop_in_words
from laticauda.trials import PREDICTORS, Values, compared, mape, predict
from laticauda.values.packaging import renamed_names


@dataclass(frozen=True, kw_only=True)
class Score:
    """Predictions of the speeds of a table, and mean absolute percentage errors (MAPE)."""

    name: str
    """The predictor: a null model, a set of coefficients, or one way to simulate, in words."""
    n_fitted: int | None
    """Number of values fitted to Table 1; None if all coefficients are from other sources [-]."""
    measured: tuple[float, ...]
    """Measured speed of the robot, by case that was measured [m/s]."""
    speeds: tuple[float, ...]
    """Predicted speed, by the same cases [m/s]."""
    overall: float
    """Error over all cases [%]."""
    by_group: tuple[float, ...]
    """Error by group of the settings [%]."""
    leave_one_out: float | None = None
    """Error with each row predicted from all others; None if nothing is fitted to them [%]."""
    leave_one_group_out: float | None = None
    """Error with each group predicted from all others; None if that is impossible [%]."""
    is_null: bool = False
    """Whether it is a null model, which contains no physics."""

    @property
    def title(self) -> str:
        """Name of the predictor in tables."""
        if self.is_null:
            return f"null model: {self.name}"
        return self.name


def score_study(study: EfficiencyStudy | PathFollowingStudy) -> tuple[Score, ...]:
    """Return the errors of the simulations of a study, then those of the null models.

    Args:
        study: Result of `run_efficiency` or `run_path_following`.
    """
    if isinstance(study, EfficiencyStudy):
        return _score_models(study) + _score_null_models(study)
    return score_simulations(study) + score_null_predictions(study)


def find_best_null(scores: Sequence[Score]) -> Score:
    """Return the null model with the smallest error on rows of Table 1 to which it was not fitted.

    Args:
        scores: Scores of Table 1.
    """
    null_scores = [score for score in scores if score.leave_one_out is not None]
    return min(null_scores, key=lambda score: score.leave_one_out or 0.0)


def _score_speeds(
    study: EfficiencyStudy | PathFollowingStudy,
    name: str,
    n_fitted: int | None,
    speeds: Values,
    **null_fields: Any,
) -> Score:
    """Compare predicted speeds with the measured ones of a study."""
    cases: Sequence[Case | FollowingCase] = study.cases
    if isinstance(study, EfficiencyStudy):
        cases = study.measured
    measured = np.array([case.measured.forward_velocity for case in cases], dtype=float)
    group_of_case = np.array([study.settings.groups.index(case.group) for case in cases])
    by_group: list[float] = []
    for group in np.unique(group_of_case):
        in_group = group_of_case == group
        by_group.append(mape(measured[in_group], speeds[in_group]))
    return Score(
        name=name,
        n_fitted=n_fitted,
        measured=tuple(measured.tolist()),
        speeds=tuple(float(speed) for speed in speeds),
        overall=mape(measured, speeds),
        by_group=tuple(by_group),
        **null_fields,
    )


# ---- Table 1 -------------------------------------------------------------------------------------


def _score_models(study: EfficiencyStudy) -> tuple[Score, ...]:
    scores: list[Score] = []
    for index, model in enumerate(study.settings.models):
        speeds = np.array([case.forward_velocity[index] for case in study.measured])
        scores.append(_score_speeds(study, model.name, model.n_fitted, speeds))
    return tuple(scores)


def _score_null_models(study: EfficiencyStudy) -> tuple[Score, ...]:
    rows = [case.measured for case in study.measured]
    measured = np.array([row.forward_velocity for row in rows], dtype=float)
    scores: list[Score] = []
    for null_model in compared(rows, measured):
        score = _score_speeds(
            study,
            name=null_model.name,
            n_fitted=null_model.n_parameters,
            speeds=null_model.speeds,
            is_null=True,
            leave_one_out=_none_if_nan(null_model.left_out),
            leave_one_group_out=_none_if_nan(null_model.group_left_out),
        )
        scores.append(score)
    return tuple(scores)


def _none_if_nan(error: float) -> float | None:
    if math.isnan(error):
        return None
    return error


# ---- Table 2 -------------------------------------------------------------------------------------


class _Simulation(NamedTuple):
    """One way to simulate all cases of Table 2."""

    name: str
    """Name in tables."""
    n_fitted: int | None
    """Number of values fitted to Table 1; None for coefficients from other sources [-]."""
    runs: list[FollowingRun]
    """Runs of all cases."""


def score_simulations(study: PathFollowingStudy) -> tuple[Score, ...]:
    """Return the scores of all ways to simulate Table 2: the chosen one is first, our models last.

    Args:
        study: Result of `run_path_following`.
    """
    simulations = [_Simulation(runs[0].name, None, runs) for runs in list_runs_by_way(study)]
    for own_study in study.own:
        model = own_study.settings.coefficients
        runs = [case.run for case in own_study.cases]
        name = f"{model.name}, {loop_in_words(vars(runs[0]))}"
        simulations.append(_Simulation(name, model.n_fitted, runs))
    scores: list[Score] = []
    for simulation in simulations:
        speeds = np.array([run.forward_velocity for run in simulation.runs])
        scores.append(_score_speeds(study, simulation.name, simulation.n_fitted, speeds))
    return tuple(scores)


def list_runs_by_way(study: PathFollowingStudy) -> list[list[FollowingRun]]:
    """Return the runs of all cases, way by way: the chosen one, the rest of the band, cycle mean.

    Args:
        study: Result of `run_path_following`.
    """
    cases = study.cases
    first_case = cases[0]
    ways = [[case.run for case in cases]]
    for index, run in enumerate(first_case.band):
        if run.name != first_case.run.name:
            ways.append([case.band[index] for case in cases])
    ways.append([case.cycle_mean for case in cases])
    return ways


def score_null_predictions(study: PathFollowingStudy) -> tuple[Score, ...]:
    """Return the predictions of Table 2 by the null models fitted to Table 1.

    Args:
        study: Result of `run_path_following`.
    """
    table1 = read_efficiency_trials()
    fitted_rows = [row for row in table1 if row.forward_velocity is not None]
    fitted_speeds = np.array([row.forward_velocity for row in fitted_rows], dtype=float)
    predicted_rows = [case.measured for case in study.cases]
    scores: list[Score] = []
    for name in PREDICTORS:
        speeds, n_fitted = predict(name, fitted_rows, fitted_speeds, predicted_rows)
        scores.append(_score_speeds(study, name, n_fitted, speeds, is_null=True))
    return tuple(scores)


def compute_meter_costs(study: PathFollowingStudy) -> dict[str, Float[np.ndarray, "2 n_cases"]]:
    """Return the energy per meter of all cases by group [J/m].

    The first row is measured (electrical, above idle), the second simulated (mechanical): not
    comparable.

    Args:
        study: Result of `run_path_following`.
    """
    costs: dict[str, Float[np.ndarray, "2 n_cases"]] = {}
    for group in study.settings.groups:
        measured: list[float] = []
        simulated: list[float] = []
        for case in study.cases:
            if case.group.name == group.name:
                measured.append(case.measured.mean_power / case.measured.forward_velocity)
                simulated.append(case.run.joules_per_meter)
        costs[group.name] = np.array([measured, simulated])
    return costs


# Names of 0.2, for one release.
__getattr__ = renamed_names(__name__, {"scores": "score_study"})
