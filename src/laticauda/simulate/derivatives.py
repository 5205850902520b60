"""Derivatives of the figures of trials with respect to the parameters of the trials.

The runs themselves are differentiated exactly: the kernels compute with a complex step
(`laticauda.compiling.duals`). How a parameter enters the kernels' rows is given by a few short
formulas, whose slope is computed by eighth-order differences, which are exact for polynomials of
that degree: to about 1e-13 for everything in a robot.
"""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Unpack

import numpy as np
from jaxtyping import Bool, Float

from laticauda import interfaces, robot
from laticauda.errors import BadArgument, check_choice
from laticauda.gaits import Gait
from laticauda.planar import batch, model
from laticauda.scenarios import ModelChanges, Scenario
from laticauda.simulate import batch_run, batch_scenarios, runner
from laticauda.simulate.numbers import (
    UNITS,
    Parameter,
    change_parameters,
    list_parameters,
    look_up,
    value_of,
)
from laticauda.trial import metrics

# Points of the differences, in steps, and their weights: eighth order; fourth order at an end of
# the allowed range.
_MIDDLE = {
    1: 4 / 5,
    -1: -4 / 5,
    2: -1 / 5,
    -2: 1 / 5,
    3: 4 / 105,
    -3: -4 / 105,
    4: -1 / 280,
    -4: 1 / 280,
}
_AHEAD = {0: -25 / 12, 1: 4.0, 2: -3.0, 3: 4 / 3, 4: -1 / 4}
_BEHIND = {-point: -weight for point, weight in _AHEAD.items()}
_LINE = {1: 1 / 2, -1: -1 / 2}  # the numbers of a gait and of a start are rows themselves
# The step as a share of the number. The smaller ones are for numbers near the end of the allowed
# range.
_SHARES = (2.0**-7, 2.0**-10, 2.0**-13)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensitivities:
    """Figures of trials and their derivatives with respect to parameters, nan where a trial lacks one (see `Swims`)."""

    figures: tuple[str, ...]
    """Names of the figures, as in `Swims`; x, y: final position of the center of mass."""
    parameters: tuple[Parameter, ...]
    """Parameters of the differentiation: name, unit and title."""
    point: Float[np.ndarray, "n_trials n_parameters"]
    """Values of the parameters, in their units."""
    values: Float[np.ndarray, "n_trials n_figures"]
    """Values of the figures, in the units of `UNITS`."""
    jacobian: Float[np.ndarray, "n_trials n_figures n_parameters"]
    """Derivative of each figure with respect to each parameter, in the figure's unit per the parameter's."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the trial reached its end."""
    status: tuple[str, ...]
    """How each trial ended."""

    def of(self, figure: str, parameter: str) -> Float[np.ndarray, " n_trials"]:
        """Return the derivative of one figure with respect to one parameter, for every trial.

        Args:
            figure: Name of the figure.
            parameter: Dotted name of the parameter.

        Raises:
            ValueError: If this object has no such figure or parameter.
        """
        names = tuple(known.name for known in self.parameters)
        column = names.index(check_choice("parameter", parameter, names))
        return self.jacobian[
            :, self.figures.index(check_choice("figure", figure, self.figures)), column
        ]

    @property
    def elasticity(self) -> Float[np.ndarray, "n_trials n_figures n_parameters"]:
        """Percent by which a figure grows when a parameter grows by one percent: (df/dq) q/f, nan where f is 0 [-]."""
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
    """Compute derivatives of the figures of one or many trials with respect to numbers of robot, gait and environment.

    The derivatives are those of the kernels' results, at the time step of the trial, exact to
    rounding: the kernels carry each number with its derivative (a complex step). Trials and
    parameters are computed side by side; each pair costs as much as three to four trials of a
    batch. Where a figure has a kink (|u phi'| at u phi' = 0 in a power, saturation of a servo), it
    is differentiated on either side; over a whole trial, this is not visible.

    Args:
        robots: The scenarios, all planar, with one duration and sample interval and without
            controllers; or the robots, together with their gaits. Time steps do not change with a
            parameter.
        gaits: The commanded gaits, one for all or one for each; omitted with scenarios.
        duration: Duration of every trial [s].
        names: Dotted names of the parameters: `gait.amplitude`, `water.normal_drag`,
            `robot.caudal_fin.length`, `robot.module.mass` (of all modules alike); see
            `laticauda.simulate.numbers`.
        environments: Waters or grounds, one for all or one for each; None uses `default_water` of
            each robot and gait.
        starts: Start of each trial; None: at the origin, along x.
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        changes: Settings of the model: `joints` (prescribed, pd, servo, or a joint law), `dt` [s]
            and the other fields of `laticauda.scenarios.ModelChanges`. A fluid law that branches is
            differentiated on the branch taken.

    Returns:
        Figures and derivatives, as arrays.

    Raises:
        ValueError: If an argument is out of its range, or a parameter does not exist, is a count,
            or cannot change.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.52, frequency=2.27, phase_shift=0.70)
        >>> found = sensitivities(lc.load_robot("mamba"), gait, names=["gait.frequency", "water.normal_drag"])
        >>> found.of("forward_velocity", "gait.frequency").round(4)
        array([0.0486])
    """
    if isinstance(names, str) or not names:
        raise BadArgument("names", f"must hold at least one name of a parameter, got {names!r}")
    scenarios = batch_scenarios.scenarios_of_batch(
        robots,
        gaits,
        environments=environments,
        starts=starts,
        duration=duration,
        sample_interval=sample_interval,
        **changes,
    )
    runs = batch_scenarios.runs_of(scenarios)
    duration, sample_interval = scenarios[0].duration, scenarios[0].sample_interval
    chosen = [_chosen(names, one) for one in scenarios]
    point = [[value_of(parameter.name, one) for parameter in chosen[0]] for one in scenarios]
    numbers = [
        Number(
            name=parameter.name,
            scenario=one,
            value=value,
            change=functools.partial(_moved, one, parameter.name),
        )
        for one, known, values in zip(scenarios, chosen, point, strict=True)
        for parameter, value in zip(known, values, strict=True)
    ]
    pairs = [run for run in runs for _ in names]
    found = compute_slopes(
        pairs,
        numbers,
        duration,
        sample_interval=sample_interval,
        threads=threads,
        progress=progress,
    )
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
    """Return the parameters of the given names.

    Raises:
        ValueError: If there is no parameter of that name, or it is a count.
    """
    known = list_parameters(scenario)
    found = tuple(look_up(name, known, "names") for name in names)
    for parameter in found:
        if parameter.is_whole:
            raise BadArgument(
                "names",
                f"must be of numbers that can vary slightly, got `{parameter.name}`, a count",
            )
    return found


