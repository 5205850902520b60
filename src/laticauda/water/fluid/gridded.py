"""Water with motion on a grid of places and times, from netCDF or an xarray Dataset; any flow can be sampled to one.

A Dataset has the velocities `u`, `v` and optionally `w` [m/s] and the `elevation` of the surface
[m], over the coordinates `time`, `z` (or `depth`, positive down), `y` and `x`, any of which may be
missing. Names and units of the CF conventions are supported; degrees are not, because the world is
flat here.

Between the nodes the motion is multilinear: velocity and elevation are continuous and of second
order in the grid's steps; the gradients, which are those of the same cell, are of first order.
Kernels read the nodes where they are in memory (`laticauda.values.scalars.table_row`).
"""

import functools
import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from laticauda.values import (
    BadArgument,
    Formula,
    check_instance,
    first_lane,
    option,
    quantity,
    show_value,
    table_address,
    table_row,
    value_class,
    where,
)
from laticauda.water.fluid.flow import Flow

if TYPE_CHECKING:
    import xarray

COMPONENTS = ("u", "v", "w", "elevation")
AXES = ("time", "z", "y", "x")
NAMES = {
    "u": ["u", "sea_water_x_velocity", "eastward_sea_water_velocity", "uo"],
    "v": ["v", "sea_water_y_velocity", "northward_sea_water_velocity", "vo"],
    "w": ["w", "upward_sea_water_velocity", "wo"],
    "elevation": ["elevation", "sea_surface_height_above_mean_sea_level", "zeta"],
    "time": ["t", "time"],
    "z": ["z", "height", "depth", "altitude"],
    "y": ["y", "projection_y_coordinate"],
    "x": ["x", "projection_x_coordinate"],
}
"""Accepted names of variables and coordinates: their name or attribute `standard_name`, which is the second entry."""
_METERS = {"m": 1.0, "meter": 1.0, "meters": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0}
_SPEEDS = {
    f"{meter}{per}": factor
    for meter, factor in _METERS.items()
    for per in ("/s", " s-1", " s^-1", "/second")
}
_TIMES = {"s": 1.0, "seconds": 1.0, "minutes": 60.0, "h": 3600.0, "hours": 3600.0, "days": 86400.0}
UNITS = {
    **dict.fromkeys("uvw", _SPEEDS),
    **dict.fromkeys(("elevation", *"zyx"), _METERS),
    "time": _TIMES,
}
"""Accepted units with their factors to our units; our own units come first, and are assumed if there are none."""


class Axis(NamedTuple):
    """Nodes at equal steps; a single node if the axis is missing."""

    first: float = 0.0
    step: float = 1.0
    nodes: int = 1


class Grid:
    """A flow at the nodes of a grid; grids with the same digest are equal.

    Args:
        axes: Axes in the order of `AXES` [s], [m].
        table: Velocity and elevation at every node, nodes along x next to each other, shape (n, 4);
            the last node of each axis is followed by its first one again.
    """

    def __init__(self, axes: tuple[Axis, ...], table: np.ndarray) -> None:
        self.axes, self.table = axes, table
        self.digest = hashlib.sha256(f"{axes}".encode() + table.tobytes()).hexdigest()

    def __eq__(self, other: object) -> bool:
        """Compare the digests."""
        return isinstance(other, Grid) and other.digest == self.digest

    def __hash__(self) -> int:
        """Return the hash of the digest."""
        return hash(self.digest)


def read_grid(file: str) -> Grid:
    """Return the grid in a netCDF file; the last few grids are cached until their files change.

    Args:
        file: Path of the file.

    Raises:
        ValueError: If the file cannot be read or does not hold a flow.
    """
    try:
        return _read(file, Path(file).stat().st_mtime_ns)
    except (OSError, RuntimeError, ValueError) as error:
        rule = (
            f"must be a netCDF file that holds a flow, got {file}: {' '.join(str(error).split())}"
        )
        raise BadArgument("source", rule.rstrip(".")) from error


