"""The efficiency study: speed and power of the robot over amplitude, frequency and phase shift.

It repeats the trials behind the paper's Figs. 4 to 11 and Table 1 in simulation, and compares the
contents of the table, the maxima of sweeps, with the maxima of the simulated sweeps. The errors of
the speeds are computed in `scores`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.motion import gaits
from laticauda.paper.measured import MeasuredCase
from laticauda.paper.runs import NamedScenario, Runs, Study
from laticauda.paper.settings import (
    EfficiencySettings,
    Group,
    SweepSettings,
    load_efficiency_settings,
)

Curves = Float[np.ndarray, "n_models n_groups n_values"]
CURVES = ("forward_velocity", "steady_velocity", "mechanical_power")
"""Figures of a trial that a sweep keeps, as its fields are named."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SweepResult:
    """Curves over one parameter of the gait."""

    settings: SweepSettings
    """Settings of the sweep."""
    forward_velocity: Curves
    """Forward velocity by equation (5), by model, group and value [m/s]."""
    steady_velocity: Curves
    """Forward velocity without the start [m/s]."""
    mechanical_power: Curves
    """Mechanical power, the mean of sum |u phi'| [W]."""

    @property
    def values(self) -> Float[np.ndarray, " n_values"]:
        """Values of the parameter, in ascending order [rad, rad/s]."""
        return self.settings.values


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row of Table 1, measured and simulated."""

    group: Group
    """Part of the table to which the row belongs."""
    measured: MeasuredCase
    """The row: its gait, its number and the measured values."""
    forward_velocity: tuple[float, ...]
    """Simulated forward velocity, by model [m/s]."""
    mechanical_power: tuple[float, ...]
    """Simulated mechanical power, by model [W]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EfficiencyStudy(Study[EfficiencySettings]):
    """Settings and results of the efficiency study."""

    sweeps: tuple[SweepResult, ...]
    """Results, one per sweep of the settings."""
    cases: tuple[Case, ...]
    """All rows of Table 1, in its order."""
    judged: int = 0
    """Index of the model to which the claims refer."""

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the sets of coefficients, in the order of the first axis of all curves."""
        return tuple(model.name for model in self.settings.models)

    @property
    def judged_model(self) -> str:
        """Name of the model to which the claims refer."""
        return self.models[self.judged]

    @property
    def measured(self) -> tuple[Case, ...]:
        """The rows with a measured velocity."""
        return tuple(case for case in self.cases if case.measured.forward_velocity is not None)

    default_settings = staticmethod(load_efficiency_settings)

    @classmethod
    def from_runs(cls, settings: EfficiencySettings, runs: Runs) -> "EfficiencyStudy":
        """Run the trials of `settings` by `runs`, and return the study.

        Args:
            settings: Settings of the study.
            runs: Runner, with the model and the progress callback.
        """
        runs.n_runs = settings.n_runs
        cases: list[Case] = []
        for group in settings.groups:
            for row in group.cases:
                cases.append(_run_case(settings, runs, group, row))
        sweeps = [_run_sweep(settings, runs, sweep) for sweep in settings.sweeps]
        return EfficiencyStudy(
            settings=settings,
            trial_settings=runs.trial_settings,
            sweeps=tuple(sweeps),
            cases=tuple(cases),
        )


run_efficiency = EfficiencyStudy.run


def _run_case(settings: EfficiencySettings, runs: Runs, group: Group, row: MeasuredCase) -> Case:
    """Run one row of Table 1 with every model."""
    tasks = _scenarios_from_last_model(settings, runs, group, row.gait)
    trials_from_last = [runs.swim(task.name, task.scenario) for task in tasks]
    trials = trials_from_last[::-1]
    return Case(
        group=group,
        measured=row,
        forward_velocity=tuple(trial.forward_velocity for trial in trials),
        mechanical_power=tuple(trial.mechanical_power for trial in trials),
    )


def _run_sweep(settings: EfficiencySettings, runs: Runs, sweep: SweepSettings) -> SweepResult:
    """Run one sweep with every group and model."""
    tasks: list[NamedScenario] = []
    for group in settings.groups:
        for value in sweep.values:
            gait = sweep.gait(group.gait, value)
            tasks += _scenarios_from_last_model(settings, runs, group, gait)
    figures = runs.swim_many(tasks)
    # The tasks are ordered by group, value and model, and curves by model, group and value.
    shape = (len(settings.groups), sweep.values.size, -1)
    curves: dict[str, Any] = {}
    for name in CURVES:
        from_last_model = figures[name].reshape(shape)
        from_first_model = from_last_model[:, :, ::-1]
        curves[name] = np.moveaxis(from_first_model, 2, 0)
    return SweepResult(settings=sweep, **curves)


def _scenarios_from_last_model(
    settings: EfficiencySettings, runs: Runs, group: Group, gait: gaits.Gait
) -> list[NamedScenario]:
    """Return the scenario of each model's trial, backwards.

    The first model's is the last to run, so that it determines `runs.trial_settings`.
    """
    angles = np.degrees([gait.amplitude, gait.frequency, gait.phase_shift])
    setting = "amplitude {:.3g}, frequency {:.3g}, phase shift {:.3g} [deg, deg/s]".format(*angles)
    tasks: list[NamedScenario] = []
    for coefficients in reversed(settings.models):
        scenario = coefficients.build_scenario(
            group.robot,
            gait,
            model=coefficients.give_joints(runs.model),
            duration=settings.duration,
        )
        name = f"{scenario.robot.name}, {gait.kind}, {setting}, {scenario.environment.name}"
        tasks.append(NamedScenario(name, scenario))
    return tasks


# ---- maxima --------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Maximum:
    """The fastest point of one sweep of one group: one of the 12 starred entries of Table 1."""

    group: Group
    """Gait and configuration."""
    parameter: str
    """Parameter that was swept."""
    measured_at: float
    """Value at which the robot was fastest [rad, rad/s]."""
    measured_velocity: float
    """Velocity of the robot there; the best of several noisy values, and so biased upward [m/s]."""
    simulated_at: tuple[float, ...]
    """By model, value at which the simulation is fastest [rad, rad/s]."""
    simulated_velocity: tuple[float, ...]
    """By model, velocity of the simulation there [m/s]."""
    at_the_end: tuple[bool, ...]
    """By model, whether it is at an end of the sweep, so that the maximum may lie outside."""

    def distance(self, model: int) -> float:
        """Return the distance between measured and simulated maximum [rad, rad/s].

        It is infinite if the simulated one is at an end of the sweep.

        Args:
            model: Index of the model.
        """
        if self.at_the_end[model]:
            return np.inf
        return abs(self.simulated_at[model] - self.measured_at)


def find_maxima(study: EfficiencyStudy) -> tuple[Maximum, ...]:
    """Return the starred entries of Table 1 with the maxima of the simulated sweeps, by group.

    Args:
        study: Result of `run_efficiency`.
    """
    stars = {(case.group.name, case.measured.starred): case.measured for case in study.measured}
    maxima: list[Maximum] = []
    for group_index, group in enumerate(study.settings.groups):
        for sweep in study.sweeps:
            star = stars.get((group.name, sweep.settings.parameter))
            if star is not None:
                maxima.append(_find_maximum(group, sweep, star, group_index))
    return tuple(maxima)


def _find_maximum(
    group: Group, sweep: SweepResult, star: MeasuredCase, group_index: int
) -> Maximum:
    curves = sweep.forward_velocity[:, group_index]
    values = sweep.values
    parameter = sweep.settings.parameter
    fastest: Sequence[int] = np.argmax(curves, axis=1).tolist()
    return Maximum(
        group=group,
        parameter=parameter,
        measured_at=getattr(star.gait, parameter),
        measured_velocity=star.forward_velocity or 0.0,
        simulated_at=tuple(float(value) for value in values[fastest]),
        simulated_velocity=tuple(
            float(curve[index]) for curve, index in zip(curves, fastest, strict=True)
        ),
        at_the_end=tuple(index in (0, values.size - 1) for index in fastest),
    )
