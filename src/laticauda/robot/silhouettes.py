"""Fins as plates of finite span: free rectangles by the table of the law, all others by the vortex lattice.

What is rigidly ahead of a fin's root decides on its leading edge (`plate_ahead`): without a gap there, the water
cannot go around it. Flat modules ahead are one plate with the fin; a body ahead counts as such a plate, too.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import takewhile

import numpy as np
from jaxtyping import Float

from laticauda.robot.body import is_flat
from laticauda.robot.effectors import CaudalFin
from laticauda.robot.robot import Robot
from laticauda.values import add_up
from laticauda.water.fluid.edges import LAG_OF_SPAN, LONGEST_LAG, plate_functions
from laticauda.water.fluid.lattice import Outline, PlateAhead, compute_plate

N_LEVELS = 200
"""Heights at which the breadth of a silhouette is sampled."""
N_PLACES = 8
"""Places along a strip at which it is."""
BELOW_TOP = 1.0 - 1e-9
"""Share of its height at which the top of a silhouette still has a breadth [-]."""
LEAST_AHEAD = 0.1
"""Height over that of the fin below which what is ahead does not count; it lifts by the square of that [-]."""
LONGEST_AHEAD = 2.0
"""Length over the height of the fin beyond which what is ahead makes no difference of 1 % to the lift [-]."""


@dataclass(frozen=True, kw_only=True)
class FinPlate:
    """A fin as a plate; masses are relative to m', the added mass per length of a slender plate of its height."""

    mass: float
    """M / m' [m]."""
    center: float
    """Distance of the center of its added mass behind the root [m]."""
    inertia: float
    """Added moment of inertia about that center, over m' [m^3]."""
    lift: float
    """k_s = G / m' [-]."""
    lift_center: float
    """Distance of x_ac behind the root [m]."""
    control: float
    """Distance of x_w behind the root [m]."""
    lag: float
    """l [m]."""


def fin_plate(robot: Robot) -> FinPlate | None:
    """Return a robot's fin as a plate, behind what is ahead of it; None without a fin.

    The lattice takes some hundredths of a second, once for each shape.

    Args:
        robot: The robot.
    """
    fin = robot.caudal_fin
    if fin is None:
        return None
    return _plate_of(fin, plate_ahead(robot))


def plate_ahead(robot: Robot) -> PlateAhead | None:
    """Return what is rigidly ahead of a robot's fin, as a plate; None if the fin's leading edge is free.

    It is as high as the tail end of the body, at most as the fin, and as long as the row of modules there that are
    flat like the last one, or are not. The leading edge is free behind an open opening, if a joint turns
    the fin about its root, and if what is ahead is less than a tenth as high.

    Args:
        robot: The robot.
    """
    fin = robot.caudal_fin
    if fin is None or fin.joint is not None or _root_of(fin) > 0.0:
        return None
    tail = robot.modules[0]
    height = min(2.0 * tail.section.half_height, fin.height)
    if height < LEAST_AHEAD * fin.height:
        return None
    row = takewhile(lambda module: is_flat(module) == is_flat(tail), robot.modules)
    length = add_up(module.length for module in row)
    return PlateAhead(length=min(length, LONGEST_AHEAD * fin.height), height=height)


@lru_cache(maxsize=256)
def _plate_of(fin: CaudalFin, ahead: PlateAhead | None) -> FinPlate:
    if fin.silhouette is not None or ahead is not None:
        return _plate_by_lattice(fin, ahead)
    root = _root_of(fin)
    chord = fin.length - root
    functions = plate_functions(fin.height / chord)
    return FinPlate(
        mass=functions.added_mass * chord,
        center=root + 0.5 * chord,
        inertia=functions.rotary * chord**3 / 12.0,
        lift=functions.lift,
        lift_center=root + functions.center * chord,
        control=fin.length - functions.center * chord,
        lag=_lag(chord, fin.height),
    )


