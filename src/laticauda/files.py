"""Reading and writing of files: texts of bounded size, TOML, files that are replaced as a whole, and locks."""

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

from laticauda.errors import LaticaudaError, StorageFailed
from laticauda.extensions import Unknown

MOST_BYTES = 1 << 26
"""A text that a person or a program wrote for us is not longer than this."""
MOST_DATA = 1 << 32
"""Nor is a table or a trial longer than this."""
_HOST = f"{zlib.crc32(platform.node().encode()):08x}"


def local(path: str | os.PathLike[str]) -> Path:
    """A place on this computer: object stores have neither the locks nor the renaming that files are kept by.

    Args:
        path: What was given.

    Raises:
        StorageFailed: If it is empty, or an address, as `s3://bucket/sweep`.
    """
    place = Path(path)
    if str(path) == "":
        raise StorageFailed("'': an empty text is the name of no file")
    if place.parts and place.parts[0][2:].endswith(":"):  # a drive's name has one letter
        shown = str(path).replace("://", ":/").replace(":/", "://")  # a path has lost a slash
        raise StorageFailed(f"{shown}: is an address; give a path on this computer, and copy from or to there besides")
    return place


def read_bytes(path: str | Path, most_bytes: int = MOST_DATA) -> bytes:
    """All of a file, of data that a program wrote.

    Args:
        path: Of the file.
        most_bytes: A longer file is refused, before it fills the memory.

    Raises:
        OSError: If it cannot be read, or is longer.
    """
    with local(path).open("rb") as file:
        size = os.fstat(file.fileno()).st_size  # room for all of it is asked for at once
        most_bytes = most_bytes if size else min(most_bytes, MOST_BYTES)  # a device has no size, and maybe no end
        content = file.read(min(size or most_bytes, most_bytes) + 1)
    if len(content) > most_bytes:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
    return content


def read_text(
    path: str | Path,
    error: type[LaticaudaError] = StorageFailed,
    *,
    missing: type[LaticaudaError] | None = None,
    most_bytes: int = MOST_BYTES,
) -> str:
    """The text of a file; a byte-order mark at its beginning is left out.

    Args:
        path: Of the file.
        error: What is raised if it cannot be read; the message says which file and why.
        missing: The same for a file that is not there; None: `error`.
        most_bytes: A longer file is refused, before it fills the memory.

    Raises:
        LaticaudaError: As `error` says.
    """
    local(path)
    try:
        content = read_bytes(path, most_bytes)
    except FileNotFoundError:
        raise (missing or error)(f"{path}: no such file") from None
    except IsADirectoryError:
        raise error(f"{path}: is a folder, not a file") from None
    except (OSError, ValueError) as failure:  # a null byte in the name is a ValueError
        if getattr(failure, "errno", None) == errno.EFBIG:
            raise error(f"{path}: is longer than {most_bytes >> 20} MiB, which no file of this kind is") from None
        raise error(f"{path}: cannot be read: {getattr(failure, 'strerror', None) or failure}") from None
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as failure:
        raise error(f"{path}: is not a text in UTF-8 ({failure.reason} at byte {failure.start})") from None


