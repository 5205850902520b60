"""A search for one objective that knows the slopes of its objective and of its limits.

From the best point it solves a quadratic program: the loss to second order (its curvature by BFGS) has to
fall as far as it can, while every limit, to first order, is respected and no number changes by more than
a *radius* (sequential quadratic programming; Nocedal and Wright, Numerical Optimization, 2006, ch. 18).
Several radii are tried at once. Limits bend, so that a step along one of them ends beyond it: some of the
points keep a distance from the limits, which grows with the square of the radius and is learned from the
points that were tried. Where nothing helps any more, an evolution explores from there.
"""

from dataclasses import replace
from typing import NamedTuple, Protocol, TypeAlias, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float

from laticauda.studies.cma_search import CmaSearch
from laticauda.studies.local_model import LocalModel
from laticauda.studies.point_search import Losses, PointSearch, Violation
from laticauda.studies.quadratic import solve_quadratic
from laticauda.studies.sampling import Table
from laticauda.studies.slopes import PointSlope

Point: TypeAlias = Float[np.ndarray, " n_names"]


@runtime_checkable
class Problem(Protocol):
    """What a search asks about its problem, besides the results of points."""

    @property
    def model_cost(self) -> int:
        """Trials that one local model costs."""
        ...

    @property
    def is_stepped(self) -> Bool[np.ndarray, " n_names"]:
        """Whether each number is counted in steps."""
        ...

    def model_at(self, point: Point) -> LocalModel | None:
        """Return what loss and limits depend on near a point; None if nothing is known there."""
        ...

    def exceed_exactly(self, point: Point) -> Float[np.ndarray, " n_exact"]:
        """Return by how much a point exceeds those limits that need no trial, the last ones of a model."""
        ...

    def round_steps(self, points: Table) -> Table:
        """Return points with those numbers rounded that are counted in steps."""
        ...


FIRST_RADIUS = 0.1
"""Radius of the first step, as a share of every number's range [-]."""
LARGEST_RADIUS = 0.5
"""Largest radius, likewise [-]."""
EXPLORED_DEVIATION = 0.01
"""Standard deviation of the points that explore, likewise [-]."""
LEAST_RADIUS = 1e-5
"""Radius below which the search explores instead, likewise [-]."""
N_RADII = 4
"""Radii that are tried at once, each half of the one before."""
DISTANCES_FROM_LIMITS = (1.0, 0.25)
"""Distances from the limits with which each radius is tried, as shares of the one that was learned [-]."""
FORGETTING = 0.7
"""Factor of that distance after points that all were feasible [-]."""
FIRST_BEND = 0.1
"""Excess of a limit per radius squared before any is known [-]."""
MOST_CUTS = 3
"""Most refused points whose limits are added at one point."""
LARGEST_BEND = 1e3
"""Largest excess of a limit per radius squared that is believed [-]."""
LEAST_GAIN = 1e-4
"""Gain, as a share of the loss, below which the search explores before it goes on [-]."""
N_CORRECTIONS = 4
"""Most corrections of a point by what it exceeds of those limits that need no trial."""
EXACT_DISTANCE = 1e-7
"""Distance from those limits [-]."""
LEAST_CURVATURE = 1e-8
"""Curvature below which two slopes say nothing about it, relative to their sizes [-]."""


class TriedPoint(NamedTuple):
    """A point that was tried, as shares of the ranges."""

    point: Point
    violation: float
    """0 if it is feasible, otherwise how far it is from being so."""
    loss: float
    """Loss (smaller is better)."""

    def is_better(self, best: "TriedPoint | None") -> bool:
        """Return whether it is nearer to being feasible than the best one before, or as near and better."""
        if best is None:
            return True
        return (self.violation, self.loss) < (best.violation, best.loss)


class _Steps(NamedTuple):
    """Points that are tried along directions from the best one."""

    points: Table
    """The points, as shares of the ranges."""
    radii: Float[np.ndarray, " n"]
    """Largest change of a number on the way to each, as a share of its range [-]."""
    distances: Float[np.ndarray, " n"]
    """By how much each stays below the limits to first order [-]."""