def _plate_by_lattice(fin: CaudalFin, ahead: PlateAhead | None) -> FinPlate:
    loads = compute_plate(outline_of_fin(fin), ahead)
    slender = 0.25 * np.pi * fin.height**2
    excess = 0.0
    if ahead is not None:
        excess = max(loads.mass_ahead - _mass_by_coefficients(ahead), 0.0)
    return FinPlate(
        mass=(loads.mass + excess) / slender,
        center=loads.mass_center,
        inertia=loads.inertia / slender,
        lift=min(loads.lift / slender, 1.0),
        lift_center=loads.center - excess / loads.lift,
        control=loads.control,
        lag=_lag(mean_chord(fin), fin.height),
    )


def _mass_by_coefficients(ahead: PlateAhead) -> float:
    """Return the added mass that flat modules have: half of what a free end takes off, and nothing at the fin.

    The fin carries what the lattice finds there besides.
    """
    slender = 0.25 * np.pi * ahead.height**2 * ahead.length
    lacking = 1.0 - plate_functions(ahead.height / ahead.length).added_mass
    return slender * (1.0 - 0.5 * lacking)


def _lag(chord: float, height: float) -> float:
    """Return l of a plate with a (mean) chord [m]."""
    return min(chord + height / LAG_OF_SPAN, LONGEST_LAG * chord)


def _root_of(fin: CaudalFin) -> float:
    """Return where the plate begins, behind an open opening [m]."""
    if fin.opening == "open":
        return fin.opening_length
    return 0.0


def mean_chord(fin: CaudalFin) -> float:
    """Return area over height of a fin's plate, without an open opening [m].

    Args:
        fin: The fin.
    """
    if fin.silhouette is not None:
        return fin.area / fin.height
    return fin.length - _root_of(fin)


def slender_length(fin: CaudalFin) -> float:
    """Return the added mass of a fin's strips without an effect of its span, over m' of its height [m].

    Args:
        fin: The fin.
    """
    if fin.silhouette is None:
        return mean_chord(fin)
    edges = np.linspace(0.0, fin.length, fin.n_strips + 1)
    return float(np.diff(edges) @ (strip_heights(fin, edges) / fin.height) ** 2)


def outline_of_fin(fin: CaudalFin) -> Outline:
    """Return the upper half of a fin.

    Args:
        fin: The fin.
    """
    if fin.silhouette is None:
        return Outline.rectangle(fin.length, fin.height)
    return Outline(
        height=2.0 * max(z for _, z in fin.silhouette),
        leading=lambda z: _crossings(fin, z)[0],
        trailing=lambda z: _crossings(fin, z)[1],
    )


def _crossings(
    fin: CaudalFin, z: Float[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """Return where a silhouette begins and ends at some heights, the outermost places if there is a gap [m]."""
    corners = np.array(fin.silhouette)
    level = np.minimum(z, BELOW_TOP * corners[:, 1].max())
    first, last = np.full(z.shape, np.inf), np.full(z.shape, -np.inf)
    for (x_0, z_0), (x_1, z_1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if z_0 == z_1:
            continue
        is_between = (level >= min(z_0, z_1)) & (level < max(z_0, z_1))
        crossing = x_0 + (level - z_0) / (z_1 - z_0) * (x_1 - x_0)
        first = np.where(is_between, np.minimum(first, crossing), first)
        last = np.where(is_between, np.maximum(last, crossing), last)
    return first, last


def strip_heights(
    fin: CaudalFin, edges: Float[np.ndarray, " n_edges"]
) -> Float[np.ndarray, " n_strips"]:
    """Return the mean height of the plate in every strip [m].

    Args:
        fin: The fin.
        edges: Distances of the strips' edges behind the root, increasing [m].
    """
    if fin.silhouette is None:
        return np.full(edges.size - 1, fin.height)
    levels = (np.arange(N_LEVELS) + 0.5) / N_LEVELS * 0.5 * fin.height
    places = (np.arange(N_PLACES) + 0.5) / N_PLACES
    x = (edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * places)[:, :, np.newaxis]
    first, last = _crossings(fin, levels)
    is_below_top = levels < max(z for _, z in fin.silhouette)
    on = (x >= first) & (x < last) & is_below_top
    return fin.height * on.mean(axis=(1, 2))
