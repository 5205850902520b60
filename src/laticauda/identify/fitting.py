"""`fit`: the values of the unknowns with which the model describes the measurements best."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.errors import SimulationFailed, one_of, positive, whole, within
from laticauda.identify import door
from laticauda.identify.identifiability import LIMIT, Identifiability, identifiability
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import predict
from laticauda.identify.problem import Problem, problem
from laticauda.identify.result import Estimate, Fit, Search
from laticauda.identify.unknowns import Unknown
from laticauda.robot import Robot
from laticauda.simulate.plants import MODELS, FluidLaw
from laticauda.simulate.runner import Progress

NOISES = ("known", "estimated")
SPREAD = 3.0  # further starts lie within this factor of the first
_MOST_STEPS = 100
_ROUNDS = 20  # of estimating the noise beside priors
_SAME = 1e-6

Vector = Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True)
class Method:
    """How a fit is made."""

    noise: str = "known"
    """known: as the measurements state it; estimated: that times a common factor, which the residuals say."""
    loss: str = "linear"
    """One of `door.LOSSES`."""
    n_starts: int = 4
    """How many starts."""
    seed: int = 0
    """Of the further starts."""
    confidence: float = 0.95
    """Of the intervals."""
    limit: float = LIMIT
    """From which relative standard deviation on an unknown counts as not identified."""

    def __post_init__(self) -> None:
        """Check every field once."""
        one_of("noise", self.noise, NOISES)
        one_of("loss", self.loss, door.LOSSES)
        whole("n_starts", self.n_starts, 1)
        whole("seed", self.seed, 0)
        within("confidence", self.confidence, 0.5, 0.9999)
        positive("limit", self.limit)


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
    fluid_law: FluidLaw | None = None,
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
        fluid_law: See there.
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
    one_of("model", model, MODELS)
    method = Method(noise=noise, loss=loss, n_starts=n_starts, seed=seed, confidence=confidence, limit=limit)
    options: dict[str, Any] = {
        "joints": joints,
        "dt": dt,
        "offset_bandwidth": offset_bandwidth,
        "ramp": ramp,
        "fluid_law": fluid_law,
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
            searches.append((_search(put, method, x, 1.0), x))
        elif not begin.failures:
            _refuse_missing(put, begin.values)
        if progress is not None:
            progress((number + 1) / method.n_starts)
    if not searches:
        name, status = next(iter(failures.items()))
        raise SimulationFailed(f"The measurement `{name}` cannot be simulated at any start of the search: {status}")
    searches.sort(key=lambda item: item[0].cost)
    best = searches[0][0]
    factor = 1.0
    if method.noise == "estimated":
        best, factor = _with_noise(put, method, best)
    return _result(put, method, best, factor, searches)


def _search(put: Problem, method: Method, x: Vector, factor: float) -> door.Found:
    """One search from x, with `factor` times the stated noise."""
    sigma = factor * put.sigma

    def residuals(at: np.ndarray) -> np.ndarray:
        values = put.values_of(at)
        return np.concatenate([(predict(put, values).values - put.observed) / sigma, _prior_rows(put, values)])

    def jacobian(at: np.ndarray) -> np.ndarray:
        values = put.values_of(at)
        found = predict(put, values, jacobian=True).jacobian
        assert found is not None
        return np.concatenate([found / sigma[:, np.newaxis] * slopes_of(put, values), _prior_slopes(put, values)])

    bounds = np.array([[u.x(end) if math.isfinite(end) else end for end in (u.lower, u.upper)] for u in put.unknowns])
    sizes = np.array([unknown.size for unknown in put.unknowns])
    ends = bounds[:, 0], bounds[:, 1]
    return door.least_squares(residuals, jacobian, x, ends, sizes, loss=method.loss, most=_MOST_STEPS)


def slopes_of(put: Problem, values: Vector) -> Vector:
    """dq/dx of every unknown."""
    return np.array([unknown.slope(float(value)) for unknown, value in zip(put.unknowns, values, strict=True)])


def _prior_rows(put: Problem, values: np.ndarray) -> np.ndarray:
    pairs = [(value, unknown.prior) for value, unknown in zip(values, put.unknowns, strict=True)]
    return np.array([(value - prior[0]) / prior[1] for value, prior in pairs if prior is not None])


def _prior_slopes(put: Problem, values: np.ndarray) -> np.ndarray:
    rows = [
        np.eye(len(put.unknowns))[k] * unknown.slope(float(values[k])) / unknown.prior[1]
        for k, unknown in enumerate(put.unknowns)
        if unknown.prior is not None
    ]
    return np.reshape(rows, (len(rows), len(put.unknowns)))


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


def _with_noise(put: Problem, method: Method, best: door.Found) -> tuple[door.Found, float]:
    """The search again with the noise as the residuals have it, until both agree; once, without priors."""
    factor = 1.0
    for _ in range(_ROUNDS):
        information = _information(put, best, factor)
        whole_information = best.jacobian.T @ best.jacobian
        fitted = float(np.trace(np.linalg.pinv(whole_information) @ information))
        off = (predict(put, put.values_of(best.x)).values - put.observed) / put.sigma
        new = math.sqrt(float(np.sum(off**2)) / (put.observed.size - fitted))
        if not any(unknown.prior for unknown in put.unknowns):
            return best._replace(jacobian=best.jacobian / (new or 1.0)), new
        settled = abs(new - factor) <= _SAME * factor
        factor = new
        if settled or new == 0.0:
            break
        best = _search(put, method, best.x, factor)
    return best, factor


def _information(put: Problem, found: door.Found, factor: float) -> np.ndarray:
    """J^T J of the data alone."""
    data = found.jacobian[: put.observed.size]
    return data.T @ data


def _result(
    put: Problem, method: Method, best: door.Found, factor: float, searches: Sequence[tuple[door.Found, np.ndarray]]
) -> Fit:
    values = put.values_of(best.x)
    predicted = predict(put, values).values
    chi2 = float(np.sum(((predicted - put.observed) / put.sigma) ** 2))
    seen = identifiability(_information(put, best, factor), put.unknowns, limit=method.limit)
    all_seen = identifiability(best.jacobian.T @ best.jacobian, put.unknowns, limit=method.limit)
    n_priors = sum(unknown.prior is not None for unknown in put.unknowns)
    degrees = float(put.observed.size - max(len(put.unknowns) - n_priors, 0))
    covariance, correlations = _covariance(put, best.jacobian, all_seen)
    quantile = door.two_sided(method.confidence, degrees if method.noise == "estimated" else math.inf)
    names = put.names
    return Fit(
        problem=put,
        estimates=tuple(_estimate(put, k, values, seen, all_seen, quantile) for k in range(len(names))),
        covariance=covariance,
        correlations=correlations,
        identifiability=seen,
        predictions=predicted,
        chi2=chi2,
        noise_factor=math.sqrt(chi2 / degrees) if degrees > 0.0 else math.nan,
        noise=method.noise,
        loss=method.loss,
        confidence=method.confidence,
        degrees_of_freedom=degrees,
        searches=tuple(
            Search(
                start=dict(zip(names, map(float, put.values_of(x)), strict=True)),
                end=dict(zip(names, map(float, put.values_of(found.x)), strict=True)),
                cost=found.cost,
                converged=found.converged,
            )
            for found, x in searches
        ),
        warnings=(*_warnings(put), *seen.words),
    )


def _covariance(put: Problem, jacobian: np.ndarray, seen: Identifiability) -> tuple[np.ndarray, np.ndarray]:
    """Covariance and correlations of the coordinates; inf and nan for what is not seen at all."""
    sizes = np.array([unknown.size for unknown in put.unknowns])
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
    put: Problem, k: int, values: np.ndarray, seen: Identifiability, all_seen: Identifiability, quantile: float
) -> Estimate:
    """What is known of one unknown."""
    unknown, value = put.unknowns[k], float(values[k])
    share, alone = float(all_seen.sigma[k]), float(seen.sigma[k])
    x, deviation = unknown.x(value), share * unknown.size
    parameter, notes = unknown.parameter, list[str]()
    if unknown.name in seen.without_effect:
        notes.append("has no effect on what was measured")
    elif alone >= seen.limit:
        worst = max(seen.directions, key=lambda d: abs(d.weights[k]) * min(d.sigma, 1e9))
        notes.append(f"not identifiable: the data do not see {worst.name}")
    if unknown.prior is not None and share**2 > 0.5 * (unknown.prior[1] / unknown.slope(value) / unknown.size) ** 2:
        notes.append("known from the prior rather than from the data")
    reach = _SAME * (1.0 if unknown.is_log else unknown.size)
    for end, word in ((unknown.lower, "lower"), (unknown.upper, "upper")):
        if math.isfinite(end) and abs(unknown.x(end) - x) <= reach:
            notes.append(f"at the {word} end of its range")
    identified = share < all_seen.limit
    low, high = (unknown.value(x + sign * quantile * deviation) if identified else 0.0 for sign in (-1.0, 1.0))
    return Estimate(
        name=unknown.name,
        unit=parameter.unit,
        title=parameter.title,
        value=value,
        sigma=deviation * unknown.slope(value) if identified else None,
        interval=(low, high) if identified else None,
        note="; ".join(notes),
    )


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


def _warnings(put: Problem) -> list[str]:
    """What is odd about the data, though nothing is wrong with it."""
    found: list[str] = []
    gaits = {(s.gait, s.robot.caudal_fin, s.environment) for s in put.settings}
    if len(gaits) == 1 and len(put.settings) > 1:
        found.append("All measurements are of the same gait with the same robot: they are one measurement, repeated.")
    return found


def refitted(found: Fit, put: Problem) -> Fit:
    """Another problem of the same kind, begun where a fit ended, and solved once."""
    method = Method(
        noise=found.noise,
        loss=found.loss,
        n_starts=1,
        confidence=found.confidence,
        limit=found.identifiability.limit,
    )
    start = np.array([found.values.get(unknown.name, unknown.start) for unknown in put.unknowns])
    return solve(replace(put), method, start=start)
