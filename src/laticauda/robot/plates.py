"""Fins and flat modules as plates: drag and added mass across them from their own proportions.

Drag and added mass of a body's sections do not hold for thin plates on it: a fin has free edges on
all sides, and is no box. In a water with `plate_drag` and `plate_added_mass`, fins and flat modules that
have no coefficients of their own take those of rectangular plates, times these factors
(`laticauda.water.plates`, `laticauda.water.fluid.edges`). A fin behind a body has the added mass that the
lattice gives it there (`laticauda.robot.silhouettes`). Flat modules in a row are one plate. Where it
adjoins another part of the robot, the water cannot go around its end: of what free ends take off
the added mass of a slender plate, each takes half.
"""

from collections.abc import Sequence
from functools import lru_cache
from itertools import groupby
from typing import NamedTuple

from laticauda.robot.body import Module, is_flat
from laticauda.robot.robot import Robot
from laticauda.robot.silhouettes import (
    fin_plate,
    mean_chord,
    slender_length,
)
from laticauda.values import add_up
from laticauda.water.fluid.edges import plate_functions
from laticauda.water.plates import plate_drag


class PlateCoefficients(NamedTuple):
    """Coefficients of one plate across the flow."""

    drag: float
    """C_D [-]."""
    added_mass: float
    """C_A [-]."""


def plate_of_fin(robot: Robot) -> PlateCoefficients | None:
    """Return the coefficients of a robot's fin as a plate, behind what is ahead of it; None without a fin.

    Args:
        robot: The robot.
    """
    fin, plate = robot.caudal_fin, fin_plate(robot)
    if fin is None or plate is None:
        return None
    return PlateCoefficients(
        drag=plate_drag(fin.height, mean_chord(fin)),
        added_mass=plate.mass / slender_length(fin),
    )


@lru_cache(maxsize=256)
def plates_of_modules(robot: Robot) -> tuple[PlateCoefficients | None, ...]:
    """Return the coefficients of each module as a part of a plate, tail first; None for one that is not flat.

    Args:
        robot: The robot.
    """
    plates: list[PlateCoefficients | None] = []
    for flat, group in groupby(robot.modules, key=is_flat):
        row = list(group)
        if not flat:
            plates += [None] * len(row)
            continue
        begins_free = not plates and robot.caudal_fin is None
        ends_free = len(plates) + len(row) == robot.n_links
        plate = _plate_of_row(row, n_free_ends=int(begins_free) + int(ends_free))
        plates += [plate] * len(row)
    return tuple(plates)


def _plate_of_row(row: Sequence[Module], *, n_free_ends: int) -> PlateCoefficients:
    """Return the coefficients of flat modules in a row, as of one plate of their mean height."""
    length = add_up(module.length for module in row)
    face = add_up(2.0 * module.section.half_height * module.length for module in row)
    height = face / length
    lacking = 1.0 - plate_functions(height / length).added_mass
    return PlateCoefficients(
        drag=plate_drag(height, length), added_mass=1.0 - 0.5 * n_free_ends * lacking
    )
