"""Interpolation of a flow between the nodes of a grid, for kernels, which read the nodes in memory.

Between the nodes the motion is multilinear: velocity and elevation are continuous and of second
order in the grid's steps; the gradients, which are those of the same cell, are of first order.

Which axes a grid has is known when its formula is built. The formula is therefore composed of
functions for just these axes, each of which interpolates between two results of the one before: of
2^n nodes, none is read in vain.
"""

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda.values import Formula, first_lane, table_row, where
from laticauda.water.fluid.flow import Flow
from laticauda.water.fluid.grids import COMPONENTS, Grid

EDGE = 1e-9
"""Distance in steps beyond which a place is outside [-]."""
HOLD = 0.0
"""Rule of an axis beyond which the motion is that at the edge."""
STILL = -1.0
"""Rule of an axis beyond which there is no motion."""
REFUSE = -2.0
"""Rule of an axis beyond which a run ends: rates are not a number there."""


def build_cells(grid: Grid, numbers: Mapping[str, float]) -> Flow:
    """Return the flow that interpolates in a grid; it has no name of its own among the flows.

    Args:
        grid: Grid that owns the table.
        numbers: Address of the table, and for each of the axes t, z, y, x its first node, steps per
            unit, number of nodes, and rule beyond its ends.
    """
    return _Cells(grid=grid, values=numbers)


@dataclass(frozen=True, eq=False)
class _Cells(Flow):
    """The numbers of a grid: address of its table, and for each axis its first node, steps per unit, nodes and rule.

    Outside the grid, the rule is 1 / nodes for a periodic grid, whose first node follows one step
    after its last, as on a missing axis; `HOLD`, `STILL` or `REFUSE` otherwise.
    """

    grid: Grid
    """Grid that owns the table; it lives as long as this object."""
    values: Mapping[str, float]
    """All numbers by name."""

    def __post_init__(self) -> None:
        vars(self).update(self.values)  # a formula finds its numbers as fields

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of nodes per axis, which must be the same for all runs side by side."""
        return tuple(axis.nodes for axis in self.grid.axes)

    @property
    def formula(self) -> Formula:
        """Formula for all grids that have the same axes."""
        has_axis = tuple(count > 1 for count in reversed(self.shape))
        return Formula(name="Gridded", function=_interpolation(has_axis), fields=tuple(self.values))


@functools.cache
def _interpolation(has_axis: tuple[bool, ...]) -> Callable[..., Any]:
    """Return the formula of all grids that have the given ones of the axes x, y, z and t."""
    at_place: Any = _at_node
    count = len(COMPONENTS)
    slopes = ""
    cells = ""
    for k, name in enumerate("xyzt"):
        if not has_axis[k]:
            slopes += "0.0 * f[0], " * len(COMPONENTS)
            cells += "(0.0, 0.0, 0.0, 1.0, 0.0), "
            continue
        slopes += "".join(f"f[{count + j}], " for j in range(len(COMPONENTS)))
        cells += (
            f"cell({name}, law.{name}_first, law.{name}_per_step, "
            f"law.{name}_count.real, law.{name}_rule.real), "
        )
        at_place = _between_nodes(at_place, count, k)
        count += len(COMPONENTS)
    whole = eval(f"lambda f: (f[0], f[1], f[2], f[3], {slopes})")
    cells_of = eval(f"lambda law, x, y, z, t: ({cells})", {"cell": _cell})

    def interpolated(self: Any, x: float, y: float, z: float, t: float) -> Any:
        n_y = first_lane(self.x_count.real) + 1.0
        n_z = n_y * (first_lane(self.y_count.real) + 1.0)
        n_t = n_z * (first_lane(self.z_count.real) + 1.0)
        at_x, at_y, at_z, at_t = cells_of(self, x, y, z, t)
        i_x, f_x, per_x, in_x, no_x = at_x
        i_y, f_y, per_y, in_y, no_y = at_y
        i_z, f_z, per_z, _, _ = at_z
        i_t, f_t, per_t, in_t, no_t = at_t
        first = i_x + n_y * i_y + n_z * i_z + n_t * i_t
        ways = 1.0, f_x, n_y, f_y, n_z, f_z, n_t, f_t
        f = whole(at_place(self.table.real, first, 0.0, ways))
        share = in_x * in_y * in_t
        refused = no_x + no_y + no_t
        velocity = f[0] * share, f[1] * share, f[2] * share
        rates = f[16] * per_t + refused, f[17] * per_t + refused, f[18] * per_t + refused
        slopes_of_u = f[4] * per_x, f[8] * per_y, f[12] * per_z
        slopes_of_v = f[5] * per_x, f[9] * per_y, f[13] * per_z
        slopes_of_w = f[6] * per_x, f[10] * per_y, f[14] * per_z
        return *velocity, *rates, *slopes_of_u, *slopes_of_v, *slopes_of_w, f[3] * share

    return interpolated


def _at_node(table: float, i: float, further: float, ways: Any) -> Any:
    return table_row(table, i, further)


def _between_nodes(at_node: Any, count: int, k: int) -> Any:
    """Return a function that interpolates numbers between two nodes, then appends the first ones' slopes per step.

    Args:
        at_node: Function of table, node, nodes to add and `ways`, which returns `count` numbers.
        count: Number of numbers.
        k: Number of the axis; `ways` holds, for each axis, the nodes from one node along it to the
            next, and the fraction of the way between them.
    """
    mixtures = "".join(f"a[{j}] + f * (b[{j}] - a[{j}]), " for j in range(count))
    slopes = "".join(f"b[{j}] - a[{j}], " for j in range(len(COMPONENTS)))
    mixed = eval(f"lambda a, b, f: ({mixtures}{slopes})")
    this_node = "before(table, i, further, c)"
    next_node = f"before(table, i, further + c[{2 * k}], c)"
    return eval(
        f"lambda table, i, further, c: mixed({this_node}, {next_node}, c[{2 * k + 1}])",
        {"mixed": mixed, "before": at_node},
    )


def _cell(at: float, first: float, per_step: float, count: float, rule: float) -> Any:
    """Locate a place on an axis: node before it, fraction to the next, slope factor, motion factor, nan or 0."""
    wraps = where(rule > 0.0, rule, 0.0)
    last = count - 1.0 + wraps * count
    p = (at - first) * per_step
    p = p - count * np.floor(p.real * wraps)
    is_inside = (p.real >= -EDGE) & (p.real <= last + EDGE)
    inside = where(is_inside, 1.0, 0.0)
    p = where(p.real > 0.0, p, 0.0 * p)
    p = where(p.real < last, p, last + 0.0 * p)
    # A valid node even if the place is not a number.
    i = np.floor(where(p.real < last - 1.0, p.real, last - 1.0))
    refused = where(is_inside, 0.0, where(rule < -1.5, math.nan, 0.0))
    share = where(rule == -1.0, inside, 1.0)
    return i, p - i, inside * per_step, share, refused
