"""Flows as xarray Datasets, and Datasets and netCDF files as tables that kernels read.

A Dataset has the velocities `u`, `v` and perhaps `w` [m/s] and the `elevation` of the surface [m], over the coordinates
`time`, `z` (or `depth`, positive down), `y` and `x`, any of which may be missing. Names and units of the CF conventions
are understood; degrees are not, for the world is flat here.
"""

import functools
import hashlib
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from laticauda.errors import BadArgument, instance, shown
from laticauda.fluid.flow import Flow

if TYPE_CHECKING:
    import xarray

COMPONENTS = ("u", "v", "w", "elevation")
AXES = ("time", "z", "y", "x")
NAMES = {
    "u": ("u", "sea_water_x_velocity", "eastward_sea_water_velocity", "uo"),
    "v": ("v", "sea_water_y_velocity", "northward_sea_water_velocity", "vo"),
    "w": ("w", "upward_sea_water_velocity", "wo"),
    "elevation": ("elevation", "sea_surface_height_above_mean_sea_level", "zeta"),
    "time": ("t", "time"),
    "z": ("z", "height", "depth", "altitude"),
    "y": ("y", "projection_y_coordinate"),
    "x": ("x", "projection_x_coordinate"),
}
"""What variables and coordinates may be called, by name or by their attribute `standard_name`, which is the second."""
_METERS = {"m": 1.0, "meter": 1.0, "meters": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0}
_SPEEDS = {f"{meter}{per}": factor for meter, factor in _METERS.items() for per in ("/s", " s-1", " s^-1", "/second")}
_TIMES = {"s": 1.0, "seconds": 1.0, "minutes": 60.0, "h": 3600.0, "hours": 3600.0, "days": 86400.0}
UNITS = {**dict.fromkeys("uvw", _SPEEDS), **dict.fromkeys(("elevation", *"zyx"), _METERS), "time": _TIMES}
"""What their units may be, and how many of ours each is; none means ours, which come first."""


class Axis(NamedTuple):
    """Nodes at equal steps; one where the axis is missing."""

    first: float = 0.0
    step: float = 1.0
    nodes: int = 1


class Grid:
    """A flow at the nodes of a grid; two of the same digest are equal.

    Args:
        axes: Those of `AXES` [s], [m].
        table: Velocity and elevation at every node, those along x next to each other, shape (n, 4); behind the last
            node of an axis there is the first one again.
    """

    def __init__(self, axes: tuple[Axis, ...], table: np.ndarray) -> None:
        self.axes, self.table = axes, table
        self.digest = hashlib.sha256(f"{axes}".encode() + table.tobytes()).hexdigest()

    def __eq__(self, other: object) -> bool:
        """Of the same digest."""
        return isinstance(other, Grid) and other.digest == self.digest

    def __hash__(self) -> int:
        """That of the digest."""
        return hash(self.digest)


def read(file: str) -> Grid:
    """The grid in a netCDF file; the last few are kept, until they change.

    Args:
        file: Its path.

    Raises:
        ValueError: If it cannot be read, or is no flow.
    """
    try:
        return _read(file, Path(file).stat().st_mtime_ns)
    except (OSError, RuntimeError, ValueError) as error:
        rule = f"must be a netCDF file that holds a flow, got {file}: {' '.join(str(error).split())}"
        raise BadArgument("source", rule.rstrip(".")) from error


@functools.lru_cache(maxsize=4)
def _read(file: str, changed: int) -> Grid:
    xarray: Any = import_module("xarray")
    with xarray.open_dataset(file, engine="netcdf4", decode_timedelta=False) as dataset:
        return grid_of(dataset)


def grid_of(dataset: "xarray.Dataset | Grid") -> Grid:
    """A Dataset as a table.

    Args:
        dataset: See above.

    Raises:
        ValueError: If something is missing, or is not what it should be; the message says what, and where.
    """
    given: Any = dataset
    if isinstance(dataset, Grid):
        return dataset
    instance("source", given, import_module("xarray").Dataset)
    called = {name: _called(given, name) for name in NAMES}
    there = [name for name in COMPONENTS if called[name] is not None]
    if there[:2] != ["u", "v"]:
        listed = ", ".join(f"`{name}`" for name in given.variables)
        raise BadArgument("source", f"must have `u` and `v`, by their names or `standard_name`, got {listed}")
    ours: Any = given.rename({one: name for name, one in called.items() if one not in (None, name)})[there]
    units = [_unit(called[name], name, ours[name]) for name in there]
    ours = ours.expand_dims([axis for axis in AXES if axis not in ours.dims])
    axes: list[Axis] = []
    for name in AXES:
        if ours.sizes[name] > 1:
            ours = _placed(called[name] or name, name, ours)
        nodes = ours[name].values if ours.sizes[name] > 1 else np.arange(2.0)
        axes.append(Axis(float(nodes[0]), float(nodes[-1] - nodes[0]) / (nodes.size - 1), ours.sizes[name]))
    values = np.zeros((*(axis.nodes for axis in axes), len(COMPONENTS)))
    values[..., [COMPONENTS.index(name) for name in there]] = ours.to_array("of").transpose(*AXES, "of").values * units
    table = np.pad(values, [*[(0, 1)] * 4, (0, 0)], "wrap").reshape(-1, len(COMPONENTS))
    return Grid(tuple(axes), table)


