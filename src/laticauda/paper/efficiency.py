"""The efficiency study: speed and power of the robot over amplitude, frequency and phase shift.

It repeats the trials behind the paper's Figs. 4 to 11 and Table 1 in simulation, and compares the
contents of the table, the maxima of sweeps, with the maxima of the simulated sweeps. The errors of
the speeds are computed in `scores`.

Repeated trials from a user's CSV file show the scatter of measurements of the same setting. The
file is a table of speeds (`laticauda.trials.measured`), intended to have several rows per setting.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from jaxtyping import Float

from laticauda import scenarios
from laticauda.motion import gaits
from laticauda.paper.measured import MeasuredCase
from laticauda.paper.runs import Runs, Study
from laticauda.paper.settings import EfficiencySettings, Group, SweepSettings, efficiency_settings
from laticauda.tank.operate.series import mean_and_deviation
from laticauda.trials import measured, null_models

Curves = Float[np.ndarray, "n_models n_groups n_values"]
CURVES = ("forward_velocity", "steady_velocity", "mechanical_power")


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
    def measured(self) -> tuple[Case, ...]:
        """The rows with a measured velocity."""
        return tuple(case for case in self.cases if case.measured.forward_velocity is not None)

    usual = staticmethod(efficiency_settings)

    @classmethod
    def by_runs(cls, settings: EfficiencySettings, runs: Runs) -> "EfficiencyStudy":
        """Run the trials of `settings` by `runs`, and return the study.

        Args:
            settings: Settings of the study.
            runs: Runner, with the model and the progress callback.
        """
        runs.n_runs = settings.n_runs

        def tasks(group: Group, gait: gaits.Gait) -> list[tuple[str, scenarios.Scenario]]:
            """Return name and scenario of each model's trial; the first model's is last and determines `runs.how`."""
            setting = "amplitude {:.3g}, frequency {:.3g}, phase shift {:.3g} [deg, deg/s]".format(
                *np.degrees([gait.amplitude, gait.frequency, gait.phase_shift])
            )
            swimmers = [
                one.scenario(
                    group.robot, gait, model=one.driven(runs.model), duration=settings.duration
                )
                for one in reversed(settings.models)
            ]
            return [
                (f"{one.robot.name}, {gait.kind}, {setting}, {one.environment.name}", one)
                for one in swimmers
            ]

        cases: list[Case] = []
        for group, row in [(one, row) for one in settings.groups for row in one.cases]:
            trials = [runs.swim(*task) for task in tasks(group, row.gait)][::-1]
            velocity, power = zip(
                *[(one.forward_velocity, one.mechanical_power) for one in trials], strict=True
            )
            cases.append(
                Case(group=group, measured=row, forward_velocity=velocity, mechanical_power=power)
            )
        sweeps: list[SweepResult] = []
        for sweep in settings.sweeps:
            points = [
                tasks(group, sweep.gait(group.gait, at))
                for group in settings.groups
                for at in sweep.values
            ]
            found, shape = (
                runs.figures(list(chain(*points))),
                (len(settings.groups), sweep.values.size, -1),
            )
            curves = {
                name: np.moveaxis(found[name].reshape(shape)[:, :, ::-1], 2, 0) for name in CURVES
            }
            sweeps.append(SweepResult(settings=sweep, **curves))
        return EfficiencyStudy(
            settings=settings, how=runs.how, sweeps=tuple(sweeps), cases=tuple(cases)
        )


run_efficiency = EfficiencyStudy.run


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
    """By model, whether this is the first or last value of the sweep, so that the maximum may lie outside the range."""

    def distance(self, model: int) -> float:
        """Return the distance between measured and simulated maximum; infinite if none is within range [rad, rad/s].

        Args:
            model: Index of the model.
        """
        return (
            np.inf if self.at_the_end[model] else abs(self.simulated_at[model] - self.measured_at)
        )


def maxima(study: EfficiencyStudy) -> tuple[Maximum, ...]:
    """Return the starred entries of Table 1 with the maxima of the simulated sweeps, group by group.

    Args:
        study: Result of `run_efficiency`.
    """
    stars = {(case.group.name, case.measured.starred): case.measured for case in study.measured}
    return tuple(
        _maximum(group, sweep, stars[group.name, sweep.settings.parameter], place)
        for place, group in enumerate(study.settings.groups)
        for sweep in study.sweeps
        if (group.name, sweep.settings.parameter) in stars
    )


def _maximum(group: Group, sweep: SweepResult, star: MeasuredCase, place: int) -> Maximum:
    curves, values, parameter = (
        sweep.forward_velocity[:, place],
        sweep.values,
        sweep.settings.parameter,
    )
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


# ---- repeated trials -----------------------------------------------------------------------------

TABLE2 = Path(__file__).parent / "data" / "table2_series.toml"
"""Table 2 as a series file of `laticauda operate`: twelve settings, three runs each."""


@dataclass(frozen=True, kw_only=True)
class Repeat(null_models.Row):
    """All trials of one setting."""

    forward_velocity: tuple[float, ...]
    """Forward velocity by equation (5), trial by trial [m/s]."""
    mean_power: tuple[float | None, ...]
    """Electrical power above idle, trial by trial; None if missing [W]."""

    @property
    def velocity(self) -> tuple[float, float | None]:
        """Mean and standard deviation of the forward velocity; a single trial has no deviation [m/s]."""
        return mean_and_deviation(self.forward_velocity)

    @property
    def power(self) -> tuple[float, float | None] | None:
        """Mean and standard deviation of the power; None if no trial has a power [W]."""
        known = [value for value in self.mean_power if value is not None]
        return mean_and_deviation(known) if known else None


def load_repeats(path: str | Path) -> tuple[Repeat, ...]:
    """Load repeated trials from a CSV file.

    Args:
        path: Path of the file.

    Returns:
        One entry per setting, in the order in which they first appear.

    Raises:
        TrialFileError: If `load_speeds` cannot read the file.
    """
    trials: dict[tuple[gaits.Gait, bool], list[tuple[float, float | None]]] = {}
    for one in measured.load_speeds(path):
        if one.v_m_s is not None:
            trials.setdefault((one.motion, one.config == "fin"), []).append(
                (one.v_m_s, one.P_avg_W)
            )
    return tuple(
        Repeat(
            gait=gait,
            has_fin=has_fin,
            forward_velocity=tuple(speed for speed, _ in found),
            mean_power=tuple(power for _, power in found),
        )
        for (gait, has_fin), found in trials.items()
    )
