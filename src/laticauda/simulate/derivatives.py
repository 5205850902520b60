"""How the figures of trials follow the numbers that went into them: derivatives, each to one number of a trial.

The runs themselves are differentiated exactly: the kernels compute with a complex step (`laticauda.compiling.duals`).
How that number enters the kernels' rows is a matter of a few short formulas, and their slope comes from differences of
order eight, which are exact for polynomials of that degree: to some 1e-13 for all that a robot has.
"""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Unpack

import numpy as np
from jaxtyping import Bool, Float

from laticauda import interfaces, robot
from laticauda.errors import BadArgument, one_of
from laticauda.gaits import Gait
from laticauda.planar import batch, model
from laticauda.scenarios import ModelChanges, Scenario
from laticauda.simulate import many, runner
from laticauda.simulate.numbers import UNITS, Parameter, changed, look_up, parameters, value_of
from laticauda.trial import metrics

# Points of the differences, in steps, and their weights: of order eight; four at an end of what is allowed.
_MIDDLE = {1: 4 / 5, -1: -4 / 5, 2: -1 / 5, -2: 1 / 5, 3: 4 / 105, -3: -4 / 105, 4: -1 / 280, -4: 1 / 280}
_AHEAD = {0: -25 / 12, 1: 4.0, 2: -3.0, 3: 4 / 3, 4: -1 / 4}
_BEHIND = {-point: -weight for point, weight in _AHEAD.items()}
_LINE = {1: 1 / 2, -1: -1 / 2}  # the numbers of a gait and of a start are rows themselves
# A step as a share of the number. Smaller ones serve numbers near the end of what is allowed.
_SHARES = (2.0**-7, 2.0**-10, 2.0**-13)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensitivities:
    """Figures of trials and their derivatives to parameters, nan where a trial has no such figure (see `Swims`)."""

    figures: tuple[str, ...]
    """Names of the figures, as in `Swims`; x, y: the center of mass at the end."""
    parameters: tuple[Parameter, ...]
    """What they are differentiated to: name, unit and title."""
    point: Float[np.ndarray, "n_trials n_parameters"]
    """Values of the parameters, in their units."""
    values: Float[np.ndarray, "n_trials n_figures"]
    """The figures, in the units of `UNITS`."""
    jacobian: Float[np.ndarray, "n_trials n_figures n_parameters"]
    """Derivative of each figure to each parameter, in the figure's unit per the parameter's."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the trial reached its end."""
    status: tuple[str, ...]
    """How it ended."""

    def of(self, figure: str, parameter: str) -> Float[np.ndarray, " n_trials"]:
        """The derivative of one figure to one parameter, for every trial.

        Args:
            figure: Its name.
            parameter: Its name, with dots.

        Raises:
            ValueError: If there is no such figure or parameter here.
        """
        names = tuple(known.name for known in self.parameters)
        column = names.index(one_of("parameter", parameter, names))
        return self.jacobian[:, self.figures.index(one_of("figure", figure, self.figures)), column]

    @property
    def elasticity(self) -> Float[np.ndarray, "n_trials n_figures n_parameters"]:
        """By how many percent a figure grows when a parameter grows by one: (df/dq) q/f, nan where f is 0 [-]."""
        with np.errstate(all="ignore"):
            share = self.jacobian * self.point[:, np.newaxis, :] / self.values[:, :, np.newaxis]
        return np.where(np.isfinite(share), share, np.nan)