def _called(dataset: Any, name: str) -> Any:
    """What a Dataset calls one of `NAMES`, None if it has none."""
    every = [*dataset.variables, *(dim for dim in dataset.dims if dim not in dataset.variables)]
    words = [(one, (str(one).lower(), dataset[one].attrs.get("standard_name"))) for one in every]
    return next((one for one, both in words if any(word in NAMES[name] for word in both)), None)


def _unit(called: str, name: str, variable: Any) -> float:
    """How many of ours the unit of a variable or a coordinate is; without gaps, and over nothing else."""
    given = variable.attrs.get("units", next(iter(UNITS[name])))
    if given not in UNITS[name]:
        raise BadArgument(called, f"must be in {', '.join(list(UNITS[name])[:4])} or the like, got {shown(given)}")
    other = [dim for dim in variable.dims if dim not in AXES]
    if other:
        raise BadArgument(called, f"must be over time, z (or depth), y and x alone, got the dimension `{other[0]}`")
    gaps = np.argwhere(~np.isfinite(variable.values))
    if len(gaps):
        first = ", ".join(f"{dim} = {variable[dim].values[i]}" for dim, i in zip(variable.dims, gaps[0], strict=True))
        rule = f"must be a number at all {variable.size} nodes, got {len(gaps)} without one, the first at {first}"
        raise BadArgument(called, f"{rule}; fill them, as `dataset.fillna(0.0)` does")
    return UNITS[name][given]


def _placed(called: str, name: str, ours: Any) -> Any:
    """A Dataset with the places of an axis upward, in our unit; dates count from the first."""
    if name not in ours.coords:
        raise BadArgument(called, "must have coordinates, which say where the nodes are")
    at, attributes = ours[name].values, ours[name].attrs
    if at.dtype.kind == "M":
        at = (at - at[0]) / np.timedelta64(1, "s")
    else:
        down = name == "z" and attributes.get("positive", "down" if called.lower() == "depth" else "up") == "down"
        at = at.astype(float) * _unit(called, name, ours[name]) * (-1.0 if down else 1.0)
    ours = ours.assign_coords({name: at})
    if at[0] > at[-1]:
        ours, at = ours.isel({name: slice(None, None, -1)}), at[::-1]
    least, most = float(np.diff(at).min()), float(np.diff(at).max())
    if not (least > 0.0 and most - least < 1e-3 * least):
        rule = f"must go up or down by equal steps, got some from {least:g} to {most:g}"
        raise BadArgument(called, f"{rule}; interpolate it, as `dataset.interp` does")
    return ours


def to_dataset(flow: Flow, **axes: Sequence[float] | np.ndarray) -> "xarray.Dataset":
    """Any flow on a grid, as `Gridded` and other programs take it; ``to_netcdf`` writes it to a file.

    Args:
        flow: Which.
        axes: The nodes along `time` since the start of a run [s], and along `z` above the mean surface, `y` and `x`
            [m]; one that is left out is missing in the grid, and the flow is taken where it is 0.
    """
    if unknown := axes.keys() - set(AXES):
        raise BadArgument(unknown.pop(), f"must be one of {', '.join(AXES)}, got another axis")
    t, z, y, x = np.meshgrid(*(np.asarray(axes.get(name, [0.0]), dtype=float) for name in AXES), indexing="ij")
    motion, there = flow.motion(x, y, z, t), [name for name in AXES if name in axes]
    size = [len(axes[name]) for name in there]

    def about(name: str) -> dict[str, str]:
        return {"units": next(iter(UNITS[name])), "standard_name": NAMES[name][1]}

    shaped = {name: np.broadcast_to(getattr(motion, name), x.shape).reshape(size) for name in COMPONENTS}
    made = {name: (there, shaped[name], about(name)) for name in COMPONENTS}
    coordinates = {name: (name, axes[name], about(name)) for name in there}
    return import_module("xarray").Dataset(made, coordinates, {"Conventions": "CF-1.11", "title": flow.words})
