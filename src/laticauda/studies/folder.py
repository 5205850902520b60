"""Folder of a job that may be stopped at any moment and resumed there: to which job it belongs, and who writes to it.

A job is everything that its results depend on, recorded in one of its files. A resumed job is
compared with that record, so that a folder never holds results of two jobs. While a process works
there, it holds the folder's lock, which is released when the process ends, however it ends.
"""

import json
from collections.abc import Generator, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, cast

from laticauda.errors import BadArgument, MissingExtra, StorageFailed
from laticauda.files import is_full, local, locked

FORMAT = 2
"""Format of the definitions; format 1, which was not numbered, held no scenario."""
MOST_DIFFERENCES = 3
_UNFINISHED = (
    ".[0-9]*-*"  # files that `laticauda.files.write` had not moved into place when it was killed
)


def as_stored(definition: Mapping[str, Any]) -> dict[str, Any]:
    """Return a job's definition as read back from its file, with the number of the format.

    Args:
        definition: Everything that the results depend on.

    Raises:
        ValueError: If a file cannot hold it, such as a law that is a user-defined function.
    """
    try:
        return json.loads(json.dumps({"format": FORMAT, **definition}, allow_nan=False))
    except TypeError as error:
        raise BadArgument("scenario", f"must be one that a file can hold: {error}") from error


def check_same(path: Path, job: str, stored: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse to continue with a job other than the one that was begun.

    Args:
        path: The folder.
        job: Name of the job in messages.
        stored: The stored definition.
        wanted: Definition of the job to continue.

    Raises:
        ValueError: If they differ; the message names the differences.
    """
    if stored.get("format") != FORMAT:
        raise BadArgument(
            "folder",
            f"must be empty, or hold this {job}, got {path} with one started by another release of laticauda: "
            "use another folder, or continue with that release; the results of a sweep can still be read",
        )
    found = list(_differences(stored, wanted))
    if found:
        more = f" and {len(found) - MOST_DIFFERENCES} more" if len(found) > MOST_DIFFERENCES else ""
        listed = "; ".join(found[:MOST_DIFFERENCES]) + more
        raise BadArgument(
            "folder", f"must be empty, or hold this {job}, got {path} with another one: {listed}"
        )


@contextmanager
def owned(path: Path, job: str, mark: str) -> Generator[None]:
    """Hold a folder for this process alone; it is created if needed.

    Args:
        path: The folder.
        job: Name of the job in messages.
        mark: The file that every folder of such a job has.

    Raises:
        ValueError: If it is a file, holds foreign files, or another process writes to it.
        StorageFailed: If it cannot be created.
    """
    if local(path).exists() and not path.is_dir():
        raise BadArgument("folder", f"must be a folder, got the file {path}")
    with storage(path, "0 trials are stored"):
        path.mkdir(parents=True, exist_ok=True)
    if not (path / mark).exists():
        others = sorted(file.name for file in path.iterdir() if not file.match(_UNFINISHED))
        if others:
            listed = ", ".join(others[:MOST_DIFFERENCES]) + (
                ", ..." if len(others) > MOST_DIFFERENCES else ""
            )
            raise BadArgument(
                "folder", f"must be empty, or hold this {job}, got {path} with {listed}"
            )
    with ExitStack() as held:
        try:
            held.enter_context(locked(path, wait=False))
        except BlockingIOError as error:
            raise BadArgument(
                "folder", f"must be one that no other process is writing to, got {path}"
            ) from error
        # Zarr files have another name until they are complete.
        for left in (*path.glob(_UNFINISHED), *path.rglob("*.partial")):
            left.unlink(missing_ok=True)
        yield


@contextmanager
def storage(path: Path, kept: str) -> Generator[None]:
    """Turn system errors about a folder into a sentence with advice.

    Args:
        path: The folder.
        kept: What is already stored there, in words.

    Raises:
        StorageFailed: In place of an OSError.
    """
    try:
        yield
    except OSError as failure:  # a StorageFailed of a single file is also one
        error = failure.__cause__ if isinstance(failure.__cause__, OSError) else failure
        full = is_full(error)
        reason = "the disk is full" if full else (error.strerror or str(error)).lower()
        advice = "free some space" if full else "fix that"
        raise StorageFailed(
            f"{path}: {reason}. Nothing that was stored is lost: {kept}; {advice} and run the same again to continue."
        ) from error


@contextmanager
def readable(path: Path, file: str) -> Generator[None]:
    """Turn any library's error about a damaged file into an error about its folder.

    Args:
        path: The folder.
        file: Name of the file read there.

    Raises:
        ValueError: In place of any other error.
    """
    try:
        yield
    except MissingExtra:
        raise
    except Exception as error:
        if isinstance(error, BadArgument) and error.name == "folder":
            raise
        raise BadArgument(
            "folder", f"must hold a readable `{file}`, got {path}: {str(error).rstrip('.')}"
        ) from error


def _differences(there: Any, here: Any, name: str = "") -> Iterator[str]:
    """Yield the differences between two definitions, with the path to each."""
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