def parse_toml(text: str, shown: object, error: type[LaticaudaError] = StorageFailed) -> dict[str, Any]:
    """The table that a TOML text holds.

    Args:
        text: What to parse.
        shown: What messages call it.
        error: What is raised if it is no TOML.

    Raises:
        LaticaudaError: As `error` says.
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise error(f"{shown}: is not valid TOML: nested too deeply") from None
    except ValueError as failure:  # also a number of more digits than Python reads
        raise error(f"{shown}: is not valid TOML: {failure}") from None


def read_toml(
    path: str | Path, error: type[LaticaudaError] = StorageFailed, *, missing: type[LaticaudaError] | None = None
) -> dict[str, Any]:
    """The table in a TOML file.

    Args:
        path: Of the file.
        error: What is raised if it cannot be read or is no TOML; the message says which file and why.
        missing: The same for a file that is not there; None: `error`.
    """
    return parse_toml(read_text(path, error, missing=missing), path, error)


def read_rows(
    path: str | Path, error: type[LaticaudaError] = StorageFailed
) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """The columns of a CSV file, and of each row below them where it stands, counted from 1, and its cells by column.

    Rows without anything and lines that begin with # do not count.

    Args:
        path: Of the file.
        error: What is raised if it cannot be read, or its rows differ in length; the message says which file and why.
    """
    lines = ["" if line.startswith("#") else line for line in read_text(path, error).splitlines()]
    reader = csv.reader(lines, strict=True)
    try:
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if any(row)]
    except csv.Error as failure:
        raise error(f"{path}: row {reader.line_num}: {failure}") from None
    (_, names), *rows = rows or [(1, [])]
    for number, row in rows:
        if len(row) != len(names):
            raise error(f"{path}: row {number}: it must have a cell per column.")
    return names, [(number, dict(zip(names, row, strict=True))) for number, row in rows]


def read_columns(path: str | Path, error: type[LaticaudaError] = StorageFailed) -> dict[str, list[str]]:
    """The cells of a CSV file by column.

    Args:
        path: Of the file.
        error: What is raised if it cannot be read, or its rows differ in length; the message says which file and why.
    """
    names, rows = read_rows(path, error)
    return {name: [row[name] for _, row in rows] for name in names}


def csv_text(rows: Iterable[Iterable[object]], newline: str = "\r\n") -> str:
    """The content of a CSV file.

    Args:
        rows: Of cells, that of the columns' names first; a cell that is None is empty.
        newline: What a line ends in.
    """
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator=newline).writerows(rows)
    return text.getvalue()


def plain(content: Any) -> Any:
    """Mappings and lists as JSON has them: a number that is not finite is None, as what is not available is.

    Args:
        content: Of numbers, texts, lists and mappings.
    """
    if isinstance(content, Mapping):
        return {key: plain(one) for key, one in cast("Mapping[str, Any]", content).items()}
    if isinstance(content, Unknown):
        return plain(content.written)
    if isinstance(content, list | tuple):
        return [plain(one) for one in cast("list[Any]", content)]
    return None if isinstance(content, float) and not math.isfinite(content) else content


def to_json(content: Any, indent: int | None = 2) -> str:
    """The same as a text in JSON.

    Args:
        content: Of numbers, texts, lists and mappings.
        indent: Of its lines; None: one line.
    """
    return json.dumps(plain(content), indent=indent, allow_nan=False)


def write(path: str | Path, content: bytes | str | Callable[[Path], object]) -> None:
    """Put a file in its place as a whole, so that whoever reads it meets the old one or the new one.

    It is written beside the place, under another name with the same ending, and then moved there. What processes of
    this computer left there that were killed meanwhile is removed. What is no plain file, as a pipe or a device, is
    written to.

    Args:
        path: Of the file; its folder has to be there.
        content: Bytes, a text (written in UTF-8), or a function that writes to the path that it is given.

    Raises:
        StorageFailed: If it cannot be written; what was there before is still there.
    """
    target = Path(os.path.realpath(local(path)))  # a link goes on pointing to the file
    is_plain = target.is_file() or not target.exists()
    new = target.with_name(f".{os.getpid()}-{_HOST}{os.urandom(4).hex()}{target.suffix}") if is_plain else target
    try:
        if target.exists() and not os.access(target, os.W_OK):  # a move would ask the folder alone
            raise PermissionError(errno.EACCES, "it is read-only")
        _clear(target.parent)
        if callable(content):
            new.open("ab").close()  # what stands in the way is said by the system, not by a library in its own words
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
        reason, advice = error.strerror or error, "make room there" if is_full(error) else "put that right"
        raise StorageFailed(f"{path}: cannot be written: {reason}; {advice}, or name another place.") from error
    finally:
        if is_plain:
            with suppress(OSError):  # it could not be made
                new.unlink()


def is_full(error: OSError) -> bool:
    """Whether something cannot be written for want of room.

    Args:
        error: What the system said.
    """
    return error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def _clear(folder: Path) -> None:
    """Remove what processes of this computer that are no more had not moved to its place."""
    for left in folder.glob(f".[0-9]*-{_HOST}*") if os.name == "posix" else ():
        with suppress(OSError, ValueError):
            try:
                os.kill(int(left.name[1:].partition("-")[0]), 0)  # no signal, a question
            except ProcessLookupError:
                left.unlink()


@contextmanager
def locked(path: Path, *, wait: bool) -> Generator[None]:
    """Keep other processes from doing the same work, where the system and the file system have locks.

    Args:
        path: A folder or a file that all of them lock; a file is made if need be. The lock goes with the process,
            however that ends.
        wait: For another process that has it.

    Raises:
        BlockingIOError: If another process has it and `wait` is not set.
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
                raise  # all others are a file system's that has no locks
        yield
    finally:
        os.close(handle)
