"""`fit`: find the values of the unknowns with which the model best describes the measurements."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Unpack

import numpy as np
from jaxtyping import Float, Int

from laticauda.identify import identifiability, result, unknowns
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import Predicted, predict, scaled_jacobian
from laticauda.identify.problem import Problem, make_problem
from laticauda.models.simulate.runner import Progress, silent
from laticauda.robot import Robot
from laticauda.scenarios import Model, ModelChanges
from laticauda.values.errors import BadArgument, SimulationFailed
from laticauda.values.optional import optional_import

SPREAD = 3.0  # additional starts lie within this factor of the first
_ROUNDS = 20  # iterations of the noise estimate when there are priors
_SAME = 1e-6
_LOSSES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "linear": lambda z: z,
    "soft_l1": lambda z: 2.0 * (np.sqrt(1.0 + z) - 1.0),
    "huber": lambda z: np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
    "cauchy": np.log1p,
    "arctan": np.arctan,
}
_TIGHT = 1e-10
_NEAR = 0.01  # fraction of a large change of each coordinate: a search this close to another's end stops there
_MOST_STEPS = 100

Vector = Float[np.ndarray, " n"]


Keep = Callable[[Mapping[str, float], float], None]
"""Callback of a search, called with the best values so far, by name, and their sum of squares."""
INTERRUPTED = "interrupted: these are the best values so far; later steps were not computed."


def fit(
    measurements: Sequence[Measurement],
    robot: Robot | None = None,
    *,
    parameters: Sequence[str | unknowns.Unknown] | Mapping[str, tuple[float, float]],
    model: Model | str | None = None,
    noise: str = "known",
    loss: str = "linear",
    n_starts: int = 4,
    seed: int = 0,
    confidence: float = 0.95,
    limit: float = identifiability.LIMIT,
    threads: int | None = None,
    progress: Progress = silent,
    keep: Keep = silent,
    **changes: Unpack[ModelChanges],
) -> result.Fit:
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
        n_starts: Number of starts; the first uses the values that robot and water have.
        seed: Seed of the random starts.
        confidence: Confidence level of the intervals [-].
        limit: Relative standard deviation from which on an unknown counts as not identified [-].
        threads: Number of threads; None uses all cores available to this process.
        progress: Called periodically with the finished fraction, from 0 to 1.
        keep: Called with the best values by name and their sum of squares, whenever they improve.
        changes: Changes of the model: `joints` (prescribed, pd, servo, or a joint law), `dt` [s]
            and the other fields of `laticauda.scenarios.ModelChanges`.

    Returns:
        Values, intervals, correlations, predictions, and the directions that the data do not see.

    Raises:
        ValueError: If an argument is out of its range, or there are fewer measured numbers than
            unknowns.
        SimulationFailed: If a measurement cannot be simulated at any start.
        MissingExtra: If scipy is not installed.

    Example:
        >>> from laticauda.identify import fit, from_table1
        >>> found = fit(from_table1(), parameters=["water.tangential_friction"], noise="estimated", n_starts=1)
        >>> found["water.tangential_friction"].is_identified
        True
    """
    method = result.Method(
        noise=noise, loss=loss, n_starts=n_starts, seed=seed, confidence=confidence, limit=limit
    )
    problem = make_problem(measurements, parameters, robot, threads=threads, model=model, **changes)
    return solve(problem, method, progress=progress, keep=keep)


def solve(
    problem: Problem,
    method: result.Method,
    *,
    start: Vector | None = None,
    progress: Progress = silent,
    keep: Keep = silent,
) -> result.Fit:
    """Solve a problem; arguments and errors as for `fit`.

    Args:
        problem: Measurements and unknowns.
        method: Settings of the fit.
        start: Starting values to use instead of the problem's own.
        progress: Called periodically with the finished fraction.
        keep: Called with the best values by name and their sum of squares, whenever they improve.
    """
    _check_enough(problem, method)
    searches: list[result.LocalSearch] = []
    failures: Mapping[str, str] = {}
    kept, least = None, math.inf

    def look(x: Vector, cost: float) -> None:
        nonlocal kept, least
        if cost < least:
            kept, least = x, cost
            keep(problem.named(x), cost)

    steps = _MOST_STEPS
    try:
        for number, x in enumerate(
            _starts(problem, method, problem.start if start is None else start)
        ):
            begin = predict(problem, problem.values_of(x))
            failures = begin.failures or failures
            if np.all(np.isfinite(begin.values)):
                searches.append(minimize(problem, x, loss=method.loss, look=look, known=searches))
            elif not begin.failures:
                _refuse_missing(problem, begin.values)
            progress((number + 1) / method.n_starts)
    except KeyboardInterrupt:
        if kept is None:
            raise
        steps = 1
        searches.append(minimize(problem, kept, loss=method.loss, steps=steps))
    if not searches:
        name, status = next(iter(failures.items()))
        raise SimulationFailed(
            f"The measurement `{name}` cannot be simulated at any start of the search: {status}"
        )
    searches.sort(key=lambda one: one.cost)
    best = searches[0]
    if method.noise == "estimated":
        best = _with_noise(problem, method, best, steps)

    found = result.fit_of(problem, method, best, searches)
    return found if steps > 1 else replace(found, warnings=(INTERRUPTED, *found.warnings))


