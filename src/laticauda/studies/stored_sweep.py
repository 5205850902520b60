"""Reading the folder of a sweep: its results as a Dataset, its best points, how many trials failed.

    sweep.json      definition of the sweep: a folder belongs to one sweep
    results.zarr    the Dataset; a region of the sweep is one chunk of every array, hence one file
    regions.done    one byte per region, 1 once all of it is stored

`laticauda.studies.store` writes such a folder.
"""

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from laticauda.studies.folder import readable
from laticauda.studies.point_trials import COSTS, FIGURES, QUANTITIES
from laticauda.studies.regions import Regions
from laticauda.trials.feasibility import CAN_DO
from laticauda.values import (
    BadArgument,
    check_choice,
    check_whole_number,
    local,
    optional_import,
    read_text,
)

if TYPE_CHECKING:
    import xarray

DEFINITION = "sweep.json"
RESULTS = "results.zarr"
DONE = "regions.done"
UTILIZATION = "utilization"
REGION_KEY = "region"
"""Key of the definition that holds the size of a region."""


def open_sweep(folder: str | Path) -> "xarray.Dataset":
    """Open the results of a sweep, finished or not; they are read when they are used.

    A grid has one dimension per parameter, with the parameter's values; lists and samples have the
    dimension `trial`, with the parameters as coordinates along it. Points not yet computed are nan
    and have not `succeeded`; the attributes `n_trials` and `n_finished` count all points and the
    finished ones.

    Args:
        folder: Where the sweep is stored.

    Raises:
        ValueError: If the folder holds no sweep.
        MissingExtra: If zarr is not installed.
    """
    import_zarr()
    xarray: Any = import_module("xarray")
    path = Path(folder)
    regions = regions_of(path)
    if not (path / DONE).exists():
        raise BadArgument("folder", f"must hold the results of a sweep, got {folder}")
    done = read_marks(path, regions)
    with readable(path, RESULTS):
        dataset = xarray.open_zarr(str(path / RESULTS), consolidated=False, chunks=None)
        # In our order; folders of older releases have fewer.
        dataset = dataset[[name for name in QUANTITIES if name in dataset]]
        if any(variable.shape != regions.shape for variable in dataset.values()):
            raise BadArgument(RESULTS, f"must have shape {regions.shape}")
        for name in _parameter_names(path):
            if name not in dataset.coords:
                raise BadArgument(name, "is missing, or no longer a coordinate")
    for coordinate in dataset.coords.values():
        # For a netCDF file of it: no value of a coordinate is missing.
        coordinate.encoding["_FillValue"] = None
    return dataset.assign_attrs(
        n_trials=int(np.prod(regions.shape, dtype=np.int64)),
        n_finished=count_points(regions, done),
    )


def regions_of(folder: str | Path) -> Regions:
    """Return the regions of the stored results, to read them piece by piece.

    Args:
        folder: Folder of a sweep.

    Raises:
        ValueError: If it is not the folder of a sweep.
    """
    definition = read_definition(Path(folder))
    if definition is None:
        raise BadArgument("folder", f"must hold the results of a sweep, got {folder}")
    return regions_of_definition(Path(folder), definition)


def regions_of_definition(path: Path, definition: Mapping[str, Any]) -> Regions:
    """Return the regions that a stored definition states.

    Args:
        path: The folder, for messages.
        definition: The definition.
    """
    with readable(path, DEFINITION):
        return Regions(shape=definition["shape"], block=definition[REGION_KEY])


def read_definition(path: Path) -> dict[str, Any] | None:
    """Return the stored definition of a sweep; None if there is none.

    Args:
        path: The folder.
    """
    file = local(path) / DEFINITION
    if not file.is_file():
        return None
    with readable(path, DEFINITION):
        definition = json.loads(read_text(file))
    if (
        not isinstance(definition, dict)
        or "shape" not in definition
        or REGION_KEY not in definition
    ):
        raise BadArgument(
            "folder", f"must hold a `{DEFINITION}` of a sweep, got {path} with another one"
        )
    return cast("dict[str, Any]", definition)


def read_marks(path: Path, regions: Regions) -> np.ndarray:
    """Return whether each region is stored, according to the marks.

    Args:
        path: The folder.
        regions: The regions of its sweep.
    """
    done = np.array(bytearray((path / DONE).read_bytes()), dtype=bool)
    if done.size != regions.count:
        raise BadArgument(
            "folder", f"must hold intact files, got a `{DONE}` of {done.size} bytes in {path}"
        )
    return done


