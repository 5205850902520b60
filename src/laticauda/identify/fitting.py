"""`fit`: the values of the unknowns with which the model describes the measurements best."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.errors import SimulationFailed, one_of
from laticauda.identify import door
from laticauda.identify.estimating import assembled, information_of
from laticauda.identify.identifiability import LIMIT
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import predict
from laticauda.identify.problem import Problem, problem
from laticauda.identify.result import Fit
from laticauda.identify.searching import Method, search
from laticauda.identify.unknowns import Unknown
from laticauda.robot import Robot
from laticauda.scenarios import MODELS
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
    model: str = "planar",
    joints: str = "prescribed",
    dt: float | None = None,
    offset_bandwidth: float = 10.0,
    ramp: float | None = None,
    noise: str = "known",
    loss: str = "linear",
    n_starts: int = 4,
    seed: int = 0,
    confidence: float = 0.95,
    limit: float = LIMIT,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Identify parameters of robot and water from measured trials, by least squares.

    Minimizes the sum over all measured numbers of ((predicted - measured) / sigma)^2, and over all priors of
    ((q - mean) / sd)^2, within the ranges of the unknowns, from several starts.

    Args:
        measurements: What was measured.
        robot: What swam where a measurement does not say it.
        parameters: Names of what is identified, or `Unknown`s with ranges and priors.
        model: planar, or spatial: the 3D twin, which is slow.
        joints: See `laticauda.simulate.plant`.
        dt: See there [s].
        offset_bandwidth: See there [rad/s].
        ramp: See there [s].
        noise: known: the uncertainties take the noise as the measurements state it; estimated: a common factor on it is
            estimated from the residuals.
        loss: linear, or soft_l1, huber, cauchy, arctan: outliers count less.
        n_starts: How many starts; the first is at the values that robot and water have.
        seed: Of the further starts.
        confidence: Of the intervals [-].
        limit: From which standard deviation on, as a share of itself, an unknown counts as not identified [-].
        threads: How many to compute with; None takes all cores that this process may use.
        progress: Called now and then with the share that is finished, from 0 to 1.

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
    one_of("model", model, tuple(MODELS))
    method = Method(noise=noise, loss=loss, n_starts=n_starts, seed=seed, confidence=confidence, limit=limit)
    options: dict[str, Any] = {
        "joints": joints,
        "dt": dt,
        "offset_bandwidth": offset_bandwidth,
        "ramp": ramp,
    }
    put = problem(measurements, robot, parameters, model=model, options=options, threads=threads)
    return solve(put, method, progress=progress)


def solve(put: Problem, method: Method, *, start: Vector | None = None, progress: Progress | None = None) -> Fit:
    """Solve a problem; arguments and errors as for `fit`.

    Args:
        put: Measurements and unknowns.
        method: How.
        start: Values to begin with instead of the problem's own.
        progress: Called now and then with the share that is finished.
    """
    _check_enough(put, method)
    searches: list[tuple[door.Found, np.ndarray]] = []
    failures: Mapping[str, str] = {}
    for number, x in enumerate(_starts(put, method, put.start if start is None else start)):
        begin = predict(put, put.values_of(x))
        failures = begin.failures or failures
        if np.all(np.isfinite(begin.values)):
            searches.append((search(put, method, x, 1.0), x))
        elif not begin.failures:
            _refuse_missing(put, begin.values)
        if progress is not None:
            progress((number + 1) / method.n_starts)
    if not searches:
        name, status = next(iter(failures.items()))
        raise SimulationFailed(f"The measurement `{name}` cannot be simulated at any start of the search: {status}")
    searches.sort(key=lambda item: item[0].cost)
    best = searches[0][0]
    if method.noise == "estimated":
        best = _with_noise(put, method, best)
    return assembled(put, method, best, searches)


def _starts(put: Problem, method: Method, first: np.ndarray) -> list[np.ndarray]:
    """Coordinates to begin with: the first, and a Latin hypercube around it, the same for a given seed."""
    x, n = put.x_of(first), method.n_starts - 1
    rng = np.random.default_rng(method.seed)
    columns: list[np.ndarray] = []
    for k, unknown in enumerate(put.unknowns):
        reach = math.log(SPREAD) if unknown.is_log else unknown.prior[1] if unknown.prior else unknown.size
        low = max(x[k] - reach, unknown.x(unknown.lower) if unknown.lower > -math.inf else -math.inf)
        high = min(x[k] + reach, unknown.x(unknown.upper) if unknown.upper < math.inf else math.inf)
        columns.append(low + (high - low) * (rng.permutation(n) + rng.random(n)) / max(n, 1))
    return [x, *np.array(columns).T]


def _with_noise(put: Problem, method: Method, best: door.Found) -> door.Found:
    """The search again with the noise as the residuals have it, until both agree; once, without priors."""
    factor = 1.0
    for _ in range(_ROUNDS):
        information = information_of(put, best)
        whole_information = best.jacobian.T @ best.jacobian
        fitted = float(np.trace(np.linalg.pinv(whole_information) @ information))
        off = (predict(put, put.values_of(best.x)).values - put.observed) / put.sigma
        new = math.sqrt(float(np.sum(off**2)) / (put.observed.size - fitted))
        if not any(unknown.prior for unknown in put.unknowns):
            return best._replace(jacobian=best.jacobian / (new or 1.0))
        settled = abs(new - factor) <= _SAME * factor
        factor = new
        if settled or new == 0.0:
            break
        best = search(put, method, best.x, factor)
    return best


def _check_enough(put: Problem, method: Method) -> None:
    """Refuse fewer numbers than unknowns."""
    n_priors = sum(unknown.prior is not None for unknown in put.unknowns)
    n_data, n_free = put.observed.size, len(put.unknowns) - n_priors
    more = 1 if method.noise == "estimated" else 0
    if n_data < n_free + more:
        also = " and the noise" if more else ""
        raise ValueError(
            f"`measurements` must hold at least {n_free + more} numbers for {n_free} unknowns without a prior{also}, "
            f"got {n_data}."
        )


def _refuse_missing(put: Problem, predicted: np.ndarray) -> None:
    measurement = put.measurements[int(put.owner[np.flatnonzero(~np.isfinite(predicted))[0]])]
    names = ", ".join(measurement.figures)
    raise ValueError(
        f"`figures` of `{measurement.name}` must be ones that its simulation has, got {names}; a trial of "
        f"{measurement.duration:g} s may be too short for a steady velocity."
    )


def method_of(found: Fit) -> Method:
    """How a fit was made, with one start."""
    limit = found.identifiability.limit
    return Method(noise=found.noise, loss=found.loss, n_starts=1, confidence=found.confidence, limit=limit)


def refitted(found: Fit, put: Problem) -> Fit:
    """The same unknowns from other measurements, begun where a fit ended."""
    return solve(put, method_of(found), start=np.array(list(found.values.values())))