@functools.lru_cache(maxsize=4)
def _read(file: str, changed: int) -> Grid:
    xarray: Any = import_module("xarray")
    with xarray.open_dataset(file, engine="netcdf4", decode_timedelta=False) as dataset:
        return grid_of(dataset)


def grid_of(dataset: "xarray.Dataset | Grid") -> Grid:
    """Convert a Dataset to a grid.

    Args:
        dataset: Dataset as described for the module, or a grid, which is returned unchanged.

    Raises:
        ValueError: If something is missing or invalid; the message says what and where.
    """
    given: Any = dataset
    if isinstance(dataset, Grid):
        return dataset
    check_instance("source", given, import_module("xarray").Dataset)
    called = {name: _called(given, name) for name in NAMES}
    there = [name for name in COMPONENTS if called[name] is not None]
    if there[:2] != ["u", "v"]:
        listed = ", ".join(f"`{name}`" for name in given.variables)
        raise BadArgument(
            "source", f"must have variables `u` and `v`, by name or `standard_name`, got {listed}"
        )
    ours: Any = given.rename(
        {one: name for name, one in called.items() if one not in (None, name)}
    )[there]
    units = [_unit(called[name], name, ours[name]) for name in there]
    ours = ours.expand_dims([axis for axis in AXES if axis not in ours.dims])
    axes: list[Axis] = []
    for name in AXES:
        if ours.sizes[name] > 1:
            ours = _placed(called[name] or name, name, ours)
        nodes = ours[name].values if ours.sizes[name] > 1 else np.arange(2.0)
        axes.append(
            Axis(float(nodes[0]), float(nodes[-1] - nodes[0]) / (nodes.size - 1), ours.sizes[name])
        )
    values = np.zeros((*(axis.nodes for axis in axes), len(COMPONENTS)))
    values[..., [COMPONENTS.index(name) for name in there]] = (
        ours.to_array("of").transpose(*AXES, "of").values * units
    )
    table = np.pad(values, [*[(0, 1)] * 4, (0, 0)], "wrap").reshape(-1, len(COMPONENTS))
    return Grid(tuple(axes), table)


def _called(dataset: Any, name: str) -> Any:
    """Return a Dataset's name for one of `NAMES`, None if it has none."""
    every = [*dataset.variables, *(dim for dim in dataset.dims if dim not in dataset.variables)]
    words = [(one, (str(one).lower(), dataset[one].attrs.get("standard_name"))) for one in every]
    return next((one for one, both in words if any(word in NAMES[name] for word in both)), None)


def _unit(called: str, name: str, variable: Any) -> float:
    """Return the factor from the unit of a variable or coordinate to ours; check for gaps and other dimensions."""
    given = variable.attrs.get("units", next(iter(UNITS[name])))
    if given not in UNITS[name]:
        raise BadArgument(
            called,
            f"must be in {', '.join(list(UNITS[name])[:4])} or the like, got {show_value(given)}",
        )
    other = [dim for dim in variable.dims if dim not in AXES]
    if other:
        raise BadArgument(
            called,
            f"must depend only on time, z (or depth), y and x, got the dimension `{other[0]}`",
        )
    gaps = np.argwhere(~np.isfinite(variable.values))
    if len(gaps):
        first = ", ".join(
            f"{dim} = {variable[dim].values[i]}"
            for dim, i in zip(variable.dims, gaps[0], strict=True)
        )
        rule = f"must be a number at all {variable.size} nodes, got {len(gaps)} gaps, the first at {first}"
        raise BadArgument(called, f"{rule}; fill them, e.g. with `dataset.fillna(0.0)`")
    return UNITS[name][given]


