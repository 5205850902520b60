"""Reading and writing of files: texts of limited size, TOML, files that are replaced as a whole, and locks."""

import csv
import errno
import io
import json
import math
import os
import platform
import shutil
import tomllib
import zlib
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, cast

from laticauda.values.errors import LaticaudaError, StorageFailed
from laticauda.values.extensions import Unknown

MOST_BYTES = 1 << 26
"""Maximum size in bytes of a text written by a person or a program."""
MOST_DATA = 1 << 32
"""Maximum size in bytes of a table or a trial."""
_HOST = f"{zlib.crc32(platform.node().encode()):08x}"


def local(path: str | os.PathLike[str]) -> Path:
    """Return a path on this computer; object stores lack the locks and the renaming that writing files relies on.

    Args:
        path: The path given.

    Raises:
        StorageFailed: If it is empty, or an address, such as `s3://bucket/sweep`.
    """
    place = Path(path)
    if str(path) == "":
        raise StorageFailed("'': an empty text is not the name of a file")
    if place.parts and place.parts[0][2:].endswith(":"):  # a drive name has a single letter
        shown = str(path).replace("://", ":/").replace(":/", "://")  # a path has lost a slash
        raise StorageFailed(
            f"{shown}: is an address; give a path on this computer, and copy the files separately"
        )
    return place


def read_bytes(path: str | Path, most_bytes: int = MOST_DATA) -> bytes:
    """Read all of a data file written by a program.

    Args:
        path: Path of the file.
        most_bytes: Maximum size; a larger file is rejected before it fills the memory.

    Raises:
        OSError: If the file cannot be read, or is larger.
    """
    with local(path).open("rb") as file:
        size = os.fstat(file.fileno()).st_size  # memory for all of it is requested at once
        most_bytes = (
            most_bytes if size else min(most_bytes, MOST_BYTES)
        )  # a device has no size, and perhaps no end
        content = file.read(min(size or most_bytes, most_bytes) + 1)
    if len(content) > most_bytes:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
    return content


def read_content(
    path: str | Path,
    error: type[LaticaudaError] = StorageFailed,
    *,
    missing: type[LaticaudaError] | None = None,
    most_bytes: int = MOST_BYTES,
) -> bytes:
    """Read all bytes of a file.

    Args:
        path: Path of the file.
        error: Error raised if the file cannot be read; the message states which file and why.
        missing: Error raised if the file does not exist; None: `error`.
        most_bytes: Maximum size; a larger file is rejected before it fills the memory.

    Raises:
        LaticaudaError: The error given as `error` or `missing`.
    """
    local(path)
    try:
        return read_bytes(path, most_bytes)
    except FileNotFoundError:
        raise (missing or error)(f"{path}: no such file") from None
    except IsADirectoryError:
        raise error(f"{path}: is a folder, not a file") from None
    except (OSError, ValueError) as failure:  # a null byte in the name is a ValueError
        if getattr(failure, "errno", None) == errno.EFBIG:
            raise error(
                f"{path}: is larger than {most_bytes >> 20} MiB, too large for a file of this kind"
            ) from None
        raise error(
            f"{path}: cannot be read: {getattr(failure, 'strerror', None) or failure}"
        ) from None


def read_text(
    path: str | Path,
    error: type[LaticaudaError] = StorageFailed,
    *,
    missing: type[LaticaudaError] | None = None,
    most_bytes: int = MOST_BYTES,
) -> str:
    """Read the text of a file, without a byte-order mark at its beginning.

    Args:
        path: Path of the file.
        error: Error raised if the file cannot be read; the message states which file and why.
        missing: Error raised if the file does not exist; None: `error`.
        most_bytes: Maximum size; a larger file is rejected before it fills the memory.

    Raises:
        LaticaudaError: The error given as `error` or `missing`.
    """
    content = read_content(path, error, missing=missing, most_bytes=most_bytes)
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as failure:
        raise error(
            f"{path}: is not UTF-8 text ({failure.reason} at byte {failure.start})"
        ) from None


