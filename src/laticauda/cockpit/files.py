"""Files that are shown: trials in all of their formats, recordings of operations, stored sweeps."""

import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from laticauda.cockpit.sweeps import NO_SWEEP, StoredSweep, is_sweep, read_sweep, unpacked
from laticauda.errors import TrialFileError
from laticauda.logs import load_trial, open_recording
from laticauda.operate import read_operation, trial_of
from laticauda.operate.recording.recorder import HEADER
from laticauda.trial import Format, Trial

READ: tuple[str, ...] = tuple(ending for ending in Format.endings() if ending != ".csv")


def opened(path: Path) -> Trial | StoredSweep:
    """What is in a file or a folder of this computer.

    Args:
        path: A trial or a recording, or the folder of a sweep, packed or not.

    Raises:
        TrialFileError: If it is none; the message has the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    if not path.exists():
        raise TrialFileError(f"Cannot load {path}: there is no such file.")
    if _has_sweep(path):
        return _sweep(path, path.name)
    return _trial(path, str(path))


def received_trial(name: str, content: bytes) -> Trial:
    """The trial, or the run of a recorded operation, in a file that a page sent.

    Args:
        name: The file's name.
        content: What is in it.

    Raises:
        TrialFileError: If it is none; the message has the file's name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    with _stored(name, content) as path:
        if _has_sweep(path):
            raise TrialFileError(f"Cannot play back {name}: it is no trial; the tab Map loads sweeps.")
        return _trial(path, name)


def received_sweep(name: str, content: bytes) -> StoredSweep:
    """The sweep in a file that a page sent.

    Args:
        name: The file's name.
        content: What is in it.

    Raises:
        TrialFileError: If it is none; the message has the file's name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    with _stored(name, content) as path:
        return _sweep(path, name)


def _has_sweep(path: Path) -> bool:
    """Whether it is meant as a sweep: both are stored as .nc."""
    ending = path.suffix.lower()
    return path.is_dir() or ending == ".zip" or (ending == ".nc" and is_sweep(path))


def _trial(path: Path, name: str) -> Trial:
    if path.suffix not in READ:
        raise TrialFileError(f"Cannot load {name}: a trial file ends in one of {', '.join(READ)}.")
    try:
        if path.suffix == ".mcap" and HEADER in open_recording(path).metadata:
            return trial_of(read_operation(path))
        return load_trial(path)
    except TrialFileError as error:
        raise TrialFileError(str(error).replace(str(path), name)) from error


def _sweep(path: Path, name: str) -> StoredSweep:
    ending = path.suffix.lower()
    if path.is_dir() or ending == ".nc":
        return read_sweep(path, name)
    if ending != ".zip":
        raise TrialFileError(f"Cannot load {name}: {NO_SWEEP}.")
    with tempfile.TemporaryDirectory() as folder:
        return read_sweep(unpacked(path, Path(folder), name), name)


@contextmanager
def _stored(name: str, content: bytes) -> Generator[Path]:
    """A file of this computer with that content and ending, as long as the block lasts."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"uploaded{Path(name).suffix.lower()}"
        path.write_bytes(content)
        yield path
