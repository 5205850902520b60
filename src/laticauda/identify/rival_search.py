"""Searches with rival laws: no further than it takes to tell whether one is clearly better.

A rival is the same problem in another water, and its best values are seldom far from those of the
fit. Its search therefore begins there, or at the values of robot and water if these describe the
data better. It ends

    - when one more step would gain less than `PRECISION` in chi^2, which no judgment needs, or
    - when `CAUTION` times what one more step gains would not bring it to where it matters: below the
      fit, and, if there is a better law already, to within `EVIDENCE` of that.

If the fit's own residuals are larger than the noise usually leaves, a rival that is no better may
have ended in a wrong minimum, and is given a second start.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice

import numpy as np

from laticauda.identify.chi2 import independent_share
from laticauda.identify.correlated_noise import noise_widening
from laticauda.identify.doubt import EVIDENCE, Doubt, is_usual, judge_residuals, residual_factor
from laticauda.identify.local_search import LocalSearch, Vector, all_residuals, minimize
from laticauda.identify.method import cost_of
from laticauda.identify.model import predict
from laticauda.identify.problem import Problem
from laticauda.identify.result import Fit
from laticauda.identify.rival_laws import RivalLaw, list_rival_laws
from laticauda.identify.starts import spread_starts
from laticauda.values import SimulationFailed

PRECISION = 0.05
"""Gain in chi^2 for which no further step of a rival is made [-]."""
CAUTION = 3.0
"""How many times what a linear model promises a search may gain, if it goes on [-]."""
_FIRST_STEPS = 2
"""Steps of a search that are made whatever the model promises."""
_STARTS = 2
"""Largest number of starts of a rival."""


def doubt_after_rivals(fit: Fit) -> Doubt | None:
    """Return the doubt of a fit after other laws have been fitted to its data.

    Args:
        fit: The fit.
    """
    if fit.degrees_of_freedom < 1.0:
        return fit.doubt
    contest = _Contest(fit=fit, doubt=fit.doubt or _judge_usual_residuals(fit))
    if contest.doubt.chi2 <= EVIDENCE:
        return fit.doubt  # no law can leave less by as much
    for rival in list_rival_laws(fit.problem):
        if rival.has_other_form and contest.is_explained:
            break
        contest.admit(rival)
    if fit.doubt is None and contest.doubt.better_law is None:
        return None
    return contest.doubt


def _judge_usual_residuals(fit: Fit) -> Doubt:
    """Return how large residuals are that the stated noise usually leaves."""
    problem = fit.problem
    residuals = (fit.predictions - problem.observed) / problem.sigma
    is_of_series = all(block.is_series for block in problem.data_blocks)
    return judge_residuals(
        fit.method, residuals, fit.degrees_of_freedom, {}, is_of_series=is_of_series
    )


@dataclass(kw_only=True, eq=False)
class _Contest:
    """The laws that were tried so far, and what the next one has to beat."""

    fit: Fit
    doubt: Doubt
    """The doubt of the fit with these laws."""
    values: dict[str, float] = field(default_factory=dict[str, float])
    """Values of the last law that was tried, by name."""
    best_cost: float = math.inf
    """Least sum of squares of a rival, in the noise of the searches."""

    @property
    def is_explained(self) -> bool:
        """Whether there is a law that needs no other form of the added mass."""
        return self.doubt.better_law is not None or self.doubt.factor <= self.doubt.usual_factor

    @property
    def noise_factor(self) -> float:
        """Factor on the stated noise: that of the fit, where the values depend on it."""
        method = self.fit.method
        if method.loss == "linear" and self.fit.problem.n_priors == 0:
            return 1.0
        return self.fit.used_noise_factor

    def admit(self, rival: RivalLaw) -> None:
        """Try one more law; one with which the data cannot be simulated is no better one."""
        search = self._search(rival)
        if search is None:
            return
        problem = rival.problem
        values = problem.values_of(search.end)
        residuals = (predict(problem, values).values - problem.observed) / problem.sigma
        if not np.all(np.isfinite(residuals)):
            return
        by_name = problem.values_by_name(search.end)
        self.values = by_name
        self.best_cost = min(self.best_cost, search.cost)
        handicap = 0.0
        if rival.fits_reference_speed:
            handicap = math.log(residuals.size)  # of Schwarz's criterion
        self.doubt = self.doubt.after_trying(
            rival.name_with(by_name),
            residual_factor(self.fit.method, residuals, self.doubt.degrees),
            self._share_of_independent(problem, search, residuals),
            handicap,
        )

    def _share_of_independent(
        self, problem: Problem, search: LocalSearch, residuals: np.ndarray
    ) -> float:
        """Return how many of a rival's residuals are independent, if that matters."""
        is_best = search.cost <= self.best_cost
        if not is_best or not any(block.is_series for block in problem.data_blocks):
            return 1.0
        _, lags = noise_widening(problem, search.jacobian, residuals, None)
        return independent_share(lags)

    def _search(self, rival: RivalLaw) -> LocalSearch | None:
        """Return the best search with a law; None if nothing can be simulated with it."""
        best: LocalSearch | None = None
        for start in islice(self._starts(rival), min(self.fit.method.n_starts, _STARTS)):
            search = self._search_from(rival.problem, start, best)
            if search is not None and (best is None or search.cost < best.cost):
                best = search
            if best is not None and (is_usual(self.doubt) or best.cost < self._own_cost):
                return best
        return best

    def _search_from(
        self, problem: Problem, start: Vector, earlier: LocalSearch | None
    ) -> LocalSearch | None:
        """Return a search from one start; None if nothing can be simulated there."""
        enough = None
        if self.fit.method.loss == "linear":
            enough = _Enough(
                cost_to_beat=self._cost_to_beat, precision=PRECISION / self.noise_factor**2
            )
        try:
            return minimize(
                problem,
                start,
                loss=self.fit.method.loss,
                factor=self.noise_factor,
                earlier_searches=[earlier] if earlier is not None else [],
                enough=enough,
            )
        except SimulationFailed:
            return None

    def _starts(self, rival: RivalLaw) -> Iterator[Vector]:
        """Yield the start near the fit, then one from points spread over the ranges."""
        problem = rival.problem
        near = self._start_near_fit(rival)
        yield near
        spread = spread_starts(problem, replace(self.fit.method, n_starts=_STARTS), near)
        yield from islice(spread, 1, None)

    def _start_near_fit(self, rival: RivalLaw) -> Vector:
        """Return the best of the values fitted so far, and of those of robot and water."""
        problem = rival.problem
        candidates: list[Mapping[str, float]] = [self.fit.values, {}]
        if rival.fits_reference_speed:
            candidates.append(self.values)
        points: list[Vector] = []
        for values in candidates:
            start = [values.get(unknown.name, unknown.start) for unknown in problem.unknowns]
            points.append(problem.coordinates_of(np.array(start)))
        return min(points, key=lambda x: self._cost_at(problem, x))

    def _cost_at(self, problem: Problem, x: Vector) -> float:
        """Return the sum of squares; inf where nothing can be simulated."""
        with np.errstate(all="ignore"):
            residuals = all_residuals(problem, problem.values_of(x), self.noise_factor)
        if not np.all(np.isfinite(residuals)):
            return math.inf
        return cost_of(residuals, self.fit.method.loss, n_priors=problem.n_priors)

    @cached_property
    def _own_cost(self) -> float:
        """Sum of squares of the fit itself, in the noise of the searches."""
        problem = self.fit.problem
        residuals = (self.fit.predictions - problem.observed) / (self.noise_factor * problem.sigma)
        of_priors = problem.prior_residuals(self.fit.best)
        return cost_of(
            np.concatenate([residuals, of_priors]),
            self.fit.method.loss,
            n_priors=problem.n_priors,
        )

    @property
    def _cost_to_beat(self) -> float:
        """Sum of squares beyond which a law is neither better than the fit nor named."""
        if self.best_cost >= self._own_cost:
            return self._own_cost
        per_degree = self.best_cost / self.doubt.degrees
        evidence = EVIDENCE * max(1.0 / self.noise_factor**2, per_degree)
        return min(self._own_cost, self.best_cost + evidence)


@dataclass(kw_only=True)
class _Enough:
    """Tells whether a rival's search need not go on."""

    cost_to_beat: float
    """Sum of squares beyond which the law does not matter."""
    precision: float
    """Gain for which no further step is made."""
    n_steps: int = 0

    def __call__(self, cost: float, promised_cost: float) -> bool:
        """Return whether no further step is needed.

        Args:
            cost: Sum of squares.
            promised_cost: What one more step would leave of it if the model were linear.
        """
        self.n_steps += 1
        gain = cost - promised_cost
        if gain < self.precision:
            return True
        return self.n_steps > _FIRST_STEPS and cost - CAUTION * gain > self.cost_to_beat
