"""Writing the folder of a sweep, region by region; `laticauda.studies.stored_sweep` says what is in it.

A zarr file is written under another name and then renamed, so a chunk exists either completely or
not at all; a region is marked once all its chunks exist. The mark is one byte in a file that has
its full length from the start: it is never half written, and a full disk does not prevent it. A
region interrupted in between is simply computed again, to the same bits. (This holds for killed
programs; after a power failure it depends on the file system.)
"""

import json
import shutil
from collections.abc import Generator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from laticauda.studies.folder import as_stored, check_same, owned, readable, storage
from laticauda.studies.point_trials import QUANTITIES, Column, attributes_of, labels_of
from laticauda.studies.regions import Regions, block_shape
from laticauda.studies.sampling import Grid, Table
from laticauda.studies.stored_sweep import (
    DEFINITION,
    DONE,
    REGION_KEY,
    RESULTS,
    count_points,
    import_zarr,
    read_definition,
    read_marks,
    regions_of_definition,
)
from laticauda.studies.sweep import Sweep
from laticauda.values import BadArgument, write


@dataclass(kw_only=True, eq=False)
class Store:
    """A sweep's folder, open for writing by this process alone; see `open_store`."""

    folder: Path
    """Path of the folder."""
    sweep: Sweep
    """Sweep to which it belongs."""
    regions: Regions
    """Regions of the sweep."""
    done: np.ndarray
    """Whether each region is stored."""
    n_done: int
    """Number of stored trials."""
    arrays: Mapping[str, Any]
    """Arrays that are written region by region."""
    marks: BinaryIO
    """File of the marks, unbuffered."""

    def write(self, index: int, table: Table, results: Mapping[str, Column]) -> None:
        """Store a region, then mark it.

        Args:
            index: Index of the region.
            table: Its points.
            results: Its results by quantity.

        Raises:
            StorageFailed: If it cannot be written: it stays unmarked, and all others are unchanged.
        """
        block = self.regions.at(index)
        parameters = dict(zip(self.sweep.points.names, table.T, strict=True))
        columns = {**results, **parameters}
        with storage(self.folder, f"{self.n_done} of {self.sweep.n_trials} trials are stored"):
            for name, array in self.arrays.items():
                array[block] = columns[name].reshape(block_shape(block))
            self.marks.seek(index)
            self.marks.write(b"\1")
        self.done[index] = True
        self.n_done += len(table)


@contextmanager
def open_store(
    folder: str | Path, sweep: Sweep, *, region_size: int | None, resume: bool
) -> Generator[Store]:
    """Open the folder of a sweep, and create it if there is none.

    Args:
        folder: Path of the folder.
        sweep: Sweep that it is to hold.
        region_size: Maximum number of trials in a region of a new folder; None chooses what suits
            the sweep.
        resume: Whether it may already hold results.

    Raises:
        ValueError: If it holds something else or results that are not allowed, or another process
            writes to it.
        StorageFailed: If it cannot be created.
    """
    zarr = import_zarr()
    path = Path(folder)
    with ExitStack() as stack:
        stack.enter_context(owned(path, "sweep", DEFINITION))
        # Only a new folder is written to here.
        with storage(path, "0 trials are stored"):
            regions = _claim(path, sweep, region_size)
            if not (path / DONE).exists():
                _create_arrays(zarr, path, sweep, regions)
            marks = stack.enter_context((path / DONE).open("r+b", buffering=0))
            arrays = _open_arrays(zarr, path, sweep, regions)
        done = read_marks(path, regions)
        if done.any() and not resume:
            raise BadArgument(
                "folder", f"must have no results yet unless `resume` is set, got {path}"
            )
        yield Store(
            folder=path,
            sweep=sweep,
            regions=regions,
            done=done,
            n_done=count_points(regions, done),
            arrays=arrays,
            marks=marks,
        )


def _claim(path: Path, sweep: Sweep, region_size: int | None) -> Regions:
    """Write the definition of the sweep to the folder, or compare it; return its regions."""
    definition = as_stored(sweep.definition())
    stored = read_definition(path)
    if stored is None:
        regions = sweep.regions(region_size)
        content = {**definition, "shape": regions.shape, REGION_KEY: regions.block}
        write(path / DEFINITION, json.dumps(content, indent=1) + "\n")
        return regions
    regions = regions_of_definition(path, stored)
    del stored[REGION_KEY]
    check_same(path, "sweep", stored, {**definition, "shape": list(sweep.points.shape)})
    return regions


def _create_arrays(zarr: Any, path: Path, sweep: Sweep, regions: Regions) -> None:
    """Create the empty arrays and, last, the marks: without them the folder counts as not yet created."""
    shutil.rmtree(path / RESULTS, ignore_errors=True)
    points = sweep.points
    attributes: dict[str, Any] = {"title": "Sweep", **attributes_of(sweep.scenario)}
    if not isinstance(points, Grid):
        attributes["coordinates"] = " ".join(points.names)
    group = zarr.open_group(str(path / RESULTS), mode="w", attributes=attributes)
    labels = labels_of(sweep.scenario)
    for name in _names_by_region(sweep):
        is_truth = name == "succeeded"
        group.create_array(
            name,
            shape=regions.shape,
            chunks=regions.block,
            dtype=bool if is_truth else float,
            fill_value=False if is_truth else np.nan,
            dimension_names=points.dims,
            attributes=labels[name],
        )
    if isinstance(points, Grid):
        for name, values in points.values.items():
            group.create_array(
                name, data=np.asarray(values), dimension_names=(name,), attributes=labels[name]
            )
    # If the disk has no room for the marks, this fails now.
    write(path / DONE, bytes(regions.count))


def _open_arrays(zarr: Any, path: Path, sweep: Sweep, regions: Regions) -> dict[str, Any]:
    """Return the arrays that are written region by region."""
    with readable(path, RESULTS):
        group = zarr.open_group(str(path / RESULTS), mode="r+", use_consolidated=False)
        arrays = {name: group[name] for name in _names_by_region(sweep)}
        for name, array in arrays.items():
            if array.shape != regions.shape or array.chunks != regions.block:
                raise BadArgument(name, f"must have shape {regions.shape}, got {array.shape}")
    return arrays


def _names_by_region(sweep: Sweep) -> tuple[str, ...]:
    """Return the names of the arrays that have one chunk per region."""
    if isinstance(sweep.points, Grid):
        return QUANTITIES
    return (*QUANTITIES, *sweep.points.names)
