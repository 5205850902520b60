"""Whose folder it is: a sweep says in a file what it is, and is compared with it when it comes back."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

from laticauda.studies.regions import Regions
from laticauda.studies.sweep import Sweep

DEFINITION = "sweep.json"
NEW = ".new"  # the end of a file's name until it is complete
BLOCK = "region"
MOST_DIFFERENCES = 3


def check_place(path: Path) -> None:
    """Refuse a folder with files of somebody else: nothing of theirs may be touched."""
    if path.exists() and not path.is_dir():
        raise ValueError(f"`folder` must be a folder, got the file {path}.")
    if not path.exists() or (path / DEFINITION).exists():
        return
    others = sorted(file.name for file in path.iterdir() if file.name != DEFINITION + NEW)
    if others:
        more = ", ..." if len(others) > MOST_DIFFERENCES else ""
        listed = ", ".join(others[:MOST_DIFFERENCES]) + more
        raise ValueError(f"`folder` must be empty, or hold this sweep, got {path} with {listed}.")


def claim(path: Path, sweep: Sweep, region_size: int | None) -> Regions:
    """Say in the folder what it is for, or compare; how its sweep is cut."""
    # Through JSON and back: tuples are lists there.
    wanted: dict[str, Any] = json.loads(json.dumps(sweep.definition(), allow_nan=False))
    stored = _definition(path)
    if stored is None:
        regions = sweep.regions(region_size)
        text = json.dumps({**wanted, "shape": regions.shape, BLOCK: regions.block}, indent=1)
        (path / (DEFINITION + NEW)).write_text(text + "\n", encoding="utf-8")
        os.replace(path / (DEFINITION + NEW), path / DEFINITION)
        return regions
    shape, block = stored.pop("shape"), stored.pop(BLOCK)
    listed = list_of_differences(stored, wanted)
    if listed:
        raise ValueError(f"`folder` must be empty, or hold this sweep, got {path} with another one: {listed}.")
    return Regions(shape=tuple(shape), block=tuple(block))


def regions_of(folder: str | Path) -> Regions:
    """How the stored results are cut, to read them piece by piece.

    Args:
        folder: That of a sweep.

    Raises:
        ValueError: If it is none.
    """
    found = _definition(Path(folder))
    if found is None:
        raise ValueError(f"`folder` must hold the results of a sweep, got {folder}.")
    return Regions(shape=tuple(found["shape"]), block=tuple(found[BLOCK]))


def _definition(path: Path) -> dict[str, Any] | None:
    file = path / DEFINITION
    if not file.is_file():
        return None
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"`folder` must hold a readable `{DEFINITION}`, got {path}: {error}.") from error
    if not isinstance(found, dict) or "shape" not in found or BLOCK not in found:
        raise ValueError(f"`folder` must hold a `{DEFINITION}` of a sweep, got {path} with another one.")
    return cast("dict[str, Any]", found)


def list_of_differences(there: Any, here: Any) -> str:
    """The first few ways in which two definitions differ, in words; "" if they are equal.

    Args:
        there: The one that is stored.
        here: The other one.
    """
    found = list(_differences(there, here))
    more = f" and {len(found) - MOST_DIFFERENCES} more" if len(found) > MOST_DIFFERENCES else ""
    return "; ".join(found[:MOST_DIFFERENCES]) + more


def _differences(there: Any, here: Any, name: str = "") -> Iterator[str]:
    """What differs between two definitions, with the way to it."""
    if isinstance(there, dict) and isinstance(here, dict):
        one, other = cast("dict[str, Any]", there), cast("dict[str, Any]", here)
        for key in dict.fromkeys([*one, *other]):
            way = f"{name}.{key}" if name else key
            yield from _differences(one.get(key, "nothing"), other.get(key, "nothing"), way)
    elif isinstance(there, list) and isinstance(here, list):
        items, others = cast("list[Any]", there), cast("list[Any]", here)
        if len(items) != len(others):
            yield f"{name} has {len(items)} values there and {len(others)} here"
            return
        for i, (item, also) in enumerate(zip(items, others, strict=True)):
            yield from _differences(item, also, f"{name}[{i}]")
    elif there != here:
        yield f"{name} is {_short(there)} there and {_short(here)} here"


def _short(value: Any) -> str:
    if isinstance(value, list):
        return "a list"
    return "a table" if isinstance(value, dict) else str(value)
