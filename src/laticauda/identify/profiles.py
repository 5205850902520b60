"""Intervals from profile likelihoods: how far one unknown can go while all others are refitted."""

import math
from dataclasses import dataclass

import numpy as np

from laticauda.identify.local_search import all_residuals, minimize
from laticauda.identify.method import cost_of
from laticauda.identify.result import Fit
from laticauda.values import check_choice, optional_import

_CLOSE = 1e-3
"""Relative accuracy of the distance to an end [-]."""
_FAR = 1e3
"""Sizes beyond which no end is searched for, and rise that stands for an infinite one [-]."""
_FIRST_STEP = 0.5
"""First step along a direction without curvature, in sizes [-]."""

Ends = tuple[float | None, float | None]
"""Ends of an interval; None: every value up to the end of its range describes the data as well."""


def profile_interval(fit: Fit, name: str) -> Ends:
    """Return the interval of one unknown with a sum of squares less than q^2 above its minimum.

    q is the quantile used for the fit's own intervals. Where the model is far from linear within
    the uncertainty, the coverage of this interval is more accurate than that of the interval from
    the covariance. It costs about ten searches, because all other unknowns are refitted at its
    ends.

    Args:
        fit: The fit.
        name: Name of the unknown.

    Raises:
        ValueError: If there is no such unknown.
    """
    names = fit.problem.names
    k = names.index(check_choice("name", name, names))
    return _find_end(fit, k, -1.0), _find_end(fit, k, 1.0)


@dataclass(kw_only=True, eq=False)
class _Profile:
    """The rise of the sum of squares along one unknown, with all others refitted."""

    fit: Fit
    k: int
    """Index of the unknown."""
    sign: float
    """1 to go to larger coordinates, -1 to smaller ones."""
    quantile: float
    """Half-width of the interval in standard deviations, widened by correlated noise [-]."""
    least_cost: float
    """Sum of squares of the fit."""
    coordinates: np.ndarray
    """Where the last refit ended, and the next one begins."""

    def missing_rise(self, step: float) -> float:
        """Return by how much the root of the rise at a step from the fit exceeds the quantile."""
        is_profiled = np.arange(self.coordinates.size) == self.k
        profiled_coordinate = self.fit.x + self.sign * step
        self.coordinates = np.where(is_profiled, profiled_coordinate, self.coordinates)
        free = np.flatnonzero(~is_profiled)
        if free.size:
            refit = minimize(
                self.fit.problem,
                self.coordinates,
                loss=self.fit.method.loss,
                factor=self.fit.used_noise_factor,
                free=free,
            )
            self.coordinates = refit.end
        cost = sum_of_squares(self.fit, self.coordinates)
        if not math.isfinite(cost):
            return _FAR - self.quantile
        rise = math.sqrt(max(cost - self.least_cost, 0.0))
        return min(rise, _FAR) - self.quantile


def _find_end(fit: Fit, k: int, sign: float) -> float | None:
    """Find one end of the interval: where the root of the rise equals the quantile."""
    optimize = optional_import("Identification", "scipy", "identify", "scipy.optimize")
    x = fit.x
    unknown = fit.problem.unknowns[k]
    quantile = fit.method.quantile(fit.degrees_of_freedom) * float(fit.widening[k])
    profile = _Profile(
        fit=fit,
        k=k,
        sign=sign,
        quantile=quantile,
        least_cost=sum_of_squares(fit, x),
        coordinates=x,
    )
    lower_end, upper_end = unknown.ends
    end_of_range = upper_end if sign > 0.0 else lower_end
    longest_step = min(abs(end_of_range - x[k]), _FAR * unknown.size)
    deviation = math.sqrt(fit.covariance[k, k])
    step = _FIRST_STEP * unknown.size
    if math.isfinite(deviation) and deviation > 0.0:
        step = quantile * deviation
    step = min(step, longest_step)
    while profile.missing_rise(step) < 0.0:
        if step >= longest_step:
            return None
        step = min(2.0 * step, longest_step)
    distance = optimize.brentq(profile.missing_rise, 0.0, step, rtol=_CLOSE, xtol=_CLOSE * step)
    return unknown.value(x[k] + sign * distance)


def sum_of_squares(fit: Fit, x: np.ndarray) -> float:
    """Compute the sum of squares of data and priors, in the noise that the fit used.

    Args:
        fit: The fit.
        x: Coordinates of the unknowns.
    """
    values = fit.problem.values_of(x)
    residuals = all_residuals(fit.problem, values, fit.used_noise_factor)
    n_data = fit.problem.observed.size
    loss = fit.method.loss
    return cost_of(residuals[:n_data], loss) + cost_of(residuals[n_data:], loss)
