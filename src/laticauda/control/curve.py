"""Smooth curve through points, parameterized by its arc length; independent of robots.

The curve is a natural cubic spline over centripetal knots (a parameter step is the square root of
the chord). Unlike a Catmull-Rom curve it has continuous curvature, so a robot that follows it need
not jump; the centripetal knots prevent overshoot between points at unequal distances; and its
curvature is zero at both ends, so that it continues as a straight line without a jump in curvature.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.values.errors import BadArgument

Numbers = Float[np.ndarray, " n_points"]
Vectors = Float[np.ndarray, "n_points 2"]
Knots = Float[np.ndarray, " n_knots"]
Nodes = Float[np.ndarray, " n_nodes"]
Steps = Float[np.ndarray, " n_stretches"]
Cubics = Float[np.ndarray, "4 n_stretches 2"]

PIECES = 32  # per stretch between two points: one piece is too short for the curve to have two nearest points in it
_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(5)


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

    def derivatives(self, u: Numbers) -> tuple[Vectors, Vectors, Vectors]:
        """Return the points at `u` and their first and second derivatives with respect to u."""
        return _derivatives(self.knots, self.cubics, u)

    def length(self, u: Numbers) -> Numbers:
        """Return the length from the start to `u` [m]."""
        # At the end, i is the last node: nothing is added, not even rounding, so points beyond it
        # are recognized.
        i = np.searchsorted(self.nodes, u, side="right") - 1
        return self.lengths[i] + _length(self.knots, self.cubics, self.nodes[i], u)

    def parameter(self, length: Numbers) -> Numbers:
        """Return u at a `length` [m] between 0 and the whole length: Newton's method started from the table."""
        u = np.interp(length, self.lengths, self.nodes)
        for _ in range(4):
            speed = np.linalg.norm(self.derivatives(u)[1], axis=1)
            u = np.clip(u - (self.length(u) - length) / speed, self.nodes[0], self.nodes[-1])
        return u

    def nearest(self, position: Float[np.ndarray, " 2"], near: float | None) -> float:
        """Return u of the curve point nearest to `position` [m].

        Args:
            position: Any point in the plane.
            near: Length [m] at which to start: the nearest point is tracked downhill from there and
                does not jump to another part of the curve that happens to be closer. None searches
                the whole curve.
        """
        distance = np.sum((self.corners - position) ** 2, axis=1)
        if near is None:
            i = int(np.argmin(distance))
        else:
            i = (
                int(np.searchsorted(self.lengths, near))
                if near < self.lengths[-1]
                else distance.size - 1
            )
            while i + 1 < distance.size and distance[i + 1] < distance[i]:
                i += 1
            while i > 0 and distance[i - 1] < distance[i]:
                i -= 1
        low, high = (
            float(self.nodes[max(i - 1, 0)]),
            float(self.nodes[min(i + 1, self.nodes.size - 1)]),
        )
        return self._foot(position, low, float(self.nodes[i]), high)

    def _foot(self, position: Float[np.ndarray, " 2"], low: float, u: float, high: float) -> float:
        """Find (r - p) . r' = 0 between `low` and `high`, or an end of the curve if that is nearer."""
        for _ in range(60):
            (r,), (first,), (second,) = self.derivatives(np.array([u]))
            slope = float((r - position) @ first)
            low, high = (low, u) if slope > 0.0 else (u, high)
            bend = float(first @ first + (r - position) @ second)
            step = u - slope / bend if bend > 0.0 else low
            last, u = u, step if low < step < high else 0.5 * (low + high)
            if abs(u - last) <= 1e-14 * float(self.nodes[-1]):
                break
        return u


def natural_cubic(points: Vectors) -> Curve:
    """Return the smooth curve through two or more points.

    Args:
        points: Points in order, no two neighbors equal [m].

    Raises:
        ValueError: If the curve stops and turns back at a point, where its direction is undefined.
    """
    step = np.sqrt(np.linalg.norm(np.diff(points, axis=0), axis=1))
    knots = np.concatenate(([0.0], np.cumsum(step)))
    cubics = _cubics(points, step)
    inner = np.linspace(0.0, 1.0, PIECES, endpoint=False)
    nodes = np.concatenate(
        ((knots[:-1, np.newaxis] + step[:, np.newaxis] * inner).ravel(), knots[-1:])
    )
    corners, first, _ = _derivatives(knots, cubics, nodes)
    speed = np.linalg.norm(first, axis=1)
    slowest = int(np.argmin(speed))
    if speed[slowest] < 1e-6 * np.max(speed):
        x, y = corners[slowest]
        raise BadArgument(
            "waypoints",
            f"must give a curve with a direction everywhere, but it turns on the spot at ({x:g}, {y:g})",
        )
    pieces = _length(knots, cubics, nodes[:-1], nodes[1:])
    lengths = np.concatenate(([0.0], np.cumsum(pieces)))
    return Curve(knots=knots, cubics=cubics, nodes=nodes, corners=corners, lengths=lengths)


def _cubics(points: Vectors, step: Steps) -> Cubics:
    """Solve the classical conditions: continuous second derivatives, zero at both ends."""
    slope = np.diff(points, axis=0) / step[:, np.newaxis]
    n = len(points)
    matrix, right = np.eye(n), np.zeros((n, 2))
    for i in range(1, n - 1):
        matrix[i, i - 1 : i + 2] = step[i - 1], 2.0 * (step[i - 1] + step[i]), step[i]
        right[i] = 6.0 * (slope[i] - slope[i - 1])
    second = np.linalg.solve(matrix, right)
    h = step[:, np.newaxis]
    first = slope - h * (2.0 * second[:-1] + second[1:]) / 6.0
    return np.stack((points[:-1], first, 0.5 * second[:-1], np.diff(second, axis=0) / (6.0 * h)))


def _derivatives(knots: Knots, cubics: Cubics, u: Numbers) -> tuple[Vectors, Vectors, Vectors]:
    i = np.clip(np.searchsorted(knots, u, side="right") - 1, 0, knots.size - 2)
    h = (u - knots[i])[:, np.newaxis]
    a, b, c, d = cubics[:, i]
    return ((d * h + c) * h + b) * h + a, (3.0 * d * h + 2.0 * c) * h + b, 6.0 * d * h + 2.0 * c


def _length(knots: Knots, cubics: Cubics, begin: Numbers, end: Numbers) -> Numbers:
    """Return the length from `begin` to `end`, each within one piece, by Gauss quadrature of |r'|."""
    half = 0.5 * (end - begin)[:, np.newaxis]
    u = (0.5 * (begin + end)[:, np.newaxis] + half * _GAUSS).ravel()
    speed = np.linalg.norm(_derivatives(knots, cubics, u)[1], axis=1).reshape(-1, _GAUSS.size)
    return (half * speed) @ _WEIGHT
