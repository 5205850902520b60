"""The efficiency study: how fast the robot swims, and at what power, over amplitude, frequency and phase shift.

It repeats the trials behind the paper's Figs. 4 to 11 and Table 1 in simulation. What it finds about the table is
computed in `table1` and `scores`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.errors import SimulationFailed
from laticauda.gaits import Gait
from laticauda.packaging import __version__
from laticauda.paper.measured import MeasuredTrial, measured_trial
from laticauda.paper.settings import EfficiencySettings, Group, SweepSettings, efficiency_settings
from laticauda.robot import Robot, Water, load_robot
from laticauda.simulate import swim
from laticauda.studies.progress import Progress
from laticauda.trial import Trial
from laticauda.trial.contents import Setting

Curves = Float[np.ndarray, "n_models n_groups n_values"]
# Forward velocity [m/s], steady velocity [m/s] and mechanical power [W].
Figures = Float[np.ndarray, "n_trials n_models 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SweepResult:
    """Curves over one parameter of the gait."""

    settings: SweepSettings
    """What was swept."""
    values: Float[np.ndarray, " n_values"]
    """The parameter, in rising order [rad, rad/s]."""
    forward_velocity: Curves
    """Equation (5), by model, group and value [m/s]."""
    steady_velocity: Curves
    """The same without the start [m/s]."""
    mechanical_power: Curves
    """Mean of sum |u phi'| [W]."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row of Table 1, measured and simulated."""

    group: Group
    """The part of the table that it is in."""
    index: int
    """Its place there, from 0; the paper counts from 1 [-]."""
    gait: Gait
    """What the joints were asked for."""
    starred: str | None
    """The parameter whose best value this is said to be; None for the others."""
    measured_velocity: float | None
    """None where the paper has none [m/s]."""
    measured_power: float | None
    """Electrical, above idle; None where the paper has none [W]."""
    forward_velocity: tuple[float, ...]
    """Simulated, by model [m/s]."""
    mechanical_power: tuple[float, ...]
    """Simulated, by model [W]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EfficiencyStudy:
    """What the efficiency study ran, and what came out."""

    settings: EfficiencySettings
    """What was run."""
    how: Mapping[str, Setting]
    """How every trial was computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s] and the like."""
    version: str
    """Version of laticauda that ran it."""
    sweeps: tuple[SweepResult, ...]
    """One per sweep of the settings."""
    cases: tuple[Case, ...]
    """All rows of Table 1 in its order."""

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the sets of coefficients, in the order of the first axis of all curves."""
        return tuple(model.name for model in self.settings.models)

    @property
    def measured(self) -> tuple[Case, ...]:
        """The rows with a measured velocity."""
        return tuple(case for case in self.cases if case.measured_velocity is not None)


def run_efficiency(
    settings: EfficiencySettings | None = None,
    *,
    model: str = "planar",
    joints: str = "prescribed",
    dt: float | None = None,
    offset_bandwidth: float = 10.0,
    ramp: float | None = None,
    progress: Progress | None = None,
) -> EfficiencyStudy:
    """Run the efficiency study: every sweep and every row of Table 1, straight and from rest.

    Args:
        settings: None takes those of the paper.
        model: See `laticauda.simulate.plant`.
        joints: See `laticauda.simulate.plant`.
        dt: See `laticauda.simulate.plant` [s].
        offset_bandwidth: See `laticauda.simulate.plant` [rad/s].
        ramp: See `laticauda.simulate.plant` [s].
        progress: Called now and then with the number of trials done, and of all.

    Returns:
        Speeds and powers; the logs of the trials are not kept.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If a trial blows up; the message says which.
    """
    settings = settings or efficiency_settings()
    options = {"model": model, "joints": joints, "dt": dt, "offset_bandwidth": offset_bandwidth, "ramp": ramp}
    rows = [(group, gait) for group in settings.groups for gait in group.cases]
    points = [
        (group, sweep.gait(group.gait, value))
        for sweep in settings.sweeps
        for group in settings.groups
        for value in sweep.values
    ]
    found, how = _measured([*rows, *points], settings, options, progress)
    of_rows, of_points = iter(found[: len(rows)]), found[len(rows) :]
    return EfficiencyStudy(
        settings=settings,
        how=how,
        version=__version__,
        sweeps=tuple(_curves(settings, of_points)),
        cases=tuple(
            _case(group, index, next(of_rows)) for group in settings.groups for index in range(len(group.cases))
        ),
    )


def _measured(
    trials: Sequence[tuple[Group, Gait]],
    settings: EfficiencySettings,
    options: Mapping[str, Any],
    progress: Progress | None,
) -> tuple[Figures, dict[str, Setting]]:
    """The figures of every trial with every set of coefficients, and how they were computed."""
    robots = {group.robot: load_robot(group.robot) for group in settings.groups}
    wanted = {(group.robot, group.gait) for group in settings.groups}
    # By set of coefficients, by robot and gait: what swims, and where.
    setups = [
        {(robot, gait): (model.robot(robots[robot], gait), model.water(gait)) for robot, gait in wanted}
        for model in settings.models
    ]
    found = np.empty((len(trials), len(setups), 3))
    how: dict[str, Setting] = {}
    for i, (group, gait) in enumerate(trials):
        for m, setup in enumerate(setups):
            trial = _swim(*setup[group.robot, gait.kind], gait, settings.duration, options)
            found[i, m] = trial.forward_velocity, trial.steady_velocity, trial.mechanical_power
            how |= trial.settings
        if progress is not None:
            progress((i + 1) * len(setups), settings.n_runs)
    return found, how


def _swim(robot: Robot, water: Water, gait: Gait, duration: float, options: Mapping[str, Any]) -> Trial:
    try:
        return swim(robot, gait, duration, environment=water, throw=True, **options)
    except SimulationFailed as error:
        setting = "amplitude {:.3g}, frequency {:.3g}, phase shift {:.3g} [deg, deg/s]".format(
            *np.degrees([gait.amplitude, gait.frequency, gait.phase_shift])
        )
        raise SimulationFailed(f"{robot.name}, {gait.kind}, {setting}, {water.name}: {error}") from error


def _curves(settings: EfficiencySettings, found: Figures) -> Iterator[SweepResult]:
    """The figures of all sweeps, which come one sweep after the other, group by group."""
    begin = 0
    for sweep in settings.sweeps:
        shape = (len(settings.groups), sweep.values.size)
        end = begin + shape[0] * shape[1]
        velocity, steady, power = np.moveaxis(found[begin:end].reshape(*shape, -1, 3), (3, 2), (0, 1))
        yield SweepResult(
            settings=sweep,
            values=sweep.values,
            forward_velocity=velocity,
            steady_velocity=steady,
            mechanical_power=power,
        )
        begin = end


def _case(group: Group, index: int, found: Float[np.ndarray, "n_models 3"]) -> Case:
    gait = group.cases[index]
    measured: MeasuredTrial | None = measured_trial(gait, group.has_fin)
    return Case(
        group=group,
        index=index,
        gait=gait,
        starred=group.starred(index),
        measured_velocity=None if measured is None else measured.forward_velocity,
        measured_power=None if measured is None else measured.mean_power,
        forward_velocity=tuple(map(float, found[:, 0])),
        mechanical_power=tuple(map(float, found[:, 2])),
    )
