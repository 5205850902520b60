"""Smooth curve through points, parameterized by its arc length; independent of robots.

The curve is a natural cubic spline over centripetal knots (a parameter step is the square root of
the chord). Unlike a Catmull-Rom curve it has continuous curvature, so a robot that follows it need
not jump; the centripetal knots prevent overshoot between points at unequal distances; and its
curvature is zero at both ends, so that it continues as a straight line without a jump in curvature.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.values import BadArgument

Numbers = Float[np.ndarray, " n_points"]
Vectors = Float[np.ndarray, "n_points 2"]
Knots = Float[np.ndarray, " n_knots"]
Nodes = Float[np.ndarray, " n_nodes"]
Steps = Float[np.ndarray, " n_stretches"]
Cubics = Float[np.ndarray, "4 n_stretches 2"]

PIECES = 32
"""Pieces per stretch between two points: each is too short for two nearest points [-]."""
MOST_BISECTIONS = 60
"""Most steps of the search for a nearest point: enough to end by halving alone [-]."""
TOLERANCE = 1e-14
"""Change of u, per whole range of u, at which that search ends [-]."""
SLOWEST = 1e-6
"""Share of the largest |r'| below which the curve turns on the spot [-]."""
_GAUSS_POINTS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(5)


class Derivatives(NamedTuple):
    """Points of a curve, and their derivatives with respect to its parameter u."""

    points: Vectors
    """r [m]."""
    first: Vectors
    """r'."""
    second: Vectors
    """r''."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """Curve given by cubics in a parameter u, with its length at the ends of short pieces."""

    knots: Knots
    """u at the points the curve passes through."""
    cubics: Cubics
    """Coefficients in powers of u - knot for each stretch, lowest power first."""
    nodes: Nodes
    """u at the ends of the pieces."""
    corners: Float[np.ndarray, "n_nodes 2"]
    """Points at the nodes [m]."""
    lengths: Nodes
    """Length from the start to each node [m]."""

    def derivatives(self, u: Numbers) -> Derivatives:
        """Return the points at `u` and their first and second derivatives with respect to u."""
        return _evaluate(self.knots, self.cubics, u)

    def length(self, u: Numbers) -> Numbers:
        """Return the length from the start to `u` [m]."""
        # At the end, i is the last node: nothing is added, not even rounding, so points beyond it
        # are recognized.
        i = np.searchsorted(self.nodes, u, side="right") - 1
        return self.lengths[i] + _integrate_length(self.knots, self.cubics, self.nodes[i], u)

    def parameter(self, length: Numbers) -> Numbers:
        """Return u at a `length` between 0 and the whole length [m].

        Newton's method, started from the lengths at the nodes.
        """
        u = np.interp(length, self.lengths, self.nodes)
        for _ in range(4):
            speed = np.linalg.norm(self.derivatives(u).first, axis=1)
            step = (self.length(u) - length) / speed
            u = np.clip(u - step, self.nodes[0], self.nodes[-1])
        return u

    def nearest(self, position: Float[np.ndarray, " 2"], near: float | None) -> float:
        """Return u of the curve point nearest to `position` [m].

        Args:
            position: Any point in the plane.
            near: Length [m] at which to start: the nearest point is tracked downhill from there and
                does not jump to another part of the curve that happens to be closer. None searches
                the whole curve.
        """
        i = self._nearest_node(position, near)
        last = self.nodes.size - 1
        low = float(self.nodes[max(i - 1, 0)])
        high = float(self.nodes[min(i + 1, last)])
        return self._find_foot(position, low, float(self.nodes[i]), high)

    def _nearest_node(self, position: Float[np.ndarray, " 2"], near: float | None) -> int:
        """Return the node nearest to `position`: of all, or the first downhill from `near`."""
        squared_distance = np.sum((self.corners - position) ** 2, axis=1)
        if near is None:
            return int(np.argmin(squared_distance))
        last = squared_distance.size - 1
        i = last
        if near < self.lengths[-1]:
            i = int(np.searchsorted(self.lengths, near))
        while i < last and squared_distance[i + 1] < squared_distance[i]:
            i += 1
        while i > 0 and squared_distance[i - 1] < squared_distance[i]:
            i -= 1
        return i

    def _find_foot(
        self, position: Float[np.ndarray, " 2"], low: float, u: float, high: float
    ) -> float:
        """Find (r - p) . r' = 0 between `low` and `high`, or an end of the curve if that is nearer.

        Newton's method from `u`; where its step would leave the range, the range is halved.
        """
        for _ in range(MOST_BISECTIONS):
            points, first_derivatives, second_derivatives = self.derivatives(np.array([u]))
            apart = points[0] - position
            first = first_derivatives[0]
            slope = float(apart @ first)
            if slope > 0.0:
                high = u
            else:
                low = u
            slope_rate = float(first @ first + apart @ second_derivatives[0])
            last_u = u
            u = 0.5 * (low + high)
            if slope_rate > 0.0:
                newton_u = last_u - slope / slope_rate
                if low <= newton_u <= high:  # at the foot, Newton's step is zero
                    u = newton_u
            if abs(u - last_u) <= TOLERANCE * float(self.nodes[-1]):
                break
        return u


def nearest_of_many(
    curve: Curve, positions: Float[np.ndarray, "n_points 2"], near: Numbers | None
) -> Numbers:
    """Return u of the curve points nearest to many positions, as `Curve.nearest` does for one.

    Args:
        curve: The curve.
        positions: Points in the plane [m].
        near: Length [m] at which to start for each; None searches the whole curve.
    """
    i = _nearest_nodes(curve, positions, near)
    last = curve.nodes.size - 1
    before = np.maximum(i - 1, 0)
    after = np.minimum(i + 1, last)
    low = curve.nodes[before]
    high = curve.nodes[after]
    return _find_feet(curve, positions, low, curve.nodes[i], high)


def _nearest_nodes(curve: Curve, positions: Vectors, near: Numbers | None) -> np.ndarray:
    """Return the node nearest to each position: of all, or the first downhill from `near`."""
    if near is None:
        nodes = [
            np.argmin(np.sum((curve.corners - position) ** 2, axis=1)) for position in positions
        ]
        return np.array(nodes)
    last = curve.nodes.size - 1

    def squared_distance(i: np.ndarray) -> np.ndarray:
        corners = curve.corners[np.clip(i, 0, last)]
        return np.sum((corners - positions) ** 2, axis=1)

    i = np.minimum(np.searchsorted(curve.lengths, near), last)
    for step in (1, -1):
        distance = squared_distance(i)
        while True:
            following = i + step
            distance_after = squared_distance(following)
            is_inside = (following >= 0) & (following <= last)
            moves = is_inside & (distance_after < distance)
            if not moves.any():
                break
            i = i + step * moves
            distance = np.where(moves, distance_after, distance)
    return i


def _find_feet(
    curve: Curve, positions: Vectors, low: Numbers, u: Numbers, high: Numbers
) -> Numbers:
    """Find (r - p) . r' = 0 between `low` and `high` for many points, see `Curve.nearest`."""
    found = u.copy()
    searched = np.arange(u.size)
    tolerance = TOLERANCE * float(curve.nodes[-1])
    for _ in range(MOST_BISECTIONS):
        points, first, second = curve.derivatives(u)
        apart = points - positions[searched]
        slope = np.sum(apart * first, axis=1)
        is_beyond = slope > 0.0
        high = np.where(is_beyond, u, high)
        low = np.where(is_beyond, low, u)
        squared_speed = np.sum(first * first, axis=1)
        slope_rate = squared_speed + np.sum(apart * second, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton_u = u - slope / slope_rate
        is_inside = (low <= newton_u) & (newton_u <= high)
        is_newton = is_inside & (slope_rate > 0.0)
        middle = 0.5 * (low + high)
        next_u = np.where(is_newton, newton_u, middle)
        found[searched] = next_u
        goes_on = np.abs(next_u - u) > tolerance
        if not goes_on.any():
            break
        searched = searched[goes_on]
        u, low, high = next_u[goes_on], low[goes_on], high[goes_on]
    return found


def fit_natural_cubic(points: Vectors) -> Curve:
    """Return the smooth curve through two or more points.

    Args:
        points: Points in order, no two neighbors equal [m].

    Raises:
        ValueError: If the curve stops and turns back at a point, where its direction is undefined.
    """
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    step = np.sqrt(chords)
    knots = np.concatenate(([0.0], np.cumsum(step)))
    cubics = _solve_cubics(points, step)
    nodes = _place_nodes(knots, step)
    corners, first, _ = _evaluate(knots, cubics, nodes)
    _check_speed(corners, first)
    piece_lengths = _integrate_length(knots, cubics, nodes[:-1], nodes[1:])
    lengths_after = np.cumsum(piece_lengths)
    return Curve(
        knots=knots,
        cubics=cubics,
        nodes=nodes,
        corners=corners,
        lengths=np.concatenate(([0.0], lengths_after)),
    )


def _solve_cubics(points: Vectors, step: Steps) -> Cubics:
    """Solve the classical conditions: continuous second derivatives, zero at both ends."""
    slope = np.diff(points, axis=0) / step[:, np.newaxis]
    n = len(points)
    matrix = np.eye(n)
    right_side = np.zeros((n, 2))
    for i in range(1, n - 1):
        step_before = step[i - 1]
        step_after = step[i]
        matrix[i, i - 1] = step_before
        matrix[i, i] = 2.0 * (step_before + step_after)
        matrix[i, i + 1] = step_after
        right_side[i] = 6.0 * (slope[i] - slope[i - 1])
    second = np.linalg.solve(matrix, right_side)
    h = step[:, np.newaxis]
    bend = 2.0 * second[:-1] + second[1:]
    first = slope - h * bend / 6.0
    third = np.diff(second, axis=0) / (6.0 * h)
    return np.stack((points[:-1], first, 0.5 * second[:-1], third))


def _place_nodes(knots: Knots, step: Steps) -> Nodes:
    """Return u at the ends of the pieces, `PIECES` in every stretch."""
    fractions = np.linspace(0.0, 1.0, PIECES, endpoint=False)
    starts = knots[:-1, np.newaxis] + step[:, np.newaxis] * fractions
    return np.concatenate((starts.ravel(), knots[-1:]))


def _check_speed(points: Vectors, first: Vectors) -> None:
    """Reject a curve that turns on the spot."""
    speed = np.linalg.norm(first, axis=1)
    slowest = int(np.argmin(speed))
    if speed[slowest] < SLOWEST * np.max(speed):
        x, y = points[slowest]
        rule = "must give a curve with a direction everywhere"
        raise BadArgument("waypoints", f"{rule}, but it turns on the spot at ({x:g}, {y:g})")


def _evaluate(knots: Knots, cubics: Cubics, u: Numbers) -> Derivatives:
    i = np.clip(np.searchsorted(knots, u, side="right") - 1, 0, knots.size - 2)
    h = (u - knots[i])[:, np.newaxis]
    a, b, c, d = cubics[:, i]
    points = ((d * h + c) * h + b) * h + a
    first = (3.0 * d * h + 2.0 * c) * h + b
    second = 6.0 * d * h + 2.0 * c
    return Derivatives(points=points, first=first, second=second)


def _integrate_length(knots: Knots, cubics: Cubics, begin: Numbers, end: Numbers) -> Numbers:
    """Return the length from `begin` to `end`, each in one piece, by Gauss quadrature of |r'|."""
    half = 0.5 * (end - begin)[:, np.newaxis]
    middle = 0.5 * (begin + end)[:, np.newaxis]
    u = (middle + half * _GAUSS_POINTS).ravel()
    speed = np.linalg.norm(_evaluate(knots, cubics, u).first, axis=1)
    return (half * speed.reshape(-1, _GAUSS_POINTS.size)) @ _GAUSS_WEIGHTS
