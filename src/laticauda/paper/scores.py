"""Errors of predicted speeds against the measurements of Tables 1 and 2, compared with null models without physics.

The null models are fitted to Table 1 by least squares of the logarithm. There they are scored on
the same rows to which they are fitted, so their errors are also given for rows that were left out
of the fit; Table 2 is predicted without a further fit.
The changes due to the fin, and the energy per meter, are computed here too.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from jaxtyping import Float

from laticauda.paper.efficiency import Case, EfficiencyStudy
from laticauda.paper.measured import (
    PrintedChange,
    efficiency_trials,
    percent_change,
    printed_changes,
)
from laticauda.paper.path_following import FollowingCase, FollowingRun, PathFollowingStudy
from laticauda.scenarios import loop_in_words
from laticauda.trials.null_models import PREDICTORS, Values, compared, mape, predict

AnyCase = TypeVar("AnyCase", Case, FollowingCase)


@dataclass(frozen=True, kw_only=True)
class Score:
    """Predictions of the measured speeds of a table by one predictor, and mean absolute percentage errors (MAPE)."""

    name: str
    """The predictor: a null model, a set of coefficients, or joint law, bandwidth and heading of a simulation."""
    n_fitted: int | None
    """Number of values fitted to Table 1; None for a simulation with coefficients from other sources [-]."""
    measured: tuple[float, ...]
    """Measured speed of the robot, by case that was measured [m/s]."""
    speeds: tuple[float, ...]
    """Predicted speed, by the same cases [m/s]."""
    overall: float
    """Error over all cases [%]."""
    by_group: tuple[float, ...]
    """Error by group of the settings [%]."""
    leave_one_out: float | None = None
    """Error with each row of Table 1 predicted from all others; None if nothing is fitted to the scored rows [%]."""
    leave_one_group_out: float | None = None
    """Error with each group predicted from all others; None if that is impossible [%]."""
    is_null: bool = False
    """Whether it is a null model, which contains no physics."""

    @property
    def title(self) -> str:
        """Name of the predictor in tables."""
        return f"null model: {self.name}" if self.is_null else self.name


@dataclass(frozen=True, kw_only=True)
class FinGain(Generic[AnyCase]):
    """Changes due to the fin between two cases of a table.

    In Table 2 the two cases start from different places, so the change includes that effect.
    """

    without: AnyCase
    """The case without the fin."""
    with_fin: AnyCase
    """The case with the fin."""

    @property
    def measured(self) -> PrintedChange:
        """Measured changes: as printed, and from the table's own numbers."""
        return PrintedChange(without=self.without.measured, with_fin=self.with_fin.measured)

    def simulated(self, figure: Callable[[AnyCase], float]) -> float:
        """Return the change of a simulated figure [%].

        Args:
            figure: Function that returns the figure of a case.
        """
        return percent_change(figure(self.without), figure(self.with_fin))


def fin_gains(cases: Sequence[AnyCase]) -> tuple[FinGain[AnyCase], ...]:
    """Return the changes due to the fin, for every case with the fin that has a counterpart without it.

    Args:
        cases: Cases of a study.
    """
    by_row = {id(case.measured): case for case in cases}
    return tuple(
        FinGain(without=by_row[id(pair.without)], with_fin=by_row[id(pair.with_fin)])
        for pair in printed_changes([case.measured for case in cases])
    )


def score_study(study: EfficiencyStudy | PathFollowingStudy) -> tuple[Score, ...]:
    """Return the errors of the simulations of a study, then those of the null models.

    Args:
        study: Result of `run_efficiency` or `run_path_following`.
    """
    return (
        _table1(study)
        if isinstance(study, EfficiencyStudy)
        else score_simulations(study) + null_predictions(study)
    )


def _table1(study: EfficiencyStudy) -> tuple[Score, ...]:
    rows = [case.measured for case in study.measured]
    found = [
        _scored(
            study,
            one.name,
            one.n_fitted,
            np.array([case.forward_velocity[i] for case in study.measured]),
        )
        for i, one in enumerate(study.settings.models)
    ]
    for null in compared(rows, np.array([row.forward_velocity for row in rows], dtype=float)):
        one, one_group = (
            None if math.isnan(error) else error for error in (null.left_out, null.group_left_out)
        )
        errors: dict[str, Any] = {"leave_one_out": one, "leave_one_group_out": one_group}
        found.append(
            _scored(study, null.name, null.n_parameters, null.speeds, is_null=True, **errors)
        )
    return tuple(found)


def score_simulations(study: PathFollowingStudy) -> tuple[Score, ...]:
    """Return the scores of all ways to simulate Table 2: the chosen one, the rest of the band, cycle mean, own models.

    Args:
        study: Result of `run_path_following`.
    """
    ways: list[tuple[str, int | None, list[FollowingRun]]] = [
        (runs[0].name, None, runs) for runs in in_all_ways(study)
    ]
    for one in study.own:
        model, runs = one.settings.coefficients, [case.run for case in one.cases]
        ways.append((f"{model.name}, {loop_in_words(vars(runs[0]))}", model.n_fitted, runs))
    return tuple(
        _scored(study, name, n, np.array([run.forward_velocity for run in runs]))
        for name, n, runs in ways
    )


def in_all_ways(study: PathFollowingStudy) -> list[list[FollowingRun]]:
    """Return the runs of all cases, way by way: the chosen one first, then the rest of the band, then the cycle mean.

    Args:
        study: Result of `run_path_following`.
    """
    cases, first = study.cases, study.cases[0]
    others = [
        [case.band[i] for case in cases]
        for i, run in enumerate(first.band)
        if run.name != first.run.name
    ]
    return [[case.run for case in cases], *others, [case.cycle_mean for case in cases]]


def null_predictions(study: PathFollowingStudy) -> tuple[Score, ...]:
    """Return the predictions of Table 2 by the null models fitted to Table 1.

    Args:
        study: Result of `run_path_following`.
    """
    known = [trial for trial in efficiency_trials() if trial.forward_velocity is not None]
    others = [case.measured for case in study.cases]
    speeds = np.array([trial.forward_velocity for trial in known], dtype=float)
    return tuple(
        _scored(study, name, n_fitted, predicted, is_null=True)
        for name in PREDICTORS
        for predicted, n_fitted in [predict(name, known, speeds, others)]
    )


def meter_costs(study: PathFollowingStudy) -> dict[str, Float[np.ndarray, "2 n_cases"]]:
    """Return energy per meter by group: measured electrical, above idle; simulated mechanical; not comparable [J/m].

    Args:
        study: Result of `run_path_following`.
    """
    found: dict[str, list[tuple[float, float]]] = {
        group.name: [] for group in study.settings.groups
    }
    for case in study.cases:
        measured = case.measured.mean_power / case.measured.forward_velocity
        found[case.group.name].append((measured, case.run.joules_per_meter))
    return {name: np.array(costs).T for name, costs in found.items()}


def _scored(
    study: EfficiencyStudy | PathFollowingStudy,
    name: str,
    n_fitted: int | None,
    speeds: Values,
    **more: Any,
) -> Score:
    cases = study.measured if isinstance(study, EfficiencyStudy) else study.cases
    measured = np.array([case.measured.forward_velocity for case in cases], dtype=float)
    group = np.array([study.settings.groups.index(case.group) for case in cases])
    return Score(
        name=name,
        n_fitted=n_fitted,
        measured=tuple(measured.tolist()),
        speeds=tuple(map(float, speeds)),
        overall=mape(measured, speeds),
        by_group=tuple(mape(measured[group == i], speeds[group == i]) for i in np.unique(group)),
        **more,
    )
