"""Sweeps in shares: each is run by a process of its own, as in a job array, and all are merged in the end.

A share has a folder of its own beside that of the whole sweep, so that processes on different
computers never write to the same file:

    big                     the whole sweep, written by `merge_shares`
    big.share-1-of-4        the first of four shares: a folder like that of the sweep, partly filled
    big.share-2-of-4

Share k of n takes every n-th region from the k-th on: regions that take long, such as those of slow
gaits, lie side by side, and all shares get some of them. A region comes to the same bits wherever it
is computed (on processors of one kind), so a merged folder is that of a sweep which ran in one go.
"""

import glob
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.models.simulate import silent
from laticauda.studies import damage
from laticauda.studies.folder import owned, readable
from laticauda.studies.point_trials import Column, Progress
from laticauda.studies.regions import Regions
from laticauda.studies.store import Store, check_definition, open_store
from laticauda.studies.stored_sweep import (
    DEFINITION,
    RESULTS,
    import_zarr,
    open_unread,
    read_definition,
    read_marks,
    regions_of,
)
from laticauda.studies.sweep import Sweep
from laticauda.values import BadArgument, check_whole_number, quantity, value_class

if TYPE_CHECKING:
    import xarray

REGIONS_PER_SHARE = 4
"""Regions of a share at least, so that all shares take about equally long."""
FOLDER_OF_SHARE = re.compile(r"\.share-(?P<number>\d+)-of-(?P<count>\d+)")
"""What is added to the name of a sweep's folder."""


@value_class
class Share:
    """One of several equal shares of a sweep.

    Example:
        >>> Share(number=2, count=4).folder("big").name
        'big.share-2-of-4'
    """

    number: int = quantity("", "Which share, counted from 1", ge=1)
    count: int = quantity("", "Number of shares", ge=1)

    def __post_init__(self) -> None:
        """Check the fields against each other."""
        if self.number > self.count:
            rule = f"must be at most `count`, {self.count}, got {self.number}"
            raise BadArgument("number", rule)

    def __str__(self) -> str:
        """Return the share as it is written for `parse_share`."""
        return f"{self.number}/{self.count}"

    def has_region(self, index: int) -> bool:
        """Return whether a region is part of the share.

        Args:
            index: Index of the region.
        """
        return index % self.count == self.number - 1

    def folder(self, folder: str | Path) -> Path:
        """Return the folder of the share.

        Args:
            folder: Folder of the whole sweep.
        """
        path = Path(folder)
        return path.with_name(f"{path.name}.share-{self.number}-of-{self.count}")

    def file(self, file: str | Path) -> Path:
        """Return the file of the share, for studies that are kept in one file.

        Args:
            file: File of the whole study.

        Example:
            >>> Share(number=2, count=4).file("rows.csv").name
            'rows.share-2-of-4.csv'
        """
        path = Path(file)
        of_share = self.folder(path.with_suffix(""))
        return of_share.with_name(of_share.name + path.suffix)


@dataclass(frozen=True)
class StoredShare:
    """A share that is there, and where."""

    share: Share
    """The share."""
    path: Path
    """Its folder or file."""


@dataclass(frozen=True, kw_only=True)
class Merged:
    """What came of a merger."""

    results: "xarray.Dataset"
    """The whole sweep, as `open_sweep` returns it."""
    n_done: int
    """Number of trials that are stored in its folder."""
    unfinished: tuple[Share, ...]
    """Shares that are missing, or that are there, but not finished."""


def merge_shares(
    sweep: Sweep,
    folder: str | Path,
    *,
    progress: Progress = silent,
    region_size: int | None = None,
) -> Merged:
    """Put the shares of a sweep together; what is there already is kept, and what is missing can follow.

    Args:
        sweep: The whole sweep.
        folder: Its folder; the shares lie beside it, see `Share.folder`.
        progress: Called at the start and after every region with the number of trials done and the
            total.
        region_size: As it was for the shares.

    Raises:
        ValueError: If there is no share beside the folder, or one of another sweep, one that is
            damaged, or one that another process writes to.
        StorageFailed: If the folder cannot be written. Nothing that was stored is lost.
    """
    stored_shares = find_shares(folder)
    if region_size is None:
        n_shares = stored_shares[-1].share.count
        region_size = region_size_for(sweep, n_shares)
    with open_store(folder, sweep, region_size=region_size, resume=True) as store:
        progress(store.n_done, sweep.n_trials)
        for stored_share in stored_shares:
            with owned(stored_share.path, "sweep", DEFINITION):
                _copy_share(stored_share.path, store, progress)
        shares = list_shares(stored_shares)
        unfinished = tuple(share for share in shares if not _is_finished(share, store))
    results = open_unread(Path(folder))
    return Merged(results=results, n_done=store.n_done, unfinished=unfinished)


