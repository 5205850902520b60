"""Intervals from profile likelihoods: how far one unknown can go while all others are refitted."""

import math
from dataclasses import dataclass, field

import numpy as np

from laticauda.identify.local_search import all_residuals, minimize
from laticauda.identify.method import cost_of
from laticauda.identify.result import Fit
from laticauda.values import SimulationFailed, check_choice, optional_import

_ACCURACY = 1e-3
"""Relative accuracy of the distance to an end [-]."""
_FARTHEST_END = 1e3
"""Sizes of an unknown beyond which no end is searched for [-]."""
_LARGEST_RISE = 1e3
"""Standard deviations that stand for an infinite rise, so that it can be interpolated [-]."""
_FIRST_STEP = 0.5
"""First step along a direction without curvature, in sizes [-]."""

Ends = tuple[float | None, float | None]
"""Ends of an interval; None: every value up to the end of its range describes the data as well."""


def profile_interval(fit: Fit, name: str) -> Ends:
    """Return the interval of one unknown with a sum of squares less than q^2 above its minimum.

    q is the quantile used for the fit's own intervals. Where the model is far from linear within
    the uncertainty, the coverage of this interval is more accurate than that of the interval from
    the covariance. It costs about ten searches, because all other unknowns are refitted at its
    ends. It also ends where the measurements cannot be simulated any more.

    Args:
        fit: The fit.
        name: Name of the unknown.

    Raises:
        ValueError: If there is no such unknown.
    """
    names = fit.problem.names
    k = names.index(check_choice("name", name, names))
    return _find_end(fit, k, -1.0), _find_end(fit, k, 1.0)


def _find_end(fit: Fit, k: int, sign: float) -> float | None:
    """Find one end of the interval of unknown k: the step at which the refits are q off.

    Steps go outward, each twice as long as the last one, until one is outside. The end lies between
    it and the fit, which is inside.
    """
    optimize = optional_import("Identification", "scipy", "identify", "scipy.optimize")
    unknown = fit.problem.unknowns[k]
    profile = _Profile(
        fit=fit, k=k, sign=sign, least_cost=sum_of_squares(fit, fit.x), coordinates=fit.x
    )
    quantile = fit.method.quantile(fit.degrees_of_freedom) * float(fit.widening[k])

    def excess(step: float) -> float:
        """Return by how much a step is outside the interval; negative inside."""
        return profile.rise(step) - quantile

    longest_step = _longest_step(fit, k, sign)
    step = min(_first_step(fit, k, quantile), longest_step)
    while excess(step) < 0.0:
        if step >= longest_step:
            return None
        step = min(2.0 * step, longest_step)
    distance = optimize.brentq(excess, 0.0, step, rtol=_ACCURACY, xtol=_ACCURACY * step)
    return unknown.value(float(fit.x[k] + sign * distance))


def _longest_step(fit: Fit, k: int, sign: float) -> float:
    """Return the distance from the fit to the end of the range of unknown k, or to far away."""
    unknown = fit.problem.unknowns[k]
    lower_end, upper_end = unknown.ends
    end_of_range = lower_end
    if sign > 0.0:
        end_of_range = upper_end
    return min(abs(end_of_range - float(fit.x[k])), _FARTHEST_END * unknown.size)


def _first_step(fit: Fit, k: int, quantile: float) -> float:
    """Return how far the end of the interval of unknown k is by the covariance, if it tells."""
    deviation = math.sqrt(fit.covariance[k, k])
    if math.isfinite(deviation) and deviation > 0.0:
        return quantile * deviation
    return _FIRST_STEP * fit.problem.unknowns[k].size


@dataclass(kw_only=True, eq=False)
class _Profile:
    """The rise of the sum of squares along one unknown, with all others refitted.

    A refit may end in another minimum if it begins elsewhere. Each step is therefore refitted once,
    and its rise kept: what was inside or outside the interval remains so.
    """

    fit: Fit
    k: int
    """Index of the unknown."""
    sign: float
    """1 to go to larger coordinates, -1 to smaller ones."""
    least_cost: float
    """Sum of squares of the fit."""
    coordinates: np.ndarray
    """Where the last refit ended, and the next one begins."""
    known_rises: dict[float, float] = field(default_factory=lambda: {0.0: 0.0})
    """Rise by step; by definition, the fit itself has none."""

    def rise(self, step: float) -> float:
        """Return the root of the rise of the sum of squares at a step from the fit."""
        if step not in self.known_rises:
            rise = math.sqrt(max(self._cost_at(step) - self.least_cost, 0.0))
            self.known_rises[step] = min(rise, _LARGEST_RISE)
        return self.known_rises[step]

    def _cost_at(self, step: float) -> float:
        """Return the least sum of squares at a step; inf where nothing can be simulated."""
        start = self.coordinates.copy()
        start[self.k] = self.fit.x[self.k] + self.sign * step
        try:
            end = self._refit(start)
        except SimulationFailed:
            return math.inf
        cost = sum_of_squares(self.fit, end)
        if not math.isfinite(cost):
            return math.inf
        self.coordinates = end
        return cost

    def _refit(self, start: np.ndarray) -> np.ndarray:
        """Return the coordinates after a search for all unknowns but the profiled one."""
        free = np.delete(np.arange(start.size), self.k)
        if free.size == 0:
            return start
        refit = minimize(
            self.fit.problem,
            start,
            loss=self.fit.method.loss,
            factor=self.fit.used_noise_factor,
            free=free,
        )
        return refit.end


def sum_of_squares(fit: Fit, x: np.ndarray) -> float:
    """Compute what the fit minimized: the sum over data and priors, in the noise that it used.

    With a robust loss, it is not a sum of squares but of rho(r^2) (see `laticauda.identify.method`).

    Args:
        fit: The fit.
        x: Coordinates of the unknowns.
    """
    values = fit.problem.values_of(x)
    residuals = all_residuals(fit.problem, values, fit.used_noise_factor)
    return cost_of(residuals, fit.method.loss, n_priors=fit.problem.n_priors)
