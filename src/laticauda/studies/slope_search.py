"""A search for one objective that knows its slopes: from the best point it goes downhill, else it explores.

Differential evolution learns only from comparing points, which takes many of them where many numbers
vary. Here the best point is improved by a quasi-Newton method (BFGS, on the numbers that are free to
move within the bounds; Nocedal and Wright, Numerical Optimization, 2006, chs. 6 and 16): its slope
gives a direction, and points at several distances along it are tried at once. While this helps, it
goes on; otherwise follows another generation of the evolution, into whose population the best point
has gone. A point that is not feasible is never taken: near a limit, the shorter distances remain.
"""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from jaxtyping import Bool, Float

from laticauda.studies.point_search import Losses, PointSearch, Violation
from laticauda.studies.sampling import Table
from laticauda.studies.search import Search
from laticauda.studies.slopes import PointSlope, SlopeChange

Point: TypeAlias = Float[np.ndarray, " n_names"]
Slope: TypeAlias = Callable[[Point], Point | None]
"""Returns the derivatives of the loss with respect to all parameters at a point; None if there are none."""

N_DISTANCES = 8
"""Points that are tried along a direction: as many as the kernel computes side by side."""
FIRST_DISTANCE = 0.25
"""Longest distance along the first slope, as a share of the range of the number that changes most [-]."""
LEAST_GAIN = 3e-3
"""Gain, as a share of the loss, below which a generation of the evolution comes before the next direction [-]."""
STEPS_OF_NEWTON = 2.0
"""Longest distance along later directions, in steps of the method [-]."""
LEAST_CURVATURE = 1e-10
"""Curvature below which two slopes say nothing about it [-]."""


class SlopeSearch(PointSearch):
    """A search for one objective whose slopes are known.

    Args:
        search: The evolution.
        slope: Returns the slopes of the loss.
        low: Smallest value of every parameter.
        high: Largest value of every parameter.
    """

    def __init__(self, search: Search, slope: Slope, low: Point, high: Point) -> None:
        self._search = search
        self._slope = slope
        self._low = low
        self._range = high - low
        self._best: Point | None = None
        """Best feasible point, as shares of the ranges."""
        self._least_loss = np.inf
        self._is_descending = False
        """Whether the slope is followed from the best point next."""
        self._is_unfinished = False
        """Whether the slope from there has helped, if only a little."""
        self._asked_along_slope = False
        """Whether the points that were asked last lie along a direction."""
        self._asked: Table = np.empty((0, low.size))
        self._newton = _QuasiNewton(low.size)

    def ask(self) -> Table:
        """Return the next points to try."""
        points = self._points_along_slope()
        self._asked_along_slope = points is not None
        if points is None:
            points = self._search.ask()
        self._asked = points
        return points

    def _learn(self, losses: Losses, violation: Violation) -> None:
        if not self._asked_along_slope:
            self._search.tell(losses, violation)
            self._is_descending = self._is_unfinished
        feasible_losses = np.where(violation == 0.0, losses[:, 0], np.inf)
        best = int(np.argmin(feasible_losses))
        least_loss = float(feasible_losses[best])
        if least_loss < self._least_loss:
            self._take(self._asked[best], least_loss)

    def _take(self, point: Point, loss: float) -> None:
        """Take a point as the best one."""
        gain = self._least_loss - loss
        self._best = (point - self._low) / self._range
        self._least_loss = loss
        if self._asked_along_slope:
            self._search.insert(point, loss)
            self._is_descending = gain > LEAST_GAIN * abs(loss)
        else:
            self._newton.forget()
            self._is_descending = True
        self._is_unfinished = True

    def _points_along_slope(self) -> Table | None:
        """Return points along a direction downhill from the best one; None if there is none that is new."""
        if self._best is None or not self._is_descending:
            return None
        self._is_descending = False
        self._is_unfinished = False
        slope = self._slope(self._low + self._range * self._best)
        if slope is None:
            return None
        slope_of_share = slope * self._range
        change = self._newton.find_change(self._best, slope_of_share)
        if change is None:
            return None
        distances = 0.5 ** np.arange(N_DISTANCES)
        shares = self._best + np.outer(distances, change)
        within_bounds = np.clip(shares, 0.0, 1.0)
        return self._low + self._range * within_bounds


class _QuasiNewton:
    """Inverse of the loss's curvature, as far as its slopes at the best points so far tell it."""

    def __init__(self, size: int) -> None:
        self._size = size
        self.forget()

    def forget(self) -> None:
        """Begin anew at another point."""
        self._inverse: np.ndarray | None = None
        self._last: PointSlope | None = None

    def find_change(self, point: Point, slope: Point) -> Point | None:
        """Return the longest change to try from a point; None if the loss falls in no direction within the bounds.

        Args:
            point: The point, from 0 to 1.
            slope: Slope of the loss there.
        """
        self._learn(point, slope)
        is_held_below = (point <= 0.0) & (slope > 0.0)
        is_held_above = (point >= 1.0) & (slope < 0.0)
        is_free = ~(is_held_below | is_held_above)
        if not np.any(slope[is_free]):
            return None
        if self._inverse is not None:
            change = -self._newton_step(slope, is_free)
            if change @ slope < 0.0:
                return STEPS_OF_NEWTON * change
        steepest = np.where(is_free, -slope, 0.0)
        largest = np.abs(steepest).max()
        return FIRST_DISTANCE / largest * steepest

    def _newton_step(self, slope: Point, is_free: Bool[np.ndarray, " n_names"]) -> Point:
        """Return the step of the numbers that are free to move."""
        assert self._inverse is not None
        are_free = np.outer(is_free, is_free)
        inverse = np.where(are_free, self._inverse, 0.0)
        return inverse @ slope

    def _learn(self, point: Point, slope: Point) -> None:
        """Improve the inverse curvature by the change of the slope since the last point (BFGS)."""
        last = self._last
        self._last = PointSlope(point, slope)
        if last is None:
            return
        change = last.change_to(self._last)
        if change.curvature > LEAST_CURVATURE * change.largest_curvature:
            self._update(change)

    def _update(self, change: SlopeChange) -> None:
        step = change.step
        turn = change.turn
        curvature = change.curvature
        identity = np.eye(self._size)
        inverse = self._inverse
        if inverse is None:
            inverse = curvature / float(turn @ turn) * identity
        mixed = np.outer(step, turn)
        along_step = np.outer(step, step)
        projection = identity - mixed / curvature
        projected = projection @ inverse @ projection.T
        self._inverse = projected + along_step / curvature