def _placed(called: str, name: str, ours: Any) -> Any:
    """Return a Dataset with the coordinate of an axis ascending and in our unit; dates count from the first."""
    if name not in ours.coords:
        raise BadArgument(called, "must have coordinates that give the positions of the nodes")
    at, attributes = ours[name].values, ours[name].attrs
    if at.dtype.kind == "M":
        at = (at - at[0]) / np.timedelta64(1, "s")
    else:
        down = (
            name == "z"
            and attributes.get("positive", "down" if called.lower() == "depth" else "up") == "down"
        )
        at = at.astype(float) * _unit(called, name, ours[name]) * (-1.0 if down else 1.0)
    ours = ours.assign_coords({name: at})
    if at[0] > at[-1]:
        ours, at = ours.isel({name: slice(None, None, -1)}), at[::-1]
    least, most = float(np.diff(at).min()), float(np.diff(at).max())
    if not (least > 0.0 and most - least < 1e-3 * least):
        rule = f"must ascend or descend in equal steps, got steps from {least:g} to {most:g}"
        raise BadArgument(called, f"{rule}; interpolate it, e.g. with `dataset.interp`")
    return ours


def to_dataset(flow: Flow, **axes: Sequence[float] | np.ndarray) -> "xarray.Dataset":
    """Sample any flow on a grid for `Gridded` and other programs; ``to_netcdf`` writes the result to a file.

    Args:
        flow: Flow to sample.
        axes: Nodes along `time` since the start of a run [s], and along `z` above the mean surface,
            `y` and `x` [m]; an omitted axis is missing in the grid, and the flow is sampled where
            its coordinate is 0.
    """
    if unknown := axes.keys() - set(AXES):
        raise BadArgument(unknown.pop(), f"must be one of {', '.join(AXES)}, got another axis")
    t, z, y, x = np.meshgrid(
        *(np.asarray(axes.get(name, [0.0]), dtype=float) for name in AXES), indexing="ij"
    )
    motion, there = flow.motion(x, y, z, t), [name for name in AXES if name in axes]
    size = [len(axes[name]) for name in there]

    def about(name: str) -> dict[str, str]:
        return {"units": next(iter(UNITS[name])), "standard_name": NAMES[name][1]}

    shaped = {
        name: np.broadcast_to(getattr(motion, name), x.shape).reshape(size) for name in COMPONENTS
    }
    made = {name: (there, shaped[name], about(name)) for name in COMPONENTS}
    coordinates = {name: (name, axes[name], about(name)) for name in there}
    return import_module("xarray").Dataset(
        made, coordinates, {"Conventions": "CF-1.11", "title": flow.words}
    )


EDGE = 1e-9  # distance in steps beyond which a place is outside


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
        is_path = isinstance(self.source, str | Path)
        object.__setattr__(
            self, "source", str(Path(self.source).resolve()) if is_path else grid_of(self.source)
        )
        object.__setattr__(self, "digest", self.digest or self.grid.digest)

    @functools.cached_property
    def grid(self) -> Grid:
        """Grid on which the flow is known.

        Raises:
            ValueError: If the file has changed since its digest was computed, or cannot be read.
        """
        grid = read_grid(self.source) if isinstance(self.source, str) else self.source
        if self.digest not in ("", grid.digest):
            raise BadArgument(
                "digest", f"must match `{self.source}`, which has changed since, got {self.digest}"
            )
        return grid

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Axes in the order of `AXES`, with time from the start of the run."""
        time, *others = self.grid.axes
        return (time._replace(first=time.first - self.start), *others)

    @property
    def parts(self) -> tuple[Flow, ...]:
        """A single part, which is not cached because its address is valid in one process only."""
        numbers = {"table": table_address(self.grid.table)}
        for name, axis, rule in zip(
            "tzyx", self.axes, (self.beyond, "hold", *2 * [self.outside]), strict=True
        ):
            codes = {"periodic": 1.0 / axis.nodes, "hold": 0.0, "zero": -1.0, "refuse": -2.0}
            own = {
                "first": axis.first,
                "per_step": 1.0 / axis.step,
                "count": axis.nodes,
                "rule": codes[rule],
            }
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
        """Description of the flow."""
        return (
            f"the flow of `{self.source}`" if isinstance(self.source, str) else "a flow on a grid"
        )


@dataclass(frozen=True, eq=False)
class _Cells(Flow):
    """The numbers of a grid: address of its table, and for each axis its first node, steps per unit, nodes and rule.

    Outside the grid, the rule is 1 / nodes for a periodic grid, whose first node follows one step
    after its last, as on a missing axis; 0 to hold the edges; -1 for no motion; -2 to end the run,
    because rates are not a number there.
    """

    grid: Grid
    """Grid that owns the table; it lives as long as this object."""
    values: Mapping[str, float]
    """All numbers by name."""

    def __post_init__(self) -> None:
        vars(self).update(self.values)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of nodes per axis, which must be the same for all runs side by side."""
        return tuple(axis.nodes for axis in self.grid.axes)

    @property
    def formula(self) -> Formula:
        """Formula for all grids that have the same axes."""
        function = _interpolating(tuple(count > 1 for count in reversed(self.shape)))
        return Formula(name="Gridded", function=function, fields=(*self.values,))