def _copy_share(folder: Path, store: Store, progress: Progress) -> None:
    """Store the regions of a share that the whole sweep does not have yet."""
    for index, results in _read_share(folder, store):
        (table,) = store.sweep.tables([store.regions.at(index)])
        store.write(index, table, results)
        progress(store.n_done, store.sweep.n_trials)


def find_shares(folder: str | Path, *, suffix: str = "") -> list[StoredShare]:
    """Return the shares beside a study, in their order.

    Args:
        folder: Its folder, or its file.
        suffix: What ends the name of the study and of its shares, if each is a file.

    Raises:
        ValueError: If there is none.
    """
    path = Path(folder)
    stem = path.name.removesuffix(suffix)
    stored_shares: list[StoredShare] = []
    for neighbour in path.parent.glob(f"{glob.escape(stem)}.share-*{suffix}"):
        ending = neighbour.name.removeprefix(stem).removesuffix(suffix)
        match = FOLDER_OF_SHARE.fullmatch(ending)
        if match:
            share = Share(
                number=int(match["number"]),
                count=int(match["count"]),
            )
            stored_shares.append(StoredShare(share, neighbour))
    if not stored_shares:
        example = f"{stem}.share-1-of-4{suffix}"
        rule = f"must have shares beside it, such as {example}, got {path} without any"
        raise BadArgument("table" if suffix else "folder", rule)

    def count_and_number(stored_share: StoredShare) -> tuple[int, int]:
        return stored_share.share.count, stored_share.share.number

    return sorted(stored_shares, key=count_and_number)


def list_shares(stored_shares: Sequence[StoredShare]) -> list[Share]:
    """Return all shares of the division into the largest number of them.

    Args:
        stored_shares: Those that are there, as `find_shares` returns them.
    """
    count = stored_shares[-1].share.count
    return [Share(number=number, count=count) for number in range(1, count + 1)]


def _read_share(folder: Path, store: Store) -> Iterator[tuple[int, dict[str, Column]]]:
    """Yield index and results of the regions of a share that the whole sweep does not have yet."""
    _check_share(folder, store)
    marks = read_marks(folder, store.regions)
    is_in_share = damage.is_stored(folder, marks)
    is_new = is_in_share & ~store.done
    zarr = import_zarr()
    with readable(folder, RESULTS):
        group = zarr.open_group(str(folder / RESULTS), mode="r", use_consolidated=False)
    for index in np.flatnonzero(is_new).tolist():
        block = store.regions.at(index)
        results: dict[str, Column] = {}
        # zarr compares the checksum of every chunk that it reads.
        with readable(folder, RESULTS):
            for name in store.sweep.quantities:
                values: Any = group[name][block]
                results[name] = values.reshape(-1)
        yield index, results


def _check_share(folder: Path, store: Store) -> None:
    """Refuse a share of another sweep, and one that was divided into other regions."""
    # Refuses what is no sweep, and damaged files.
    regions_of(folder)
    definition = read_definition(folder) or {}
    regions = check_definition(folder, store.sweep, definition)
    if regions != store.regions:
        raise BadArgument(
            "folder",
            f"must be divided into regions of {store.regions.block}, got {folder} with "
            f"{regions.block}: give the `region_size` of the shares",
        )


def _is_finished(share: Share, store: Store) -> bool:
    """Return whether the whole sweep has all regions of a share."""
    return all(store.done[index] for index in regions_of_share(share, store.regions))


def region_size_for(sweep: Sweep, n_shares: int) -> int:
    """Return the size of regions of which every share gets some, at most about a second of work.

    Args:
        sweep: The whole sweep.
        n_shares: Number of shares.
    """
    equal_size = math.ceil(sweep.n_trials / (REGIONS_PER_SHARE * n_shares))
    return min(equal_size, sweep.default_region_size())


def regions_of_share(share: Share, regions: Regions) -> list[int]:
    """Return the indices of the regions of a share.

    Args:
        share: The share.
        regions: All regions of the sweep.
    """
    return [index for index in range(regions.count) if share.has_region(index)]


def parse_share(text: str) -> Share:
    """Return a share that is written as `3/16`.

    Args:
        text: Its number, counted from 1, and the number of shares.

    Raises:
        ValueError: If the text has another form.
    """
    match = re.fullmatch(r"(\d+)/(\d+)", text)
    if match is None:
        raise BadArgument("share", f"must be NUMBER/COUNT, such as 3/16, got {text}")
    number = int(match[1])
    count = int(match[2])
    check_whole_number("share", count, 1)
    if not 1 <= number <= count:
        raise BadArgument("share", f"must be between 1/{count} and {count}/{count}, got {text}")
    return Share(number=number, count=count)
