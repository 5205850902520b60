"""Files that are shown: trials in all of their formats, recordings of operations, stored sweeps."""

# xarray's own annotations are partial.
# pyright: reportUnknownMemberType=false

import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from zipfile import BadZipFile, ZipFile

import xarray

from laticauda.cockpit.maps import NO_SWEEP, Map, map_of
from laticauda.errors import TrialFileError
from laticauda.logs import load_trial, open_recording
from laticauda.operate import read_operation, trial_of
from laticauda.operate.recording.header import HEADER
from laticauda.studies import open_sweep
from laticauda.trial import Format, Trial

MOST_BYTES = 1 << 30  # of an archive, unpacked
DEFINITION = "sweep.json"  # in the folder of a sweep
READ: tuple[str, ...] = tuple(ending for ending in Format.endings() if ending != ".csv")


def opened(path: Path) -> Trial | Map:
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


def received_sweep(name: str, content: bytes) -> Map:
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
    if path.is_dir() or ending != ".nc":
        return path.is_dir() or ending == ".zip"
    try:
        with xarray.open_dataset(path, engine="netcdf4") as dataset:
            return "forward_velocity" in dataset and "center_of_mass" not in dataset
    except (ValueError, OSError):
        return False


def _trial(path: Path, name: str) -> Trial:
    if path.suffix not in READ:
        raise TrialFileError(f"Cannot load {name}: a trial file ends in one of {', '.join(READ)}.")
    try:
        if path.suffix == ".mcap" and HEADER in open_recording(path).metadata:
            return trial_of(read_operation(path))
        return load_trial(path)
    except TrialFileError as error:
        raise TrialFileError(str(error).replace(str(path), name)) from error


def _sweep(path: Path, name: str) -> Map:
    try:
        if path.is_dir():
            return map_of(open_sweep(path), name)
        if path.suffix.lower() == ".nc":
            with xarray.open_dataset(path, engine="netcdf4") as dataset:
                return map_of(dataset, name)
        if path.suffix.lower() != ".zip":
            raise ValueError(f"{NO_SWEEP}.")
        with tempfile.TemporaryDirectory() as folder:
            return _sweep(_unpacked(path, Path(folder)), name)
    except TrialFileError:
        raise
    except BadZipFile as error:
        raise TrialFileError(f"Cannot load {name}: {error}.") from error
    except (ValueError, KeyError, OSError) as error:
        raise TrialFileError(f"Cannot load {name}: {error}".replace(str(path), name)) from error


def _unpacked(path: Path, folder: Path) -> Path:
    """The folder of a sweep that was packed as .zip."""
    with ZipFile(path) as archive:
        if sum(item.file_size for item in archive.infolist()) > MOST_BYTES:
            raise ValueError(f"unpacked it is larger than {MOST_BYTES >> 20} MB.")
        archive.extractall(folder)
    found = sorted(folder.rglob(DEFINITION))
    if not found:
        raise ValueError(f"{NO_SWEEP}.")
    return found[0].parent


@contextmanager
def _stored(name: str, content: bytes) -> Generator[Path]:
    """A file of this computer with that content and ending, as long as the block lasts."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"uploaded{Path(name).suffix.lower()}"
        path.write_bytes(content)
        yield path
