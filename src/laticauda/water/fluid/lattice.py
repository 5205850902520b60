"""Vortex lattice of a flat plate: its added mass, and its lift in a steady flow, for any silhouette.

The plate stands upright, symmetric about its chord, and the flow comes along it. Rows of cells reach from its
leading to its trailing edge, and carry vortex rings of strength mu, the jump of the potential. Without circulation the
rings alone meet the normal velocity at the cells' middles: the impulse of the water is that of its added
mass. In a steady flow the rings begin at a quarter of their cells and meet it at three quarters, and the last one
of each row goes on behind the plate for ever (Katz and Plotkin, Low-Speed Aerodynamics, 2001, ch. 12).
Both errors fall as one over the number of cells along the chord, so results at n and 2 n cells are
extrapolated.

A plate may have another one, of constant height, rigidly ahead of its root. Its rows begin there then,
and the loads are those of the plate itself in the presence of the other.

The density is 1, lengths are in units of one's own, and x counts aft from the root.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from laticauda.water.fluid.edges import PlateFunctions

N_CHORD = 8
"""Cells along the chord in the coarsest lattice."""
N_AHEAD = 6
"""Cells along a plate ahead in that lattice, shorter toward the root."""
N_HALF_SPAN = 9
"""Rows across half the span, closer together toward the tip."""
LEAST_ROWS = 2
"""Rows above and below the height of a plate ahead at least."""
WAKE_SPANS = 1e3
"""Length of the wake in spans."""
SMALLEST = 1e-14
"""Cross product below which a point lies on a segment."""

EdgeLine = Callable[[np.ndarray], np.ndarray]
"""Distance of an edge behind the root at heights above the chord."""


@dataclass(frozen=True, kw_only=True)
class Outline:
    """Upper half of a plate: at every height one stretch from the leading to the trailing edge."""

    height: float
    """Largest height of the whole plate."""
    leading: EdgeLine
    """Where the plate begins."""
    trailing: EdgeLine
    """Where it ends."""

    @classmethod
    def rectangle(cls, length: float, height: float) -> "Outline":
        """Return the outline of a rectangular plate.

        Args:
            length: From the root to the end of the plate.
            height: Its height.
        """
        return cls(
            height=height,
            leading=lambda z: np.zeros_like(z),
            trailing=lambda z: np.full_like(z, length),
        )


class PlateAhead(NamedTuple):
    """A plate rigidly ahead of the root of another one."""

    length: float
    """Its length."""
    height: float
    """Its height, at most that of the other one."""


class PlateLoads(NamedTuple):
    """What a plate does to the water, per density."""

    mass: float
    """M, added mass of the plate itself."""
    mass_center: float
    """Where that mass has its center."""
    inertia: float
    """Its added moment of inertia about that center, with a plate ahead at rest."""
    mass_ahead: float
    """Added mass of the plate ahead, behind a free end; 0 without one."""
    lift: float
    """Steady lift per speed and speed across, G."""
    center: float
    """x_ac, where the steady lift acts, besides the Munk moment of a plate ahead."""
    control: float
    """x_w: by a speed across w(x) = x the plate lifts as by the uniform one w(x_w)."""


def compute_plate(
    outline: Outline, ahead: PlateAhead | None = None, *, refinement: int = 1
) -> PlateLoads:
    """Return the loads of a plate, extrapolated in the number of cells.

    Args:
        outline: Its upper half.
        ahead: The plate ahead of its root; None if its leading edge is free.
        refinement: By how much more cells there are along the chord than in the coarsest lattice.
    """
    coarse = _loads(build_cells(outline, ahead, refinement=refinement))
    fine = _loads(build_cells(outline, ahead, refinement=2 * refinement))
    return PlateLoads(*(2.0 * at_2n - at_n for at_n, at_2n in zip(coarse, fine, strict=True)))


def rectangle(aspect: float) -> PlateFunctions:
    """Return the functions of a rectangular plate, of which `edges.TABLE` has some.

    Args:
        aspect: A = h/c.
    """
    chord = 1.0 / aspect
    loads = compute_plate(Outline.rectangle(chord, 1.0), refinement=2)
    slender = 0.25 * np.pi
    return PlateFunctions(
        added_mass=loads.mass / (slender * chord),
        lift=loads.lift / slender,
        rotary=loads.inertia / (slender * chord**3 / 12.0),
        center=loads.center / chord,
    )


class Rings(NamedTuple):
    """Rings with two sides along the chord: where these begin and end, one number per ring."""

    front_below: np.ndarray
    back_below: np.ndarray
    front_above: np.ndarray
    back_above: np.ndarray
    below: np.ndarray
    """Height of the lower side."""
    above: np.ndarray
    """Height of the upper side."""


class Cells(NamedTuple):
    """Cells of the upper half of a plate, row by row, each from the front to the trailing edge."""

    sides: Rings
    middle: np.ndarray
    """Height at which they are looked at."""
    of_fin: np.ndarray
    """Whether they belong to the plate itself, and not to the one ahead."""
    is_first: np.ndarray
    """Whether they are the first ones of their rows."""
    is_last: np.ndarray
    """Whether they are the last ones of their rows."""
    height: float
    """Largest height of the whole plate."""


def build_cells(outline: Outline, ahead: PlateAhead | None, *, refinement: int) -> Cells:
    """Return the cells of a plate.

    Args:
        outline: Its upper half.
        ahead: The plate ahead of its root; None if its leading edge is free.
        refinement: By how much more cells there are along the chord than in the coarsest lattice.
    """
    lines, middles = _build_rows(outline.height, ahead)
    n_chord = refinement * N_CHORD
    shares = np.linspace(0.0, 1.0, n_chord + 1)
    rows: list[Cells] = []
    for below, above, middle in zip(lines[:-1], lines[1:], middles, strict=True):
        ends = np.array((below, above))
        leading = outline.leading(ends)
        trailing = outline.trailing(ends)
        is_behind = ahead is not None and middle < 0.5 * ahead.height
        if is_behind:
            leading = np.zeros(2)  # the gap to the plate ahead is taken as closed
        x = leading + shares[:, np.newaxis] * (trailing - leading)
        n_ahead = 0
        if ahead is not None and is_behind:
            n_ahead = refinement * N_AHEAD
            distances = ahead.length * np.linspace(1.0, 0.0, n_ahead + 1)[:-1] ** 2
            x = np.concatenate((-np.stack((distances, distances), axis=1), x))
        index = np.arange(len(x) - 1)
        sides = Rings(
            *(x[:-1, 0], x[1:, 0], x[:-1, 1], x[1:, 1]),
            below=np.full(index.size, below),
            above=np.full(index.size, above),
        )
        rows.append(
            Cells(
                sides=sides,
                middle=np.full(index.size, middle),
                of_fin=index >= n_ahead,
                is_first=index == 0,
                is_last=index == index[-1],
                height=outline.height,
            )
        )
    sides_of_rows = [row.sides for row in rows]
    return Cells(
        sides=Rings(*map(np.concatenate, zip(*sides_of_rows, strict=True))),
        middle=np.concatenate([row.middle for row in rows]),
        of_fin=np.concatenate([row.of_fin for row in rows]),
        is_first=np.concatenate([row.is_first for row in rows]),
        is_last=np.concatenate([row.is_last for row in rows]),
        height=outline.height,
    )


def _build_rows(height: float, ahead: PlateAhead | None) -> tuple[np.ndarray, np.ndarray]:
    """Return the heights between the rows, and those at which the rows are looked at."""
    half = 0.5 * height
    cut = 0.0
    lines, middles = np.zeros(1), np.zeros(0)
    n_above = N_HALF_SPAN
    if ahead is not None and ahead.height < height:
        cut = 0.5 * ahead.height
        n_below = round(N_HALF_SPAN * cut / half)
        n_below = min(max(n_below, LEAST_ROWS), N_HALF_SPAN - LEAST_ROWS)
        n_above -= n_below
        lines = np.linspace(0.0, cut, n_below + 1)
        middles = 0.5 * (lines[1:] + lines[:-1])
    turn = np.linspace(0.0, 0.5 * np.pi, n_above + 1)
    lines = np.concatenate((lines, cut + (half - cut) * np.sin(turn[1:])))
    middles = np.concatenate((middles, cut + (half - cut) * np.sin(0.5 * (turn[1:] + turn[:-1]))))
    return lines, middles


def _loads(cells: Cells) -> PlateLoads:
    """Return the loads of one lattice."""
    sides = cells.sides
    share = (cells.middle - sides.below) / (sides.above - sides.below)
    front = sides.front_below + share * (sides.front_above - sides.front_below)
    back = sides.back_below + share * (sides.back_above - sides.back_below)
    breadth = 2.0 * (sides.above - sides.below)
    x = 0.5 * (front + back)
    mean_chord = 0.5 * (sides.back_below - sides.front_below + sides.back_above - sides.front_above)
    area = breadth * mean_chord
    of_fin = cells.of_fin
    alone = np.where(of_fin, 1.0, 0.0)
    speeds = np.stack((np.ones_like(x), alone, alone * x), axis=1)
    strengths = np.linalg.solve(influence(x, cells.middle, sides), speeds)
    impulses = -(strengths * area[:, np.newaxis])
    mass, mass_alone, _ = impulses[of_fin].sum(axis=0)
    first, first_alone, second_alone = x[of_fin] @ impulses[of_fin]
    mass_ahead = impulses[~of_fin, 0].sum()

    vortices = shift_by_a_quarter(cells)
    at_three_quarters = front + 0.75 * (back - front)
    speeds = np.stack((np.ones_like(x), at_three_quarters), axis=1)
    flowing = influence(at_three_quarters, cells.middle, vortices)
    strengths = np.linalg.solve(flowing, speeds)
    # A ring's bound vortex, at a quarter of its cell, has its strength less that of the ring ahead.
    before = np.where(cells.is_first[:, np.newaxis], 0.0, np.roll(strengths, 1, axis=0))
    bound = (strengths - before) * breadth[:, np.newaxis]
    lift, lift_of_turning = -bound.sum(axis=0)
    moment = -(0.5 * (vortices.front_below + vortices.front_above) @ bound[:, 0])
    return PlateLoads(
        mass=float(mass),
        mass_center=float(first / mass),
        inertia=float(second_alone - first_alone**2 / mass_alone),
        mass_ahead=float(mass_ahead),
        lift=float(lift),
        center=float((moment + mass_ahead) / lift),
        control=float(lift_of_turning / lift),
    )


def shift_by_a_quarter(cells: Cells) -> Rings:
    """Return the rings of a steady flow, from a quarter of a cell to that of the next one or along the wake.

    Args:
        cells: The cells.
    """
    sides = cells.sides
    quarter_below = sides.front_below + 0.25 * (sides.back_below - sides.front_below)
    quarter_above = sides.front_above + 0.25 * (sides.back_above - sides.front_above)
    far = np.max(sides.back_below) + WAKE_SPANS * cells.height
    return sides._replace(
        front_below=quarter_below,
        front_above=quarter_above,
        back_below=np.where(cells.is_last, far, np.roll(quarter_below, -1)),
        back_above=np.where(cells.is_last, far, np.roll(quarter_above, -1)),
    )


def influence(x: np.ndarray, z: np.ndarray, rings: Rings) -> np.ndarray:
    """Return the normal velocity at points (rows) by rings of strength 1 and their mirror images (columns).

    Args:
        x: Distances of the points behind the root.
        z: Their heights.
        rings: Rings of the upper half.
    """
    images = Rings(
        front_below=rings.front_above,
        back_below=rings.back_above,
        front_above=rings.front_below,
        back_above=rings.back_below,
        below=-rings.above,
        above=-rings.below,
    )
    px, pz = x[:, np.newaxis], z[:, np.newaxis]
    return -(_ring(px, pz, rings) + _ring(px, pz, images))


def _ring(x: np.ndarray, z: np.ndarray, rings: Rings) -> np.ndarray:
    """Return the normal velocity by rings, counter-clockwise."""
    below, above = rings.below, rings.above
    return (
        _segment(x, z, rings.front_below, below, rings.back_below, below)
        + _segment(x, z, rings.back_below, below, rings.back_above, above)
        + _segment(x, z, rings.back_above, above, rings.front_above, above)
        + _segment(x, z, rings.front_above, above, rings.front_below, below)
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
