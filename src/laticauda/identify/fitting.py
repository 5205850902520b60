"""`fit`: the values of the unknowns with which the model describes the measurements best."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Unpack

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, SimulationFailed
from laticauda.extras import optional_import
from laticauda.identify.identifiability import LIMIT, Identifiability, identifiability
from laticauda.identify.least_squares import Method, Minimum, minimize
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import predict
from laticauda.identify.problem import Problem, make_problem
from laticauda.identify.result import Fit, LocalSearch, ParameterEstimate
from laticauda.identify.unknowns import Unknown
from laticauda.robot import Robot
from laticauda.scenarios import Model, ModelChanges
from laticauda.simulate.runner import Progress

SPREAD = 3.0  # further starts lie within this factor of the first
_ROUNDS = 20  # of estimating the noise beside priors
_SAME = 1e-6

Vector = Float[np.ndarray, " n"]


def fit(
    measurements: Sequence[Measurement],
    robot: Robot | None = None,
    *,
    parameters: Sequence[str | Unknown] | Mapping[str, tuple[float, float]],
    model: Model | str | None = None,
    noise: str = "known",
    loss: str = "linear",
    n_starts: int = 4,
    seed: int = 0,
    confidence: float = 0.95,
    limit: float = LIMIT,
    threads: int | None = None,
    progress: Progress | None = None,
    **changes: Unpack[ModelChanges],
) -> Fit:
    """Identify parameters of robot and water from measured trials, by least squares.

    Minimizes the sum over all measured numbers of ((predicted - measured) / sigma)^2, and over all priors of
    ((q - mean) / sd)^2, within the ranges of the unknowns, from several starts.

    Args:
        measurements: What was measured.
        robot: What has to have swum, with or without its fin; None: what the first measurement says.
        parameters: Names of what is identified, or `Unknown`s with ranges and priors.
        model: planar, or spatial, the 3D twin, which is slow; None: that of the measurements' scenarios.
        noise: known: the uncertainties take the noise as the measurements state it; estimated: a common factor on it is
            estimated from the residuals.
        loss: linear, or soft_l1, huber, cauchy, arctan: outliers count less.
        n_starts: How many starts; the first is at the values that robot and water have.
        seed: Of the further starts.
        confidence: Of the intervals [-].
        limit: From which standard deviation on, as a share of itself, an unknown counts as not identified [-].
        threads: How many to compute with; None takes all cores that this process may use.
        progress: Called now and then with the share that is finished, from 0 to 1.
        changes: Of the model, as `joints`; see `laticauda.scenarios.ModelChanges`.

    Returns:
        Values, intervals, correlations, predictions, and what the data do not see.

    Raises:
        ValueError: If an argument is out of its range, or there are fewer numbers than unknowns.
        SimulationFailed: If a measurement cannot be simulated at any start.
        MissingExtra: If scipy is not installed.

    Example:
        >>> from laticauda.identify import fit, from_table1
        >>> found = fit(from_table1(), parameters=["water.tangential_friction"], noise="estimated", n_starts=1)
        >>> found["water.tangential_friction"].is_identified
        True
    """
    method = Method(noise=noise, loss=loss, n_starts=n_starts, seed=seed, confidence=confidence, limit=limit)
    problem = make_problem(measurements, parameters, robot, threads=threads, model=model, **changes)
    return solve(problem, method, progress=progress)


def solve(problem: Problem, method: Method, *, start: Vector | None = None, progress: Progress | None = None) -> Fit:
    """Solve a problem; arguments and errors as for `fit`.

    Args:
        problem: Measurements and unknowns.
        method: How.
        start: Values to begin with instead of the problem's own.
        progress: Called now and then with the share that is finished.
    """
    _check_enough(problem, method)
    searches: list[tuple[Minimum, np.ndarray]] = []
    failures: Mapping[str, str] = {}
    for number, x in enumerate(_starts(problem, method, problem.start if start is None else start)):
        begin = predict(problem, problem.values_of(x))
        failures = begin.failures or failures
        if np.all(np.isfinite(begin.values)):
            searches.append((minimize(problem, x, loss=method.loss), x))
        elif not begin.failures:
            _refuse_missing(problem, begin.values)
        if progress is not None:
            progress((number + 1) / method.n_starts)
    if not searches:
        name, status = next(iter(failures.items()))
        raise SimulationFailed(f"The measurement `{name}` cannot be simulated at any start of the search: {status}")
    searches.sort(key=lambda item: item[0].cost)
    best = searches[0][0]
    if method.noise == "estimated":
        best = _with_noise(problem, method, best)
    return fit_of(problem, method, best, searches)


def _starts(problem: Problem, method: Method, first: np.ndarray) -> list[np.ndarray]:
    """Coordinates to begin with: the first, and a Latin hypercube around it, the same for a given seed."""
    x, n = problem.x_of(first), method.n_starts - 1
    rng = np.random.default_rng(method.seed)
    columns: list[np.ndarray] = []
    for k, unknown in enumerate(problem.unknowns):
        reach = math.log(SPREAD) if unknown.is_log else unknown.prior[1] if unknown.prior else unknown.size
        low = max(x[k] - reach, unknown.x(unknown.lower) if unknown.lower > -math.inf else -math.inf)
        high = min(x[k] + reach, unknown.x(unknown.upper) if unknown.upper < math.inf else math.inf)
        columns.append(low + (high - low) * (rng.permutation(n) + rng.random(n)) / max(n, 1))
    return [x, *np.array(columns).T]


def _with_noise(problem: Problem, method: Method, best: Minimum) -> Minimum:
    """The search again with the noise as the residuals have it, until both agree; once, without priors."""
    factor = 1.0
    for _ in range(_ROUNDS):
        information = information_of(problem, best)
        whole_information = best.jacobian.T @ best.jacobian
        fitted = float(np.trace(np.linalg.pinv(whole_information) @ information))
        off = (predict(problem, problem.values_of(best.x)).values - problem.observed) / problem.sigma
        new = math.sqrt(float(np.sum(off**2)) / (problem.observed.size - fitted))
        if not any(unknown.prior for unknown in problem.unknowns):
            return best._replace(jacobian=best.jacobian / (new or 1.0))
        has_settled = abs(new - factor) <= _SAME * factor
        factor = new
        if has_settled or new == 0.0:
            break
        best = minimize(problem, best.x, loss=method.loss, factor=factor)
    return best


def _check_enough(problem: Problem, method: Method) -> None:
    """Refuse fewer numbers than unknowns."""
    n_priors = sum(unknown.prior is not None for unknown in problem.unknowns)
    n_data, n_free = problem.observed.size, len(problem.unknowns) - n_priors
    more = 1 if method.noise == "estimated" else 0
    if n_data < n_free + more:
        also = " and the noise" if more else ""
        raise BadArgument(
            "measurements",
            f"must hold at least {n_free + more} numbers for {n_free} unknowns without a prior{also}, got {n_data}",
        )


def _refuse_missing(problem: Problem, predicted: np.ndarray) -> None:
    measurement = problem.measurements[int(problem.owner[np.flatnonzero(~np.isfinite(predicted))[0]])]
    names = ", ".join(measurement.figures)
    raise BadArgument(
        "figures",
        f"of `{measurement.name}` must be ones that its simulation has, got {names}; a trial of "
        f"{measurement.scenario.duration:g} s may be too short for a steady velocity",
    )


def refitted(found: Fit, problem: Problem) -> Fit:
    """The same unknowns from other measurements, begun where a fit ended."""
    return solve(problem, replace(found.method, n_starts=1), start=found.best)


_AT_END = 1e-6  # closer to the end of its range, in sizes, an unknown is there


def fit_of(problem: Problem, method: Method, best: Minimum, searches: Sequence[tuple[Minimum, np.ndarray]]) -> Fit:
    """Everything that is known at the end of a search.

    Args:
        problem: Measurements and unknowns.
        method: How it was searched.
        best: The end, with the Jacobian in the noise that counts.
        searches: Ends and starts of all searches, the best first.
    """
    values = problem.values_of(best.x)
    predicted = predict(problem, values).values
    chi2 = float(np.sum(((predicted - problem.observed) / problem.sigma) ** 2))
    by_data = identifiability(information_of(problem, best), problem.unknowns, limit=method.limit)
    by_all = identifiability(best.jacobian.T @ best.jacobian, problem.unknowns, limit=method.limit)
    n_priors = sum(unknown.prior is not None for unknown in problem.unknowns)
    degrees = float(problem.observed.size - max(len(problem.unknowns) - n_priors, 0))
    covariance, correlations = _covariance(problem, best.jacobian, by_all)
    quantile = quantile_of(method.confidence, degrees if method.noise == "estimated" else math.inf)
    names = problem.names
    return Fit(
        problem=problem,
        method=method,
        estimates=tuple(_estimate(problem, k, values, by_data, by_all, quantile) for k in range(len(names))),
        covariance=covariance,
        correlations=correlations,
        identifiability=by_data,
        predictions=predicted,
        chi2=chi2,
        noise_factor=math.sqrt(chi2 / degrees) if degrees > 0.0 else math.nan,
        degrees_of_freedom=degrees,
        searches=tuple(
            LocalSearch(
                start=dict(zip(names, map(float, problem.values_of(x)), strict=True)),
                end=dict(zip(names, map(float, problem.values_of(found.x)), strict=True)),
                cost=found.cost,
                converged=found.converged,
            )
            for found, x in searches
        ),
        warnings=(*_warnings(problem), *by_data.words),
    )


def _covariance(problem: Problem, jacobian: np.ndarray, seen: Identifiability) -> tuple[np.ndarray, np.ndarray]:
    """Covariance and correlations of the coordinates; inf and nan for what is not seen at all."""
    sizes = problem.sizes
    scaled = jacobian * sizes
    covariance = np.linalg.pinv(scaled.T @ scaled, rcond=1e-13, hermitian=True)
    blind = ~np.isfinite(seen.sigma)
    with np.errstate(divide="ignore", invalid="ignore"):
        deviation = np.sqrt(np.diag(covariance))
        correlations = np.clip(covariance / np.outer(deviation, deviation), -1.0, 1.0)
    covariance = covariance * np.outer(sizes, sizes)
    covariance[blind, :], covariance[:, blind] = np.inf, np.inf
    hidden = seen.sigma >= seen.limit
    correlations[hidden, :], correlations[:, hidden] = np.nan, np.nan
    return covariance, correlations


def _estimate(
    problem: Problem, k: int, values: np.ndarray, by_data: Identifiability, by_all: Identifiability, quantile: float
) -> ParameterEstimate:
    """What is known of one unknown."""
    unknown, value = problem.unknowns[k], float(values[k])
    share, alone = float(by_all.sigma[k]), float(by_data.sigma[k])
    x, deviation = unknown.x(value), share * unknown.size
    parameter, notes = unknown.parameter, list[str]()
    if unknown.name in by_data.without_effect:
        notes.append("has no effect on what was measured")
    elif alone >= by_data.limit:
        its_own = [direction for direction in by_data.directions if abs(direction.weights[k]) > 0.1]
        worst = max(its_own, key=lambda direction: abs(direction.weights[k]) * min(direction.sigma, 1e9))
        notes.append(f"not identifiable: the data do not see {worst.name}")
    if unknown.prior is not None and share**2 > 0.5 * (unknown.prior[1] / unknown.slope(value) / unknown.size) ** 2:
        notes.append("known from the prior rather than from the data")
    reach = _AT_END * (1.0 if unknown.is_log else unknown.size)
    for end, word in ((unknown.lower, "lower"), (unknown.upper, "upper")):
        if math.isfinite(end) and abs(unknown.x(end) - x) <= reach:
            notes.append(f"at the {word} end of its range")
    identified = share < by_all.limit
    low, high = (unknown.value(x + sign * quantile * deviation) if identified else 0.0 for sign in (-1.0, 1.0))
    return ParameterEstimate(
        name=unknown.name,
        unit=parameter.unit,
        title=parameter.title,
        value=value,
        sigma=deviation * unknown.slope(value) if identified else None,
        interval=(low, high) if identified else None,
        note="; ".join(notes),
    )


def _warnings(problem: Problem) -> list[str]:
    """What is odd about the data, though nothing is wrong with it."""
    found: list[str] = []
    gaits = {(s.gait, s.robot.caudal_fin, s.environment) for s in problem.scenarios}
    if len(gaits) == 1 and len(problem.scenarios) > 1:
        found.append("All measurements are of the same gait with the same robot: they are one measurement, repeated.")
    return found


def information_of(problem: Problem, found: Minimum) -> np.ndarray:
    """J^T J of the data alone, without priors."""
    data = found.jacobian[: problem.observed.size]
    return data.T @ data


def quantile_of(confidence: float, degrees: float) -> float:
    """The quantile of Student's t (normal for infinite degrees of freedom) with `confidence` between -q and q.

    Args:
        confidence: [-].
        degrees: Of freedom.

    Raises:
        MissingExtra: If scipy is not installed.
    """
    special = optional_import("Identification", "scipy", "identify", "scipy.special")
    share = 0.5 * (1.0 + confidence)
    return float(special.ndtri(share) if np.isinf(degrees) else special.stdtrit(degrees, share))
