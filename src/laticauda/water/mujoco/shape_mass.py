"""Added mass and inertia of boxes, cylinders and capsules in unbounded water, from tables.

The tables were computed with boundary elements (campaigns/added_mass.py). They hold shares of simple
expressions, the scales below, which have the right limits for plates and rods, so that every share
lies between 0.1 and 4 and varies slowly with the proportions. A box without thickness is a plate: what it
carries across itself comes from the same functions as that of fins (`laticauda.water.fluid.edges`).
"""

import csv
import functools
import math
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from laticauda.water.fluid.edges import plate_functions
from laticauda.water.mujoco.lamb import lamb

MassShape: TypeAlias = Literal["ellipsoid", "cylinder", "capsule", "box"]
"""Cylinders and capsules are round, with their axis along x."""
BOX_COLUMNS = (
    "short_over_middle",
    "middle_over_long",
    "mass_along_short",
    "mass_along_middle",
    "mass_along_long",
    "inertia_about_short",
    "inertia_about_middle",
    "inertia_about_long",
)
ROUND_COLUMNS = ("shape", "length", "mass_along", "mass_across", "inertia_across")
"""Length is h / (h + r), with h half the length of the cylinder or of the capsule's cylinder."""


ACROSS_PLATE = (0, 4, 5)
"""Columns of a box's shares that move water across a plate: those of `_plate_shares`."""


class AddedMass(NamedTuple):
    """Added mass and inertia of a body in unbounded water, for water of 1 kg/m^3."""

    mass: np.ndarray
    """Along x, y and z [m^3]."""
    inertia: np.ndarray
    """About x, y and z through the middle [m^5]."""


def added_mass(shape: MassShape, half_size: tuple[float, float, float]) -> AddedMass:
    """Return added mass and inertia of a shape in unbounded water, relative to the water's density.

    Ellipsoids: exact. The others: within 1 to 3 % of the boundary-element code (theory page).

    Args:
        shape: Its shape.
        half_size: Half of its length, width and height; a cylinder or capsule has its radius twice [m].

    References:
        H. Lamb, Hydrodynamics, 6th ed., Cambridge 1932, art. 114 and 115.
    """
    if shape == "box":
        return _of_box(np.asarray(half_size, dtype=float))
    half_length, radius, _ = half_size
    if shape == "cylinder":
        shares = _round_shares("cylinder", half_length / (half_length + radius))
        return _of_revolution(shares * cylinder_scale(radius, half_length))
    if shape == "capsule":
        of_cylinder = max(half_length - radius, 0.0)
        shares = _round_shares("capsule", of_cylinder / half_length)
        return _of_revolution(shares * capsule_scale(radius, of_cylinder))
    volume = 4.0 / 3.0 * math.pi * math.prod(half_size)
    per_volume = lamb(half_size)
    return AddedMass(mass=volume * per_volume.mass, inertia=volume * per_volume.inertia)


def box_scale(half: tuple[float, float, float]) -> np.ndarray:
    """Return the six expressions that the shares of a box multiply: strips of the long side, and its ends.

    Of two sides that are as long as each other both have the same expression.

    Args:
        half: Short, middle and long half size [m].
    """
    short, middle, long = half
    return np.array(
        [
            2.0 * math.pi * middle**2 * long,
            2.0 * math.pi * short**2 * long,
            2.0 * math.pi * short**2 * middle,
            2.0 / 3.0 * math.pi * short**2 * long**3,
            2.0 / 3.0 * math.pi * middle**2 * long**3,
            0.25 * math.pi * middle**4 * long,
        ]
    )


def cylinder_scale(radius: float, half_length: float) -> np.ndarray:
    """Return the expressions for a cylinder: along, across, and about an axis across.

    Along: a disc; across: strips, fewer of a flat one; about: strips and a disc.
    """
    disc_inertia = 16.0 / 45.0 * radius**5
    strips_inertia = 2.0 / 3.0 * math.pi * radius**2 * half_length**3
    return np.array(
        [
            8.0 / 3.0 * radius**3,
            2.0 * math.pi * radius**2 * half_length**2 / (half_length + radius),
            disc_inertia + strips_inertia,
        ]
    )


