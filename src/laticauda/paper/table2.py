"""Table 2 of the paper: measured against simulated speeds, what the fin changes, and the cost of a meter.

The null models are fitted to Table 1 and predict Table 2 as it stands: nothing is fitted to these rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.paper.following_run import FollowingRun
from laticauda.paper.measured import MeasuredTrial, efficiency_trials, path_following_trials
from laticauda.paper.path_following import FollowingCase, PathFollowingStudy
from laticauda.paper.table1 import is_misprint, percent_change
from laticauda.trial.null_models import PREDICTORS, Row, mape, predict

Speeds = Float[np.ndarray, " n_cases"]


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """What one predictor says of the speeds of Table 2, and its mean absolute percentage errors (MAPE)."""

    name: str
    """The predictor: a null model, or joint law, bandwidth and heading of the simulation."""
    n_fitted: int | None
    """How many numbers are fitted to Table 1; None for a simulation [-]."""
    speeds: tuple[float, ...]
    """By case [m/s]."""
    overall: float
    """Over all cases [%]."""
    by_group: tuple[float, ...]
    """By group of the settings [%]."""


@dataclass(frozen=True, kw_only=True)
class FinChange:
    """What the fin changes from a case of Table 2 to the one with the same number, in percent.

    The two start from different places, so the change holds that too.
    """

    without: FollowingCase
    """The case without the fin."""
    with_fin: FollowingCase
    """The case with it."""
    measured_velocity: float
    """Recomputed from the table's speeds [%]."""
    measured_power: float
    """Recomputed from the table's electrical powers [%]."""
    simulated_velocity: float
    """Of the chosen runs [%]."""
    simulated_power: float
    """Mechanical, of the chosen runs [%]."""
    band_velocity: tuple[float, float]
    """Smallest and largest over the ways of the band [%]."""
    printed_velocity: float | None
    """As printed [%]."""
    printed_power: float | None
    """As printed [%]."""

    @property
    def misprints(self) -> tuple[str, ...]:
        """What is printed and does not follow from the table's own numbers: velocity, power."""
        pairs = {
            "velocity": (self.printed_velocity, self.measured_velocity),
            "power": (self.printed_power, self.measured_power),
        }
        return tuple(name for name, (printed, found) in pairs.items() if is_misprint(printed, found))


@dataclass(frozen=True, kw_only=True)
class MeterCost:
    """Energy per meter of one group of Table 2; the two powers are not comparable."""

    group: str
    """Its name."""
    measured: tuple[float, ...]
    """By case, electrical power above idle / forward velocity [J/m]."""
    simulated: tuple[float, ...]
    """By case, mechanical power / forward velocity of the chosen runs [J/m]."""

    @property
    def measured_mean(self) -> float:
        """Mean over the cases [J/m]."""
        return sum(self.measured) / len(self.measured)

    @property
    def simulated_mean(self) -> float:
        """Mean over the cases [J/m]."""
        return sum(self.simulated) / len(self.simulated)


def simulated(study: PathFollowingStudy) -> tuple[Prediction, ...]:
    """The speeds of every way to simulate Table 2: the chosen one first, then the others of the band, the cycle mean.

    Args:
        study: What `run_path_following` returned.
    """
    n_ways = len(study.cases[0].band)
    found = [_prediction(study, [case.run for case in study.cases])]
    found += [_prediction(study, [case.band[i] for case in study.cases]) for i in range(n_ways)]
    found.append(_prediction(study, [case.cycle_mean for case in study.cases]))
    return found[0], *(each for each in found[1:] if each.name != found[0].name)  # the chosen way is in the band


