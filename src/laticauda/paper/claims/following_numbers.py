"""Numbers of the path-following study that claims refer to: way to the path, headings, speeds."""

import math
from collections.abc import Callable, Sequence
from statistics import fmean
from typing import NamedTuple

import numpy as np

from laticauda import scenarios
from laticauda.motion import gaits
from laticauda.paper.claims.printed_numbers import Numbers
from laticauda.paper.fin_effect import find_fin_gains, simulate_band_gains
from laticauda.paper.path_following import (
    FollowingCase,
    FollowingRun,
    PathFollowingStudy,
    read_simulated_power,
    read_simulated_velocity,
)
from laticauda.trials import following as figures_of_path


def collect_following_numbers(study: PathFollowingStudy) -> Numbers:
    """Return the findings of the path-following study.

    Args:
        study: Result of `run_path_following`.
    """
    figures = [case.run.figures for case in study.cases]
    mean_errors = [figure["last_third_error"] for figure in figures]
    ripples = [figure["ripple"] for figure in figures]
    heading_errors = [_measure_heading_errors(case) for case in study.cases]
    convergence = _compare_convergence(study)
    gains = find_fin_gains(study.cases)
    all_band_gains: list[float] = []
    for gain in gains:
        all_band_gains += simulate_band_gains(gain)
    return {
        "setup": _describe_setup(study),
        "all": _describe_convergence(study, study.cases),
        "fin": _describe_convergence(study, [case for case in study.cases if case.group.has_fin]),
        "means": [error if error is not None else math.nan for error in mean_errors],
        "known_means": [error for error in mean_errors if error is not None],
        "ripples": [ripple for ripple in ripples if ripple is not None],
        "mean_heading": [error.of_cycle_mean for error in heading_errors],
        "heading": [error.with_swing for error in heading_errors],
        "convergence": convergence,
        "later_with_fin": [row.with_fin - row.without for row in convergence],
        "gain": [gain.measured.velocity for gain in gains],
        "simulated_gain": [gain.simulated_change(read_simulated_velocity) for gain in gains],
        "band_gain": all_band_gains,
        "spreads": {name: _spread_in_groups(study, figure) for name, figure in FIGURES.items()},
    }


def _describe_setup(study: PathFollowingStudy) -> str:
    """Return joints, coefficients and loop of the chosen runs in words."""
    joints = study.trial_settings["joints"]
    loop = scenarios.loop_in_words(study.trial_settings)
    return f"{joints} joints, {study.settings.coefficients.name}, {loop}"


# ---- figures of a case ---------------------------------------------------------------------------


def _measured_velocity(case: FollowingCase) -> float:
    return case.measured.forward_velocity


def _measured_power(case: FollowingCase) -> float:
    return case.measured.mean_power


FIGURES: dict[str, Callable[[FollowingCase], float]] = {
    "measured velocity": _measured_velocity,
    "measured power": _measured_power,
    "simulated velocity": read_simulated_velocity,
    "simulated power": read_simulated_power,
}
"""Velocities [m/s] and powers [W] of a case, by the names that `claims.toml` uses."""


def _spread_in_groups(
    study: PathFollowingStudy, figure: Callable[[FollowingCase], float]
) -> list[float]:
    """Return by group the difference between largest and smallest value over the mean [%]."""
    spreads: list[float] = []
    for group in study.settings.groups:
        values = [figure(case) for case in study.cases if case.group == group]
        spreads.append(100.0 * (max(values) - min(values)) / fmean(values))
    return spreads


# ---- way to the path -----------------------------------------------------------------------------


def _describe_convergence(study: PathFollowingStudy, cases: Sequence[FollowingCase]) -> Numbers:
    """Return which runs converged to the path, and which stayed there."""
    accepted = study.settings.accepted_error
    late_errors = [_late_error(case.run) for case in cases]
    in_all_ways: list[bool] = []
    for case in cases:
        in_all_ways += [run.has_come and _late_error(run) <= accepted for run in case.band]
    return {
        "came": [case.run.has_come for case in cases],
        "rms": late_errors,
        "stayed": [error <= accepted for error in late_errors],
        "ways": in_all_ways,
    }


def _late_error(run: FollowingRun) -> float:
    """Return the rms of the cycle-mean error over the last third; infinite if there is none [m]."""
    if run.last_third_rms is None:
        return math.inf
    return run.last_third_rms


class ConvergenceRow(NamedTuple):
    """Mean over a gait's cases until the path is reached; infinite if one does not reach it."""

    gait: str
    """The gait, in words."""
    unit: str
    """Unit of what follows: s for the time, m for the distance."""
    without: float
    """Without the fin."""
    with_fin: float
    """With the fin."""


def _compare_convergence(study: PathFollowingStudy) -> list[ConvergenceRow]:
    """Return by gait the mean time and the mean distance to reach the path."""
    rows: list[ConvergenceRow] = []
    for gait in dict.fromkeys(group.gait for group in study.settings.groups):
        for name, unit in (("convergence_time", "s"), ("convergence_distance", "m")):
            row = ConvergenceRow(
                gait=gaits.GAIT_WORDS[gait],
                unit=unit,
                without=_mean_figure(study, gait, has_fin=False, name=name),
                with_fin=_mean_figure(study, gait, has_fin=True, name=name),
            )
            rows.append(row)
    return rows


def _mean_figure(study: PathFollowingStudy, gait: str, *, has_fin: bool, name: str) -> float:
    """Return the mean of a figure over the cases of a group; infinite if a case has none."""
    figures: list[float] = []
    for case in study.cases:
        if case.group.gait == gait and case.group.has_fin == has_fin:
            figure = case.run.figures[name]
            figures.append(figure if figure is not None else math.inf)
    return fmean(figures)


# ---- heading -------------------------------------------------------------------------------------


class HeadingErrors(NamedTuple):
    """Root mean square of the heading error over the last third of a run."""

    of_cycle_mean: float
    """Of its mean over the gait cycle [deg]."""
    with_swing: float
    """Of the error itself, with the gait's swing [deg]."""


def _measure_heading_errors(case: FollowingCase) -> HeadingErrors:
    trial = case.trial
    assert trial.period is not None
    begin_of_last_third = trial.time[0] + 2.0 / 3.0 * trial.duration
    error = np.degrees(trial.signals["heading_ref"] - trial.signals["heading_used"])
    late_mean_error = figures_of_path.last_third(trial.time, error, trial.period)
    late_error = error[trial.time >= begin_of_last_third]
    return HeadingErrors(
        of_cycle_mean=float(np.sqrt(np.mean(late_mean_error**2))),
        with_swing=float(np.sqrt(np.mean(late_error**2))),
    )
