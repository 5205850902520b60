"""Warnings of a fit: what is unusual, though not invalid, about its data and residuals.

A new warning is one more function that returns a sentence, or "" if there is nothing to warn of.
"""

from collections.abc import Mapping

from laticauda.identify.chi2 import usual_chi2
from laticauda.identify.problem import Problem


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
    usual = usual_chi2(degrees, lags)
    if usual.low <= chi2 <= usual.high:
        return ""
    return (
        f"chi^2 out of range: {chi2:.4g} at {degrees:.0f} degrees of freedom, where the stated "
        f"noise gives {usual.low:.4g} to {usual.high:.4g} in 99.9 % of all cases: "
        "it or the model is wrong, and so are the intervals."
    )


def _warn_of_correlation(lags: Mapping[str, float], widening: float) -> str:
    """Return a warning if neighboring residuals are correlated; "" if they are not."""
    if not lags:
        return ""
    correlations = ", ".join(f"{lag:.2f} ({name})" for name, lag in lags.items())
    return (
        f"correlated residuals: from sample to sample by {correlations}, by noise that is correlated "
        f"in time or an error of the model; intervals are wider for it, up to {widening:.2g} times."
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
