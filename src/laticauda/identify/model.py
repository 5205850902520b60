"""Model predictions of the measurements, and their derivatives with respect to the unknowns.

The planar model computes all trials in a batch, and their derivatives with a complex step in the
kernels. The 3D twin runs trial by trial, and its derivatives are finite differences.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import cast

import numpy as np
from jaxtyping import Float

from laticauda.identify import unknowns
from laticauda.identify.measurements import Measurement, Run as Raw, measured_values
from laticauda.identify.problem import SAMPLE_INTERVAL, Problem, shift_start
from laticauda.models.planar import rows
from laticauda.models.planar.batch import STEP, Block, Run
from laticauda.models.simulate import batch_run, batch_scenarios, derivatives, numbers, several
from laticauda.models.simulate.runner import silent
from laticauda.scenarios import Planar, Scenario
from laticauda.trials import Trial

TOW_DIFFERENCE = 2.0**-12  # step of the finite differences of a tow's loads, relative to the value
DIFFERENCE = 1e-3  # step of the 3D twin's finite differences, as a fraction of a large change

Values = Float[np.ndarray, " n_unknowns"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Predicted:
    """Model predictions at given values of the unknowns."""

    values: Float[np.ndarray, " n_data"]
    """Predicted values, in the order of `Problem.observed`; nan where a run diverged."""
    failures: Mapping[str, str]
    """Status of each run that diverged, by name of the measurement."""
    differentiated: Callable[[], Float[np.ndarray, "n_data n_unknowns"]]
    """Function that computes the `jacobian`."""

    @cached_property
    def jacobian(self) -> Float[np.ndarray, "n_data n_unknowns"]:
        """Derivative of each value with respect to each unknown, computed on first access."""
        return self.differentiated()


def predict(problem: Problem, values: Values) -> Predicted:
    """Predict all measurements with the model.

    Args:
        problem: Measurements and unknowns.
        values: Values of the unknowns, in their units.
    """
    scenarios = problem.scenarios_at(values)
    if isinstance(problem.model, Planar):
        raw, failures = _planar_runs(problem, scenarios)
        slopes = partial(_planar_jacobian, problem, scenarios, values, raw)
    else:
        raw, failures = _spatial_runs(problem, scenarios)
        slopes = partial(_differences, problem, values)
    return Predicted(values=_seen(problem, raw, values), failures=failures, differentiated=slopes)


def scaled_jacobian(
    problem: Problem, values: Values, factor: float = 1.0, predicted: Predicted | None = None
) -> Float[np.ndarray, "n_data n_unknowns"]:
    """Compute the Jacobian with respect to the coordinates of the unknowns, in standard deviations of the noise.

    Args:
        problem: Measurements and unknowns.
        values: Values of the unknowns.
        factor: Factor applied to the stated noise.
        predicted: Prediction at these values, if already computed.
    """
    jacobian = (predicted or predict(problem, values)).jacobian
    return jacobian / (factor * problem.sigma)[:, np.newaxis] * problem.slopes(values)


def _seen(problem: Problem, raw: Sequence[Raw], values: np.ndarray) -> np.ndarray:
    """Return the measured quantities of every run."""
    parts = [
        measured_values(m, raw[i], problem.nuisance(i, values))
        for i, m in enumerate(problem.measurements)
    ]
    return np.concatenate(parts)


def _by_duration(scenarios: Sequence[Scenario], members: Sequence[int]) -> dict[float, list[int]]:
    """Return, by duration, the positions in `members` of scenarios of that duration."""
    found: dict[float, list[int]] = {}
    for place, i in enumerate(members):
        found.setdefault(scenarios[i].duration, []).append(place)
    return found


def _towed(problem: Problem, scenarios: Sequence[Scenario]) -> tuple[list[Raw], list[int]]:
    """Return the loads on robots that are towed, and the indices of the measurements that swim."""
    tows = [one.tow for one in problem.measurements]
    raw: list[Raw] = [
        {} if tow is None else dict(tow.loads(one))
        for tow, one in zip(tows, scenarios, strict=True)
    ]
    return raw, [i for i, tow in enumerate(tows) if tow is None]


def _planar_runs(
    problem: Problem, scenarios: Sequence[Scenario]
) -> tuple[list[Raw], dict[str, str]]:
    """Simulate every measurement with the planar model; return the raw results and the failures."""
    (raw, swum), failures = _towed(problem, scenarios), dict[str, str]()
    for duration, places in _by_duration(scenarios, swum).items():
        members = [swum[place] for place in places]
        runs = batch_scenarios.runs_of([scenarios[i] for i in members])
        found = batch_run.run_batch(
            runs,
            duration,
            SAMPLE_INTERVAL,
            threads=problem.threads,
            progress=silent,
            observe=_keeper(problem, members, [raw[i] for i in members]),
            with_joints=_needs_joints(problem, members),
        )
        for place, i in enumerate(members):
            raw[i] |= {name: found.figures[name][place] for name in numbers.UNITS}
            if not found.succeeded[place]:
                failures[problem.measurements[i].name] = found.status[place]
                raw[i] = {name: np.full(np.shape(value), np.nan) for name, value in raw[i].items()}
    return raw, failures


def _planar_jacobian(
    problem: Problem, scenarios: Sequence[Scenario], values: Values, raw: Sequence[Raw]
) -> np.ndarray:
    """Compute the Jacobian for each pair of a measurement and an unknown."""
    jacobian = np.zeros((problem.owner.size, len(problem.unknowns)))
    data_of = [np.flatnonzero(problem.owner == i) for i in range(len(scenarios))]
    simulated: list[tuple[int, int]] = []
    for i, k in cast("list[tuple[int, int]]", np.argwhere(problem.moves).tolist()):
        name = problem.unknowns[k].parameter.name
        if name in unknowns.NUISANCE and name not in unknowns.SIMULATED:
            nuisance = problem.nuisance(
                i, values.astype(complex) + 1j * STEP * (np.arange(values.size) == k)
            )
            jacobian[data_of[i], k] = (
                np.imag(measured_values(problem.measurements[i], raw[i], nuisance)) / STEP
            )
        elif problem.measurements[i].tow is not None:
            jacobian[data_of[i], k] = _towed_slope(problem, scenarios[i], i, k, values)
        else:
            simulated.append((i, k))
    for duration, places in _by_duration(scenarios, [i for i, _ in simulated]).items():
        pairs = [simulated[place] for place in places]
        members = sorted({i for i, _ in pairs})
        run_of = dict(
            zip(members, batch_scenarios.runs_of([scenarios[i] for i in members]), strict=True)
        )
        mine: list[Raw] = [{} for _ in pairs]
        found = derivatives.compute_slopes(
            [run_of[i] for i, _ in pairs],
            [_number(problem, scenarios[i], i, k, values) for i, k in pairs],
            duration,
            sample_interval=SAMPLE_INTERVAL,
            threads=problem.threads,
            observe=_keeper(problem, [i for i, _ in pairs], mine),
            with_joints=_needs_joints(problem, members),
        )
        for place, (i, k) in enumerate(pairs):
            mine[place] |= {name: found.figures[name][place] for name in numbers.UNITS}
            predicted = measured_values(
                problem.measurements[i], mine[place], problem.nuisance(i, values)
            )
            jacobian[data_of[i], k] = (
                np.imag(predicted) / STEP if found.succeeded[place] else np.nan
            )
    return jacobian


def _towed_slope(
    problem: Problem, scenario: Scenario, i: int, k: int, values: Values
) -> np.ndarray:
    """Differentiate a tow's loads, smooth functions in closed form, with respect to one unknown, to second order."""
    measurement, unknown = problem.measurements[i], problem.unknowns[k]
    step = TOW_DIFFERENCE * (abs(float(values[k])) or unknown.size)
    ends = np.clip(values[k] + np.array([-step, step]), unknown.lower, unknown.upper).tolist()
    assert measurement.tow is not None
    runs = [
        measurement.tow.loads(_changed(scenario, unknown.parameter.name, unknown.tied, end))
        for end in ends
    ]
    low, high = (measured_values(measurement, run, {}) for run in runs)
    return (high - low) / (ends[1] - ends[0])


