"""Runs of the planar model: all trials of one duration in a batch, and their derivatives.

The kernels carry each number with its derivative (a complex step), so that the derivative of a run
with respect to one unknown is one more run of a batch, whose results are complex. A run of which few
figures were measured, and which depends on many unknowns, is differentiated backward in time.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from laticauda.identify.interpolation import interpolated
from laticauda.identify.problem import SAMPLE_INTERVAL, Problem, shift_start
from laticauda.identify.resolving import with_tied
from laticauda.identify.runs import SimulatedRuns, data_of_measurements, logged_series, swimming
from laticauda.identify.sensing import RunResults, figures_seen, measured_values
from laticauda.identify.series import SERIES_KINDS
from laticauda.identify.unknowns import NUISANCE, SIMULATED, ResolvedUnknown
from laticauda.models.planar import STEP, Block, Run
from laticauda.models.simulate import (
    UNITS,
    batch_run,
    batch_scenarios,
    change_parameters,
    derivatives,
    gradients,
    silent,
)
from laticauda.scenarios import Scenario


class Pair(NamedTuple):
    """A measurement, and an unknown on which its run depends."""

    measurement: int
    """Index of the measurement."""
    unknown: int
    """Index of the unknown."""


def simulate(problem: Problem, scenarios: Sequence[Scenario], runs: SimulatedRuns) -> None:
    """Simulate every measurement in which the robot swam, and fill in the results and the failures.

    Args:
        problem: Measurements and unknowns.
        scenarios: Scenario of each measurement, with the values of the unknowns.
        runs: Results to fill in.
    """
    durations = [scenario.duration for scenario in scenarios]
    for duration in dict.fromkeys(durations[i] for i in swimming(problem)):
        members = [i for i in swimming(problem) if durations[i] == duration]
        _simulate_batch(problem, scenarios, members, runs)


def _simulate_batch(
    problem: Problem, scenarios: Sequence[Scenario], members: Sequence[int], runs: SimulatedRuns
) -> None:
    """Simulate some measurements of the same duration."""
    results = [runs.results[i] for i in members]
    batch = batch_run.run_batch(
        batch_scenarios.runs_of([scenarios[i] for i in members]),
        scenarios[members[0]].duration,
        SAMPLE_INTERVAL,
        threads=problem.threads,
        progress=silent,
        observe=_series_collector(problem, members, results),
        with_joints=_needs_joints(problem, members),
    )
    for lane, i in enumerate(members):
        for name in UNITS:
            results[lane].figures[name] = batch.figures[name][lane]
        if not batch.succeeded[lane]:
            runs.failures[problem.measurements[i].name] = batch.status[lane]
            runs.results[i] = _without_numbers(results[lane])


def _without_numbers(results: RunResults) -> RunResults:
    """Return results of the same shapes that are all nan, for a run that diverged."""
    return RunResults(
        figures={name: np.full(np.shape(value), np.nan) for name, value in results.figures.items()},
        series={name: np.full(np.shape(value), np.nan) for name, value in results.series.items()},
    )


def differentiate_sensors(
    problem: Problem, values: np.ndarray, runs: SimulatedRuns, jacobian: np.ndarray
) -> None:
    """Fill in the derivatives with respect to unknowns that change only what is seen of a run.

    Args:
        problem: Measurements and unknowns.
        values: Values of the unknowns.
        runs: Results of the runs at these values.
        jacobian: Jacobian to fill in.
    """
    data_of = data_of_measurements(problem)
    for i, k in _dependent_pairs(problem):
        name = problem.unknowns[k].parameter.name
        if name not in NUISANCE or name in SIMULATED:
            continue
        stepped = values.astype(complex) + 1j * STEP * (np.arange(values.size) == k)
        nuisance = problem.nuisance(i, stepped)
        shown = measured_values(problem.measurements[i], runs.results[i], nuisance)
        jacobian[data_of[i], k] = np.imag(shown) / STEP


def differentiate_runs(
    problem: Problem, scenarios: Sequence[Scenario], values: np.ndarray, jacobian: np.ndarray
) -> None:
    """Fill in the derivatives with respect to unknowns on which the runs themselves depend.

    Args:
        problem: Measurements and unknowns.
        scenarios: Scenario of each measurement, with the values of the unknowns.
        values: Values of the unknowns.
        jacobian: Jacobian to fill in.
    """
    pairs = pairs_to_differentiate(problem)
    slopes = differentiate_pairs(problem, scenarios, values, pairs)
    fill_in_slopes(problem, pairs, slopes, jacobian)


def pairs_to_differentiate(problem: Problem) -> list[Pair]:
    """Return the pairs of a measurement and an unknown on which its run itself depends.

    Args:
        problem: Measurements and unknowns.
    """
    return [pair for pair in _dependent_pairs(problem) if _is_differentiated_run(problem, pair)]


def fill_in_slopes(
    problem: Problem, pairs: Sequence[Pair], slopes: Sequence[np.ndarray], jacobian: np.ndarray
) -> None:
    """Fill in the slopes of pairs.

    Args:
        problem: Measurements and unknowns.
        pairs: The pairs.
        slopes: Those of each pair, see `differentiate_pairs`.
        jacobian: Jacobian to fill in.
    """
    data_of = data_of_measurements(problem)
    for (i, k), slopes_of_pair in zip(pairs, slopes, strict=True):
        jacobian[data_of[i], k] = slopes_of_pair


def differentiate_pairs(
    problem: Problem, scenarios: Sequence[Scenario], values: np.ndarray, pairs: Sequence[Pair]
) -> list[np.ndarray]:
    """Return, for each pair, the derivatives of the measurement's numbers with respect to the unknown.

    Args:
        problem: Measurements and unknowns.
        scenarios: Scenario of each measurement, with the values of the unknowns.
        values: Values of the unknowns.
        pairs: The pairs, from `pairs_to_differentiate`.
    """
    slope_of_pair: dict[Pair, np.ndarray] = {}
    durations = [scenarios[pair.measurement].duration for pair in pairs]
    for duration in dict.fromkeys(durations):
        same_duration = [
            pair for pair, own in zip(pairs, durations, strict=True) if own == duration
        ]
        backward = _measurements_differentiated_backward(problem, scenarios, same_duration)
        forward_pairs = [pair for pair in same_duration if pair.measurement not in backward]
        backward_pairs = [pair for pair in same_duration if pair.measurement in backward]
        if forward_pairs:
            slopes = _differentiate_batch(problem, scenarios, values, forward_pairs)
            slope_of_pair.update(zip(forward_pairs, slopes, strict=True))
        if backward_pairs:
            slopes = _differentiate_backward(problem, scenarios, values, backward_pairs)
            slope_of_pair.update(zip(backward_pairs, slopes, strict=True))
    return [slope_of_pair[pair] for pair in pairs]


def _dependent_pairs(problem: Problem) -> list[Pair]:
    return [Pair(int(i), int(k)) for i, k in np.argwhere(problem.depends_on)]


def _is_differentiated_run(problem: Problem, pair: Pair) -> bool:
    name = problem.unknowns[pair.unknown].parameter.name
    is_of_sensor = name in NUISANCE and name not in SIMULATED
    return not is_of_sensor and problem.measurements[pair.measurement].tow is None


def _differentiate_batch(
    problem: Problem,
    scenarios: Sequence[Scenario],
    values: np.ndarray,
    pairs: Sequence[Pair],
) -> list[np.ndarray]:
    """Differentiate the runs of some pairs of the same duration, one complex run for each pair."""
    members = sorted({pair.measurement for pair in pairs})
    member_runs = batch_scenarios.runs_of([scenarios[i] for i in members])
    run_of_member = dict(zip(members, member_runs, strict=True))
    stepped_results = [RunResults() for _ in pairs]
    # Complex runs: their imaginary parts over STEP are the derivatives.
    stepped_runs = derivatives.compute_slopes(
        [run_of_member[pair.measurement] for pair in pairs],
        [_differentiated_number(problem, scenarios, values, pair) for pair in pairs],
        scenarios[members[0]].duration,
        sample_interval=SAMPLE_INTERVAL,
        threads=problem.threads,
        observe=_series_collector(problem, [pair.measurement for pair in pairs], stepped_results),
        with_joints=_needs_joints(problem, members),
    )
    data_of = data_of_measurements(problem)
    slopes: list[np.ndarray] = []
    for lane, (i, _) in enumerate(pairs):
        if not stepped_runs.succeeded[lane]:
            slopes.append(np.full(data_of[i].size, np.nan))
            continue
        for name in UNITS:
            stepped_results[lane].figures[name] = stepped_runs.figures[name][lane]
        nuisance = problem.nuisance(i, values)
        shown = measured_values(problem.measurements[i], stepped_results[lane], nuisance)
        slopes.append(np.imag(shown) / STEP)
    return slopes


def _measurements_differentiated_backward(
    problem: Problem, scenarios: Sequence[Scenario], pairs: Sequence[Pair]
) -> set[int]:
    """Return the measurements whose few figures are cheaper to differentiate than their runs by every unknown.

    What pairs there are besides does not matter: a cluster gets the same results from a part of them.
    """
    n_unknowns = Counter(pair.measurement for pair in pairs_to_differentiate(problem))
    members: list[int] = []
    for i in sorted({pair.measurement for pair in pairs}):
        if n_unknowns[i] > gradients.MOST_FORWARD and not problem.measurements[i].series:
            members.append(i)
    if not members:
        return set()
    runs = batch_scenarios.runs_of([scenarios[i] for i in members])
    backward: set[int] = set()
    for i, run in zip(members, runs, strict=True):
        n_figures = len(figures_seen(problem.measurements[i]))
        if gradients.is_cheaper([run.plant], n_figures=n_figures, n_numbers=n_unknowns[i]):
            backward.add(i)
    return backward


def _differentiate_backward(
    problem: Problem, scenarios: Sequence[Scenario], values: np.ndarray, pairs: Sequence[Pair]
) -> list[np.ndarray]:
    """Differentiate the runs of some pairs of the same duration, one sweep for each figure of a measurement."""
    pairs_of: dict[int, list[Pair]] = {}
    for pair in pairs:
        pairs_of.setdefault(pair.measurement, []).append(pair)
    numbers: list[list[derivatives.Number]] = []
    for members in pairs_of.values():
        numbers.append(
            [_differentiated_number(problem, scenarios, values, pair) for pair in members]
        )
    figures = [figures_seen(problem.measurements[i]) for i in pairs_of]
    results = gradients.compute_jacobians(
        batch_scenarios.runs_of([scenarios[i] for i in pairs_of]),
        numbers,
        figures,
        scenarios[pairs[0].measurement].duration,
        sample_interval=SAMPLE_INTERVAL,
        threads=problem.threads,
    )
    slope_of_pair: dict[Pair, np.ndarray] = {}
    for (i, members), names, result in zip(pairs_of.items(), figures, results, strict=True):
        nuisance = problem.nuisance(i, values)
        for column, pair in enumerate(members):
            stepped_values = result.values + 1j * STEP * result.jacobian[:, column]
            stepped_result = RunResults(figures=dict(zip(names, stepped_values, strict=True)))
            shown = measured_values(problem.measurements[i], stepped_result, nuisance)
            slope_of_pair[pair] = np.imag(shown) / STEP
    return [slope_of_pair[pair] for pair in pairs]


def _differentiated_number(
    problem: Problem, scenarios: Sequence[Scenario], values: np.ndarray, pair: Pair
) -> derivatives.Number:
    """Return one unknown of one measurement in the form that `compute_slopes` takes."""
    unknown = problem.unknowns[pair.unknown]
    scenario = scenarios[pair.measurement]
    value = float(values[pair.unknown])
    name = unknown.parameter.name
    if name in NUISANCE:
        return derivatives.Number(
            name=f"{name} of {problem.measurements[pair.measurement].name}",
            scenario=scenario,
            value=value,
            change=lambda _: scenario,
            start=lambda changed: shift_start(scenario.start, name, changed - value),
        )
    return derivatives.Number(
        name=name,
        scenario=scenario,
        value=value,
        change=partial(_with_value, scenario, unknown),
    )


def _with_value(scenario: Scenario, unknown: ResolvedUnknown, value: float) -> Scenario:
    """Return a scenario with another value of an unknown.

    At the current point of a search, the numbers tied to it are already in proportion.
    """
    numbers = with_tied(scenario, unknown.parameter.name, value, unknown.tied)
    return change_parameters(scenario, numbers)


def _needs_joints(problem: Problem, members: Sequence[int]) -> bool:
    """Return whether the model must log its joints."""
    for i in members:
        if any(SERIES_KINDS[name].needs_joints for name in problem.measurements[i].series):
            return True
    return False


def _series_collector(
    problem: Problem, members: Sequence[int], results: Sequence[RunResults]
) -> Callable[[Sequence[Run], Block], None]:
    """Return a callback that takes, from a block's logs, the series that were measured."""

    def collect(runs: Sequence[Run], block: Block) -> None:
        for lane, index in enumerate(block.index):
            measurement = problem.measurements[members[int(index)]]
            if measurement.time is None:
                continue
            for name in logged_series(measurement):
                samples = SERIES_KINDS[name].of_lane(block, lane, runs[lane])
                at_moments = interpolated(block.time, samples, measurement.time)
                results[int(index)].series[name] = at_moments

    return collect