def count_points(regions: Regions, done: np.ndarray) -> int:
    """Return the number of points in the stored regions.

    Args:
        regions: All regions.
        done: Whether each of them is stored.
    """
    return sum(map(regions.n_points, np.flatnonzero(done).tolist()))


def _parameter_names(path: Path) -> Iterable[str]:
    """Return the parameters varied by the stored definition: by a grid, samples or a list of points."""
    definition = read_definition(path) or {}
    points = definition.get("points", {})
    for key in ("values", "ranges", "sha256"):
        if key in points:
            return points[key]
    return ()


@dataclass(frozen=True, order=True)
class _RankedPoint:
    """A point and its rank; of equal ones, the first in the sweep comes first."""

    is_beyond: bool
    """Whether it comes last, because it asks for more than the robot has."""
    loss: float
    """Value of the quantity; negative if the largest is best."""
    indices: tuple[int, ...]
    """Index of the point along each dimension."""


def best_points(
    folder: str | Path,
    quantity: str = "forward_velocity",
    count: int = 5,
    *,
    feasible_first: bool = False,
) -> list[dict[str, float]]:
    """Return the points of a sweep with the highest speed, or the lowest power or cost of transport, best first.

    Args:
        folder: Folder of a sweep, finished or not.
        quantity: Quantity by which the points are ranked.
        count: Maximum number of points; runs that diverged and points not yet computed are
            excluded.
        feasible_first: Whether points that ask for more than the robot has, whose `utilization` is
            above 1, come after all others.

    Returns:
        The parameters and all quantities of each point by name.

    Raises:
        ValueError: If there is no such quantity, or no sweep in the folder.
    """
    check_choice("quantity", quantity, FIGURES)
    check_whole_number("count", count, 1)
    sign = 1.0 if quantity in COSTS else -1.0
    dataset = open_sweep(folder)
    regions = regions_of(folder)
    values = dataset[quantity].variable
    utilization = dataset[UTILIZATION].variable
    ranked: list[_RankedPoint] = []
    for index in range(regions.count):
        block = regions.at(index)
        with readable(Path(folder), RESULTS):
            losses: np.ndarray = sign * values[block].to_numpy()
            is_beyond = np.isnan(losses)  # such runs come last
            if feasible_first:
                is_beyond |= utilization[block].to_numpy() > CAN_DO
        best_of_region = np.lexsort((losses.ravel(), is_beyond.ravel()))[:count]
        for flat_index in map(int, best_of_region):
            point = _RankedPoint(
                is_beyond=bool(is_beyond.flat[flat_index]),
                loss=float(losses.flat[flat_index]),
                indices=_indices_within(block, flat_index, losses.shape),
            )
            if not math.isnan(point.loss):
                ranked.append(point)
        ranked = sorted(ranked)[:count]
    return [_read_point(dataset, point.indices) for point in ranked]


def _indices_within(
    block: tuple[slice, ...], flat_index: int, shape: tuple[int, ...]
) -> tuple[int, ...]:
    """Return the indices in the whole sweep of a point of a block."""
    within_block = np.unravel_index(flat_index, shape)
    return tuple(part.start + int(i) for part, i in zip(block, within_block, strict=True))


def _read_point(dataset: Any, indices: tuple[int, ...]) -> dict[str, float]:
    """Return the parameters and all figures of one point."""
    dims = dataset[FIGURES[0]].dims
    point = dataset.isel(dict(zip(dims, indices, strict=True)))
    names = [name for name in (*point.coords, *FIGURES) if name in point]
    return {str(name): float(point[name]) for name in names}


def count_failed(folder: str | Path) -> int:
    """Count the trials that diverged.

    Args:
        folder: Folder of a sweep, finished or not.
    """
    dataset = open_sweep(folder)
    regions = regions_of(folder)
    succeeded = dataset["succeeded"].variable
    n_succeeded = 0
    with readable(Path(folder), RESULTS):
        for index in range(regions.count):
            block = regions.at(index)
            n_succeeded += int(succeeded[block].to_numpy().sum())
    return int(dataset.attrs["n_finished"]) - n_succeeded


def count_infeasible(folder: str | Path) -> int:
    """Count the trials that ask for more than the robot has: their `utilization` is above 1.

    Args:
        folder: Folder of a sweep, finished or not.
    """
    dataset = open_sweep(folder)
    regions = regions_of(folder)
    utilization = dataset[UTILIZATION].variable
    n_infeasible = 0
    with readable(Path(folder), RESULTS):
        for index in range(regions.count):
            n_infeasible += int(np.sum(utilization[regions.at(index)].to_numpy() > CAN_DO))
    return n_infeasible


def import_zarr() -> Any:
    """Return the package zarr."""
    return optional_import("A sweep", "zarr", "scale")