@functools.cache
def _interpolating(there: tuple[bool, ...]) -> Callable[..., Any]:
    """Return the formula of all grids that have the given ones of the axes x, y, z and t."""
    between, count, slopes, cells = _at_node, len(COMPONENTS), "", ""
    for k, (name, is_there) in enumerate(zip("xyzt", there, strict=True)):
        slopes += "".join(
            f"f[{count + j}], " if is_there else "0.0 * f[0], " for j in range(len(COMPONENTS))
        )
        numbers = ", ".join(
            f"law.{name}_{one}" for one in ("first", "per_step", "count.real", "rule.real")
        )
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
        (i_x, f_x, x, in_x, no_x), (i_y, f_y, y, in_y, no_y), (i_t, f_t, t, in_t, no_t) = (
            at_x,
            at_y,
            at_t,
        )
        ways = 1.0, f_x, n_y, f_y, n_z, f_z, n_t, f_t
        f = whole(between(self.table.real, i_x + n_y * i_y + n_z * i_z + n_t * i_t, 0.0, ways))
        known = in_x * in_y * in_t
        none = no_x + no_y + no_t
        rates = f[16] * t + none, f[17] * t + none, f[18] * t + none
        slopes = (
            f[4] * x,
            f[8] * y,
            f[12] * z,
            f[5] * x,
            f[9] * y,
            f[13] * z,
            f[6] * x,
            f[10] * y,
            f[14] * z,
        )
        return f[0] * known, f[1] * known, f[2] * known, *rates, *slopes, f[3] * known

    return interpolated


def _at_node(table: float, i: float, further: float, ways: Any) -> Any:
    return table_row(table, i, further)


def _along(before: Any, count: int, k: int) -> Any:
    """Return a function that interpolates numbers between two nodes, then appends the first ones' slopes per step."""
    between = "".join(f"a[{j}] + f * (b[{j}] - a[{j}]), " for j in range(count))
    slopes = "".join(f"b[{j}] - a[{j}], " for j in range(len(COMPONENTS)))
    names = {"mixed": eval(f"lambda a, b, f: ({between}{slopes})"), "before": before}
    way = f"before(table, i, further + c[{2 * k}], c), c[{2 * k + 1}]"
    return eval(f"lambda table, i, further, c: mixed(before(table, i, further, c), {way})", names)


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
    i = np.floor(
        where(p.real < last - 1.0, p.real, last - 1.0)
    )  # a valid node even if the place is not a number
    refused = where(is_inside, 0.0, where(rule < -1.5, math.nan, 0.0))
    return i, p - i, inside * per_step, where(rule == -1.0, inside, 1.0), refused