class LimitedSearch(PointSearch):
    """A search for one objective whose slopes and limits are known.

    Args:
        start: Point with which it begins.
        problem: The problem.
        low: Smallest value of every parameter.
        high: Largest value of every parameter.
        seed: Seed of the evolution.
    """

    def __init__(
        self,
        start: Point,
        problem: Problem,
        low: Point,
        high: Point,
        *,
        seed: int,
    ) -> None:
        self._problem = problem
        self._low = low
        self._high = high
        self._range = high - low
        self._seed = seed
        self._evolution: CmaSearch | None = None
        """Evolution around the best point, while the search explores."""
        self._first: Table | None = start[np.newaxis]
        self._best: TriedPoint | None = None
        self._model: LocalModel | None = None
        """Local model at the best point, once it is known."""
        self._refused: Point | None = None
        """Point that was refused although the local model allows it, as shares; None if there is none."""
        self._n_cuts = 0
        """Points whose limits were added to the local model."""
        self._is_exploring = False
        self._asked: Table = np.empty((0, low.size))
        self._steps: _Steps | None = None
        self._radius = FIRST_RADIUS
        self._bend = FIRST_BEND
        self._curvature = _Curvature(low.size)

    def ask(self) -> Table:
        """Return the next points to try."""
        self._steps = None
        if self._first is not None:
            self._asked = self._first
            self._first = None
            return self._asked
        if not self._is_exploring and self._radius >= LEAST_RADIUS:
            self._steps = self._points_within_limits()
        if self._steps is not None:
            self._asked = self._low + self._range * self._steps.points
        else:
            self._asked = self._explore()
        return self._asked

    def _explore(self) -> Table:
        """Return points around the best one."""
        if self._evolution is None:
            assert self._best is not None
            best = self._low + self._range * self._best.point
            self._evolution = CmaSearch(
                best, self._low, self._high, deviation=EXPLORED_DEVIATION, seed=self._seed
            )
        return self._evolution.ask()

    def _learn(self, losses: Losses, violation: Violation) -> None:
        before = self._best
        best = self._best_of(losses[:, 0], violation)
        improves = best.is_better(before)
        if improves:
            self._best = best
            self._model = None
            self._refused = None
            self._n_cuts = 0
        if self._steps is not None:
            self._learn_from_steps(self._steps, violation, best, before, improves=improves)
        elif self._evolution is not None:
            self._evolution.tell(losses, violation)
            self._is_exploring = False
            if improves:
                self._curvature.forget()
            if improves or self._radius < LEAST_RADIUS:
                self._radius = FIRST_RADIUS
                self._bend = FIRST_BEND

    def _best_of(self, losses: np.ndarray, violation: np.ndarray) -> TriedPoint:
        """Return the best of the points that were asked last."""
        order = np.lexsort((losses, violation))
        i = int(order[0])
        shares = (self._asked[i] - self._low) / self._range
        return TriedPoint(shares, float(violation[i]), float(losses[i]))

    def _learn_from_steps(
        self,
        steps: _Steps,
        violation: np.ndarray,
        best: TriedPoint,
        before: TriedPoint | None,
        *,
        improves: bool,
    ) -> None:
        """Adapt the radius, and the distance from the limits."""
        is_beyond = violation > 0.0
        if np.any(is_beyond):
            bends = (violation + steps.distances) / steps.radii**2
            shortest = np.flatnonzero(is_beyond)[-1]
            self._bend = min(float(bends[shortest]), LARGEST_BEND)
        else:
            self._bend *= FORGETTING
        if not improves:
            self._radius = 0.5 * float(steps.radii.min())
            if np.any(is_beyond):
                self._refused = steps.points[np.flatnonzero(is_beyond)[-1]]
            return
        step_to_best = int(np.argmin(np.linalg.norm(steps.points - best.point, axis=1)))
        self._radius = min(2.0 * float(steps.radii[step_to_best]), LARGEST_RADIUS)
        self._evolution = None
        if before is not None and before.violation == 0.0:
            gain = before.loss - best.loss
            self._is_exploring = gain < LEAST_GAIN * abs(best.loss)

    def _points_within_limits(self) -> _Steps | None:
        """Return the solutions of the quadratic programs of several radii; None if nothing is known."""
        assert self._best is not None
        point = self._best.point
        model = self._model
        if model is None:
            model = self._model_of(point)
            if model is None:
                return None
            self._curvature.learn(point, model.slope)
        elif self._refused is not None and self._n_cuts < MOST_CUTS:
            model = self._with_limits_of(self._refused, model)
            self._n_cuts += 1
        self._refused = None
        self._model = model
        points: list[Point] = []
        radii: list[float] = []
        distances: list[float] = []
        for halving in range(N_RADII):
            radius = self._radius * 0.5**halving
            for share in DISTANCES_FROM_LIMITS:
                distance = share * self._bend * radius**2
                points.append(self._solve(point, model, radius, distance))
                radii.append(radius)
                distances.append(distance)
        return _Steps(np.array(points), np.array(radii), np.array(distances))

    def _model_of(self, point: Point) -> LocalModel | None:
        """Return the local model at a point, all numbers as shares of their ranges."""
        self.n_slope_trials += self._problem.model_cost
        model = self._problem.model_at(self._from_shares(point))
        if model is None:
            return None
        return replace(
            model,
            slope=model.slope * self._range,
            excess_slopes=model.excess_slopes * self._range,
        )

    def _with_limits_of(self, refused: Point, model: LocalModel) -> LocalModel:
        """Return a local model that also has the limits near a point that was refused.

        The largest of several peaks has a kink where they are equal, and only one of its two slopes
        is known from either side.
        """
        assert self._best is not None
        refused_model = self._model_of(refused)
        if refused_model is None:
            return model
        n_swim = refused_model.excess.size - refused_model.n_exact
        slopes = refused_model.excess_slopes[:n_swim]
        excess = refused_model.excess[:n_swim] + slopes @ (self._best.point - refused)
        return replace(
            model,
            excess=np.concatenate((excess, model.excess)),
            excess_slopes=np.concatenate((slopes, model.excess_slopes)),
        )

    def _solve(self, point: Point, model: LocalModel, radius: float, distance: float) -> Point:
        """Return the best point within a radius, as far as the local model tells it."""
        least = np.maximum(-radius, -point)
        most = np.minimum(radius, 1.0 - point)
        n_exact = model.n_exact
        margins = np.full(model.excess.size, distance)
        margins[margins.size - n_exact :] = EXACT_DISTANCE
        excess = model.excess + margins
        change = self._solve_program(model, excess, least, most)
        if np.any(self._problem.is_stepped):
            in_steps = self._problem.round_steps(self._from_shares(point + change)[np.newaxis])[0]
            rounded = (in_steps - self._low) / self._range - point
            least = np.where(self._problem.is_stepped, rounded, least)
            most = np.where(self._problem.is_stepped, rounded, most)
            change = self._solve_program(model, excess, least, most)
        if n_exact == 0:
            return np.clip(point + change, 0.0, 1.0)
        for _ in range(N_CORRECTIONS):
            exact = self._problem.exceed_exactly(self._from_shares(point + change))
            if np.all(exact <= 0.0):
                break
            bent = exact - model.excess_slopes[-n_exact:] @ change
            excess[-n_exact:] = bent + EXACT_DISTANCE
            change = self._solve_program(model, excess, least, most)
        return np.clip(point + change, 0.0, 1.0)

    def _solve_program(
        self, model: LocalModel, excess: np.ndarray, least: Point, most: Point
    ) -> Point:
        """Return the solution of the quadratic program of a local model."""
        curvature = self._curvature.matrix
        return solve_quadratic(model.slope, curvature, excess, model.excess_slopes, least, most)

    def _from_shares(self, shares: Point) -> Point:
        """Return a point whose numbers are given as shares of their ranges."""
        return self._low + self._range * np.clip(shares, 0.0, 1.0)


class _Curvature:
    """Curvature of the loss, as far as its slopes at the best points so far tell it (BFGS)."""

    def __init__(self, size: int) -> None:
        self._size = size
        self.forget()

    def forget(self) -> None:
        """Begin anew at another point."""
        self.matrix: np.ndarray = np.zeros((self._size, self._size))
        self._last: PointSlope | None = None

    def learn(self, point: Point, slope: Point) -> None:
        """Improve the curvature by the change of the slope since the last point.

        Args:
            point: The point, as shares of the ranges.
            slope: Slope of the loss there.
        """
        last = self._last
        self._last = PointSlope(point, slope)
        if last is None:
            return
        change = last.change_to(self._last)
        if change.curvature <= LEAST_CURVATURE * change.largest_curvature:
            return
        step = change.step
        turn = change.turn
        matrix = self.matrix
        if not np.any(matrix):
            matrix = change.curvature / float(step @ step) * np.eye(self._size)
        bent = matrix @ step
        added = np.outer(turn, turn) / change.curvature
        removed = np.outer(bent, bent) / float(step @ bent)
        self.matrix = matrix + added - removed