def sensitivities(
    robots: Sequence[Scenario] | robot.Robot | Sequence[robot.Robot],
    gaits: Gait | Sequence[Gait] | None = None,
    duration: float = 30.0,
    *,
    names: Sequence[str],
    environments: robot.Environment | Sequence[robot.Environment] | None = None,
    starts: interfaces.Start | Sequence[interfaces.Start] | None = None,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: runner.Progress = runner.silent,
    **changes: Unpack[ModelChanges],
) -> Sensitivities:
    """Derivatives of the figures of one or many trials to any numbers of robot, gait and environment.

    The derivatives are those of what the kernels compute, at the time step of the trial, exact to rounding: the kernels
    carry each number with its derivative (a complex step). Trials and parameters are computed side by side; each pair
    costs three to four trials of a batch. Where a figure has a kink (|u phi'| at u phi' = 0 in a power, saturation of a
    servo), it is differentiated on either side of it; over a trial that does not show.

    Args:
        robots: The scenarios, all planar, of one duration and sample interval, without controllers; or what swims, with
            their gaits. Time steps do not change with a parameter.
        gaits: What the joints are asked for, one or one for each; left out with scenarios.
        duration: Of every trial [s].
        names: Of the parameters, with dots: `gait.amplitude`, `water.normal_drag`, `robot.caudal_fin.length`,
            `robot.module.mass` (of all modules alike); see `laticauda.simulate.numbers`.
        environments: Waters or grounds, one or one for each; None takes `default_water` of each robot and gait.
        starts: Where each begins; None: at the origin, along x.
        sample_interval: Between two samples of the logs that the figures are taken from; they are not kept [s].
        threads: How many to compute with; None takes all cores that this process may use.
        progress: Called now and then with the share that is finished, from 0 to 1.
        changes: Of the model: `joints` (prescribed, pd, servo, or a joint law), `dt` [s] and the other fields of
            `laticauda.scenarios.ModelChanges`. A fluid law that branches is differentiated on the branch that it takes.

    Returns:
        Figures and derivatives, as arrays.

    Raises:
        ValueError: If an argument is out of its range, or a parameter does not exist, counts something, or cannot
            change.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.52, frequency=2.27, phase_shift=0.70)
        >>> found = sensitivities(lc.load_robot("mamba"), gait, names=["gait.frequency", "water.normal_drag"])
        >>> found.of("forward_velocity", "gait.frequency").round(4)
        array([0.0486])
    """
    if isinstance(names, str) or not names:
        raise BadArgument("names", f"must hold at least one name of a parameter, got {names!r}")
    scenarios = many.batch_of(robots, gaits, environments, starts, duration, sample_interval, **changes)
    runs = many.runs_of(scenarios)
    duration, sample_interval = scenarios[0].duration, scenarios[0].sample_interval
    chosen = [_chosen(names, one) for one in scenarios]
    point = [[value_of(parameter.name, one) for parameter in chosen[0]] for one in scenarios]
    numbers = [
        Number(name=parameter.name, scenario=one, value=value, change=functools.partial(_moved, one, parameter.name))
        for one, known, values in zip(scenarios, chosen, point, strict=True)
        for parameter, value in zip(known, values, strict=True)
    ]
    pairs = [run for run in runs for _ in names]
    found = slopes(pairs, numbers, duration, sample_interval=sample_interval, threads=threads, progress=progress)
    shape = len(runs), len(names)
    figures = np.stack([found.figures[name].reshape(shape) for name in UNITS], axis=1)
    return Sensitivities(
        figures=tuple(UNITS),
        parameters=chosen[0],
        point=np.array(point),
        values=np.real(figures[:, :, 0]),
        jacobian=np.imag(figures) / batch.STEP,
        succeeded=found.succeeded[:: len(names)],
        status=found.status[:: len(names)],
    )


def _chosen(names: Sequence[str], scenario: Scenario) -> tuple[Parameter, ...]:
    """The parameters of these names.

    Raises:
        ValueError: If there is none of that name, or it counts something.
    """
    known = parameters(scenario)
    found = tuple(look_up(name, known, "names") for name in names)
    for parameter in found:
        if parameter.is_whole:
            raise BadArgument("names", f"must be of numbers that may change a little, got `{parameter.name}`, a count")
    return found


def _moved(scenario: Scenario, name: str, value: float) -> Scenario:
    return changed(scenario, {name: value})


@dataclass(frozen=True, kw_only=True)
class Number:
    """A number of a scenario's robot, gait or environment that may change."""

    name: str
    """What messages call it."""
    scenario: Scenario
    """Whose number it is."""
    value: float
    """What it is there."""
    change: Callable[[float], Scenario]
    """The scenario with another value: what it is not part of stays the same object; a ValueError if out of range."""
    start: Callable[[float], interfaces.Start] | None = None
    """Where the run begins with another value; None: where it did."""


class _Entry(NamedTuple):
    """How a number enters a run."""

    rows: Float[np.ndarray, " rows"]
    weight: float
    has_extras: bool