def parse_toml(
    text: str, shown: object, error: type[LaticaudaError] = StorageFailed
) -> dict[str, Any]:
    """Parse a TOML text.

    Args:
        text: Text to parse.
        shown: Name of the text in messages.
        error: Error raised if the text is not TOML.

    Raises:
        LaticaudaError: The error given as `error`.
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise error(f"{shown}: is not valid TOML: nested too deeply") from None
    except ValueError as failure:  # also for a number with more digits than Python reads
        raise error(f"{shown}: is not valid TOML: {failure}") from None


def read_toml(
    path: str | Path,
    error: type[LaticaudaError] = StorageFailed,
    *,
    missing: type[LaticaudaError] | None = None,
) -> dict[str, Any]:
    """Read the table in a TOML file.

    Args:
        path: Path of the file.
        error: Error raised if the file cannot be read or is not TOML; the message states which file
            and why.
        missing: Error raised if the file does not exist; None: `error`.
    """
    return parse_toml(read_text(path, error, missing=missing), path, error)


def csv_text(rows: Iterable[Iterable[object]], newline: str = "\r\n") -> str:
    """Return the content of a CSV file.

    Args:
        rows: Rows of cells, starting with the column names; None becomes an empty cell.
        newline: Line terminator.
    """
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator=newline).writerows(rows)
    return text.getvalue()


def to_plain(content: Any) -> Any:
    """Convert mappings and lists to JSON-compatible data; a number that is not finite becomes None (not available).

    Args:
        content: Numbers, texts, lists and mappings.
    """
    if isinstance(content, Mapping):
        table = cast("Mapping[str, Any]", content)
        return {key: to_plain(value) for key, value in table.items()}
    if isinstance(content, Unknown):
        return to_plain(content.written)
    if isinstance(content, list | tuple):
        return [to_plain(item) for item in cast("list[Any]", content)]
    if isinstance(content, float) and not math.isfinite(content):
        return None
    return content


def to_json(content: Any, indent: int | None = 2) -> str:
    """Convert mappings and lists to JSON text in the same way.

    Args:
        content: Numbers, texts, lists and mappings.
        indent: Indentation; None: a single line.
    """
    return json.dumps(to_plain(content), indent=indent, allow_nan=False)


def write(path: str | Path, content: bytes | str | Callable[[Path], object]) -> None:
    """Write a file as a whole, so that readers see either the old or the new version.

    The content is written to another name with the same extension in the same folder, and then
    moved into place. Leftovers of processes on this computer that were killed while writing there
    are removed. A target that is not a regular file, such as a pipe or a device, is written
    directly.

    Args:
        path: Path of the file; its folder must exist.
        content: Bytes, a text (written as UTF-8), or a function that writes to the path that it
            receives.

    Raises:
        StorageFailed: If the file cannot be written; the previous content is then still there.
    """
    target = Path(os.path.realpath(local(path)))  # a link continues to point to the file
    is_plain = target.is_file() or not target.exists()
    new = (
        target.with_name(f".{os.getpid()}-{_HOST}{os.urandom(4).hex()}{target.suffix}")
        if is_plain
        else target
    )
    try:
        if target.exists() and not os.access(
            target, os.W_OK
        ):  # a move would need permission for the folder only
            raise PermissionError(errno.EACCES, "it is read-only")
        if target.is_fifo():
            _check_for_reader(target)
        _clear(target.parent)
        if callable(content):
            new.open(
                "ab"
            ).close()  # obstacles are reported by the system, not by a library in its own words
            content(new)
        else:
            new.write_bytes(content.encode() if isinstance(content, str) else content)
        if is_plain:
            with new.open("rb") as file:
                os.fsync(file.fileno())
            if target.exists():
                shutil.copymode(target, new)
            new.replace(target)
    except OSError as error:
        reason, advice = (
            error.strerror or error,
            "make room there" if is_full(error) else "correct this",
        )
        raise StorageFailed(
            f"{path}: cannot be written: {reason}; {advice}, or name another place."
        ) from error
    finally:
        if is_plain:
            with suppress(OSError):  # it could not be made
                new.unlink()


def _check_for_reader(pipe: Path) -> None:
    """Reject a pipe that nobody reads, as it could not even be opened.

    Raises:
        OSError: If nobody does.
    """
    try:
        os.close(os.open(pipe, os.O_WRONLY | os.O_NONBLOCK))
    except OSError as error:
        if error.errno == errno.ENXIO:
            raise OSError(errno.ENXIO, "it is a pipe that nobody reads") from None
        raise


def is_full(error: OSError) -> bool:
    """Return whether an error was caused by a lack of space.

    Args:
        error: Error raised by the system.
    """
    return error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def _clear(folder: Path) -> None:
    """Remove unfinished files of processes on this computer that no longer exist."""
    for left in folder.glob(f".[0-9]*-{_HOST}*") if os.name == "posix" else ():
        with suppress(OSError, ValueError):
            try:
                os.kill(
                    int(left.name[1:].partition("-")[0]), 0
                )  # signal 0 only tests whether the process exists
            except ProcessLookupError:
                left.unlink()


@contextmanager
def locked(path: Path, *, wait: bool) -> Generator[None]:
    """Keep other processes from doing the same work, where system and file system support locks.

    Args:
        path: A folder or a file that all of them lock; a file is created if needed. The lock is
            released when the process ends, however it ends.
        wait: Whether to wait for another process that holds the lock.

    Raises:
        BlockingIOError: If another process holds the lock and `wait` is not set.
    """
    try:
        import fcntl
    except ImportError:  # pragma: no cover - Windows
        yield
        return
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDONLY | os.O_CREAT, 0o666)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except OSError as error:
            if isinstance(error, BlockingIOError):
                raise  # all other errors mean that the file system has no locks
        yield
    finally:
        os.close(handle)