def _moved(scenario: Scenario, name: str, value: float) -> Scenario:
    return change_parameters(scenario, {name: value})


@dataclass(frozen=True, kw_only=True)
class Number:
    """A variable number of a scenario's robot, gait or environment."""

    name: str
    """Name used in messages."""
    scenario: Scenario
    """Scenario that contains the number."""
    value: float
    """Value of the number in that scenario."""
    change: Callable[[float], Scenario]
    """Returns the scenario with another value; unaffected parts remain the same objects; ValueError if out of range."""
    start: Callable[[float], interfaces.Start] | None = None
    """Returns the start of the run with another value; None: the start does not depend on the value."""


class _Entry(NamedTuple):
    """The way in which a number enters a run."""

    rows: Float[np.ndarray, " rows"]
    weight: float
    has_extras: bool


def compute_slopes(
    runs: Sequence[batch.Run],
    numbers: Sequence[Number],
    duration: float,
    *,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: runner.Progress = runner.silent,
    observe: batch_run.BlockObserver = runner.silent,
    with_joints: bool = False,
) -> batch_run.BatchResult:
    """Compute figures and their derivatives, run i by number i, as complex numbers (see `laticauda.planar.batch`).

    Args:
        runs: Runs from `laticauda.simulate.batch_scenarios.runs_of`; their time steps remain unchanged.
        numbers: The number with respect to which each run is differentiated.
        duration: Duration of every trial [s].
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        observe: Called once per block, in the computing threads, before the next block overwrites its
            log; all numbers there are complex, see `laticauda.planar.batch`.
        with_joints: Whether the log that `observe` receives includes the motion of the joints.

    Raises:
        ValueError: If a number cannot change to either side, or another argument is out of its
            range.
    """
    derived: list[batch.Run] = []
    weights = np.empty(len(runs), dtype=complex)
    known: dict[tuple[int, str, int], _Entry] = {}
    extra_plants: dict[int, model.PlanarPlant] = {}
    for i, (run, number) in enumerate(zip(runs, numbers, strict=True)):
        key = id(run.plant), number.name, id(run.command.gait.recorded)
        if (entry := known.get(key)) is None:
            of_gait = (
                number.start is not None
                or number.change(number.value).gait is not number.scenario.gait
            )
            entry = _entry(run, number, (_LINE if of_gait else _MIDDLE, _AHEAD, _BEHIND))
            if not of_gait:  # the same for all gaits
                known[key] = entry
        plant = run.plant
        if entry.has_extras and not plant.layout.has_extras:
            plant = extra_plants.setdefault(id(plant), _with_extras(plant))
        derived.append(replace(run, plant=plant, slope=entry.rows))
        weights[i] = (
            metrics.carried_weight(plant.robot, plant.environment) + 1j * batch.STEP * entry.weight
        )
    found = batch_run.run_batch(
        derived,
        duration,
        sample_interval,
        threads=threads,
        progress=progress,
        weights=weights,
        observe=observe,
        with_joints=with_joints,
    )
    undefined = complex(math.nan, math.nan)
    return replace(
        found,
        figures={name: np.where(np.isnan(f), undefined, f) for name, f in found.figures.items()},
    )


