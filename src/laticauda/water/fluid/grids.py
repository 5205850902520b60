"""Grids of places and times on which the motion of water is known, from netCDF or an xarray Dataset.

A Dataset has the velocities `u`, `v` and optionally `w` [m/s] and the `elevation` of the surface
[m], over the coordinates `time`, `z` (or `depth`, positive down), `y` and `x`, any of which may be
missing. Names and units of the CF conventions are supported; degrees are not, because the world is
flat here.
"""

import functools
import hashlib
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from laticauda.values import BadArgument, check_heaps, check_instance, show_value

if TYPE_CHECKING:
    import xarray

COMPONENTS = ("u", "v", "w", "elevation")
"""What a grid holds at every node [m/s], [m]."""
AXES = ("time", "z", "y", "x")
"""Axes of a grid, from the slowest to the fastest in memory [s], [m]."""
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
_PER_SECOND = ("/s", " s-1", " s^-1", "/second")
_TIMES = {"s": 1.0, "seconds": 1.0, "minutes": 60.0, "h": 3600.0, "hours": 3600.0, "days": 86400.0}


def _units_of_speed() -> dict[str, float]:
    units: dict[str, float] = {}
    for meter, factor in _METERS.items():
        for per_second in _PER_SECOND:
            units[f"{meter}{per_second}"] = factor
    return units


UNITS = {
    **dict.fromkeys(("u", "v", "w"), _units_of_speed()),
    **dict.fromkeys(("elevation", "z", "y", "x"), _METERS),
    "time": _TIMES,
}
"""Accepted units with their factors to our units; our own units come first, and are assumed if there are none."""
STEP_TOLERANCE = 1e-3
"""Share by which the steps along an axis may differ [-]."""
N_CACHED_FILES = 4
"""Files whose grids are kept in memory."""


class Axis(NamedTuple):
    """Nodes at equal steps; a single node if the axis is missing."""

    first: float = 0.0
    """Position of the first node [s], [m]."""
    step: float = 1.0
    """Distance of the nodes [s], [m]."""
    nodes: int = 1
    """Number of nodes."""

    @property
    def last(self) -> float:
        """Position of the last node [s], [m]."""
        return self.first + self.step * (self.nodes - 1)


class Grid:
    """A flow at the nodes of a grid; grids with the same digest are equal.

    Args:
        axes: Axes in the order of `AXES` [s], [m].
        table: Velocity and elevation at every node, nodes along x next to each other, shape (n, 4);
            the last node of each axis is followed by its first one again.
    """

    def __init__(self, axes: tuple[Axis, ...], table: np.ndarray) -> None:
        self.axes = axes
        self.table = table
        self.digest = hashlib.sha256(_text_of_axes(axes).encode() + table.tobytes()).hexdigest()

    def __eq__(self, grid: object) -> bool:
        """Compare the digests."""
        return isinstance(grid, Grid) and grid.digest == self.digest

    def __hash__(self) -> int:
        """Return the hash of the digest."""
        return hash(self.digest)


def _text_of_axes(axes: tuple[Axis, ...]) -> str:
    """Return axes as the text that is part of digests, which stored scenarios hold."""
    return f"{axes}"


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
        reason = getattr(error, "strerror", None) or str(error)
        reason = " ".join(reason.split())
        rule = f"must be a netCDF file that holds a flow, got {file}: {reason}"
        raise BadArgument("source", rule.rstrip(".")) from error


@functools.lru_cache(maxsize=N_CACHED_FILES)
def _read(file: str, changed: int) -> Grid:
    xarray: Any = import_module("xarray")
    check_heaps(file)
    with xarray.open_dataset(file, engine="netcdf4", decode_timedelta=False) as dataset:
        return grid_of(dataset)


def grid_of(dataset: "xarray.Dataset | Grid") -> Grid:
    """Convert a Dataset to a grid.

    Args:
        dataset: Dataset as described for the module, or a grid, which is returned unchanged.

    Raises:
        ValueError: If something is missing or invalid; the message says what and where.
    """
    if isinstance(dataset, Grid):
        return dataset
    source: Any = dataset
    check_instance("source", source, import_module("xarray").Dataset)
    source_names = {name: _name_in(source, name) for name in NAMES}
    components = [name for name in COMPONENTS if source_names[name] is not None]
    if components[:2] != ["u", "v"]:
        variables = ", ".join(f"`{name}`" for name in source.variables)
        rule = "must have variables `u` and `v`, by name or `standard_name`"
        raise BadArgument("source", f"{rule}, got {variables}")

    new_names = {
        source_name: name
        for name, source_name in source_names.items()
        if source_name not in (None, name)
    }
    ours: Any = source.rename(new_names)[components]
    factors = [_factor_to_our_unit(source_names[name], name, ours[name]) for name in components]
    ours = ours.expand_dims([axis for axis in AXES if axis not in ours.dims])
    axes: list[Axis] = []
    for name in AXES:
        if ours.sizes[name] > 1:
            ours = _with_ascending_axis(source_names[name] or name, name, ours)
        axes.append(_axis_of(ours, name))
    return Grid(tuple(axes), _table_of(ours, components, factors))


