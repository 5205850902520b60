"""Quadratic programs with bounds and limits, solved exactly by nonnegative least squares.

A strictly convex program becomes a search for the shortest vector within half-spaces, which is a problem
of nonnegative least squares (Lawson and Hanson, Solving Least Squares Problems, 1974, ch. 23).
"""

from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.values import optional_import

LEAST_CURVATURE = 0.001
"""Curvature that is added where the slope is 1 and numbers change by at most 1, so that the program is convex [-]."""
FEASIBLE = 1e-12
"""Squared residual below which limits contradict each other [-]."""
ROOM = 1e-9
"""Room that is left where limits contradict each other, and are exceeded as little as possible [-]."""

Point = Float[np.ndarray, " n"]
Matrix = Float[np.ndarray, "_ n"]


def solve_quadratic(
    slope: Point,
    curvature: Float[np.ndarray, "n n"],
    excess: Float[np.ndarray, " _"],
    excess_slopes: Matrix,
    least: Point,
    most: Point,
) -> Point:
    """Return the change d that minimizes g d + d B d / 2 within bounds, with c + A d <= 0.

    Limits that contradict each other are exceeded as little as possible.

    Args:
        slope: g.
        curvature: B, positive semidefinite.
        excess: c.
        excess_slopes: A.
        least: Smallest change of every number.
        most: Largest change of every number.
    """
    radius = float(np.max([-least, most, np.zeros_like(most)])) or 1.0
    scale = float(np.abs(slope).max()) * radius or 1.0
    scaled_slope = slope * radius / scale
    scaled_curvature = curvature * radius**2 / scale
    identity = np.eye(slope.size)
    sides = np.vstack((-excess_slopes * radius, identity, -identity))
    ends = np.concatenate((excess, least / radius, -most / radius))
    convex = scaled_curvature + LEAST_CURVATURE * identity
    change = _solve_convex(scaled_slope, convex, sides, ends)
    if change is None:
        beyond = _least_excess(sides, ends, excess.size)
        ends[: excess.size] -= beyond + ROOM
        change = _solve_convex(scaled_slope, convex, sides, ends)
    if change is None:
        change = np.zeros_like(slope)
    return np.clip(radius * change, least, most)


def _solve_convex(slope: Point, curvature: Matrix, sides: Matrix, ends: np.ndarray) -> Point | None:
    """Return x that minimizes g x + x B x / 2 with G x >= h; None if there is no such x."""
    optimize: Any = optional_import("An optimization", "scipy", "scale", "scipy.optimize")
    root = np.linalg.cholesky(curvature)
    unlimited = -np.linalg.solve(curvature, slope)
    # y = R (x - unlimited) is to be as short as possible.
    sides_of_y = np.linalg.solve(root, sides.T).T
    ends_of_y = ends - sides @ unlimited
    system = np.vstack((sides_of_y.T, ends_of_y))
    target = np.zeros(slope.size + 1)
    target[-1] = 1.0
    weights, distance = optimize.nnls(system, target, maxiter=30 * ends.size)
    if distance**2 < FEASIBLE:
        return None
    residuals = system @ weights - target
    shortest = -residuals[:-1] / residuals[-1]
    return np.asarray(unlimited + np.linalg.solve(root.T, shortest), dtype=float)


def _least_excess(sides: Matrix, ends: np.ndarray, n_limits: int) -> float:
    """Return by how much the first of some limits have to be exceeded at least."""
    optimize: Any = optional_import("An optimization", "scipy", "scale", "scipy.optimize")
    n = sides.shape[1]
    relief = np.zeros(ends.size)
    relief[:n_limits] = 1.0
    result = optimize.linprog(
        np.append(np.zeros(n), 1.0),
        A_ub=-np.column_stack((sides, relief)),
        b_ub=-ends,
        bounds=[*[(None, None)] * n, (0.0, None)],
    )
    return float(result.x[-1])
