"""Files that a command will write: they are checked before the work starts."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from laticauda.cli.flags import OutputFile, marks_of, parts_of
from laticauda.values import BadArgument

TABLE_ENDING = ".csv"
"""Ending of the only format of trials in this package that keeps a table, not all of a trial."""


def list_endings(endings: Sequence[str]) -> str:
    """Return endings of file names as a help text lists them: .nc, .mcap or .mat."""
    *first_endings, last_ending = endings
    if not first_endings:
        return last_ending
    return f"{', '.join(first_endings)} or {last_ending}"


def list_whole_endings() -> str:
    """Return the endings of the formats that keep all of a trial, as a help text lists them."""
    from laticauda.trials import Format

    return list_endings([ending for ending in Format.endings() if ending != TABLE_ENDING])


class RequestedFile(NamedTuple):
    """A file that a command will write."""

    option: str
    """Name of the option."""
    path: str | None
    """Path that was typed; None: the file is not requested."""
    endings: Sequence[str]
    """Allowed endings of the file name."""
    is_rendered: bool
    """Whether MuJoCo's renderer draws what is written."""


def files_of(command: Any) -> Iterator[RequestedFile]:
    """Yield the files that a command will write.

    Args:
        command: Command, or a part of it.
    """
    from laticauda.trials import Format

    for part in parts_of(command):
        for name, marks in marks_of(part.__class__).items():
            for mark in marks:
                if isinstance(mark, OutputFile):
                    endings = mark.endings or Format.endings()
                    yield RequestedFile(name, getattr(part, name), endings, mark.is_rendered)


def check_output(option: str, path: str | None, endings: Sequence[str]) -> None:
    """Reject an output file that cannot be written.

    Args:
        option: Name of the option.
        path: Given path; None is accepted.
        endings: Allowed endings of the file name.

    Raises:
        ValueError: If it has another ending, its folder does not exist, it is a folder or a
            pipe, or it is not writable.
    """
    if path is None:
        return
    file = Path(path)
    if file.suffix.lower() not in endings:
        raise BadArgument(option, f"must be a file that ends in {' or '.join(endings)}, got {path}")
    if not file.parent.is_dir():
        raise BadArgument(option, f"must be a file in a folder that exists, got {path}")
    if file.is_dir():
        raise BadArgument(option, f"must be a file, got the folder {path}")
    if file.is_fifo():
        raise BadArgument(option, f"must be a file, got the pipe {path}")
    if not _is_writable(file):
        raise BadArgument(option, f"must be a writable file, got {path}: permission denied")
    if file.suffix.lower() == ".mp4":
        from laticauda.show.pictures import find_ffmpeg

        find_ffmpeg()


def _is_writable(file: Path) -> bool:
    # A new file replaces an old one, so the folder must be writable.
    if not os.access(file.parent, os.W_OK):
        return False
    return not file.exists() or os.access(file, os.W_OK)
