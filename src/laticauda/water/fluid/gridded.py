"""Water with motion on a grid of places and times, as a flow; any flow can be sampled to such a grid.

`laticauda.water.fluid.grids` says what a Dataset must hold, and `laticauda.water.fluid.cells` how
the motion is interpolated between the nodes.
"""

import functools
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from laticauda.values import BadArgument, option, quantity, table_address, value_class
from laticauda.water.fluid.cells import HOLD, REFUSE, STILL, build_cells
from laticauda.water.fluid.flow import Flow
from laticauda.water.fluid.grids import (
    AXES,
    COMPONENTS,
    NAMES,
    UNITS,
    Axis,
    Grid,
    grid_of,
    read_grid,
)

if TYPE_CHECKING:
    import xarray


def to_dataset(flow: Flow, **axes: Sequence[float] | np.ndarray) -> "xarray.Dataset":
    """Sample any flow on a grid for `Gridded` and other programs; ``to_netcdf`` writes the result to a file.

    Args:
        flow: Flow to sample.
        axes: Nodes along `time` since the start of a run [s], and along `z` above the mean surface,
            `y` and `x` [m]; an omitted axis is missing in the grid, and the flow is sampled where
            its coordinate is 0.
    """
    unknown_axes = axes.keys() - set(AXES)
    if unknown_axes:
        raise BadArgument(unknown_axes.pop(), f"must be one of {', '.join(AXES)}, got another axis")
    nodes = [np.asarray(axes.get(name, [0.0]), dtype=float) for name in AXES]
    t, z, y, x = np.meshgrid(*nodes, indexing="ij")
    motion = flow.motion(x, y, z, t)
    dims = [name for name in AXES if name in axes]
    sizes = [len(axes[name]) for name in dims]
    variables: dict[str, Any] = {}
    for name in COMPONENTS:
        values = np.broadcast_to(getattr(motion, name), x.shape)
        variables[name] = (dims, values.reshape(sizes), _attributes_of(name))
    coordinates = {name: (name, axes[name], _attributes_of(name)) for name in dims}
    attributes = {"Conventions": "CF-1.11", "title": flow.words}
    return import_module("xarray").Dataset(variables, coordinates, attributes)


def _attributes_of(name: str) -> dict[str, str]:
    """Return unit and standard name of a variable or coordinate."""
    our_unit = next(iter(UNITS[name]))
    return {"units": our_unit, "standard_name": NAMES[name][1]}


@value_class
class Gridded(Flow):
    """Water whose motion is known on a grid of places and times.

    The motion is constant along an axis that the grid lacks. Above the highest level and below the
    lowest one, it is that of the nearest level.
    """

    source: Any = option(
        "A netCDF file (in a file, relative to its folder) or an xarray Dataset (not stored in files)"
    )
    outside: Literal["refuse", "hold", "zero", "periodic"] = option(
        "Beyond its edges in x and y: end the run, keep the motion at the edge, no motion, or repeat",
        default="refuse",
    )
    beyond: Literal["refuse", "hold", "zero", "periodic"] = option(
        "The same before its first and after its last time", default="refuse"
    )
    start: float = quantity(
        "s", "Grid time at which a run begins, from the first if that is a date", default=0.0
    )
    digest: str = option("Digest of its values; filled in, and checked if given", default="")

    def __post_init__(self) -> None:
        """Make a path absolute, convert a Dataset to a grid, and compute the digest."""
        if isinstance(self.source, str | Path):
            source: str | Grid = str(Path(self.source).resolve())
        else:
            source = grid_of(self.source)
        object.__setattr__(self, "source", source)
        object.__setattr__(self, "digest", self.digest or self.grid.digest)

    @functools.cached_property
    def grid(self) -> Grid:
        """Grid on which the flow is known.

        Raises:
            ValueError: If the file has changed since its digest was computed, or cannot be read.
        """
        grid = self.source
        if isinstance(self.source, str):
            grid = read_grid(self.source)
        if self.digest not in ("", grid.digest):
            raise BadArgument(
                "digest", f"must match `{self.source}`, which has changed since, got {self.digest}"
            )
        return grid

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Axes in the order of `AXES`, with time from the start of the run."""
        time, z, y, x = self.grid.axes
        return (time._replace(first=time.first - self.start), z, y, x)

    @property
    def parts(self) -> tuple[Flow, ...]:
        """A single part, which is not cached because its address is valid in one process only."""
        numbers = {"table": table_address(self.grid.table)}
        rules = (self.beyond, "hold", self.outside, self.outside)
        for name, axis, rule in zip("tzyx", self.axes, rules, strict=True):
            numbers[f"{name}_first"] = axis.first
            numbers[f"{name}_per_step"] = 1.0 / axis.step
            numbers[f"{name}_count"] = axis.nodes
            numbers[f"{name}_rule"] = _code_of(rule, axis)
        return (build_cells(self.grid, numbers),)

    @property
    def limits(self) -> str:
        """See `Flow.limits`."""
        rules = {"time": self.beyond, "y": self.outside, "x": self.outside}
        limited = [
            f"{name} from {axis.first:g} to {axis.last:g}"
            for name, axis in zip(AXES, self.axes, strict=True)
            if axis.nodes > 1 and rules.get(name) == "refuse"
        ]
        if not limited:
            return ""
        return f"{self.words} is known for {', '.join(limited)} (s, m)"

    @property
    def words(self) -> str:
        """Description of the flow."""
        if isinstance(self.source, str):
            return f"the flow of `{self.source}`"
        return "a flow on a grid"


def _code_of(rule: str, axis: Axis) -> float:
    """Return the number by which kernels know what lies beyond the ends of an axis, see `Cells`."""
    if rule == "periodic":
        return 1.0 / axis.nodes
    return {"hold": HOLD, "zero": STILL, "refuse": REFUSE}[rule]
