"""Vortex lattice of a flat plate: its added mass, and its lift in a steady flow, for any silhouette.

The plate stands upright, symmetric about its chord, and the flow comes along it. Cells between spanwise
and chordwise lines carry vortex rings of strength mu, the jump of the potential. Without circulation the
rings alone meet the normal velocity at the cells' middles: the impulse of the water is that of its added
mass. In a steady flow the rings begin at a quarter of their cells and meet it at three quarters, and the last one
of each row goes on behind the plate for ever (Katz and Plotkin, Low-Speed Aerodynamics, 2001, ch. 12).
Both errors fall as one over the number of cells along the chord, so results at n and 2 n cells are
extrapolated.

The density is 1, lengths are in units of one's own, and x counts aft from the root.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from laticauda.water.fluid.edges import PlateFunctions

N_CHORD = 16
"""Cells along the chord in the coarser lattice of two."""
N_HALF_SPAN = 9
"""Cells across half the span, closer together toward the tip."""
WAKE_SPANS = 1e3
"""Length of the wake in spans."""
SMALLEST = 1e-14
"""Cross product below which a point lies on a segment."""

Inside = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Whether points (distance behind the root, height above the chord) lie on the plate."""


class PlateLoads(NamedTuple):
    """What a plate does to the water, per density."""

    added_mass: np.ndarray
    """Added mass for heave and for turning about the root: [[M, M x], [M x, I]]."""
    lift: float
    """Steady lift per speed and speed across, G."""
    center: float
    """x_ac, where the steady lift acts."""
    control: float
    """x_w: by a speed across w(x) = x the plate lifts as by the uniform one w(x_w)."""


def compute_plate(length: float, height: float, inside: Inside | None = None) -> PlateLoads:
    """Return the loads of a plate, extrapolated in the number of cells.

    Args:
        length: From the root to the end of the plate.
        height: Its largest height.
        inside: Which points within this rectangle belong to the plate; None: all.
    """
    coarse = _loads(length, height, inside, N_CHORD)
    fine = _loads(length, height, inside, 2 * N_CHORD)
    return PlateLoads(
        added_mass=2.0 * fine.added_mass - coarse.added_mass,
        lift=2.0 * fine.lift - coarse.lift,
        center=2.0 * fine.center - coarse.center,
        control=2.0 * fine.control - coarse.control,
    )


def rectangle(aspect: float) -> PlateFunctions:
    """Return the functions of a rectangular plate, of which `edges.TABLE` has some.

    Args:
        aspect: A = h/c.
    """
    chord = 1.0 / aspect
    loads = compute_plate(chord, 1.0)
    slender = 0.25 * np.pi
    mass = loads.added_mass[0, 0]
    about_middle = loads.added_mass[1, 1] - mass * chord**2 / 4.0
    return PlateFunctions(
        added_mass=float(mass / (slender * chord)),
        lift=loads.lift / slender,
        rotary=float(about_middle / (slender * chord**3 / 12.0)),
        center=loads.center / chord,
    )


def _loads(length: float, height: float, inside: Inside | None, n_chord: int) -> PlateLoads:
    """Return the loads of one lattice."""
    dx = length / n_chord
    turn = np.linspace(0.0, 0.5 * np.pi, N_HALF_SPAN + 1)
    lines = 0.5 * height * np.sin(turn)
    middles = 0.5 * height * np.sin(0.5 * (turn[1:] + turn[:-1]))
    x = (np.arange(n_chord) + 0.5) * dx
    on = np.full((n_chord, N_HALF_SPAN), True)
    if inside is not None:
        on = inside(x[:, np.newaxis], middles[np.newaxis, :])
    column, row = np.nonzero(on)
    front = column * dx
    lower, upper = lines[row], lines[row + 1]
    area = 2.0 * (upper - lower) * dx
    still = _influence(x[column], middles[row], front, front + dx, lower, upper)
    speeds = np.stack((np.ones(column.size), x[column]), axis=1)
    strengths = np.linalg.solve(still, speeds)
    added = -(speeds * area[:, np.newaxis]).T @ strengths
    at_three_quarters = front + 0.75 * dx
    quarters = front + 0.25 * dx
    ends = quarters + dx
    last_columns = np.full(N_HALF_SPAN, -1)
    np.maximum.at(last_columns, row, column)
    ends[column == last_columns[row]] += WAKE_SPANS * height
    flowing = _influence(at_three_quarters, middles[row], quarters, ends, lower, upper)
    speeds = np.stack((np.ones(column.size), at_three_quarters), axis=1)
    strengths = np.linalg.solve(flowing, speeds)
    # A ring's bound vortex, at a quarter of its cell, has its strength less that of the ring ahead.
    grid = np.zeros((n_chord + 1, N_HALF_SPAN, 2))
    grid[column + 1, row] = strengths
    bound = (grid[column + 1, row] - grid[column, row]) * (2.0 * (upper - lower))[:, np.newaxis]
    lift, lift_of_turning = -bound.sum(axis=0)
    moment = -(quarters @ bound[:, 0])
    return PlateLoads(added, float(lift), float(moment / lift), float(lift_of_turning / lift))


def _influence(
    x: np.ndarray,
    y: np.ndarray,
    front: np.ndarray,
    back: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
) -> np.ndarray:
    """Return the normal velocity at points (rows) by rings of strength 1 and their mirror images (columns)."""
    px, py = x[:, np.newaxis], y[:, np.newaxis]
    by_rings = _ring(px, py, front, back, lower, upper)
    by_images = _ring(px, py, front, back, -upper, -lower)
    return -(by_rings + by_images)


def _ring(
    x: np.ndarray,
    y: np.ndarray,
    x_0: np.ndarray,
    x_1: np.ndarray,
    y_0: np.ndarray,
    y_1: np.ndarray,
) -> np.ndarray:
    """Return the normal velocity by rectangular rings, counter-clockwise."""
    return (
        _segment(x, y, x_0, y_0, x_1, y_0)
        + _segment(x, y, x_1, y_0, x_1, y_1)
        + _segment(x, y, x_1, y_1, x_0, y_1)
        + _segment(x, y, x_0, y_1, x_0, y_0)
    )


def _segment(
    x: np.ndarray,
    y: np.ndarray,
    a_x: np.ndarray,
    a_y: np.ndarray,
    b_x: np.ndarray,
    b_y: np.ndarray,
) -> np.ndarray:
    """Return the normal velocity by straight vortices from a to b (Biot and Savart)."""
    r1_x, r1_y = x - a_x, y - a_y
    r2_x, r2_y = x - b_x, y - b_y
    cross = r1_x * r2_y - r1_y * r2_x
    r1 = np.sqrt(r1_x * r1_x + r1_y * r1_y)
    r2 = np.sqrt(r2_x * r2_x + r2_y * r2_y)
    is_on = np.abs(cross) < SMALLEST
    # 1 - cos, without the loss of digits where the segment is seen at a small angle.
    cosine = (r1_x * r2_x + r1_y * r2_y) / (r1 * r2)
    strength = (r1 + r2) * (1.0 - cosine) / np.where(is_on, 1.0, cross)
    return np.where(is_on, 0.0, strength / (4.0 * np.pi))
