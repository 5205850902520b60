"""Folder of a sweep: its results in zarr, region by region.

    sweep.json      definition of the sweep: a folder belongs to one sweep
    results.zarr    the Dataset; a region of the sweep is one chunk of every array, hence one file
    regions.done    one byte per region, 1 once all of it is stored

A zarr file is written under another name and then renamed, so a chunk exists either completely or
not at all; a region is marked once all its chunks exist. The mark is one byte in a file that has
its full length from the start: it is never half written, and a full disk does not prevent it. A
region interrupted in between is simply computed again, to the same bits. (This holds for killed
programs; after a power failure it depends on the file system.)
"""

import json
import math
import shutil
from collections.abc import Generator, Iterable, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from laticauda.errors import BadArgument, check_choice, check_whole_number, optional_import
from laticauda.files import local, read_text, write
from laticauda.simulate.runner import silent
from laticauda.studies import sweep as sweeps
from laticauda.studies.folder import as_stored, check_same, owned, readable, storage
from laticauda.studies.sampling import Grid
from laticauda.studies.sweep import Regions, Sweep, block_shape

if TYPE_CHECKING:
    import xarray

DEFINITION, RESULTS, DONE = "sweep.json", "results.zarr", "regions.done"
BLOCK = "region"


@dataclass(kw_only=True, eq=False)
class Store:
    """A sweep's folder, open for writing by this process alone; see `opened`."""

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

    def write(self, index: int, table: sweeps.Table, found: Mapping[str, sweeps.Column]) -> None:
        """Store a region, then mark it.

        Args:
            index: Index of the region.
            table: Its points.
            found: Its results by quantity.

        Raises:
            StorageFailed: If it cannot be written: it stays unmarked, and all others are unchanged.
        """
        block = self.regions.at(index)
        columns = {**found, **dict(zip(self.sweep.points.names, table.T, strict=True))}
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
    zarr, path = _zarr(), Path(folder)
    with ExitStack() as held:
        held.enter_context(owned(path, "sweep", DEFINITION))
        with storage(
            path, "0 trials are stored"
        ):  # for a new folder, the only kind written to here
            regions = _claim(path, sweep, region_size)
            if not (path / DONE).exists():
                _make(zarr, path, sweep, regions)
            marks = held.enter_context((path / DONE).open("r+b", buffering=0))
            with readable(path, RESULTS):
                group = zarr.open_group(str(path / RESULTS), mode="r+", use_consolidated=False)
                arrays = {name: group[name] for name in _by_region(sweep)}
                for name, array in arrays.items():
                    if (array.shape, array.chunks) != (regions.shape, regions.block):
                        raise BadArgument(
                            name, f"must have shape {regions.shape}, got {array.shape}"
                        )
        done = _done(path, regions)
        if done.any() and not resume:
            raise BadArgument(
                "folder", f"must have no results yet unless `resume` is set, got {path}"
            )
        n_done = sum(map(regions.n_points, np.flatnonzero(done).tolist()))
        yield Store(
            folder=path,
            sweep=sweep,
            regions=regions,
            done=done,
            n_done=n_done,
            arrays=arrays,
            marks=marks,
        )


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
    _zarr()
    xarray: Any = import_module("xarray")
    path = Path(folder)
    regions = regions_of(path)
    if not (path / DONE).exists():
        raise BadArgument("folder", f"must hold the results of a sweep, got {folder}")
    done = _done(path, regions)
    with readable(path, RESULTS):
        dataset = xarray.open_zarr(str(path / RESULTS), consolidated=False, chunks=None)
        dataset = dataset[
            [name for name in sweeps.QUANTITIES if name in dataset]
        ]  # in our order; older have fewer
        if any(one.shape != regions.shape for one in dataset.values()):
            raise BadArgument(RESULTS, f"must have shape {regions.shape}")
        for name in _parameters(path):
            if name not in dataset.coords:
                raise BadArgument(name, "is missing, or no longer a coordinate")
    for one in dataset.coords.values():
        one.encoding["_FillValue"] = None  # for a netCDF file of it: no coordinate value is missing
    n_finished = sum(map(regions.n_points, np.flatnonzero(done).tolist()))
    return dataset.assign_attrs(
        n_trials=int(np.prod(regions.shape, dtype=np.int64)), n_finished=n_finished
    )