def _starts(problem: Problem, method: result.Method, first: np.ndarray) -> list[np.ndarray]:
    """Return the starting coordinates: the first, and a Latin hypercube around it, the same for a given seed."""
    x, n = problem.x_of(first), method.n_starts - 1
    rng = np.random.default_rng(method.seed)
    columns: list[np.ndarray] = []
    for k, unknown in enumerate(problem.unknowns):
        reach = (
            math.log(SPREAD)
            if unknown.is_log
            else unknown.prior[1]
            if unknown.prior
            else unknown.size
        )
        low, high = max(x[k] - reach, unknown.ends[0]), min(x[k] + reach, unknown.ends[1])
        columns.append(low + (high - low) * (rng.permutation(n) + rng.random(n)) / max(n, 1))
    return [x, *np.array(columns).T]


def _with_noise(
    problem: Problem, method: result.Method, best: result.LocalSearch, steps: int
) -> result.LocalSearch:
    """Repeat the search with the noise estimated from the residuals until both agree; without priors, rescale once."""
    factor = 1.0
    for _ in range(_ROUNDS):
        information = problem.information(best.jacobian)
        whole_information = best.jacobian.T @ best.jacobian
        fitted = float(np.trace(np.linalg.pinv(whole_information) @ information))
        off = (
            predict(problem, problem.values_of(best.end)).values - problem.observed
        ) / problem.sigma
        new = math.sqrt(float(np.sum(off**2)) / (problem.observed.size - fitted))
        if not any(unknown.prior for unknown in problem.unknowns):
            return replace(best, jacobian=best.jacobian / (new or 1.0))
        has_settled = abs(new - factor) <= _SAME * factor
        factor = new
        if has_settled or new == 0.0:
            break
        best = minimize(problem, best.end, loss=method.loss, factor=factor, steps=steps)
    return best


def _check_enough(problem: Problem, method: result.Method) -> None:
    """Reject fewer measured numbers than unknowns."""
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
    measurement = problem.measurements[
        int(problem.owner[np.flatnonzero(~np.isfinite(predicted))[0]])
    ]
    names = ", ".join(measurement.figures)
    raise BadArgument(
        "figures",
        f"of `{measurement.name}` must be ones that its simulation yields, got {names}; a trial of "
        f"{measurement.scenario.duration:g} s may be too short for a steady velocity",
    )


# ---- one search ----------------------------------------------------------------------------------


class _Arrived(Exception):
    """Raised when a search arrives where another one ended; the argument is that other search."""


def minimize(
    problem: Problem,
    x: Vector,
    *,
    loss: str,
    factor: float = 1.0,
    free: Int[np.ndarray, " n_free"] | None = None,
    steps: int = _MOST_STEPS,
    look: Callable[[Vector, float], None] = silent,
    known: Sequence[result.LocalSearch] = (),
) -> result.LocalSearch:
    """Run one search.

    Args:
        problem: Measurements and unknowns.
        x: Starting coordinates.
        loss: Loss function of the residuals.
        factor: Factor applied to the stated noise.
        free: Indices of the unknowns that may change; None: all.
        steps: Maximum number of steps.
        look: Called with all coordinates and the sum of squares at every step.
        known: Earlier searches; a search that comes close to the end of one of them, equally good,
            ends there.

    Returns:
        The finished search, with all coordinates and the Jacobian with respect to the free ones.

    Raises:
        MissingExtra: If scipy is not installed.
    """
    optimize = optional_import("Identification", "scipy", "identify", "scipy.optimize")
    mine = np.arange(x.size) if free is None else free
    here, reached = None, math.inf  # the last prediction, and its cost

    def whole(at: np.ndarray) -> Vector:
        every = x.copy()
        every[mine] = at
        return every

    def residuals(at: np.ndarray) -> np.ndarray:
        nonlocal here, reached
        values = problem.values_of(whole(at))
        here = predict(problem, values)
        found = all_residuals(problem, values, factor, here)
        reached = cost_of(found, loss)
        look(whole(at), reached)
        return found

    def jacobian(at: np.ndarray) -> np.ndarray:
        for one in known:
            if result.agree(reached, one.cost) and np.all(
                np.abs(whole(at) - one.end) <= _NEAR * problem.sizes
            ):
                raise _Arrived(one)
        values = problem.values_of(whole(at))
        rows = [scaled_jacobian(problem, values, factor, here), problem.prior_slopes(values)]
        return np.concatenate(rows)[:, mine]

    bounds = np.array([unknown.ends for unknown in problem.unknowns])[mine]
    try:
        found = optimize.least_squares(
            residuals,
            np.clip(x[mine], *bounds.T),
            jac=jacobian,
            bounds=tuple(bounds.T),
            x_scale=problem.sizes[mine],
            loss=loss,
            method="trf",
            xtol=_TIGHT,
            ftol=_TIGHT,
            gtol=_TIGHT,
            max_nfev=steps,
        )
    except _Arrived as arrived:
        return replace(arrived.args[0], start=x)
    end, jac = whole(found.x), np.asarray(found.jac)
    return result.LocalSearch(
        start=x, end=end, cost=2.0 * float(found.cost), jacobian=jac, converged=found.status > 0
    )


def all_residuals(
    problem: Problem,
    values: Float[np.ndarray, " n_unknowns"],
    factor: float = 1.0,
    predicted: Predicted | None = None,
) -> Float[np.ndarray, " n_residuals"]:
    """Return the residuals of the data and of the priors, in standard deviations.

    Args:
        problem: Measurements and unknowns.
        values: Values of the unknowns.
        factor: Factor applied to the stated noise.
        predicted: Prediction at these values, if already computed.
    """
    data = ((predicted or predict(problem, values)).values - problem.observed) / (
        factor * problem.sigma
    )
    return np.concatenate([data, problem.prior_residuals(values)])


def cost_of(residuals: Float[np.ndarray, " n_residuals"], loss: str) -> float:
    """Compute what a search minimizes: the sum of rho(r^2), with the loss function rho."""
    return float(np.sum(_LOSSES[loss](residuals**2)))