def slopes(
    runs: Sequence[batch.Run],
    numbers: Sequence[Number],
    duration: float,
    *,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: runner.Progress = runner.silent,
    look: many.Look = runner.silent,
    with_joints: bool = False,
) -> many.Collected:
    """Figures of runs and their derivatives, run i to number i: complex numbers, as those of `laticauda.planar.batch`.

    Args:
        runs: From `laticauda.simulate.many.runs_of`; steps in time stay what they are there.
        numbers: What each is differentiated to.
        duration: Of every trial [s].
        sample_interval: Between two samples of the logs that the figures are taken from; they are not kept [s].
        threads: How many to compute with; None takes all cores that this process may use.
        progress: Called now and then with the share that is finished, from 0 to 1.
        look: Called once per block, in the threads that compute, before the next one overwrites its log; all numbers
            there are complex, see `laticauda.planar.batch`.
        with_joints: Whether it finds what the joints did in the log, too.

    Raises:
        ValueError: If a number cannot change on either side, or another argument is out of its range.
    """
    derived: list[batch.Run] = []
    weights = np.empty(len(runs), dtype=complex)
    known: dict[tuple[int, str, int], _Entry] = {}
    extra_plants: dict[int, model.PlanarPlant] = {}
    for i, (run, number) in enumerate(zip(runs, numbers, strict=True)):
        key = id(run.plant), number.name, id(run.command.gait.recorded)
        if (entry := known.get(key)) is None:
            of_gait = number.start is not None or number.change(number.value).gait is not number.scenario.gait
            entry = _entry(run, number, (_LINE if of_gait else _MIDDLE, _AHEAD, _BEHIND))
            if not of_gait:  # the same for all gaits
                known[key] = entry
        plant = run.plant
        if entry.has_extras and not plant.layout.has_extras:
            plant = extra_plants.setdefault(id(plant), _with_extras(plant))
        derived.append(replace(run, plant=plant, slope=entry.rows))
        weights[i] = metrics.carried_weight(plant.robot, plant.environment) + 1j * batch.STEP * entry.weight
    how = duration, sample_interval, threads, progress
    found = many.collected(derived, *how, weights=weights, look=look, with_joints=with_joints)
    undefined = complex(math.nan, math.nan)
    return replace(found, figures={name: np.where(np.isnan(f), undefined, f) for name, f in found.figures.items()})


def _entry(run: batch.Run, number: Number, differences: Sequence[Mapping[int, float]]) -> _Entry:
    """The derivative of all that the figures are made of: the kernels' rows, and the robot's weight."""
    size = 2.0 ** math.floor(math.log2(abs(number.value))) if number.value else 1.0
    refused: ValueError | None = None
    for points in differences:
        for share in _SHARES:
            step = share * size
            try:
                near = {point: _changed(run, number, point * step) for point in points}
            except ValueError as err:
                refused = err
                continue
            if len({entry.rows.size for entry in near.values()}) == 1 and near[max(near)].rows.size == run.rows.size:
                return _Entry(
                    rows=np.sum([weight / step * near[point].rows for point, weight in points.items()], axis=0),
                    weight=sum(weight / step * near[point].weight for point, weight in points.items()),
                    has_extras=any(entry.has_extras for entry in near.values()),
                )
    reason = f": {refused}" if refused else ", but the number of fin strips depends on it there."
    rule = "`parameters` must be numbers that may change a little"
    raise ValueError(f"{rule}; `{number.name}` is {number.value:g}{reason}")


def _changed(run: batch.Run, number: Number, by: float) -> _Entry:
    """What a run's figures are made of when its number is another."""
    plant = run.plant
    after, before = number.change(number.value + by), number.scenario
    start = run.start if number.start is None else number.start(number.value + by)
    if any(getattr(after, name) is not getattr(before, name) for name in ("robot", "environment", "model")):
        settings = replace(plant.settings, joints=after.model.joints)
        plant = replace(plant, robot=after.robot, environment=after.environment, settings=settings)
    return _Entry(
        rows=replace(run, plant=plant, command=interfaces.Command(gait=after.gait), start=start).rows,
        weight=metrics.carried_weight(plant.robot, plant.environment),
        has_extras=plant.layout.has_extras,
    )


def _with_extras(plant: model.PlanarPlant) -> model.PlanarPlant:
    """The same plant, whose kernels look for loads that are 0 now, because their derivatives are not."""
    wider = replace(plant)
    vars(wider)["layout"] = replace(plant.layout, has_extras=True)  # where the cached property would put it
    return wider
