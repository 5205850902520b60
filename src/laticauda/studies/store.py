"""Writing the folder of a sweep, region by region; `laticauda.studies.stored_sweep` says what is in it.

A zarr file is written under another name and then renamed, so a chunk exists either completely or
not at all; a region is marked once all its chunks exist. The mark is one byte in a file that has
its full length from the start: it is never half written, and a full disk does not prevent it. A
region interrupted in between is simply computed again, to the same bits. (This holds for killed
programs; after a power failure it depends on the file system.)

Whatever is found damaged when a folder is opened is made anew, and a warning says so: files that
the sweep determines are written again, regions are computed again.
"""

import json
import shutil
from collections.abc import Collection, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, BinaryIO

import numpy as np

from laticauda.studies import damage
from laticauda.studies.checksums import checksum_of, read_checksums, write_checksums
from laticauda.studies.folder import as_stored, check_same, owned, readable, storage
from laticauda.studies.point_trials import Column, attributes_of, labels_of
from laticauda.studies.regions import Regions, block_shape
from laticauda.studies.sampling import Grid, Table
from laticauda.studies.stored_sweep import (
    DEFINITION,
    DONE,
    REGION_KEY,
    RESULTS,
    count_points,
    import_zarr,
    list_damaged_files,
    names_by_region,
    read_definition,
    read_marks,
    regions_of_definition,
)
from laticauda.studies.sweep import Sweep
from laticauda.values import BadArgument, StoredResultsWarning, warn_caller, write


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
        shape = block_shape(block)
        what_is_there = f"{self.n_done} of {self.sweep.n_trials} trials are stored"
        with storage(self.folder, what_is_there):
            for name, array in self.arrays.items():
                array[block] = columns[name].reshape(shape)
            self.marks.seek(index)
            self.marks.write(bytes([damage.STORED]))
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
            damaged_files = list_damaged_files(path)
            regions = _claim(path, sweep, region_size, damaged_files)
            if not (path / DONE).exists():
                _create_arrays(zarr, path, sweep, regions)
            elif damaged_files:
                _write_anew(zarr, path, sweep, regions, damaged_files)
            damage.warn_without_checksums(path)
            arrays = _open_arrays(zarr, path, sweep, regions)
        done = damage.is_stored(path, read_marks(path, regions))
        if done.any() and not resume:
            raise BadArgument(
                "folder", f"must have no results yet unless `resume` is set, got {path}"
            )
        with storage(path, "nothing was changed"):
            _forget_damaged_regions(path, regions, names_by_region(path), done)
            marks = stack.enter_context((path / DONE).open("r+b", buffering=0))
        yield Store(
            folder=path,
            sweep=sweep,
            regions=regions,
            done=done,
            n_done=count_points(regions, done),
            arrays=arrays,
            marks=marks,
        )


def _claim(
    path: Path, sweep: Sweep, region_size: int | None, damaged_files: Collection[str]
) -> Regions:
    """Write the definition of the sweep to the folder, or compare it; return its regions."""
    definition = as_stored(sweep.definition())
    if DEFINITION in damaged_files:
        return _restore_definition(path, sweep, region_size, definition)
    stored = read_definition(path)
    if stored is None:
        regions = sweep.regions(region_size)
        write(path / DEFINITION, _format_definition(definition, regions))
        return regions
    return check_definition(path, sweep, stored)


def check_definition(path: Path, sweep: Sweep, stored: Mapping[str, Any]) -> Regions:
    """Return the regions of a stored sweep; refuse the definition of another one.

    Args:
        path: Its folder.
        sweep: The sweep that it has to be.
        stored: Its definition, as `read_definition` returns it.

    Raises:
        ValueError: If it differs; the message names the differences.
    """
    stored_sweep = dict(stored)
    stored_sweep.pop(REGION_KEY, None)
    current = as_stored(sweep.definition())
    current["shape"] = list(sweep.points.shape)
    check_same(path, "sweep", stored_sweep, current)
    return regions_of_definition(path, stored)


def _format_definition(definition: Mapping[str, Any], regions: Regions) -> str:
    content = {**definition, "shape": regions.shape, REGION_KEY: regions.block}
    return json.dumps(content, indent=1) + "\n"


def _restore_definition(
    path: Path, sweep: Sweep, region_size: int | None, definition: Mapping[str, Any]
) -> Regions:
    """Write a damaged definition again, if it was that of this sweep; return its regions.

    It was, if it would have the checksum in the list with one of the possible divisions into
    regions. If it is the list that is damaged, the definition itself still is that of this sweep.
    """
    recorded = read_checksums(path).get(DEFINITION)
    for regions in _list_possible_regions(path, sweep, region_size):
        content = _format_definition(definition, regions).encode()
        if content == (path / DEFINITION).read_bytes():
            return regions
        if checksum_of(content) == recorded:
            write(path / DEFINITION, content)
            return regions
    raise BadArgument(
        "folder",
        f"must be empty, or hold this sweep, got {path} with a damaged `{DEFINITION}` that is not "
        "of this one",
    )


