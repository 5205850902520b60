"""Identification problem: the measurements, the unknowns, and the dependence between them.

All measured numbers stand in one row, the data: measurement by measurement, figures first, then
series sample by sample. Unknowns are numbered by k, measurements by i.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import compress
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.identify.dependence import find_dependence
from laticauda.identify.measurements import Measurement, root_mean_square
from laticauda.identify.resolving import (
    NumberedScenario,
    ScopedName,
    body_key,
    is_of_gait,
    list_numbers,
    resolve,
    split_name,
    with_tied,
)
from laticauda.identify.unknowns import (
    NUISANCE,
    SIMULATED,
    Prior,
    ResolvedUnknown,
    Unknown,
    as_unknowns,
)
from laticauda.models.simulate import change_parameters
from laticauda.robot import Robot
from laticauda.scenarios import Model, Resumed, Scenario, Start, model_of
from laticauda.values import BadArgument, check_instance, check_items, check_not_empty

SAMPLE_INTERVAL = 0.05
"""Sample interval of the logs that series are interpolated from [s]."""
_SIZE_OF_START = 0.1
"""A large change of where, or how fast, a trial began [m, rad, m/s]."""


class DataBlock(NamedTuple):
    """A measured figure or series, and where its numbers stand in the data."""

    owner: int
    """Index of its measurement."""
    name: str
    """Name of the figure or series."""
    is_series: bool
    """Whether it is a series."""
    numbers: slice
    """Slice of the data that holds its numbers."""
    sigma: float | Float[np.ndarray, " size"]
    """Standard deviation of the noise of its numbers: one for all, or one for each."""

    @property
    def size(self) -> int:
        """Number of its data."""
        return self.numbers.stop - self.numbers.start

    @property
    def usual_sigma(self) -> float:
        """Standard deviation of the noise, as a root mean square if each number has its own."""
        if isinstance(self.sigma, np.ndarray):
            return root_mean_square(self.sigma)
        return self.sigma


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """Measurements and unknowns that match; created by `make_problem`."""

    measurements: tuple[Measurement, ...]
    """The measurements; the scenario of each has the model with which all of them are simulated."""
    unknowns: tuple[ResolvedUnknown, ...]
    """Unknowns to be identified."""
    depends_on: Bool[np.ndarray, "n_measurements n_unknowns"]
    """Whether each measurement depends on each unknown."""
    threads: int | None
    """Number of threads."""
    client: Any = None
    """A `dask.distributed.Client` whose cluster simulates; None: this process does."""

    @cached_property
    def data_blocks(self) -> tuple[DataBlock, ...]:
        """All figures and series in the data, measurement by measurement, figures first."""
        blocks: list[DataBlock] = []
        begin = 0
        for owner, measurement in enumerate(self.measurements):
            for is_series, entries in ((False, measurement.figures), (True, measurement.series)):
                for name, (values, sigma) in entries.items():
                    end = begin + np.size(values)
                    if isinstance(sigma, np.ndarray):
                        sigma = sigma.ravel()
                    block = DataBlock(
                        owner=owner,
                        name=name,
                        is_series=is_series,
                        numbers=slice(begin, end),
                        sigma=sigma,
                    )
                    blocks.append(block)
                    begin = end
        return tuple(blocks)

    @cached_property
    def observed(self) -> Float[np.ndarray, " n_data"]:
        """All measured numbers in the order of `data_blocks`, without the selection bias."""
        parts: list[np.ndarray] = []
        for block in self.data_blocks:
            measurement = self.measurements[block.owner]
            if block.is_series:
                samples, _ = measurement.series[block.name]
                parts.append(samples.ravel())
            else:
                parts.append(np.array([measurement.without_bias(block.name)]))
        return np.concatenate(parts)

    @cached_property
    def sigma(self) -> Float[np.ndarray, " n_data"]:
        """Standard deviation of the noise of each measured number."""
        return np.concatenate([np.full(block.size, block.sigma) for block in self.data_blocks])

    @cached_property
    def owner(self) -> Int[np.ndarray, " n_data"]:
        """Index of the measurement to which each measured number belongs."""
        return np.concatenate([np.full(block.size, block.owner) for block in self.data_blocks])

    @cached_property
    def scenarios(self) -> tuple[Scenario, ...]:
        """Scenario with which each measurement is simulated, apart from the identified values."""
        return tuple(measurement.scenario for measurement in self.measurements)

    @property
    def groups(self) -> tuple[str, ...]:
        """Name of the group of each measurement."""
        return tuple(measurement.group for measurement in self.measurements)

    @property
    def model(self) -> Model:
        """Model with which all measurements are simulated."""
        return self.scenarios[0].model

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @property
    def n_priors(self) -> int:
        """Number of unknowns with a prior."""
        return sum(unknown.prior is not None for unknown in self.unknowns)

    @property
    def start(self) -> Float[np.ndarray, " n_unknowns"]:
        """Values at which the search starts."""
        return np.array([unknown.start for unknown in self.unknowns])

    @property
    def sizes(self) -> Float[np.ndarray, " n_unknowns"]:
        """Size of a large change of each coordinate."""
        return np.array([unknown.size for unknown in self.unknowns])

    @property
    def of_interest(self) -> list[int]:
        """Indices of the unknowns shown in tables: all but the starts of single trials."""
        return [k for k, unknown in enumerate(self.unknowns) if not unknown.is_start]

    @property
    def without_starts(self) -> "Problem":
        """The same problem without the unknown start states of single trials."""
        shown = self.of_interest
        unknowns = tuple(self.unknowns[k] for k in shown)
        return replace(self, unknowns=unknowns, depends_on=self.depends_on[:, shown])

    def values_of(self, x: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """Return the values at given coordinates."""
        pairs = zip(self.unknowns, x, strict=True)
        return np.array([unknown.value(float(coordinate)) for unknown, coordinate in pairs])

    def values_by_name(self, x: Float[np.ndarray, " n_unknowns"]) -> dict[str, float]:
        """Return the values at given coordinates by name."""
        return dict(zip(self.names, self.values_of(x).tolist(), strict=True))

    def coordinates_of(
        self, values: Float[np.ndarray, " n_unknowns"]
    ) -> Float[np.ndarray, " n_unknowns"]:
        """Return the coordinates of given values."""
        pairs = zip(self.unknowns, values, strict=True)
        return np.array([unknown.x(float(value)) for unknown, value in pairs])

    def slopes(self, values: Float[np.ndarray, " n_unknowns"]) -> Float[np.ndarray, " n_unknowns"]:
        """Return dq/dx of every unknown."""
        pairs = zip(self.unknowns, values, strict=True)
        return np.array([unknown.slope(float(value)) for unknown, value in pairs])

    def prior_residuals(
        self, values: Float[np.ndarray, " n_unknowns"]
    ) -> Float[np.ndarray, " n_priors"]:
        """Return the residuals of the priors."""
        residuals: list[float] = []
        for unknown, value in zip(self.unknowns, values, strict=True):
            if unknown.prior is not None:
                residuals.append((value - unknown.prior.mean) / unknown.prior.sd)
        return np.array(residuals)

    def prior_slopes(
        self, values: Float[np.ndarray, " n_unknowns"]
    ) -> Float[np.ndarray, "n_priors n_unknowns"]:
        """Return the derivatives of the prior residuals with respect to the coordinates."""
        slopes = np.zeros((self.n_priors, len(self.unknowns)))
        row = 0
        for k, unknown in enumerate(self.unknowns):
            if unknown.prior is not None:
                slopes[row, k] = unknown.slope(float(values[k])) / unknown.prior.sd
                row += 1
        return slopes

    def information(
        self, jacobian: Float[np.ndarray, "n_residuals n_unknowns"]
    ) -> Float[np.ndarray, "n n"]:
        """Return J^T J of the data alone, without the rows of the priors, which come last."""
        data = jacobian[: self.observed.size]
        return data.T @ data

    def part(self, indices: Sequence[int]) -> "Problem":
        """Return the problem with only these measurements; all unknowns stay, seen or not."""
        measurements = tuple(self.measurements[i] for i in indices)
        return replace(self, measurements=measurements, depends_on=self.depends_on[list(indices)])

    def scenarios_at(self, values: Float[np.ndarray, " n_unknowns"]) -> tuple[Scenario, ...]:
        """Return the scenario of each measurement at the given values.

        Measurements that share robot, environment and changed numbers get the same objects for
        them: a batch of runs then shares their plant (see `body_key`).
        """
        changed_scenarios: dict[object, Scenario] = {}
        scenarios: list[Scenario] = []
        for i, stated in enumerate(self.scenarios):
            numbers = self._simulated_numbers(i, values)
            numbers_of_gait = {
                name: numbers.pop(name) for name in list(numbers) if is_of_gait(name)
            }
            key = (*body_key(stated), *numbers.items())
            if key not in changed_scenarios:
                changed_scenarios[key] = change_parameters(stated, numbers)
            scenario = replace(
                changed_scenarios[key],
                motion=change_parameters(stated, numbers_of_gait).motion,
                start=self._start_of_trial(i, values),
                duration=stated.duration,
            )
            scenarios.append(scenario)
        return tuple(scenarios)

    def _simulated_numbers(self, i: int, values: np.ndarray) -> dict[str, float]:
        """Return the values of the numbers of robot, environment and gait of measurement i."""
        scenario = self.scenarios[i]
        numbers: dict[str, float] = {}
        for k in np.flatnonzero(self.depends_on[i]):
            unknown = self.unknowns[k]
            name = unknown.parameter.name
            if name in NUISANCE:
                continue
            numbers |= with_tied(scenario, name, float(values[k]), unknown.tied)
        return numbers

    def _start_of_trial(self, i: int, values: np.ndarray) -> Start | Resumed:
        """Return the start of measurement i, with the offsets on which its run depends."""
        start = self.scenarios[i].start
        for k in np.flatnonzero(self.depends_on[i]):
            name = self.unknowns[k].parameter.name
            if name in SIMULATED:
                start = shift_start(start, name, float(values[k]))
        return start

    def nuisance(self, i: int, values: np.ndarray) -> dict[str, Any]:
        """Return the values of those `NUISANCE` parameters of a measurement that are identified."""
        return {
            unknown.parameter.name: values[k]
            for k, unknown in enumerate(self.unknowns)
            if self.depends_on[i, k] and unknown.parameter.name in NUISANCE
        }


def make_problem(
    measurements: Sequence[Measurement],
    parameters: Sequence["str | Unknown"] | Mapping[str, tuple[float, float]],
    robot: Robot | None = None,
    *,
    threads: int | None = None,
    client: Any = None,
    **changes: Any,
) -> Problem:
    """Combine measurements and unknowns into a problem, and check that they match.

    Args:
        measurements: At least one, with different names.
        parameters: Unknowns to be identified.
        robot: Robot that must have swum, with or without its fin; None: that of the first
            measurement.
        threads: Number of threads.
        client: A `dask.distributed.Client` whose cluster simulates; None: this process does.
        changes: Changes of the models of all scenarios (see `laticauda.scenarios.ModelChanges`),
            and `model`.

    Raises:
        ValueError: If they do not match.
    """
    measurements = _check_measurements(measurements)
    _check_one_body(measurements, robot or measurements[0].scenario.robot)
    measurements = _by_one_model(measurements, _common_model(measurements, **changes))
    scenarios = tuple(measurement.scenario for measurement in measurements)
    numbers = list_numbers(scenarios)
    scopes = [_scopes_of(measurement) for measurement in measurements]
    unknowns = as_unknowns(parameters)
    scoped_names = [split_name(unknown, scopes, numbers) for unknown in unknowns]
    depends_on = find_dependence(scoped_names, scopes, numbers)
    numbered = [NumberedScenario(*pair) for pair in zip(scenarios, numbers, strict=True)]
    resolved: list[ResolvedUnknown] = []
    for k, unknown in enumerate(unknowns):
        dependents = list(compress(numbered, depends_on[:, k]))
        resolved.append(resolve(unknown, scoped_names[k], dependents))
    problem = Problem(
        measurements=measurements,
        unknowns=tuple(resolved),
        depends_on=depends_on,
        threads=threads,
        client=client,
    )
    return with_starts(problem)


def _scopes_of(measurement: Measurement) -> set[str]:
    """Return what an unknown may be identified for: kind of gait, group, or measurement."""
    return {measurement.scenario.gait.kind, measurement.group, measurement.name}


def with_starts(problem: Problem) -> Problem:
    """Return the problem with the start state of every trial among the unknowns.

    Args:
        problem: Measurements and unknowns.
    """
    added: list[ResolvedUnknown] = []
    owners: list[int] = []
    for i, measurement in enumerate(problem.measurements):
        present = {
            problem.unknowns[k].parameter.name for k in np.flatnonzero(problem.depends_on[i])
        }
        for name, prior in measurement.starts.items():
            if name not in present:
                added.append(_unknown_start(measurement, name, prior))
                owners.append(i)
    belongs_to = np.arange(len(problem.measurements))[:, np.newaxis] == np.array(owners, dtype=int)
    return replace(
        problem,
        unknowns=(*problem.unknowns, *added),
        depends_on=np.hstack([problem.depends_on, belongs_to]),
    )


def _unknown_start(measurement: Measurement, name: str, prior: Prior | None) -> ResolvedUnknown:
    """Return the offset of a start from the stated one as an unknown of its measurement alone."""
    return ResolvedUnknown(
        name=f"{measurement.name}.{name}",
        scope=measurement.name,
        parameter=NUISANCE[name],
        start=0.0,
        prior=prior,
        is_log=False,
        size=_SIZE_OF_START,
    )


def other_measurements(problem: Problem, measurements: Sequence[Measurement]) -> Problem:
    """Return a problem with the same unknowns and other measurements.

    Their measured numbers are not used.

    Args:
        problem: Provides the unknowns.
        measurements: The other measurements, with any names; unknowns of single measurements do not
            apply to them.
    """
    renamed = [
        replace(measurement, name=f"{i}: {measurement.name}")
        for i, measurement in enumerate(measurements)
    ]
    replaced = _by_one_model(renamed, problem.model)
    scenarios = [measurement.scenario for measurement in replaced]
    scoped_names = [
        ScopedName(unknown.scope, unknown.parameter.name) for unknown in problem.unknowns
    ]
    gait_kinds = [{scenario.gait.kind} for scenario in scenarios]
    depends_on = find_dependence(scoped_names, gait_kinds, list_numbers(scenarios))
    return replace(problem, measurements=replaced, depends_on=depends_on)


def shift_start(start: Start | Resumed, name: str, value: float) -> Start:
    """Return a start with one number shifted: identified starts are offsets from the stated ones.

    Args:
        start: Start as stated.
        name: Name of the number, one of `SIMULATED`.
        value: Offset to add.
    """
    assert isinstance(start, Start)  # ensured by the measurements
    field_name = name.removeprefix("start.")
    return replace(start, **{field_name: getattr(start, field_name) + value})


def _by_one_model(measurements: Sequence[Measurement], model: Model) -> tuple[Measurement, ...]:
    """Return the measurements with the model and sample interval of all simulations."""
    changed: list[Measurement] = []
    for measurement in measurements:
        scenario = replace(measurement.scenario, model=model, sample_interval=SAMPLE_INTERVAL)
        changed.append(replace(measurement, scenario=scenario))
    return tuple(changed)


def _common_model(
    measurements: Sequence[Measurement], model: Model | str | None = None, **changes: Any
) -> Model:
    """Return the model with which all measurements are simulated."""
    models = [_model_of(measurement, model, **changes) for measurement in measurements]
    for measurement, own_model in zip(measurements, models, strict=True):
        if own_model != models[0]:
            rule = f"must all be of one model, got another one in `{measurement.name}`"
            raise BadArgument("measurements", rule)
    return models[0]


def _model_of(measurement: Measurement, model: Model | str | None, **changes: Any) -> Model:
    """Return the model with which a measurement is simulated; a model that is only named keeps its smooth start."""
    own_model = measurement.scenario.model
    if model is None:
        return model_of(own_model, **changes)
    if isinstance(model, str) and own_model.ramp is not None:
        return model_of(model, **{"ramp": own_model.ramp, **changes})
    return model_of(model, **changes)


def _check_measurements(measurements: Sequence[Measurement]) -> tuple[Measurement, ...]:
    checked: tuple[Measurement, ...] = check_items(
        lambda name, measurement: check_instance(name, measurement, Measurement),
        "a list",
        (),
        "measurements",
        measurements,
    )
    check_not_empty("measurements", checked, "Measurement")
    names = [measurement.name for measurement in checked]
    for name in names:
        if names.count(name) > 1:
            raise BadArgument("measurements", f"must have different names, got `{name}` twice")
    return checked


def _check_one_body(measurements: Sequence[Measurement], body: Robot) -> None:
    """Reject trials of another body; the fin, tether and other mounted parts may differ."""
    for measurement in measurements:
        robot = measurement.scenario.robot
        if robot.modules != body.modules or robot.joints != body.joints:
            rule = f"must be of one body, with or without fin; `{measurement.name}` is of robot"
            reason = f"`{robot.name}`, whose modules or joints are not those of `{body.name}`"
            if robot.name == body.name:
                reason += (
                    ": one of the two was changed, as by identified parameters; without `robot`, "
                    "that of the first trial counts"
                )
            raise BadArgument("measurements", f"{rule} {reason}")
