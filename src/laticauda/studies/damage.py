"""Damage to the stored results of a sweep: which regions are no longer as they were written.

Every chunk ends in a checksum of Zstandard, and every chunk of a stored region exists, even one
without a single number. A wrong bit, a shortened file and a missing one are therefore noticed.
Folders of older releases have no checksums: of them only chunks that cannot be unpacked are found.
"""

from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.studies.checksums import CHECKSUMS
from laticauda.studies.regions import Block, Regions
from laticauda.values import StoredResultsWarning, warn_caller

NOT_STORED = 0
"""Mark of a region that is not stored."""
STORED = 255
"""Mark of a stored region: not one of its bits is that of a region that is not stored."""
MOST_LISTED = 3
"""Number of regions that a message lists."""
AGAIN = "run the same sweep again, which makes anew what is damaged"
"""Advice to whoever reads a damaged folder."""


def has_checksums(path: Path) -> bool:
    """Return whether a folder is of a release that wrote checksums."""
    return (path / CHECKSUMS).exists()


def warn_without_checksums(path: Path) -> None:
    """Say of a folder of an older release that nobody can tell whether its results are intact."""
    if not has_checksums(path):
        warn_caller(
            f"{path}: its results are of an older release and have no checksums, so damage to "
            "them would not be noticed.",
            StoredResultsWarning,
        )


def is_stored(path: Path, marks: np.ndarray) -> np.ndarray:
    """Return whether each region is stored.

    Args:
        path: The folder.
        marks: Its marks.
    """
    if has_checksums(path):
        return marks == STORED
    return marks != NOT_STORED


def find_damaged_marks(path: Path, marks: np.ndarray) -> list[int]:
    """Return the regions whose mark is none that this release writes; older ones wrote others.

    Args:
        path: The folder.
        marks: Its marks.
    """
    if not has_checksums(path):
        return []
    is_known = np.isin(marks, (NOT_STORED, STORED))
    return np.flatnonzero(~is_known).tolist()


def list_chunks(results: Path, regions: Regions, names: Iterable[str], index: int) -> list[Path]:
    """Return the files of one region.

    Args:
        results: Folder of the arrays.
        regions: All regions.
        names: Names of the arrays that have one chunk per region.
        index: Index of the region.
    """
    positions = np.unravel_index(index, regions.grid)
    parts = [str(int(position)) for position in positions]
    return [results.joinpath(name, "c", *parts) for name in names]


def find_missing(
    results: Path, regions: Regions, names: Iterable[str], stored: np.ndarray
) -> list[int]:
    """Return the stored regions that lack a file; not for folders of older releases, where it means no numbers.

    Args:
        results: Folder of the arrays.
        regions: All regions.
        names: Names of the arrays that have one chunk per region.
        stored: Whether each region is stored.
    """
    if not has_checksums(results.parent):
        return []
    names = list(names)
    missing: list[int] = []
    for index in np.flatnonzero(stored).tolist():
        chunks = list_chunks(results, regions, names, index)
        if not all(chunk.exists() for chunk in chunks):
            missing.append(index)
    return missing


def find_damaged_regions(
    results: Path, regions: Regions, names: Iterable[str], stored: np.ndarray
) -> list[int]:
    """Return the stored regions of which a file is missing, or does not have the checksum that it states.

    All of them are read: about half a second for a million points.

    Args:
        results: Folder of the arrays.
        regions: All regions.
        names: Names of the arrays that have one chunk per region.
        stored: Whether each region is stored.
    """
    names = list(names)
    damaged = set(find_missing(results, regions, names, stored))
    zstd: Any = import_module("numcodecs.zstd")
    decoder = zstd.Zstd()
    for index in np.flatnonzero(stored).tolist():
        chunks = list_chunks(results, regions, names, index)
        if not all(_is_intact(decoder, chunk) for chunk in chunks):
            damaged.add(index)
    return sorted(damaged)


def _is_intact(decoder: Any, chunk: Path) -> bool:
    """Return whether a chunk can be unpacked; Zstandard compares the checksum then, if there is one.

    A chunk that is missing is another matter.
    """
    if not chunk.exists():
        return True
    try:
        decoder.decode(chunk.read_bytes())
    except RuntimeError:  # what numcodecs raises for whatever is wrong
        return False
    return True


def describe_regions(regions: Regions, indices: Iterable[int]) -> str:
    """Return which regions these are, in words.

    Args:
        regions: All regions.
        indices: Some of them.
    """
    blocks = [_describe_block(regions.at(index)) for index in indices]
    listed = ", ".join(blocks[:MOST_LISTED])
    if len(blocks) > MOST_LISTED:
        listed += ", ..."
    return f"{len(blocks)} of {regions.count} regions (points {listed})"


def _describe_block(block: Block) -> str:
    return "x".join(f"{part.start}:{part.stop}" for part in block)
