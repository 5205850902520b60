"""Water whose motion is known on a grid of places and times, from a netCDF file or an xarray Dataset.

Between the nodes the motion is multilinear: velocity and elevation are continuous and right to the square of the grid's
steps, and the gradients, which are those of the same cell, to their first power. Kernels read the nodes where they lie
in memory (`laticauda.scalars.table_row`).
"""

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from laticauda.errors import BadArgument
from laticauda.fluid.flow import Flow
from laticauda.fluid.grids import AXES, COMPONENTS, Axis, Grid, grid_of, read
from laticauda.formulas import Formula
from laticauda.quantities import option, quantity, value
from laticauda.scalars import first_lane, table_address, table_row, where

EDGE = 1e-9  # of a step, beyond which a place is outside


@value
class Gridded(Flow):
    """Water whose motion is known on a grid of places and times.

    Where the grid lacks an axis, nothing changes along it. Above its highest level and below its lowest one, the motion
    is that of the level.
    """

    source: Any = option("A netCDF file, where a file names it from its folder, or an xarray Dataset, which none keeps")
    outside: Literal["refuse", "hold", "zero", "periodic"] = option(
        "In x and y: runs end there, or the motion at the edge, or none, or the grid again and again", default="refuse"
    )
    beyond: Literal["refuse", "hold", "zero", "periodic"] = option(
        "Before its first and after its last time: likewise", default="refuse"
    )
    start: float = quantity("s", "The grid's time at which a run begins, from its first if that is a date", default=0.0)
    digest: str = option("Of its numbers; filled in, and checked where it is given", default="")

    def __post_init__(self) -> None:
        is_path = isinstance(self.source, str | Path)
        object.__setattr__(self, "source", str(Path(self.source).resolve()) if is_path else grid_of(self.source))
        object.__setattr__(self, "digest", self.digest or self.grid.digest)

    @functools.cached_property
    def grid(self) -> Grid:
        """What it is known on.

        Raises:
            ValueError: If the file has changed since its digest was taken, or cannot be read.
        """
        grid = read(self.source) if isinstance(self.source, str) else self.source
        if self.digest not in ("", grid.digest):
            raise BadArgument("digest", f"must be that of `{self.source}`, which has changed since, got {self.digest}")
        return grid

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Those of `AXES`, time from the start of the run."""
        time, *others = self.grid.axes
        return (time._replace(first=time.first - self.start), *others)

    @property
    def parts(self) -> tuple[Flow, ...]:
        """One, which is not kept: an address is good in one process only."""
        numbers = {"table": table_address(self.grid.table)}
        for name, axis, rule in zip("tzyx", self.axes, (self.beyond, "hold", *2 * [self.outside]), strict=True):
            codes = {"periodic": 1.0 / axis.nodes, "hold": 0.0, "zero": -1.0, "refuse": -2.0}
            own = {"first": axis.first, "per_step": 1.0 / axis.step, "count": axis.nodes, "rule": codes[rule]}
            numbers |= {f"{name}_{word}": number for word, number in own.items()}
        return (_Cells(grid=self.grid, values=numbers),)

    @property
    def limits(self) -> str:
        """See `Flow.limits`."""
        rules = {"time": self.beyond, "y": self.outside, "x": self.outside}
        known = [
            f"{name} from {axis.first:g} to {axis.first + axis.step * (axis.nodes - 1):g}"
            for name, axis in zip(AXES, self.axes, strict=True)
            if axis.nodes > 1 and rules.get(name) == "refuse"
        ]
        return f"{self.words} is known for {', '.join(known)} (s, m)" if known else ""

    @property
    def words(self) -> str:
        """What it is, for people."""
        return f"the flow of `{self.source}`" if isinstance(self.source, str) else "a flow on a grid"


@dataclass(frozen=True, eq=False)
class _Cells(Flow):
    """The numbers of a grid: where its table lies, and per axis where it begins, steps per unit, nodes, and a rule.

    The rule is 1 / nodes where the grid goes on from its begin, one step behind its end, as along an axis that is
    missing; 0 where its ends are held; -1 where there is nothing; and -2 where runs end, because rates are no numbers.
    """

    grid: Grid
    """Whose table it is, which lives as long as this."""
    values: Mapping[str, float]
    """All numbers by name."""

    def __post_init__(self) -> None:
        vars(self).update(self.values)

    @property
    def shape(self) -> tuple[int, ...]:
        """What all must have in common that run side by side."""
        return tuple(axis.nodes for axis in self.grid.axes)

    @property
    def formula(self) -> Formula:
        """One for all grids that have the same axes."""
        function = _interpolating(tuple(count > 1 for count in reversed(self.shape)))
        return Formula(name="Gridded", function=function, fields=(*self.values,))


@functools.cache
def _interpolating(there: tuple[bool, ...]) -> Callable[..., Any]:
    """The formula of all grids that have these of the axes x, y, z and t."""
    between, count, slopes, cells = _at_node, len(COMPONENTS), "", ""
    for k, (name, is_there) in enumerate(zip("xyzt", there, strict=True)):
        slopes += "".join(f"f[{count + j}], " if is_there else "0.0 * f[0], " for j in range(len(COMPONENTS)))
        numbers = ", ".join(f"law.{name}_{one}" for one in ("first", "per_step", "count.real", "rule.real"))
        cells += f"cell({name}, {numbers}), " if is_there else "(0.0, 0.0, 0.0, 1.0, 0.0), "
        if is_there:
            between, count = _along(between, count, k), count + len(COMPONENTS)
    whole = eval(f"lambda f: (f[0], f[1], f[2], f[3], {slopes})")
    cells_of = eval(f"lambda law, x, y, z, t: ({cells})", {"cell": _cell})

    def interpolated(self: Any, x: float, y: float, z: float, t: float) -> Any:
        n_y = first_lane(self.x_count.real) + 1.0
        n_z = n_y * (first_lane(self.y_count.real) + 1.0)
        n_t = n_z * (first_lane(self.z_count.real) + 1.0)
        at_x, at_y, (i_z, f_z, z, _, _), at_t = cells_of(self, x, y, z, t)
        (i_x, f_x, x, in_x, no_x), (i_y, f_y, y, in_y, no_y), (i_t, f_t, t, in_t, no_t) = at_x, at_y, at_t
        ways = 1.0, f_x, n_y, f_y, n_z, f_z, n_t, f_t
        f = whole(between(self.table.real, i_x + n_y * i_y + n_z * i_z + n_t * i_t, 0.0, ways))
        known = in_x * in_y * in_t
        none = no_x + no_y + no_t
        rates = f[16] * t + none, f[17] * t + none, f[18] * t + none
        slopes = f[4] * x, f[8] * y, f[12] * z, f[5] * x, f[9] * y, f[13] * z, f[6] * x, f[10] * y, f[14] * z
        return f[0] * known, f[1] * known, f[2] * known, *rates, *slopes, f[3] * known

    return interpolated


def _at_node(table: float, i: float, further: float, ways: Any) -> Any:
    return table_row(table, i, further)


def _along(before: Any, count: int, k: int) -> Any:
    """Numbers between two nodes of an axis: those that are known at nodes, then the slopes per step of the first."""
    between = "".join(f"a[{j}] + f * (b[{j}] - a[{j}]), " for j in range(count))
    slopes = "".join(f"b[{j}] - a[{j}], " for j in range(len(COMPONENTS)))
    names = {"mixed": eval(f"lambda a, b, f: ({between}{slopes})"), "before": before}
    way = f"before(table, i, further + c[{2 * k}], c), c[{2 * k + 1}]"
    return eval(f"lambda table, i, further, c: mixed(before(table, i, further, c), {way})", names)


def _cell(at: float, first: float, per_step: float, count: float, rule: float) -> Any:
    """Where a place is on an axis: node before it, share of the way to the next, slope, what is there, nan or 0."""
    wraps = where(rule > 0.0, rule, 0.0)
    last = count - 1.0 + wraps * count
    p = (at - first) * per_step
    p = p - count * np.floor(p.real * wraps)
    is_inside = (p.real >= -EDGE) & (p.real <= last + EDGE)
    inside = where(is_inside, 1.0, 0.0)
    p = where(p.real > 0.0, p, 0.0 * p)
    p = where(p.real < last, p, last + 0.0 * p)
    i = np.floor(where(p.real < last - 1.0, p.real, last - 1.0))  # a node even if the place is no number
    refused = where(is_inside, 0.0, where(rule < -1.5, math.nan, 0.0))
    return i, p - i, inside * per_step, where(rule == -1.0, inside, 1.0), refused
