"""The efficiency study: how fast the robot swims, and at what power, over amplitude, frequency and phase shift.

It repeats the trials behind the paper's Figs. 4 to 11 and Table 1 in simulation, and puts what the table is, the maxima
of sweeps, beside the maxima of the simulated ones. How far off the speeds are is computed in `scores`.

Repeated trials of one's own, from a CSV file, show how far measurements of the same setting scatter. The file is a
table of speeds (`laticauda.trial.measured`); several rows per setting are what it is for.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from jaxtyping import Float

from laticauda import gaits, scenarios
from laticauda.operate.series import mean_and_deviation
from laticauda.paper.measured import MeasuredCase
from laticauda.paper.runs import Runs, Study
from laticauda.paper.settings import EfficiencySettings, Group, SweepSettings, efficiency_settings
from laticauda.trial import measured, null_models

Curves = Float[np.ndarray, "n_models n_groups n_values"]
CURVES = ("forward_velocity", "steady_velocity", "mechanical_power")


@dataclass(frozen=True, kw_only=True, eq=False)
class SweepResult:
    """Curves over one parameter of the gait."""

    settings: SweepSettings
    """What was swept."""
    forward_velocity: Curves
    """Equation (5), by model, group and value [m/s]."""
    steady_velocity: Curves
    """The same without the start [m/s]."""
    mechanical_power: Curves
    """Mean of sum |u phi'| [W]."""

    @property
    def values(self) -> Float[np.ndarray, " n_values"]:
        """The parameter, in rising order [rad, rad/s]."""
        return self.settings.values


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row of Table 1, measured and simulated."""

    group: Group
    """The part of the table that it is in."""
    measured: MeasuredCase
    """The row: its gait, its number and what was measured."""
    forward_velocity: tuple[float, ...]
    """Simulated, by model [m/s]."""
    mechanical_power: tuple[float, ...]
    """Simulated, by model [W]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EfficiencyStudy(Study[EfficiencySettings]):
    """What the efficiency study ran, and what came out."""

    sweeps: tuple[SweepResult, ...]
    """One per sweep of the settings."""
    cases: tuple[Case, ...]
    """All rows of Table 1 in its order."""
    judged: int = 0
    """Place of the model that the claims speak of."""

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the sets of coefficients, in the order of the first axis of all curves."""
        return tuple(model.name for model in self.settings.models)

    @property
    def measured(self) -> tuple[Case, ...]:
        """The rows with a measured velocity."""
        return tuple(case for case in self.cases if case.measured.forward_velocity is not None)

    usual = staticmethod(efficiency_settings)

    @classmethod
    def by_runs(cls, settings: EfficiencySettings, runs: Runs) -> "EfficiencyStudy":
        """What comes out of `settings`, swum by `runs`.

        Args:
            settings: What is swum.
            runs: How: by which model, and who is told how far it is.
        """
        runs.n_runs = settings.n_runs

        def tasks(group: Group, gait: gaits.Gait) -> list[tuple[str, scenarios.Scenario]]:
            """Name and scenario of every model's trial; that of the first comes last, and `runs.how` is of it."""
            setting = "amplitude {:.3g}, frequency {:.3g}, phase shift {:.3g} [deg, deg/s]".format(
                *np.degrees([gait.amplitude, gait.frequency, gait.phase_shift])
            )
            swimmers = [
                one.scenario(group.robot, gait, model=one.driven(runs.model), duration=settings.duration)
                for one in reversed(settings.models)
            ]
            return [(f"{one.robot.name}, {gait.kind}, {setting}, {one.environment.name}", one) for one in swimmers]

        cases: list[Case] = []
        for group, row in [(one, row) for one in settings.groups for row in one.cases]:
            trials = [runs.swim(*task) for task in tasks(group, row.gait)][::-1]
            velocity, power = zip(*[(one.forward_velocity, one.mechanical_power) for one in trials], strict=True)
            cases.append(Case(group=group, measured=row, forward_velocity=velocity, mechanical_power=power))
        sweeps: list[SweepResult] = []
        for sweep in settings.sweeps:
            points = [tasks(group, sweep.gait(group.gait, at)) for group in settings.groups for at in sweep.values]
            found, shape = runs.figures(list(chain(*points))), (len(settings.groups), sweep.values.size, -1)
            curves = {name: np.moveaxis(found[name].reshape(shape)[:, :, ::-1], 2, 0) for name in CURVES}
            sweeps.append(SweepResult(settings=sweep, **curves))
        return EfficiencyStudy(settings=settings, how=runs.how, sweeps=tuple(sweeps), cases=tuple(cases))