def capsule_scale(radius: float, half_length: float) -> np.ndarray:
    """Return the expressions for a capsule: along, across, and about an axis across.

    Args:
        radius: Its radius [m].
        half_length: Half of the length of its cylinder [m].
    """
    sphere = 2.0 / 3.0 * math.pi * radius**3
    strips = 2.0 * math.pi * radius**2 * half_length
    inertia = 2.0 / 3.0 * math.pi * radius**2 * half_length**2 * (half_length + radius)
    return np.array([sphere, sphere + strips, inertia])


def _of_box(half: np.ndarray) -> AddedMass:
    order = np.argsort(half, kind="stable")
    short, middle, long = (float(half[axis]) for axis in order)
    values = _box_shares(short / middle, middle / long) * box_scale((short, middle, long))
    mass = np.zeros(3)
    inertia = np.zeros(3)
    mass[order] = values[:3]
    inertia[order] = values[3:]
    return AddedMass(mass=mass, inertia=inertia)


def _of_revolution(values: np.ndarray) -> AddedMass:
    along, across, inertia = (float(value) for value in values)
    return AddedMass(
        mass=np.array([along, across, across]), inertia=np.array([0.0, inertia, inertia])
    )


class _BoxTable(NamedTuple):
    """Shares of boxes on a grid of proportions."""

    thin: np.ndarray
    """Short over middle side, (M,) [-]."""
    slender: np.ndarray
    """Middle over long side, (N,) [-]."""
    shares: np.ndarray
    """(M, N, 6) [-]."""


@functools.cache
def _box_table() -> _BoxTable:
    rows = np.array([list(row.values()) for row in _read("shape_mass_box.csv")], dtype=float)
    thin = np.unique(rows[:, 0])
    slender = np.unique(rows[:, 1])
    ordered = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    return _BoxTable(thin, slender, ordered[:, 2:].reshape(len(thin), len(slender), 6))


def _box_shares(thin: float, slender: float) -> np.ndarray:
    """Interpolate linearly in both proportions."""
    table = _box_table()
    row, in_row = _place_in(table.thin, thin)
    column, in_column = _place_in(table.slender, slender)
    shares = table.shares[row : row + 2, column : column + 2]
    if row == 0:
        shares = shares.copy()
        shares[0][:, ACROSS_PLATE] = _plate_shares(slender)
    of_rows: np.ndarray = (1.0 - in_row) * shares[0] + in_row * shares[1]
    return (1.0 - in_column) * of_rows[0] + in_column * of_rows[1]


def _plate_shares(slender: float) -> tuple[float, float, float]:
    """Return the shares of a box without thickness: mass across it, inertia about its middle and its long side.

    It turns about its middle side as a plate does whose chord is the long one, and about its long side as
    one whose chord is the middle one.

    Args:
        slender: Middle over long side [-].
    """
    along = plate_functions(slender)
    upright = plate_functions(1.0 / slender)
    return along.added_mass, along.rotary, 8.0 / 3.0 * upright.rotary / slender


def _place_in(grid: np.ndarray, value: float) -> tuple[int, float]:
    """Return the interval of a grid in which a value lies, and the share of the interval before it."""
    last = len(grid) - 2
    interval = min(int(np.searchsorted(grid, value, side="right")) - 1, last)
    start = float(grid[interval])
    end = float(grid[interval + 1])
    return interval, (value - start) / (end - start)


@functools.cache
def _round_table(shape: str) -> np.ndarray:
    """Return length and three shares, (N, 4) [-]."""
    rows = [row for row in _read("shape_mass_round.csv") if row["shape"] == shape]
    numbers = [list(row.values())[1:] for row in rows]
    return np.array(numbers, dtype=float)


def _round_shares(shape: str, length: float) -> np.ndarray:
    table = _round_table(shape)
    interval, share = _place_in(table[:, 0], length)
    before = table[interval, 1:]
    after = table[interval + 1, 1:]
    return (1.0 - share) * before + share * after


def _read(name: str) -> list[dict[str, str]]:
    with Path(__file__).with_name(name).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))
