"""From the end of a search to a `Fit`: estimates with their intervals, covariance, and remarks."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.identify.correlated_noise import noise_widening
from laticauda.identify.doubt import doubt_of
from laticauda.identify.fit_warnings import list_warnings
from laticauda.identify.identifiability import Direction, Identifiability, analyze_identifiability
from laticauda.identify.information import invert_information
from laticauda.identify.local_search import LocalSearch
from laticauda.identify.method import Method
from laticauda.identify.model import predict
from laticauda.identify.noise_factor import measure_noise_factor
from laticauda.identify.problem import Problem
from laticauda.identify.result import Fit, ParameterEstimate
from laticauda.identify.unknowns import ResolvedUnknown

_AT_END = 1e-6
"""An unknown closer than this to the end of its range, in sizes, is at that end [-]."""
_TAKES_PART = 0.1
"""Weight in a unit vector from which on an unknown takes part in a direction [-]."""
_UNSEEN = 1e9
"""Standard deviation that stands for an infinite one, so that weights still count [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Optimum:
    """The point at which a fit ends, with the Jacobian that decides its uncertainty.

    The searches count residuals in the stated noise. If the noise is estimated, this Jacobian
    counts them in the estimated one.
    """

    coordinates: Float[np.ndarray, " n_unknowns"]
    """Coordinates of the unknowns."""
    jacobian: Float[np.ndarray, "n_residuals n_unknowns"]
    """Jacobian of the residuals in standard deviations of the noise that applies.

    The rows of the priors come last.
    """
    noise_factor: float
    """Factor on the stated noise that gives this noise; 1 if the noise is known [-]."""

    @classmethod
    def of_search(cls, search: LocalSearch, *, noise_factor: float) -> "Optimum":
        """Return the end of a search, and the factor on the noise with which it was made."""
        return cls(coordinates=search.end, jacobian=search.jacobian, noise_factor=noise_factor)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Uncertainty:
    """What decides the interval of every unknown."""

    by_data: Identifiability
    """What the data alone see."""
    by_data_and_priors: Identifiability
    """What data and priors see together."""
    widening: Float[np.ndarray, " n_unknowns"]
    """Factors by which correlated noise widens the intervals [-]."""
    quantile: float
    """Half-width of an interval in standard deviations [-]."""


def assemble_fit(
    problem: Problem, method: Method, optimum: Optimum, searches: Sequence[LocalSearch]
) -> Fit:
    """Assemble the result of a fit at the end of a search.

    Args:
        problem: Measurements and unknowns.
        method: Settings of the fit.
        optimum: Where the fit ends.
        searches: All searches, best first.
    """
    values = problem.values_of(optimum.coordinates)
    jacobian = optimum.jacobian
    predictions = predict(problem, values).values
    residuals = (predictions - problem.observed) / problem.sigma
    chi2 = float(np.sum(residuals**2))
    chi2_with_priors = chi2 + float(np.sum(problem.prior_residuals(values) ** 2))
    noise_factor, degrees = measure_noise_factor(problem, method, jacobian, residuals)
    by_data = analyze_identifiability(
        problem.information(jacobian), problem.unknowns, limit=method.limit
    )
    by_data_and_priors = analyze_identifiability(
        jacobian.T @ jacobian, problem.unknowns, limit=method.limit
    )
    if method.estimates_noise:
        widening, lags = noise_widening(problem, jacobian, residuals, degrees)
        judged_chi2 = None  # the noise was chosen such that chi^2 is as usual
    else:
        widening, lags = noise_widening(problem, jacobian, residuals, None)
        judged_chi2 = chi2_with_priors
    uncertainty = _Uncertainty(
        by_data=by_data,
        by_data_and_priors=by_data_and_priors,
        widening=widening,
        quantile=method.quantile(degrees),
    )
    covariance_in_sizes = _covariance_in_sizes(problem, jacobian)
    covariance = _covariance_of_coordinates(problem, covariance_in_sizes, by_data_and_priors)
    estimates = [
        _estimate(unknown, k, float(values[k]), uncertainty)
        for k, unknown in enumerate(problem.unknowns)
    ]
    warnings = list_warnings(problem, judged_chi2, degrees, lags, float(np.max(widening)))
    return Fit(
        problem=problem,
        method=method,
        estimates=tuple(estimates),
        covariance=covariance * np.outer(widening, widening),
        correlations=_correlations(covariance_in_sizes, by_data_and_priors),
        identifiability=by_data,
        predictions=predictions,
        chi2=chi2,
        noise_factor=noise_factor,
        used_noise_factor=optimum.noise_factor,
        degrees_of_freedom=degrees,
        widening=widening,
        searches=tuple(searches),
        doubt=doubt_of(
            method,
            residuals,
            degrees,
            lags,
            is_of_series=all(block.is_series for block in problem.data_blocks),
        ),
        warnings=(*warnings, *by_data.words),
    )


def _covariance_in_sizes(problem: Problem, jacobian: np.ndarray) -> np.ndarray:
    """Compute the covariance of the coordinates in units of their sizes, in which it is inverted.

    In these units, all unknowns are of the same order, and rounding errors are told from what is
    seen. What is not seen at all has no covariance here.
    """
    scaled = jacobian * problem.sizes
    return invert_information(scaled.T @ scaled)


def _covariance_of_coordinates(
    problem: Problem, in_sizes: np.ndarray, identifiability: Identifiability
) -> np.ndarray:
    """Return the covariance in the units of the coordinates; inf where nothing is known."""
    covariance = in_sizes * np.outer(problem.sizes, problem.sizes)
    is_unknown = ~np.isfinite(identifiability.deviations)
    covariance[is_unknown, :] = np.inf
    covariance[:, is_unknown] = np.inf
    return covariance


def _correlations(covariance: np.ndarray, identifiability: Identifiability) -> np.ndarray:
    """Return the correlations of the coordinates; nan for unknowns that are not identified."""
    with np.errstate(divide="ignore", invalid="ignore"):
        deviation = np.sqrt(np.diag(covariance))
        correlations = covariance / np.outer(deviation, deviation)
    correlations = np.clip(correlations, -1.0, 1.0)  # 1 + 1e-16 is a rounding error
    is_not_identified = identifiability.deviations >= identifiability.limit
    correlations[is_not_identified, :] = np.nan
    correlations[:, is_not_identified] = np.nan
    return correlations


def _estimate(
    unknown: ResolvedUnknown, k: int, value: float, uncertainty: _Uncertainty
) -> ParameterEstimate:
    """Return the estimate of unknown k."""
    relative_deviation = float(uncertainty.widening[k]) * float(
        uncertainty.by_data_and_priors.deviations[k]
    )
    is_identified = relative_deviation < uncertainty.by_data_and_priors.limit
    notes = [
        _note_on_data(unknown, k, is_identified, uncertainty),
        _note_on_prior(unknown, value, relative_deviation),
        *_notes_on_range(unknown, value),
    ]
    sigma = None
    interval = None
    if is_identified:
        x = unknown.x(value)
        deviation = relative_deviation * unknown.size
        half_width = uncertainty.quantile * deviation
        interval = (unknown.value(x - half_width), unknown.value(x + half_width))
        sigma = deviation * unknown.slope(value)
    return ParameterEstimate(
        name=unknown.name,
        unit=unknown.parameter.unit,
        title=unknown.parameter.title,
        value=value,
        sigma=sigma,
        interval=interval,
        note="; ".join(note for note in notes if note),
    )


def _note_on_data(
    unknown: ResolvedUnknown, k: int, is_identified: bool, uncertainty: _Uncertainty
) -> str:
    """Return what the data do not tell about unknown k; "" if they tell enough."""
    by_data = uncertainty.by_data
    if unknown.name in by_data.without_effect:
        return "has no effect on what was measured"
    if float(uncertainty.widening[k]) * float(by_data.deviations[k]) < by_data.limit:
        return ""

    def spread_of_unknown(direction: Direction) -> float:
        """Return by how much the unknown moves along one deviation of a direction."""
        return abs(direction.weights[k]) * min(direction.deviation, _UNSEEN)

    takes_part_in = [
        direction for direction in by_data.directions if abs(direction.weights[k]) > _TAKES_PART
    ]
    worst = max(takes_part_in, key=spread_of_unknown)
    if is_identified:
        return f"the data do not see {worst.name}"
    return f"not identifiable: the data do not see {worst.name}"


def _note_on_prior(unknown: ResolvedUnknown, value: float, relative_deviation: float) -> str:
    """Return whether an unknown is hardly better known than by its prior; "" if it is."""
    sigma = relative_deviation * unknown.size * unknown.slope(value)
    if unknown.is_known_from_prior(sigma):
        return "known from the prior rather than from the data"
    return ""


def _notes_on_range(unknown: ResolvedUnknown, value: float) -> list[str]:
    """Return at which end of its range an unknown is, if it is at one."""
    reach = _AT_END
    if not unknown.is_log:
        reach = _AT_END * unknown.size
    notes: list[str] = []
    for end, end_name in ((unknown.lower, "lower"), (unknown.upper, "upper")):
        if math.isfinite(end) and abs(unknown.x(end) - unknown.x(value)) <= reach:
            notes.append(f"at the {end_name} end of its range")
    return notes
