"""Warnings of a fit: what is unusual, though not invalid, about its data and residuals.

A new warning is one more function that returns a sentence, or "" if there is nothing to warn of.
"""

from collections.abc import Mapping
from typing import NamedTuple

from laticauda.identify.problem import Problem
from laticauda.values import optional_import

_RARE = 5e-4
"""Probability that chi^2 is below its range, and that it is above [-]."""


def list_warnings(
    problem: Problem,
    chi2: float | None,
    degrees: float,
    lags: Mapping[str, float],
    widening: float,
) -> list[str]:
    """Return a sentence for everything unusual, though not invalid, about data and fit.

    Args:
        problem: Measurements and unknowns.
        chi2: Chi^2 of data and priors in the stated noise; None if that is not to be judged, because
            the noise is estimated [-].
        degrees: Degrees of freedom [-].
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
        widening: Largest factor by which this correlation widens an interval [-].
    """
    warnings = (
        _warn_of_chi2(chi2, degrees, lags),
        _warn_of_correlation(lags, widening),
        _warn_of_missing_coast_down(problem),
        _warn_of_repetitions(problem),
    )
    return [warning for warning in warnings if warning]


def _warn_of_chi2(chi2: float | None, degrees: float, lags: Mapping[str, float]) -> str:
    """Return a warning if the residuals do not fit the stated noise; "" if they do."""
    if chi2 is None or degrees <= 0.0:
        return ""
    usual = _usual_chi2(degrees, lags)
    if usual.low <= chi2 <= usual.high:
        return ""
    return (
        f"chi^2 out of range: {chi2:.4g} at {degrees:.0f} degrees of freedom, where the stated "
        f"noise gives {usual.low:.4g} to {usual.high:.4g} in 99.9 % of all cases: "
        "it or the model is wrong, and so are the intervals."
    )


class _Chi2Range(NamedTuple):
    """Range of chi^2 that the stated noise leaves only rarely."""

    low: float
    high: float


def _usual_chi2(degrees: float, lags: Mapping[str, float]) -> _Chi2Range:
    """Return the range of chi^2 that the stated noise leaves only rarely.

    If neighboring samples share their noise, chi^2 scatters as for a fraction of the numbers.
    """
    special = optional_import("Identification", "scipy", "identify", "scipy.special")
    square = max(lags.values(), default=0.0) ** 2
    independent_share = (1.0 - square) / (1.0 + square)
    half_degrees = 0.5 * independent_share * max(degrees, 1.0)
    # Chi^2 of n numbers is twice a gamma-distributed number of shape n/2.
    half_low = special.gammaincinv(half_degrees, _RARE)
    half_high = special.gammaincinv(half_degrees, 1.0 - _RARE)
    return _Chi2Range(
        low=2.0 * half_low / independent_share, high=2.0 * half_high / independent_share
    )


def _warn_of_correlation(lags: Mapping[str, float], widening: float) -> str:
    """Return a warning if neighboring residuals are correlated; "" if they are not."""
    if not lags:
        return ""
    correlations = ", ".join(f"{lag:.2f} ({name})" for name, lag in lags.items())
    return (
        "correlated residuals: the noise has a sample-to-sample correlation of "
        f"{correlations}, which widens intervals by a factor of up to {widening:.2g}."
    )


def _warn_of_missing_coast_down(problem: Problem) -> str:
    """Return a warning if friction is identified from swimming alone; "" if it is not."""
    frictions = [
        unknown.name
        for unknown in problem.unknowns
        if unknown.parameter.name.endswith("tangential_friction")
    ]
    if not frictions or any(measurement.coasts for measurement in problem.measurements):
        return ""
    return (
        f"no coast-down: `{frictions[0]}` makes up for any thrust or drag that the model "
        "lacks; it belongs to the water only if a straight coasting robot is among the data."
    )


def _warn_of_repetitions(problem: Problem) -> str:
    """Return a warning if all measurements are of the same gait and robot; "" if they are not."""
    if len(problem.scenarios) < 2:
        return ""
    settings = {
        (scenario.gait, scenario.robot.caudal_fin, scenario.environment)
        for scenario in problem.scenarios
    }
    if len(settings) > 1:
        return ""
    return (
        "All measurements are of the same gait with the same robot: "
        "they are one measurement, repeated."
    )