def _list_possible_regions(path: Path, sweep: Sweep, region_size: int | None) -> Iterator[Regions]:
    """Yield the divisions into regions that the arrays state, and that of a new folder."""
    for file in (path / RESULTS).glob("*/zarr.json"):
        with suppress(ValueError, KeyError, TypeError):  # this file is damaged, too
            chunk_grid = json.loads(file.read_bytes())["chunk_grid"]
            block = tuple(chunk_grid["configuration"]["chunk_shape"])
            yield Regions(shape=sweep.points.shape, block=block)
    yield sweep.regions(region_size)


def _create_arrays(zarr: Any, path: Path, sweep: Sweep, regions: Regions) -> None:
    """Create the empty arrays, their checksums and, last, the marks: a folder without them is not yet created."""
    shutil.rmtree(path / RESULTS, ignore_errors=True)
    files = _write_empty_arrays(zarr, path, sweep, regions)
    write_checksums(path, [DEFINITION, *files])
    # If the disk has no room for the marks, this fails now.
    write(path / DONE, bytes(regions.count))


def _write_empty_arrays(zarr: Any, path: Path, sweep: Sweep, regions: Regions) -> list[str]:
    """Create the arrays without results; return the names of their files."""
    points = sweep.points
    attributes: dict[str, Any] = {"title": "Sweep", **attributes_of(sweep.scenario)}
    if not isinstance(points, Grid):
        attributes["coordinates"] = " ".join(points.names)
    group = zarr.open_group(str(path / RESULTS), mode="w", attributes=attributes)
    labels = labels_of(sweep.scenario, points.names)
    with_checksum = zarr.codecs.ZstdCodec(checksum=True)
    for name in _names_by_region(sweep):
        is_truth = name == "succeeded"
        group.create_array(
            name,
            shape=regions.shape,
            chunks=regions.block,
            dtype=bool if is_truth else float,
            fill_value=False if is_truth else np.nan,
            compressors=with_checksum,
            dimension_names=points.dims,
            attributes=labels[name],
        )
    if isinstance(points, Grid):
        for name, values in points.values.items():
            group.create_array(
                name,
                data=np.asarray(values),
                compressors=with_checksum,
                dimension_names=(name,),
                attributes=labels[name],
            )
    files = [file for file in (path / RESULTS).rglob("*") if file.is_file()]
    return [file.relative_to(path).as_posix() for file in files]


def _write_anew(
    zarr: Any, path: Path, sweep: Sweep, regions: Regions, damaged: Sequence[str]
) -> None:
    """Write all files but results and marks as they were in the beginning."""
    with TemporaryDirectory() as scratch:
        files = _write_empty_arrays(zarr, Path(scratch), sweep, regions)
        for name in files:
            content = (Path(scratch) / name).read_bytes()
            target = path / name
            target.parent.mkdir(parents=True, exist_ok=True)
            write(target, content)
    write_checksums(path, [DEFINITION, *files])
    listed = ", ".join(damaged)
    message = f"{path}: {listed} had been damaged, and was made anew."
    warn_caller(message, StoredResultsWarning)


def _forget_damaged_regions(
    path: Path, regions: Regions, names: Iterable[str], done: np.ndarray
) -> None:
    """Have the regions that are damaged computed anew.

    Args:
        path: The folder.
        regions: All regions.
        names: Names of the arrays that have one chunk per region.
        done: Whether each region is stored; false afterwards for those that are damaged.
    """
    names = list(names)
    marks = bytearray((path / DONE).read_bytes())
    damaged = damage.find_damaged_marks(path, read_marks(path, regions))
    damaged += damage.find_damaged_regions(path / RESULTS, regions, names, done)
    if not damaged:
        return
    for index in damaged:
        marks[index] = damage.NOT_STORED
        done[index] = False
    write(path / DONE, bytes(marks))
    for index in damaged:
        chunks = damage.list_chunks(path / RESULTS, regions, names, index)
        for chunk in chunks:
            chunk.unlink(missing_ok=True)
    listed = damage.describe_regions(regions, sorted(damaged))
    message = f"{path}: damage was noticed in {listed}, which are computed anew."
    warn_caller(message, StoredResultsWarning)


def _open_arrays(zarr: Any, path: Path, sweep: Sweep, regions: Regions) -> dict[str, Any]:
    """Return the arrays that are written region by region."""
    with readable(path, RESULTS):
        folder = str(path / RESULTS)
        group = zarr.open_group(folder, mode="r+", use_consolidated=False)
        # A chunk without numbers is written, too: a missing file is damage.
        with zarr.config.set({"array.write_empty_chunks": True}):
            arrays = {name: group[name] for name in _names_by_region(sweep)}
        for name, array in arrays.items():
            if array.shape != regions.shape or array.chunks != regions.block:
                raise BadArgument(name, f"must have shape {regions.shape}, got {array.shape}")
    return arrays


def _names_by_region(sweep: Sweep) -> tuple[str, ...]:
    """Return the names of the arrays that have one chunk per region."""
    if isinstance(sweep.points, Grid):
        return sweep.quantities
    return (*sweep.quantities, *sweep.points.names)
