"""Where searches begin, and when enough of them have come to the same minimum.

A sum of squares may have several minima. Searches therefore begin at points that are spread over
the whole range of every unknown: evenly in its coordinate, so a number on a log scale is spread
log-uniformly. A point in a sequence without gaps (Halton's, with a random shift) is only a
candidate; of each `CANDIDATES` successive ones, the one with the least sum of squares is a start.
That costs less than one search, and keeps starts away from where the model does not depend on an
unknown, such as a speed limit that no joint reaches: searches that begin there end there, and agree
on a wrong minimum.

No further start is needed when two have reached the best sum of squares, provided that the stated
noise can leave as much. If it cannot, the minimum may be a wrong one, and four have to reach it.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from laticauda.identify.chi2 import usual_chi2
from laticauda.identify.local_search import LocalSearch, Vector, all_residuals
from laticauda.identify.method import Method, cost_of
from laticauda.identify.problem import Problem
from laticauda.identify.unknowns import ResolvedUnknown
from laticauda.values import optional_import

CANDIDATES = 8
"""Points of which the best is a start."""
PRIOR_REACH = 2.0
"""Starts lie within this many standard deviations of a prior [-]."""
ENOUGH = 2
"""Number of starts that must reach the best sum of squares."""
ENOUGH_IF_BAD = 4
"""The same if the stated noise cannot leave as much: the minimum may be a wrong one."""
_SAME_MINIMUM = 0.01
"""Difference of sums of squares that is no other minimum, per square of the noise factor [-]."""


def spread_starts(problem: Problem, method: Method, first: Vector) -> Iterator[Vector]:
    """Yield the first start, then others, at all of which the measurements can be simulated.

    Fewer than `method.n_starts` come if some points cannot be simulated. The first one is not
    tried here.

    Args:
        problem: Measurements and unknowns.
        method: Number of starts, seed and loss.
        first: Coordinates of the first start.
    """
    yield first
    n_others = method.n_starts - 1
    if n_others == 0:
        return
    candidates = _spread_points(problem, method, first, n_others * CANDIDATES)
    for batch in np.split(candidates, n_others):
        best = _best_of(problem, method, batch)
        if best is not None:
            yield best


def _best_of(problem: Problem, method: Method, batch: np.ndarray) -> Vector | None:
    """Return the point with the least sum of squares; None if none can be simulated."""
    best: Vector | None = None
    least_cost = np.inf
    for x in batch:
        with np.errstate(all="ignore"):  # far from the truth, runs may diverge
            residuals = all_residuals(problem, problem.values_of(x))
            cost = cost_of(residuals, method.loss, n_priors=problem.n_priors)
        if cost < least_cost:
            best = x
            least_cost = cost
    return best


def _spread_points(problem: Problem, method: Method, first: Vector, n_points: int) -> np.ndarray:
    """Return points that are spread over the ranges.

    Where a trial began stays as at the first start: its first sample tells it well.
    """
    qmc = optional_import("Identification", "scipy", "identify", "scipy.stats.qmc")
    points = np.tile(first, (n_points, 1))
    spread = problem.of_interest
    if not spread:
        return points
    shares = qmc.Halton(len(spread), scramble=True, seed=method.seed).random(n_points)
    for column, k in enumerate(spread):
        low, high = _reach_of_starts(problem.unknowns[k], float(first[k]))
        points[:, k] = low + (high - low) * shares[:, column]
    return points


def _reach_of_starts(unknown: ResolvedUnknown, center: float) -> tuple[float, float]:
    """Return the coordinates between which an unknown may start."""
    lower_end, upper_end = unknown.ends
    if unknown.prior is not None:
        reach = PRIOR_REACH * unknown.prior.sd
        low = unknown.prior.mean - reach
        high = unknown.prior.mean + reach
        low, high = max(low, unknown.lower), min(high, unknown.upper)
        if low < high and not (unknown.is_log and low <= 0.0):
            return unknown.x(low), unknown.x(high)
        if unknown.is_log and low < high:
            return max(lower_end, center - 1.0), unknown.x(high)
    low = lower_end if np.isfinite(lower_end) else center - unknown.size
    high = upper_end if np.isfinite(upper_end) else center + unknown.size
    return low, high


def has_reached(cost: float, least_cost: float, n_data: int) -> bool:
    """Return whether a search ended in the best minimum, by its sum of squares.

    Args:
        cost: Sum of squares of the search.
        least_cost: Sum of squares of the best search.
        n_data: Number of measured numbers.
    """
    return abs(cost - least_cost) <= _SAME_MINIMUM * max(1.0, least_cost / n_data)


def count_reaching(problem: Problem, searches: Sequence[LocalSearch]) -> int:
    """Return how many searches ended as well as the best one.

    Args:
        problem: Measurements and unknowns.
        searches: At least one search, in any order.
    """
    least_cost = min(search.cost for search in searches)
    n_data = problem.observed.size
    return sum(has_reached(search.cost, least_cost, n_data) for search in searches)


def is_settled(problem: Problem, searches: Sequence[LocalSearch]) -> bool:
    """Return whether no further start is needed.

    Args:
        problem: Measurements and unknowns.
        searches: The searches so far.
    """
    if len(searches) < ENOUGH:
        return False
    n_reaching = count_reaching(problem, searches)
    if n_reaching < ENOUGH:
        return False
    degrees = problem.observed.size - len(problem.unknowns) + problem.n_priors
    least_cost = min(search.cost for search in searches)
    is_usual = least_cost <= usual_chi2(max(degrees, 1), {}).high
    return is_usual or n_reaching >= ENOUGH_IF_BAD
