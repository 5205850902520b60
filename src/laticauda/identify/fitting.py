"""`fit`: find the values of the unknowns with which the model best describes the measurements."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Unpack

import numpy as np

from laticauda.identify.estimates import Optimum, assemble_fit
from laticauda.identify.identifiability import LIMIT
from laticauda.identify.local_search import MOST_STEPS, LocalSearch, Vector, minimize
from laticauda.identify.measurements import Measurement, warn_of_noise
from laticauda.identify.method import Method
from laticauda.identify.model import predict
from laticauda.identify.noise_factor import NoiseFactor, measure_noise_factor
from laticauda.identify.problem import Problem, make_problem
from laticauda.identify.result import Fit
from laticauda.identify.rival_search import doubt_after_rivals
from laticauda.identify.starts import is_settled, spread_starts
from laticauda.identify.unknowns import Unknown
from laticauda.models.simulate import Progress, silent
from laticauda.robot import Robot
from laticauda.scenarios import Model, ModelChanges, Planar
from laticauda.values import BadArgument, SimulationFailed

_ROUNDS = 20
"""Iterations of the noise estimate when there are priors."""
_SETTLED = 1e-6
"""Relative change of the noise factor at which it has settled [-]."""

Keep = Callable[[Mapping[str, float], float], None]
"""Callback of a search, called with the best values so far, by name, and their sum of squares."""
INTERRUPTED = "interrupted: these are the best values so far; later steps were not computed."


def fit(
    measurements: Sequence[Measurement],
    robot: Robot | None = None,
    *,
    parameters: Sequence[str | Unknown] | Mapping[str, tuple[float, float]],
    model: Model | str | None = None,
    noise: str = "known",
    loss: str = "linear",
    n_starts: int = 8,
    rivals: bool = True,
    seed: int = 0,
    confidence: float = 0.95,
    limit: float = LIMIT,
    threads: int | None = None,
    progress: Progress = silent,
    keep: Keep = silent,
    client: Any = None,
    **changes: Unpack[ModelChanges],
) -> Fit:
    """Identify parameters of the robot and the water from measured trials by least squares.

    Minimizes the sum of ((predicted - measured) / sigma)^2 over all measured numbers plus the sum
    of ((q - mean) / sd)^2 over all priors, within the ranges of the unknowns, from several starts.
    Ctrl-C ends the search and returns the best result so far.

    Args:
        measurements: The measurements.
        robot: Robot that must have swum, with or without its fin; None: that of the first
            measurement.
        parameters: Names of the numbers to identify, or `Unknown`s with ranges and priors.
        model: planar, or spatial (the 3D twin, which is slow); None: that of the measurements'
            scenarios.
        noise: known: the uncertainties use the noise stated by the measurements; estimated: a
            common factor on it is estimated from the residuals.
        loss: linear, or soft_l1, huber, cauchy or arctan, which give outliers less weight.
        n_starts: Largest number of starts; the first uses the values that robot and water have, the
            others are spread over the ranges. No more are used than it takes for two to reach the
            best minimum, or four if the stated noise cannot leave its residuals.
        rivals: Whether other laws of the water are fitted to the same data, in about the time of the
            fit itself, to see whether one is clearly better; planar model only.
        seed: Seed of the random starts.
        confidence: Confidence level of the intervals [-].
        limit: Relative standard deviation from which on an unknown counts as not identified [-].
        threads: Number of threads; None uses all cores available to this process.
        progress: Called periodically with the finished fraction, from 0 to 1.
        keep: Called with the best values by name and their sum of squares, whenever they improve.
        client: A `dask.distributed.Client`: the trials run on its cluster, to the same bits (on
            processors of one kind). None runs them in this process, as does all that is asked of the
            fit later.
        changes: Changes of the model: `joints` (prescribed, pd, servo, or a joint law), `dt` [s]
            and the other fields of `laticauda.scenarios.ModelChanges`.

    Returns:
        Values, intervals, correlations, predictions, and the directions that the data do not see.

    Raises:
        ValueError: If an argument is out of its range, or there are fewer measured numbers than
            unknowns.
        SimulationFailed: If a measurement cannot be simulated at any start.
        ClusterFailed: If the cluster's scheduler goes away, or workers die repeatedly.
        MissingExtra: If scipy is not installed.

    Example:
        >>> from laticauda.identify import fit, from_table1
        >>> names = ["water.tangential_friction"]
        >>> friction = fit(from_table1()[::4], parameters=names, noise="estimated", n_starts=1)
        >>> friction["water.tangential_friction"].is_identified
        True
    """
    method = Method(
        noise=noise, loss=loss, n_starts=n_starts, seed=seed, confidence=confidence, limit=limit
    )
    problem = make_problem(
        measurements, parameters, robot, threads=threads, client=client, model=model, **changes
    )
    for measurement in problem.measurements:
        warn_of_noise(measurement)
    solution = solve(problem, method, progress=progress, keep=keep)
    if rivals and isinstance(problem.model, Planar):
        solution = _try_rival_laws(solution)
    solution = solution.simulated_on(None)
    return _with_doubt_among_warnings(solution)


def _try_rival_laws(solution: Fit) -> Fit:
    """Return the fit with what other laws say of it."""
    if INTERRUPTED in solution.warnings:
        return solution
    try:
        return replace(solution, doubt=doubt_after_rivals(solution))
    except KeyboardInterrupt:
        return replace(solution, warnings=(INTERRUPTED, *solution.warnings))


def _with_doubt_among_warnings(solution: Fit) -> Fit:
    """Return the fit with its doubt as the first warning.

    If the noise is known, residuals beyond it that do not blame the model have their own warning.
    """
    doubt = solution.doubt
    if doubt is None or not doubt.words:
        return solution
    if not (doubt.is_of_model or solution.method.estimates_noise):
        return solution
    return replace(solution, warnings=(doubt.words, *solution.warnings))


def solve(
    problem: Problem,
    method: Method,
    *,
    start: Vector | None = None,
    progress: Progress = silent,
    keep: Keep = silent,
) -> Fit:
    """Solve a problem; arguments and errors as for `fit`.

    Args:
        problem: Measurements and unknowns.
        method: Settings of the fit.
        start: Starting values to use instead of the problem's own.
        progress: Called periodically with the finished fraction.
        keep: Called with the best values by name and their sum of squares, whenever they improve.
    """
    _check_enough_numbers(problem, method)
    if start is None:
        start = problem.start
    best_point = _BestPoint(problem=problem, keep=keep)
    searches: list[LocalSearch] = []
    is_interrupted = False
    try:
        _search_from_all_starts(problem, method, start, best_point, searches, progress)
    except KeyboardInterrupt:
        if best_point.coordinates is None:
            raise
        is_interrupted = True
        search = minimize(problem, best_point.coordinates, loss=method.loss, most_steps=1)
        searches.append(search)
    searches.sort(key=lambda search: search.cost)
    if method.estimates_noise:
        most_steps = 1 if is_interrupted else MOST_STEPS
        optimum = _optimum_with_estimated_noise(problem, method, searches[0], most_steps)
    else:
        optimum = Optimum.of_search(searches[0], noise_factor=1.0)
    solution = assemble_fit(problem, method, optimum, searches)
    if is_interrupted:
        return replace(solution, warnings=(INTERRUPTED, *solution.warnings))
    return solution


@dataclass(kw_only=True, eq=False)
class _BestPoint:
    """The best point that any search has come to, which remains if the user interrupts."""

    problem: Problem
    keep: Keep
    coordinates: Vector | None = None
    cost: float = math.inf

    def observe(self, x: Vector, cost: float) -> None:
        """Note a point of a search if it is the best so far."""
        if cost < self.cost:
            self.coordinates = x
            self.cost = cost
            self.keep(self.problem.values_by_name(x), cost)


def _search_from_all_starts(
    problem: Problem,
    method: Method,
    start: Vector,
    best_point: _BestPoint,
    searches: list[LocalSearch],
    progress: Progress,
) -> None:
    """Search from every start at which all measurements can be simulated.

    Searches are added to `searches` as they end, so that an interrupt leaves those done so far.
    """
    failures: Mapping[str, str] = {}
    first = problem.coordinates_of(start)
    for number, x in enumerate(spread_starts(problem, method, first), start=1):
        predicted = predict(problem, problem.values_of(x))
        failures = predicted.failures or failures
        if np.all(np.isfinite(predicted.values)):
            search = minimize(
                problem,
                x,
                loss=method.loss,
                observe=best_point.observe,
                earlier_searches=searches,
            )
            searches.append(search)
        elif not predicted.failures:
            _refuse_missing_figure(problem, predicted.values)
        if is_settled(problem, searches):
            break
        progress(number / method.n_starts)
    progress(1.0)
    if not searches:
        name, status = next(iter(failures.items()))
        raise SimulationFailed(
            f"The measurement `{name}` cannot be simulated at any start of the search: {status}"
        )


def _optimum_with_estimated_noise(
    problem: Problem, method: Method, best: LocalSearch, most_steps: int
) -> Optimum:
    """Repeat the search with the noise estimated from the residuals until both agree.

    If only squares are summed, and only of data, the optimum is the same for any noise, and its
    Jacobian is rescaled. A prior keeps its own standard deviation, and a robust loss tells outliers
    by the noise: both need new searches.

    The noise remains as it was if it cannot be estimated: without degrees of freedom, or because
    the model describes the data exactly.

    Args:
        problem: Measurements and unknowns.
        method: Settings of the fit.
        best: The best search, in the stated noise.
        most_steps: Predictions of each further search.
    """
    is_same_for_any_noise = problem.n_priors == 0 and method.loss == "linear"
    search = best
    searched_factor = 1.0  # the noise of `search`, and of its Jacobian, over the stated noise
    for _ in range(_ROUNDS):
        estimated = _measure_noise_factor_at_end(problem, method, search)
        if not estimated.is_usable:
            break
        if abs(estimated.factor - searched_factor) <= _SETTLED * searched_factor:
            break
        if is_same_for_any_noise:
            return Optimum(
                coordinates=search.end,
                jacobian=search.jacobian / estimated.factor,
                noise_factor=estimated.factor,
            )
        searched_factor = estimated.factor
        search = minimize(
            problem, search.end, loss=method.loss, factor=searched_factor, most_steps=most_steps
        )
    return Optimum.of_search(search, noise_factor=searched_factor)


def _measure_noise_factor_at_end(
    problem: Problem, method: Method, search: LocalSearch
) -> NoiseFactor:
    predictions = predict(problem, problem.values_of(search.end)).values
    residuals = (predictions - problem.observed) / problem.sigma  # in the stated noise
    return measure_noise_factor(problem, method, search.jacobian, residuals)


def _check_enough_numbers(problem: Problem, method: Method) -> None:
    """Reject fewer measured numbers than unknowns."""
    n_data = problem.observed.size
    n_free = len(problem.unknowns) - problem.n_priors
    n_needed = n_free
    and_the_noise = ""
    if method.estimates_noise:
        n_needed += 1
        and_the_noise = " and the noise"
    if n_data < n_needed:
        unknowns = f"{n_free} unknowns without a prior{and_the_noise}"
        rule = f"must hold at least {n_needed} numbers for {unknowns}, got {n_data}"
        raise BadArgument("measurements", rule)


def _refuse_missing_figure(problem: Problem, predictions: np.ndarray) -> None:
    """Reject a measurement whose run came to its end without yielding a figure."""
    first_missing = np.flatnonzero(~np.isfinite(predictions))[0]
    measurement = problem.measurements[int(problem.owner[first_missing])]
    names = ", ".join(measurement.figures)
    rule = f"of `{measurement.name}` must be ones that its simulation yields, got {names}"
    duration = measurement.scenario.duration
    hint = f"a trial of {duration:g} s may be too short for a steady velocity"
    raise BadArgument("figures", f"{rule}; {hint}")
