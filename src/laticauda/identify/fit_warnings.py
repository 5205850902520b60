"""Warnings of a fit: what is unusual, though not invalid, about its data and residuals."""

from collections.abc import Mapping

from laticauda.identify.problem import Problem
from laticauda.values import optional_import

_RARE = 5e-4
"""Probability that chi^2 is below its range, and that it is above [-]."""


def list_warnings(
    problem: Problem, chi2: float, degrees: float, lags: Mapping[str, float], widening: float
) -> list[str]:
    """Return a sentence for everything unusual, though not invalid, about data and fit.

    Args:
        problem: Measurements and unknowns.
        chi2: Chi^2 of data and priors, for the noise as stated; nan if that is estimated [-].
        degrees: Degrees of freedom [-].
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
        widening: Largest factor by which this correlation widens an interval [-].
    """
    warnings: list[str] = []
    low, high = _usual_chi2(degrees, lags)
    if degrees > 0.0 and (chi2 < low or chi2 > high):
        warnings.append(
            f"chi^2 out of range: {chi2:.4g} at {degrees:.0f} degrees of freedom, where the stated "
            f"noise gives {low:.4g} to {high:.4g} in 99.9 % of all cases: "
            "it or the model is wrong, and so are the intervals."
        )
    if lags:
        correlations = ", ".join(f"{lag:.2f} ({name})" for name, lag in lags.items())
        warnings.append(
            "correlated residuals: the noise has a sample-to-sample correlation of "
            f"{correlations}, which widens intervals by a factor of up to {widening:.2g}."
        )
    frictions = [
        unknown.name
        for unknown in problem.unknowns
        if unknown.parameter.name.endswith("tangential_friction")
    ]
    if frictions and not any(measurement.coasts for measurement in problem.measurements):
        warnings.append(
            f"no coast-down: `{frictions[0]}` makes up for any thrust or drag that the model "
            "lacks; it belongs to the water only if a straight coasting robot is among the data."
        )
    if len(problem.scenarios) > 1 and _are_repetitions(problem):
        warnings.append(
            "All measurements are of the same gait with the same robot: "
            "they are one measurement, repeated."
        )
    return warnings


def _usual_chi2(degrees: float, lags: Mapping[str, float]) -> tuple[float, float]:
    """Return the range of chi^2 that the stated noise leaves only rarely.

    If neighboring samples share their noise, chi^2 scatters as for a fraction of the numbers.
    """
    special = optional_import("Identification", "scipy", "identify", "scipy.special")
    square = max(lags.values(), default=0.0) ** 2
    independent_share = (1.0 - square) / (1.0 + square)
    half_degrees = 0.5 * independent_share * max(degrees, 1.0)
    low = 2.0 * special.gammaincinv(half_degrees, _RARE) / independent_share
    high = 2.0 * special.gammaincinv(half_degrees, 1.0 - _RARE) / independent_share
    return low, high


def _are_repetitions(problem: Problem) -> bool:
    settings = {
        (scenario.gait, scenario.robot.caudal_fin, scenario.environment)
        for scenario in problem.scenarios
    }
    return len(settings) == 1
