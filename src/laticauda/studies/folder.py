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

from laticauda.values import BadArgument, MissingExtra, StorageFailed, is_full, local, locked

FORMAT = 2
"""Format of the definitions; format 1, which was not numbered, held no scenario."""
MOST_DIFFERENCES = 3
"""Number of differences, or of foreign files, that a message lists."""
UNFINISHED_FILES = ".[0-9]*-*"
"""Pattern of files that `laticauda.values.files.write` had not moved into place when it was killed."""
UNFINISHED_ZARR_FILES = "*.partial"
"""Pattern of files that zarr had not moved into place when it was killed."""


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


def check_same(path: Path, job: str, stored: Mapping[str, Any], current: Mapping[str, Any]) -> None:
    """Refuse to continue with a job other than the one that was begun.

    Args:
        path: The folder.
        job: Name of the job in messages.
        stored: The stored definition.
        current: Definition of the job to continue.

    Raises:
        ValueError: If they differ; the message names the differences.
    """
    if stored.get("format") != FORMAT:
        raise BadArgument(
            "folder",
            f"must be empty, or hold this {job}, got {path} with one started by another release of "
            "laticauda: use another folder, or continue with that release; the results of a sweep "
            "can still be read",
        )
    differences = list(_list_differences(stored, current))
    if differences:
        listed = "; ".join(differences[:MOST_DIFFERENCES])
        n_more = len(differences) - MOST_DIFFERENCES
        if n_more > 0:
            listed += f" and {n_more} more"
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
        _check_without_foreign_files(path, job)
    with ExitStack() as stack:
        try:
            stack.enter_context(locked(path, wait=False))
        except BlockingIOError as error:
            raise BadArgument(
                "folder", f"must be one that no other process is writing to, got {path}"
            ) from error
        _remove_unfinished_files(path)
        yield


def _check_without_foreign_files(path: Path, job: str) -> None:
    foreign_files = sorted(file.name for file in path.iterdir() if not file.match(UNFINISHED_FILES))
    if not foreign_files:
        return
    listed = ", ".join(foreign_files[:MOST_DIFFERENCES])
    if len(foreign_files) > MOST_DIFFERENCES:
        listed += ", ..."
    raise BadArgument("folder", f"must be empty, or hold this {job}, got {path} with {listed}")


def _remove_unfinished_files(path: Path) -> None:
    """Remove what writers left that were killed: no file has its name until it is complete."""
    for file in (*path.glob(UNFINISHED_FILES), *path.rglob(UNFINISHED_ZARR_FILES)):
        file.unlink(missing_ok=True)


@contextmanager
def storage(path: Path, stored: str) -> Generator[None]:
    """Turn system errors about a folder into a sentence with advice.

    Args:
        path: The folder.
        stored: What is already stored there, in words.

    Raises:
        StorageFailed: In place of an OSError.
    """
    try:
        yield
    except OSError as failure:
        error = failure
        if isinstance(failure.__cause__, OSError):  # of a StorageFailed of a single file
            error = failure.__cause__
        if is_full(error):
            reason = "the disk is full"
            advice = "free some space"
        else:
            reason = (error.strerror or str(error)).lower()
            advice = "fix that"
        raise StorageFailed(
            f"{path}: {reason}. Nothing that was stored is lost: {stored}; "
            f"{advice} and run the same again to continue."
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


def _list_differences(stored: Any, current: Any, name: str = "") -> Iterator[str]:
    """Yield the differences between two definitions, with the path to each."""
    if isinstance(stored, dict) and isinstance(current, dict):
        stored_table = cast("dict[str, Any]", stored)
        current_table = cast("dict[str, Any]", current)
        for key in dict.fromkeys([*stored_table, *current_table]):
            path = f"{name}.{key}" if name else key
            yield from _list_differences(
                stored_table.get(key, "nothing"), current_table.get(key, "nothing"), path
            )
    elif isinstance(stored, list) and isinstance(current, list):
        stored_items = cast("list[Any]", stored)
        current_items = cast("list[Any]", current)
        if len(stored_items) != len(current_items):
            yield (f"{name} has {len(stored_items)} values there and {len(current_items)} here")
            return
        for i, (stored_item, current_item) in enumerate(
            zip(stored_items, current_items, strict=True)
        ):
            yield from _list_differences(stored_item, current_item, f"{name}[{i}]")
    elif stored != current:
        yield f"{name} is {_shorten(stored)} there and {_shorten(current)} here"


def _shorten(content: Any) -> str:
    if isinstance(content, list):
        return "a list"
    if isinstance(content, dict):
        return "a table"
    return str(content)
