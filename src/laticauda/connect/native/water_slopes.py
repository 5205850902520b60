"""How the kernels' rows depend on the water's density and coefficients, from layouts of the robot in other waters.

Each row is the sum of a constant, a constant times the density, and, for each coefficient, a
constant times the density times that coefficient (`laticauda.robot.hydrodynamics`); products of two
coefficients do not occur. Differences between layouts are therefore exact slopes, up to rounding,
and not a linearization.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.connect.native import entry
from laticauda.connect.native.variable import Variable
from laticauda.models.planar import PlanarPlant, build_layout

DENSITY_ROUNDING = 1e-12
"""Share of a row below which its change with the density is rounding [-]."""
ROUNDING = 1e-13
"""Share of a row below which its change with a field of the water is rounding [-]."""


class Term(NamedTuple):
    """A product of a water coefficient and the density, on which rows depend."""

    coefficient: int
    """Number of the coefficient's variable; `entry.NONE`: the density alone [-]."""
    density: int
    """Number of the density's variable [-]."""
    value: float
    """Value of the product in the template."""


class RowSlope(NamedTuple):
    """How a row depends on a term."""

    term: int
    """Number of the term [-]."""
    row: int
    """Index of the row [-]."""
    slope: float
    """Change of the row per unit of the term."""


class WaterSlopes(NamedTuple):
    """All terms, and all slopes that are not zero."""

    terms: list[Term]
    """Products of coefficients and density, the density alone last."""
    slopes: list[RowSlope]
    """Slopes, ordered by term and row."""


def find_water_slopes(plant: PlanarPlant, variables: Sequence[Variable]) -> WaterSlopes:
    """Compute how the rows depend on density and coefficients.

    Args:
        plant: Plant in water.
        variables: All variables, among them those of the water.
    """
    water = plant.environment
    assert isinstance(water, lc.Water)
    numbers: dict[str, int] = {}
    for number, variable in enumerate(variables):
        if variable.coefficient:
            numbers[variable.coefficient] = number
    density = numbers.pop("density")
    template = plant.layout.template
    terms: list[Term] = []
    slopes: list[RowSlope] = []
    # Per unit of density, at the coefficients of this water.
    density_slope = _change_per_unit(plant, water, "density", step=water.density)
    for name, coefficient in numbers.items():
        value: float = getattr(water, name)
        change = _change_per_unit(plant, water, name, step=max(1.0, value))
        slope = change / water.density
        density_slope -= value * slope
        slopes.extend(_list_slopes(len(terms), slope))
        terms.append(Term(coefficient=coefficient, density=density, value=value * water.density))
    is_rounding = np.abs(density_slope) * water.density <= DENSITY_ROUNDING * np.abs(template)
    density_slope[is_rounding] = 0.0
    slopes.extend(_list_slopes(len(terms), density_slope))
    terms.append(Term(coefficient=entry.NONE, density=density, value=water.density))
    return WaterSlopes(terms=terms, slopes=slopes)


def _list_slopes(term: int, slope_of_rows: np.ndarray) -> list[RowSlope]:
    """Return the slopes of all rows that depend on a term."""
    slopes: list[RowSlope] = []
    for row in np.flatnonzero(slope_of_rows):
        slopes.append(RowSlope(term=term, row=int(row), slope=float(slope_of_rows[row])))
    return slopes


def _change_per_unit(plant: PlanarPlant, water: lc.Water, field: str, *, step: float) -> np.ndarray:
    """Return the change of the rows per unit of a field of the water."""
    template = plant.layout.template
    changed_field: Any = {field: getattr(water, field) + step}
    changed_water = replace(water, **changed_field)
    changed_layout = build_layout(plant.robot, changed_water, joints=plant.joints)
    difference = changed_layout.template - template
    change = difference / step
    change[np.abs(difference) <= ROUNDING * np.abs(template)] = 0.0
    return change
