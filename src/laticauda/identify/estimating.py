"""From where a search ended to a `Fit`: intervals, correlations, and what is to be known about them."""

import math
from collections.abc import Sequence

import numpy as np

from laticauda.identify import door
from laticauda.identify.identifiability import Identifiability, identifiability
from laticauda.identify.model import predict
from laticauda.identify.problem import Problem
from laticauda.identify.result import Estimate, Fit, Search
from laticauda.identify.searching import Method

_SAME = 1e-6  # closer to the end of its range, in sizes, an unknown is there


def assembled(put: Problem, method: Method, best: door.Found, searches: Sequence[tuple[door.Found, np.ndarray]]) -> Fit:
    """Everything that is known at the end of a search.

    Args:
        put: Measurements and unknowns.
        method: How it was searched.
        best: The end, with the Jacobian in the noise that counts.
        searches: Ends and starts of all searches, the best first.
    """
    values = put.values_of(best.x)
    predicted = predict(put, values).values
    chi2 = float(np.sum(((predicted - put.observed) / put.sigma) ** 2))
    seen = identifiability(information_of(put, best), put.unknowns, limit=method.limit)
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
        its_own = [direction for direction in seen.directions if abs(direction.weights[k]) > 0.1]
        worst = max(its_own, key=lambda direction: abs(direction.weights[k]) * min(direction.sigma, 1e9))
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


def _warnings(put: Problem) -> list[str]:
    """What is odd about the data, though nothing is wrong with it."""
    found: list[str] = []
    gaits = {(s.gait, s.robot.caudal_fin, s.environment) for s in put.settings}
    if len(gaits) == 1 and len(put.settings) > 1:
        found.append("All measurements are of the same gait with the same robot: they are one measurement, repeated.")
    return found


def information_of(put: Problem, found: door.Found) -> np.ndarray:
    """J^T J of the data alone, without priors."""
    data = found.jacobian[: put.observed.size]
    return data.T @ data