def _claim(path: Path, sweep: Sweep, region_size: int | None) -> Regions:
    """Write the definition of the sweep to the folder, or compare it; return its regions."""
    wanted, stored = as_stored(sweep.definition()), _definition(path)
    if stored is None:
        regions = sweep.regions(region_size)
        text = json.dumps({**wanted, "shape": regions.shape, BLOCK: regions.block}, indent=1)
        write(path / DEFINITION, text + "\n")
        return regions
    regions = _regions(path, stored)
    del stored[BLOCK]
    check_same(path, "sweep", stored, {**wanted, "shape": list(sweep.points.shape)})
    return regions


def regions_of(folder: str | Path) -> Regions:
    """Return the regions of the stored results, to read them piece by piece.

    Args:
        folder: Folder of a sweep.

    Raises:
        ValueError: If it is not the folder of a sweep.
    """
    found = _definition(Path(folder))
    if found is None:
        raise BadArgument("folder", f"must hold the results of a sweep, got {folder}")
    return _regions(Path(folder), found)


def _regions(path: Path, definition: Mapping[str, Any]) -> Regions:
    with readable(path, DEFINITION):
        return Regions(shape=definition["shape"], block=definition[BLOCK])


def _done(path: Path, regions: Regions) -> np.ndarray:
    """Return whether each region is stored, according to the marks."""
    done = np.array(bytearray((path / DONE).read_bytes()), dtype=bool)
    if done.size != regions.count:
        raise BadArgument(
            "folder", f"must hold intact files, got a `{DONE}` of {done.size} bytes in {path}"
        )
    return done


def _definition(path: Path) -> dict[str, Any] | None:
    file = local(path) / DEFINITION
    if not file.is_file():
        return None
    with readable(path, DEFINITION):
        found = json.loads(read_text(file))
    if not isinstance(found, dict) or "shape" not in found or BLOCK not in found:
        raise BadArgument(
            "folder", f"must hold a `{DEFINITION}` of a sweep, got {path} with another one"
        )
    return cast("dict[str, Any]", found)


def _parameters(path: Path) -> Iterable[str]:
    """Return the parameters varied by the stored definition: by a grid, samples or a list of points."""
    points = (_definition(path) or {}).get("points", {})
    return next((points[key] for key in ("values", "ranges", "sha256") if key in points), ())


def _by_region(sweep: Sweep) -> dict[str, Any]:
    """Return the arrays that have one chunk per region, and their initial values."""
    names = (*sweeps.QUANTITIES, *(() if isinstance(sweep.points, Grid) else sweep.points.names))
    return {name: False if name == "succeeded" else np.nan for name in names}


def _make(zarr: Any, path: Path, sweep: Sweep, regions: Regions) -> None:
    """Create the empty arrays and, last, the marks: without them the folder counts as not yet created."""
    shutil.rmtree(path / RESULTS, ignore_errors=True)
    attributes: dict[str, Any] = {"title": "Sweep", **sweeps.attributes_of(sweep.scenario)}
    if not isinstance(sweep.points, Grid):
        attributes["coordinates"] = " ".join(sweep.points.names)
    group = zarr.open_group(str(path / RESULTS), mode="w", attributes=attributes)
    labels = sweeps.labels_of(sweep.scenario)
    for name, empty in _by_region(sweep).items():
        group.create_array(
            name,
            shape=regions.shape,
            chunks=regions.block,
            dtype=bool if empty is False else float,
            fill_value=empty,
            dimension_names=sweep.points.dims,
            attributes=labels[name],
        )
    if isinstance(sweep.points, Grid):
        for name, values in sweep.points.values.items():
            group.create_array(
                name, data=np.asarray(values), dimension_names=(name,), attributes=labels[name]
            )
    write(
        path / DONE, bytes(regions.count)
    )  # if the disk has no room for the marks, this fails now


def _zarr() -> Any:
    return optional_import("A sweep", "zarr", "scale")


# ---- running a sweep in a folder, and reading its results ----------------------------------------


