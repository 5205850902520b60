"""Fins as plates of finite span: rectangles by the table of the law, silhouettes by the vortex lattice."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float

from laticauda.robot.effectors import CaudalFin
from laticauda.water.fluid.edges import LAG_OF_SPAN, LONGEST_LAG, plate_functions
from laticauda.water.fluid.lattice import compute_plate

N_LEVELS = 200
"""Heights at which the breadth of a silhouette is sampled."""
N_PLACES = 8
"""Places along a strip at which it is."""


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


@lru_cache(maxsize=64)
def fin_plate(fin: CaudalFin) -> FinPlate:
    """Return a fin as a plate; a silhouette takes a twentieth of a second, once.

    Args:
        fin: The fin.
    """
    if fin.silhouette is not None:
        return _plate_of_silhouette(fin)
    root = fin.opening_length if fin.opening == "open" else 0.0
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


def _plate_of_silhouette(fin: CaudalFin) -> FinPlate:
    loads = compute_plate(fin.length, fin.height, lambda x, z: is_inside(fin, x, z))
    slender = 0.25 * np.pi * fin.height**2
    mass, first = loads.added_mass[0]
    center = first / mass
    return FinPlate(
        mass=float(mass / slender),
        center=float(center),
        inertia=float((loads.added_mass[1, 1] - mass * center**2) / slender),
        lift=min(loads.lift / slender, 1.0),
        lift_center=loads.center,
        control=loads.control,
        lag=_lag(fin.area / fin.height, fin.height),
    )


def _lag(chord: float, height: float) -> float:
    """Return l of a plate with a (mean) chord [m]."""
    return min(chord + height / LAG_OF_SPAN, LONGEST_LAG * chord)


def is_inside(
    fin: CaudalFin, x: Float[np.ndarray, "..."], z: Float[np.ndarray, "..."]
) -> Bool[np.ndarray, "..."]:
    """Return whether points lie on the upper half of a fin's silhouette, by the crossings of a ray.

    Args:
        fin: Fin that has a silhouette.
        x: Distances behind the root [m].
        z: Heights above the chord [m].
    """
    corners = np.array(fin.silhouette)
    inside = np.full(np.broadcast_shapes(x.shape, z.shape), False)
    for (x_0, z_0), (x_1, z_1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if z_0 == z_1:
            continue
        is_between = (z >= min(z_0, z_1)) & (z < max(z_0, z_1))
        crossing = x_0 + (z - z_0) / (z_1 - z_0) * (x_1 - x_0)
        inside = inside ^ (is_between & (x < crossing))
    return inside


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
    x = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * places
    on = is_inside(fin, x[:, :, np.newaxis], levels)
    return fin.height * on.mean(axis=(1, 2))