def _number(
    problem: Problem, scenario: Scenario, i: int, k: int, values: Values
) -> derivatives.Number:
    """Return one unknown of one measurement in the form that `slopes` takes."""
    unknown, value = problem.unknowns[k], float(values[k])
    name = unknown.parameter.name
    if name in unknowns.NUISANCE:
        return derivatives.Number(
            name=f"{name} of {problem.measurements[i].name}",
            scenario=scenario,
            value=value,
            change=lambda _: scenario,
            start=lambda other: shift_start(scenario.start, name, other - value),
        )
    # At the current point of the search, tied numbers are already in proportion.
    change = partial(_changed, scenario, name, unknown.tied)
    return derivatives.Number(name=name, scenario=scenario, value=value, change=change)


def _changed(scenario: Scenario, name: str, tied: Mapping[str, float], value: float) -> Scenario:
    return numbers.change_parameters(scenario, unknowns.with_tied(scenario, name, value, tied))


def _needs_joints(problem: Problem, members: Sequence[int]) -> bool:
    return any(
        name.startswith("joint_") for i in members for name in problem.measurements[i].series
    )


def _keeper(
    problem: Problem, members: Sequence[int], raw: Sequence[Raw]
) -> Callable[[Sequence[Run], Block], None]:
    """Return a callback that keeps, from a block's logs, the series that the measurements of its runs have."""
    measurements = [problem.measurements[i] for i in members]

    def keep(runs: Sequence[Run], block: Block) -> None:
        for lane, at in enumerate(block.index):
            measurement = measurements[int(at)]
            if measurement.time is None:
                continue
            lay = runs[lane].plant.layout
            joints = lay.n_bodies - 1
            first = {"joint_angle": rows.LOG_STATE, "joint_torque": rows.LOG_STATE + 3 * joints}
            for name in dict.fromkeys(("heading", *measurement.series)):
                if name == "heading":
                    values = block.log[:, rows.HEADING - rows.TIME, lane]
                elif name == "center_of_mass":
                    values = block.center_of_mass[:, :, lane]
                else:
                    values = block.log[:, first[name] + lay.tail_link : first[name] + joints, lane]
                raw[int(at)][f"{name} series"] = interpolated(block.time, values, measurement.time)

    return keep