def _axis_of(ours: Any, name: str) -> Axis:
    """Return an axis whose coordinate ascends; a single node gets the position 0, whatever its own is."""
    count = ours.sizes[name]
    nodes = np.arange(2.0)
    if count > 1:
        nodes = ours[name].values
    step = float(nodes[-1] - nodes[0]) / (nodes.size - 1)
    return Axis(first=float(nodes[0]), step=step, nodes=count)


def _table_of(ours: Any, components: list[str], factors: list[float]) -> np.ndarray:
    """Return velocity and elevation at every node, see `Grid`; a missing component is 0."""
    sizes = [ours.sizes[name] for name in AXES]
    values = np.zeros((*sizes, len(COMPONENTS)))
    columns = [COMPONENTS.index(name) for name in components]
    values[..., columns] = ours.to_array("of").transpose(*AXES, "of").values * factors
    one_node_more = [(0, 1)] * len(AXES)
    wrapped = np.pad(values, [*one_node_more, (0, 0)], "wrap")
    return wrapped.reshape(-1, len(COMPONENTS))


def _name_in(dataset: Any, name: str) -> Any:
    """Return a Dataset's name for one of `NAMES`, None if it has none."""
    dims = [dim for dim in dataset.dims if dim not in dataset.variables]
    for candidate in (*dataset.variables, *dims):
        if str(candidate).lower() in NAMES[name]:
            return candidate
        if dataset[candidate].attrs.get("standard_name") in NAMES[name]:
            return candidate
    return None


def _factor_to_our_unit(source_name: str, name: str, variable: Any) -> float:
    """Return the factor from the unit of a variable or coordinate to ours; reject gaps and other dimensions."""
    our_unit = next(iter(UNITS[name]))
    unit = variable.attrs.get("units", our_unit)
    if unit not in UNITS[name]:
        examples = ", ".join(list(UNITS[name])[:4])
        raise BadArgument(source_name, f"must be in {examples} or the like, got {show_value(unit)}")
    foreign_dims = [dim for dim in variable.dims if dim not in AXES]
    if foreign_dims:
        rule = "must depend only on time, z (or depth), y and x"
        raise BadArgument(source_name, f"{rule}, got the dimension `{foreign_dims[0]}`")
    _check_no_gaps(source_name, variable)
    return UNITS[name][unit]


def _check_no_gaps(source_name: str, variable: Any) -> None:
    gaps = np.argwhere(~np.isfinite(variable.values))
    if len(gaps) == 0:
        return
    first_gap = ", ".join(
        f"{dim} = {variable[dim].values[i]}" for dim, i in zip(variable.dims, gaps[0], strict=True)
    )
    rule = f"must be a number at all {variable.size} nodes"
    problem = f"got {len(gaps)} gaps, the first at {first_gap}"
    cure = "fill them, e.g. with `dataset.fillna(0.0)`"
    raise BadArgument(source_name, f"{rule}, {problem}; {cure}")


def _with_ascending_axis(source_name: str, name: str, ours: Any) -> Any:
    """Return a Dataset with the coordinate of an axis ascending and in our unit; dates count from the first."""
    if name not in ours.coords:
        raise BadArgument(source_name, "must have coordinates that give the positions of the nodes")
    nodes = ours[name].values
    if nodes.dtype.kind == "M":
        nodes = (nodes - nodes[0]) / np.timedelta64(1, "s")
    else:
        sign = -1.0 if _points_down(source_name, name, ours[name].attrs) else 1.0
        nodes = nodes.astype(float) * _factor_to_our_unit(source_name, name, ours[name]) * sign
    ours = ours.assign_coords({name: nodes})
    if nodes[0] > nodes[-1]:
        backward = slice(None, None, -1)
        ours = ours.isel({name: backward})
        nodes = nodes[::-1]

    steps = np.diff(nodes)
    least = float(steps.min())
    most = float(steps.max())
    if not (least > 0.0 and most - least < STEP_TOLERANCE * least):
        rule = f"must ascend or descend in equal steps, got steps from {least:g} to {most:g}"
        raise BadArgument(source_name, f"{rule}; interpolate it, e.g. with `dataset.interp`")
    return ours


def _points_down(source_name: str, name: str, attributes: Any) -> bool:
    """Return whether a coordinate grows downward: its `positive` says so, or its name is depth."""
    if name != "z":
        return False
    usual = "down" if source_name.lower() == "depth" else "up"
    return attributes.get("positive", usual) == "down"