def run_sweep(
    sweep: Sweep,
    folder: str | Path,
    *,
    progress: sweeps.Progress = silent,
    client: Any = None,
    threads: int | None = None,
    region_size: int | None = None,
    resume: bool = True,
) -> "xarray.Dataset":
    """Run a sweep, or the rest of it, and store the results in a folder.

    Work and storage proceed region by region: a region is marked as done once all of it is stored.
    The run may be killed at any moment, even by SIGKILL, and called again: it continues, and the
    results are bit-for-bit the same as if it had never stopped (on processors of one kind). Memory
    does not grow with the number of trials.

    Args:
        sweep: Sweep to run.
        folder: Folder for the results; created if needed. It must be empty or hold this same sweep.
        progress: Called at the start and after every region with the number of trials done and the
            total.
        client: A `dask.distributed.Client`: the trials run on its cluster. None runs them in this
            process.
        threads: Number of threads in this process; None uses one per core. A cluster uses every
            thread of a worker.
        region_size: Maximum number of trials in a region of a new folder; None takes about a second
            of work. The results depend on it only through rounding.
        resume: False rejects a folder that already has results.

    Returns:
        The whole sweep, read from the folder when it is used; see `open_sweep`.

    Raises:
        ValueError: If an argument is out of its range, or the folder holds something else or
            another sweep; the message names the differences.
        StorageFailed: If the results cannot be written. Nothing that was stored is lost.
        ClusterFailed: If the cluster's scheduler goes away, or workers die repeatedly. Nothing that
            was stored is lost.
        MissingExtra: If zarr is not installed, or scipy for samples.
    """
    if threads is not None:
        check_whole_number("threads", threads, 1)
    with open_store(folder, sweep, region_size=region_size, resume=resume) as store:
        progress(store.n_done, sweep.n_trials)
        pending = np.flatnonzero(~store.done).tolist()
        with closing(_results(sweep, store.regions, pending, client, threads)) as results:
            for index, table, found in results:
                store.write(index, table, found)
                progress(store.n_done, sweep.n_trials)
    return open_sweep(folder)


def best_points(
    folder: str | Path, quantity: str = "forward_velocity", count: int = 5
) -> list[dict[str, float]]:
    """Return the points of a sweep with the highest speed, or the lowest power or cost of transport, best first.

    Args:
        folder: Folder of a sweep, finished or not.
        quantity: Quantity by which the points are ranked.
        count: Maximum number of points; runs that diverged and points not yet computed are
            excluded.

    Returns:
        The parameters and all quantities of each point by name.

    Raises:
        ValueError: If there is no such quantity, or no sweep in the folder.
    """
    check_choice("quantity", quantity, sweeps.FIGURES)
    check_whole_number("count", count, 1)
    sign = 1.0 if quantity in sweeps.COSTS else -1.0
    dataset, regions = open_sweep(folder), regions_of(folder)
    values = dataset[quantity].variable
    ranked: list[tuple[float, tuple[int, ...]]] = []
    for block in map(regions.at, range(regions.count)):
        with readable(Path(folder), RESULTS):
            region: np.ndarray = sign * values[block].to_numpy()
        order = np.argsort(region, axis=None, kind="stable")[:count]  # nan comes last
        for flat in map(int, order):
            within = np.unravel_index(flat, region.shape)
            place = tuple(part.start + int(i) for part, i in zip(block, within, strict=True))
            ranked.append((float(region.flat[flat]), place))
        # Of equal ones, the first in the sweep.
        ranked = sorted(found for found in ranked if not math.isnan(found[0]))[:count]
    return [_point(dataset, place) for _, place in ranked]


def count_failed(folder: str | Path) -> int:
    """Count the trials that diverged.

    Args:
        folder: Folder of a sweep, finished or not.
    """
    dataset, regions = open_sweep(folder), regions_of(folder)
    succeeded = dataset["succeeded"].variable
    with readable(Path(folder), RESULTS):
        n_good = sum(
            int(succeeded[block].to_numpy().sum())
            for block in map(regions.at, range(regions.count))
        )
    return int(dataset.attrs["n_finished"]) - n_good


def _results(
    sweep: Sweep, regions: Regions, pending: list[int], client: Any, threads: int | None
) -> Generator[tuple[int, sweeps.Table, dict[str, sweeps.Column]]]:
    """Yield the results of the pending regions in order of completion."""
    tables = zip(pending, sweep.tables(map(regions.at, pending)), strict=True)
    if client is None:
        for index, table in tables:
            yield (
                index,
                table,
                sweeps.swim_points(sweep.scenario, sweep.points.names, table, threads),
            )
    else:
        from laticauda.studies.cluster import swim_on

        yield from swim_on(client, sweep.scenario, sweep.points.names, tables)


def _point(dataset: Any, place: tuple[int, ...]) -> dict[str, float]:
    point = dataset.isel(dict(zip(dataset[sweeps.FIGURES[0]].dims, place, strict=True)))
    return {
        str(name): float(point[name]) for name in (*point.coords, *sweeps.FIGURES) if name in point
    }