def null_predictions(
    study: PathFollowingStudy, trials: Sequence[MeasuredTrial] | None = None
) -> tuple[Prediction, ...]:
    """What the null models, fitted to Table 1, say of Table 2.

    Args:
        study: What `run_path_following` returned.
        trials: What they are fitted to; None takes the measured rows of Table 1.
    """
    known = [trial for trial in trials or efficiency_trials() if trial.forward_velocity is not None]
    rows = [Row(gait=trial.gait, has_fin=trial.has_fin) for trial in known]
    speeds = np.array([trial.forward_velocity for trial in known], dtype=float)
    others = [Row(gait=case.measured.gait, has_fin=case.group.has_fin) for case in study.cases]
    return tuple(
        _scored(study, name, n_fitted, predicted)
        for name in PREDICTORS
        for predicted, n_fitted in [predict(name, rows, speeds, others)]
    )


def following_scores(
    study: PathFollowingStudy, trials: Sequence[MeasuredTrial] | None = None
) -> tuple[Prediction, ...]:
    """All predictors of Table 2: the simulated ones, then the null models.

    Args:
        study: What `run_path_following` returned.
        trials: What the null models are fitted to; None takes the measured rows of Table 1.
    """
    return simulated(study) + null_predictions(study, trials)


def fin_changes(study: PathFollowingStudy) -> tuple[FinChange, ...]:
    """What the fin changes, for every case of Table 2 with the fin.

    Args:
        study: What `run_path_following` returned.
    """
    bare = {(case.group.gait, case.measured.case): case for case in study.cases if not case.group.has_fin}
    pairs = [(bare.get((case.group.gait, case.measured.case)), case) for case in study.cases if case.group.has_fin]
    return tuple(_change(without, case) for without, case in pairs if without is not None)


def meter_costs(study: PathFollowingStudy) -> tuple[MeterCost, ...]:
    """Energy per meter, group by group.

    Args:
        study: What `run_path_following` returned.
    """
    return tuple(
        MeterCost(
            group=group.name,
            measured=tuple(case.measured.mean_power / case.measured.forward_velocity for case in cases),
            simulated=tuple(case.run.joules_per_meter for case in cases),
        )
        for group in study.settings.groups
        for cases in [[case for case in study.cases if case.group == group]]
    )


def table2_changes() -> list[tuple[float, float]]:
    """Changes of velocity and power by the fin, case by case, recomputed from Table 2 [%]."""
    trials = path_following_trials()
    bare = {(trial.gait.kind, trial.case): trial for trial in trials if not trial.has_fin}
    pairs = [(bare[trial.gait.kind, trial.case], trial) for trial in trials if trial.has_fin]
    return [
        (
            percent_change(before.forward_velocity, after.forward_velocity),
            percent_change(before.mean_power, after.mean_power),
        )
        for before, after in pairs
    ]


def _prediction(study: PathFollowingStudy, runs: Sequence[FollowingRun]) -> Prediction:
    return _scored(study, runs[0].name, None, np.array([run.forward_velocity for run in runs]))


def _scored(study: PathFollowingStudy, name: str, n_fitted: int | None, speeds: Speeds) -> Prediction:
    measured = np.array([case.measured.forward_velocity for case in study.cases])
    group = np.array([study.settings.groups.index(case.group) for case in study.cases])
    return Prediction(
        name=name,
        n_fitted=n_fitted,
        speeds=tuple(map(float, speeds)),
        overall=mape(measured, speeds),
        by_group=tuple(mape(measured[group == i], speeds[group == i]) for i in np.unique(group)),
    )


def _change(without: FollowingCase, with_fin: FollowingCase) -> FinChange:
    place = with_fin.measured.case - 1
    band = [
        percent_change(before.forward_velocity, after.forward_velocity)
        for before, after in zip(without.band, with_fin.band, strict=True)
    ]
    return FinChange(
        without=without,
        with_fin=with_fin,
        measured_velocity=percent_change(without.measured.forward_velocity, with_fin.measured.forward_velocity),
        measured_power=percent_change(without.measured.mean_power, with_fin.measured.mean_power),
        simulated_velocity=percent_change(without.run.forward_velocity, with_fin.run.forward_velocity),
        simulated_power=percent_change(without.run.mechanical_power, with_fin.run.mechanical_power),
        band_velocity=(min(band), max(band)),
        printed_velocity=with_fin.group.printed_velocity_change[place],
        printed_power=with_fin.group.printed_power_change[place],
    )
