"""Runs of the 3D twin, trial by trial on several threads."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from laticauda.identify.interpolation import interpolated
from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.identify.runs import SimulatedRuns, logged_series, swimming
from laticauda.identify.sensing import RunResults
from laticauda.identify.series import series_of_trial
from laticauda.models.simulate import several
from laticauda.scenarios import Scenario
from laticauda.trials import Trial


def simulate(problem: Problem, scenarios: Sequence[Scenario], runs: SimulatedRuns) -> None:
    """Simulate every measurement in which the robot swam, and fill in the results and the failures.

    Args:
        problem: Measurements and unknowns.
        scenarios: Scenario of each measurement, with the values of the unknowns.
        runs: Results to fill in.
    """
    members = swimming(problem)
    trials = several.swim_each(
        [scenarios[i] for i in members], lambda trial: trial, threads=problem.threads
    )
    for i, trial in zip(members, trials, strict=True):
        measurement = problem.measurements[i]
        if trial.succeeded:
            runs.results[i] = _results_of(trial, measurement)
        else:
            runs.failures[measurement.name] = trial.status
            runs.results[i] = _failed_results(measurement)


def _results_of(trial: Trial, measurement: Measurement) -> RunResults:
    """Return the results of a trial in the horizontal plane."""
    end = trial.center_of_mass[-1]
    figures: dict[str, Any] = {"x": end[0], "y": end[1], "heading": trial.heading[-1]}
    for name in measurement.figures:
        if name not in figures:
            figures[name] = getattr(trial, name)
    series: dict[str, Any] = {}
    if measurement.time is not None:
        for name in logged_series(measurement):
            samples = series_of_trial(trial, name)
            series[name] = interpolated(trial.time, samples, measurement.time)
    return RunResults(figures=figures, series=series)


def _failed_results(measurement: Measurement) -> RunResults:
    """Return results that are all nan, for a trial that diverged."""
    series: dict[str, Any] = {"heading": np.nan}
    for name, (samples, _) in measurement.series.items():
        series[name] = np.full_like(samples, np.nan)
    figures = dict.fromkeys(("x", "y", "heading", *measurement.figures), np.nan)
    return RunResults(figures=figures, series=series)
