"""Reading the folder of a sweep: its results as a Dataset, its best points, how many trials failed.

    sweep.json          definition of the sweep: a folder belongs to one sweep
    results.zarr        the Dataset; a region of the sweep is one chunk of every array, hence one file
    checksums.sha256    checksums of all files but the chunks, which have their own, and the marks
    regions.done        one byte per region, not 0 once all of it is stored

`laticauda.studies.store` writes such a folder.
"""

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from laticauda.studies import damage
from laticauda.studies.checksums import find_damaged_files
from laticauda.studies.folder import readable
from laticauda.studies.point_trials import ALL_FIGURES, COSTS, FIGURES, quantities_of
from laticauda.studies.regions import Regions
from laticauda.trials import LOAD_FIGURES
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
    """Open the results of a sweep, finished or not; all are checked, then read again when they are used.

    A grid has one dimension per parameter, with the parameter's values; lists and samples have the
    dimension `trial`, with the parameters as coordinates along it. Points not yet computed are nan
    and have not `succeeded`; the attributes `n_trials` and `n_finished` count all points and the
    finished ones.

    Args:
        folder: Where the sweep is stored.

    Raises:
        ValueError: If the folder holds no sweep, or a damaged one; the message says what is damaged.
        MissingExtra: If zarr is not installed.
    """
    path = Path(folder)
    dataset = open_unread(path)
    damage.warn_without_checksums(path)
    regions = regions_of(path)
    stored = damage.is_stored(path, read_marks(path, regions))
    names = names_by_region(path)
    damaged = damage.find_damaged_regions(path / RESULTS, regions, names, stored)
    _refuse_damaged_regions(path, regions, damaged)
    return dataset


def open_unread(path: Path) -> "xarray.Dataset":
    """Open the results of a sweep, as `open_sweep` does, without reading all of them to check them.

    Whatever is read of them later is checked then.

    Args:
        path: The folder.

    Raises:
        ValueError: If the folder holds no sweep, or parts of it are missing or damaged.
    """
    import_zarr()
    xarray: Any = import_module("xarray")
    regions = regions_of(path)
    if not (path / DONE).exists():
        raise BadArgument("folder", f"must hold the results of a sweep, got {path}")
    marks = read_marks(path, regions)
    unknown_marks = damage.find_damaged_marks(path, marks)
    _refuse_damaged_regions(path, regions, unknown_marks)
    stored = damage.is_stored(path, marks)
    missing = damage.find_missing(path / RESULTS, regions, names_by_region(path), stored)
    _refuse_damaged_regions(path, regions, missing)
    with readable(path, RESULTS):
        dataset = xarray.open_zarr(str(path / RESULTS), consolidated=False, chunks=None)
        # In our order; folders of older releases have fewer, and most have no loads.
        names = [name for name in quantities_of(loads=True) if name in dataset]
        dataset = dataset[names]
        if any(variable.shape != regions.shape for variable in dataset.values()):
            raise BadArgument(RESULTS, f"must have shape {regions.shape}")
        for name in _parameter_names(path):
            if name not in dataset.coords:
                raise BadArgument(name, "is missing, or no longer a coordinate")
    for coordinate in dataset.coords.values():
        # For a netCDF file of it: no value of a coordinate is missing.
        coordinate.encoding["_FillValue"] = None
    n_trials = np.prod(regions.shape, dtype=np.int64)
    n_finished = count_points(regions, stored)
    return dataset.assign_attrs(n_trials=int(n_trials), n_finished=n_finished)


def _refuse_damaged_regions(path: Path, regions: Regions, damaged: list[int]) -> None:
    if damaged:
        listed = damage.describe_regions(regions, damaged)
        raise BadArgument(
            "folder",
            f"must hold intact results, got {path} with damage to {listed}; {damage.AGAIN}",
        )


def list_damaged_files(path: Path) -> list[str]:
    """Return the files, other than results and marks, that are not as they were written.

    Args:
        path: The folder.
    """
    if not (path / DONE).exists():  # it is not complete yet, and will be made anew
        return []
    results = path / RESULTS
    files = [path / DEFINITION, results / "zarr.json", *results.glob("*/zarr.json")]
    names = [file.relative_to(path).as_posix() for file in files]
    return find_damaged_files(path, names)


