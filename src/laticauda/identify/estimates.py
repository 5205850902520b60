"""What is known of the unknowns where a search ended: intervals, correlations, and what limits them."""

import math
from collections.abc import Sequence

import numpy as np

from laticauda.extras import optional_import
from laticauda.identify.identifiability import Identifiability, identifiability
from laticauda.identify.least_squares import Method, Minimum
from laticauda.identify.model import predict
from laticauda.identify.problem import Problem
from laticauda.identify.result import Fit, LocalSearch, ParameterEstimate

_SAME = 1e-6  # closer to the end of its range, in sizes, an unknown is there


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
    reach = _SAME * (1.0 if unknown.is_log else unknown.size)
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