def _entry(run: batch.Run, number: Number, differences: Sequence[Mapping[int, float]]) -> _Entry:
    """Differentiate everything from which the figures are computed: the kernels' rows, and the robot's weight."""
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
            if (
                len({entry.rows.size for entry in near.values()}) == 1
                and near[max(near)].rows.size == run.rows.size
            ):
                return _Entry(
                    rows=np.sum(
                        [weight / step * near[point].rows for point, weight in points.items()],
                        axis=0,
                    ),
                    weight=sum(
                        weight / step * near[point].weight for point, weight in points.items()
                    ),
                    has_extras=any(entry.has_extras for entry in near.values()),
                )
    reason = f": {refused}" if refused else ", but the number of fin strips depends on it there."
    rule = "`parameters` must be numbers that can vary slightly"
    raise ValueError(f"{rule}; `{number.name}` is {number.value:g}{reason}")


def _changed(run: batch.Run, number: Number, by: float) -> _Entry:
    """Return what a run's figures are computed from when its number changes by `by`."""
    plant = run.plant
    after, before = number.change(number.value + by), number.scenario
    start = run.start if number.start is None else number.start(number.value + by)
    if any(
        getattr(after, name) is not getattr(before, name)
        for name in ("robot", "environment", "model")
    ):
        settings = replace(plant.settings, joints=after.model.joints)
        plant = replace(plant, robot=after.robot, environment=after.environment, settings=settings)
    return _Entry(
        rows=replace(
            run, plant=plant, command=interfaces.Command(gait=after.gait), start=start
        ).rows,
        weight=metrics.carried_weight(plant.robot, plant.environment),
        has_extras=plant.layout.has_extras,
    )


def _with_extras(plant: model.PlanarPlant) -> model.PlanarPlant:
    """Return the plant with kernels that also compute loads that are 0 now, because their derivatives are not."""
    wider = replace(plant)
    vars(wider)["layout"] = replace(
        plant.layout, has_extras=True
    )  # where the cached property would store it
    return wider