def regions_of(folder: str | Path) -> Regions:
    """Return the regions of the stored results, to read them piece by piece.

    Args:
        folder: Folder of a sweep.

    Raises:
        ValueError: If it is not the folder of a sweep, or one of its files is damaged.
    """
    path = Path(folder)
    damaged = list_damaged_files(path)
    if damaged:
        rule = f"must hold intact files, got {folder} with a damaged `{damaged[0]}`"
        raise BadArgument("folder", f"{rule}; {damage.AGAIN}")
    definition = read_definition(path)
    if definition is None:
        raise BadArgument("folder", f"must hold the results of a sweep, got {folder}")
    return regions_of_definition(path, definition)


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
    """Return the marks of the regions; `laticauda.studies.damage` says what they mean.

    Args:
        path: The folder.
        regions: The regions of its sweep.
    """
    marks = np.frombuffer((path / DONE).read_bytes(), dtype=np.uint8)
    if marks.size != regions.count:
        raise BadArgument(
            "folder", f"must hold intact files, got a `{DONE}` of {marks.size} bytes in {path}"
        )
    return marks


def names_by_region(path: Path) -> list[str]:
    """Return the names of the arrays that have one chunk per region; folders of older releases have fewer.

    Args:
        path: The folder.
    """
    definition = read_definition(path) or {}
    names = list(quantities_of(loads=bool(definition.get("loads"))))
    if definition.get("points", {}).get("kind") != "grid":
        names += _parameter_names(path)
    return [name for name in names if (path / RESULTS / name).is_dir()]


def count_points(regions: Regions, done: np.ndarray) -> int:
    """Return the number of points in the stored regions.

    Args:
        regions: All regions.
        done: Whether each of them is stored.
    """
    n_points = 0
    for index in np.flatnonzero(done).tolist():
        n_points += regions.n_points(index)
    return n_points


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
    check_choice("quantity", quantity, ALL_FIGURES)
    check_whole_number("count", count, 1)
    sign = 1.0 if quantity in COSTS else -1.0
    dataset = open_unread(Path(folder))
    if quantity not in dataset:
        rule = f"must be stored in {folder}, got `{quantity}`"
        if quantity in LOAD_FIGURES:
            raise BadArgument("quantity", f"{rule}; only a sweep with `loads` stores it")
        stored_figures = ", ".join(f"`{name}`" for name in FIGURES if name in dataset)
        raise BadArgument("quantity", f"{rule}; this older sweep has {stored_figures}")
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
    indices: list[int] = []
    for part, index in zip(block, within_block, strict=True):
        indices.append(part.start + int(index))
    return tuple(indices)


def _read_point(dataset: Any, indices: tuple[int, ...]) -> dict[str, float]:
    """Return the parameters and all figures of one point."""
    dims = dataset[FIGURES[0]].dims
    point = dataset.isel(dict(zip(dims, indices, strict=True)))
    names = [name for name in (*point.coords, *ALL_FIGURES) if name in point]
    return {str(name): float(point[name]) for name in names}


def count_failed(folder: str | Path) -> int:
    """Count the trials that diverged.

    Args:
        folder: Folder of a sweep, finished or not.
    """
    dataset = open_unread(Path(folder))
    n_finished = int(dataset.attrs["n_finished"])
    succeeded = dataset["succeeded"].variable
    n_succeeded = _count_points_where(folder, succeeded, np.asarray)
    return n_finished - n_succeeded


def count_infeasible(folder: str | Path) -> int:
    """Count the trials that ask for more than the robot has: their `utilization` is above 1.

    Args:
        folder: Folder of a sweep, finished or not.
    """
    dataset = open_unread(Path(folder))
    utilization = dataset[UTILIZATION].variable
    return _count_points_where(folder, utilization, lambda values: values > CAN_DO)


def _count_points_where(
    folder: str | Path, variable: Any, holds: Callable[[np.ndarray], np.ndarray]
) -> int:
    """Count the points of which something holds, one region after the other.

    Args:
        folder: Folder of a sweep.
        variable: One of its results.
        holds: Says of a region's values of which of them it holds.
    """
    regions = regions_of(folder)
    count = 0
    with readable(Path(folder), RESULTS):
        for index in range(regions.count):
            block = regions.at(index)
            values = variable[block].to_numpy()
            count += int(np.sum(holds(values)))
    return count


def import_zarr() -> Any:
    """Return the package zarr."""
    return optional_import("A sweep", "zarr", "scale")