run_efficiency = EfficiencyStudy.run


@dataclass(frozen=True, kw_only=True)
class Maximum:
    """The fastest point of one sweep of one group: one of the 12 starred entries of Table 1."""

    group: Group
    """Gait and configuration."""
    parameter: str
    """What was swept."""
    measured_at: float
    """Where the robot was fastest [rad, rad/s]."""
    measured_velocity: float
    """How fast; the best of several noisy values, so biased upward [m/s]."""
    simulated_at: tuple[float, ...]
    """By model, where the simulation is fastest [rad, rad/s]."""
    simulated_velocity: tuple[float, ...]
    """By model, how fast [m/s]."""
    at_the_end: tuple[bool, ...]
    """By model, whether that is the first or the last value of the sweep, so that the maximum may lie beyond."""

    def distance(self, model: int) -> float:
        """From the measured to the simulated maximum; infinite where there is none inside the range [rad, rad/s].

        Args:
            model: Its place.
        """
        return np.inf if self.at_the_end[model] else abs(self.simulated_at[model] - self.measured_at)


def maxima(study: EfficiencyStudy) -> tuple[Maximum, ...]:
    """The starred entries of Table 1 beside the maxima of the simulated sweeps, group by group.

    Args:
        study: What `run_efficiency` returned.
    """
    stars = {(case.group.name, case.measured.starred): case.measured for case in study.measured}
    return tuple(
        _maximum(group, sweep, stars[group.name, sweep.settings.parameter], place)
        for place, group in enumerate(study.settings.groups)
        for sweep in study.sweeps
        if (group.name, sweep.settings.parameter) in stars
    )


def _maximum(group: Group, sweep: SweepResult, star: MeasuredCase, place: int) -> Maximum:
    curves, values, parameter = sweep.forward_velocity[:, place], sweep.values, sweep.settings.parameter
    best: Sequence[int] = np.argmax(curves, axis=1).tolist()
    return Maximum(
        group=group,
        parameter=parameter,
        measured_at=getattr(star.gait, parameter),
        measured_velocity=star.forward_velocity or 0.0,
        simulated_at=tuple(map(float, values[best])),
        simulated_velocity=tuple(float(curve[i]) for curve, i in zip(curves, best, strict=True)),
        at_the_end=tuple(i in (0, values.size - 1) for i in best),
    )


# ---- repeated trials ------------------------------------------------------------------------------------------------

TABLE2 = Path(__file__).parent / "data" / "table2_series.toml"
"""Table 2 as a series file of `laticauda operate`: twelve settings, three runs each."""


@dataclass(frozen=True, kw_only=True)
class Repeat(null_models.Row):
    """All trials of one setting."""

    forward_velocity: tuple[float, ...]
    """Equation (5), trial by trial [m/s]."""
    mean_power: tuple[float | None, ...]
    """Electrical power above idle, trial by trial; None where it is missing [W]."""

    @property
    def velocity(self) -> tuple[float, float | None]:
        """Mean and standard deviation of the forward velocity; one trial has no deviation [m/s]."""
        return mean_and_deviation(self.forward_velocity)

    @property
    def power(self) -> tuple[float, float | None] | None:
        """The same for the power; None if no trial has one [W]."""
        known = [value for value in self.mean_power if value is not None]
        return mean_and_deviation(known) if known else None


def load_repeats(path: str | Path) -> tuple[Repeat, ...]:
    """Load repeated trials from a CSV file.

    Args:
        path: Of the file.

    Returns:
        One entry per setting, in the order in which they first appear.

    Raises:
        TrialFileError: As `load_speeds`.
    """
    trials: dict[tuple[gaits.Gait, bool], list[tuple[float, float | None]]] = {}
    for one in measured.load_speeds(path):
        if one.v_m_s is not None:
            trials.setdefault((one.motion, one.config == "fin"), []).append((one.v_m_s, one.P_avg_W))
    return tuple(
        Repeat(
            gait=gait,
            has_fin=has_fin,
            forward_velocity=tuple(speed for speed, _ in found),
            mean_power=tuple(power for _, power in found),
        )
        for (gait, has_fin), found in trials.items()
    )