def _spatial_runs(
    problem: Problem, scenarios: Sequence[Scenario]
) -> tuple[list[Raw], dict[str, str]]:
    """Simulate every measurement with the 3D twin, run by run on several threads."""
    (raw, swum), failures = _towed(problem, scenarios), dict[str, str]()
    trials = several.swim_each(
        [scenarios[i] for i in swum], lambda trial: trial, threads=problem.threads
    )
    for i, trial in zip(swum, trials, strict=True):
        measurement = problem.measurements[i]
        if trial.succeeded:
            raw[i] = _raw_of(trial, measurement)
        else:
            failures[measurement.name] = trial.status
            raw[i] = dict.fromkeys(
                ("x", "y", "heading", "heading series", *measurement.figures), np.nan
            )
            for name, (values, _) in measurement.series.items():
                raw[i][f"{name} series"] = np.full_like(values, np.nan)
    return raw, failures


def _raw_of(trial: Trial, measurement: Measurement) -> Raw:
    """Return the raw results of a trial in the horizontal plane."""
    end = trial.center_of_mass[-1]
    raw: Raw = {"x": end[0], "y": end[1], "heading": trial.heading[-1]}
    raw |= {name: getattr(trial, name) for name in measurement.figures if name not in raw}
    if measurement.time is not None:
        for name in dict.fromkeys(("heading", *measurement.series)):
            values = getattr(trial, name)
            values = values[:, :2] if name == "center_of_mass" else values
            raw[f"{name} series"] = interpolated(trial.time, values, measurement.time)
    return raw


def _differences(problem: Problem, values: Values) -> np.ndarray:
    """Compute the Jacobian of the 3D twin by central differences."""
    columns: list[np.ndarray] = []
    for k, unknown in enumerate(problem.unknowns):
        step = DIFFERENCE * unknown.slope(float(values[k])) * unknown.size
        ends = np.clip(values[k] + np.array([-step, step]), unknown.lower, unknown.upper)
        moved = np.repeat(values[np.newaxis], 2, axis=0)
        moved[:, k] = ends
        behind, ahead = (
            _seen(problem, _spatial_runs(problem, problem.scenarios_at(at))[0], at) for at in moved
        )
        columns.append((ahead - behind) / (ends[1] - ends[0]))
    return np.stack(columns, axis=1)


def interpolated(
    time: Float[np.ndarray, " n"], values: np.ndarray, moments: Float[np.ndarray, " m"]
) -> np.ndarray:
    """Interpolate at least four evenly spaced samples at other times, by the cubic through the four nearest ones.

    Args:
        time: Times of the samples [s].
        values: The samples, time first; may be complex.
        moments: Times at which to interpolate [s].
    """
    step = (time[-1] - time[0]) / (time.size - 1)
    place = (moments - time[0]) / step
    first = np.clip(np.floor(place).astype(int) - 1, 0, max(time.size - 4, 0))
    s = place - first
    n = min(4, time.size)
    result = 0.0
    for j in range(n):
        others = [k for k in range(n) if k != j]
        weight = np.prod([(s - k) / (j - k) for k in others], axis=0)
        result = result + weight.reshape(-1, *[1] * (values.ndim - 1)) * values[first + j]
    return np.asarray(result)
