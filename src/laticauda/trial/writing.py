"""Files that appear whole or not at all."""

import os
import uuid
from collections.abc import Callable
from pathlib import Path

from laticauda.errors import TrialFileError


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Put at `path` what `write` makes of an empty file, whole or not at all.

    Args:
        path: Where it will be, over any older file of that name.
        write: Fills the file that it is given; what it raises passes through.

    Raises:
        TrialFileError: If the file cannot be written; the message has its name and the reason.
    """
    # In the same folder, or it could not be moved there in one step.
    beside = path.with_name(f".{path.name}.{uuid.uuid4().hex[:8]}.part")
    try:
        try:
            beside.touch(exist_ok=False)
            write(beside)
            with beside.open("rb+") as file:
                os.fsync(file.fileno())  # or a power cut could leave the new name with nothing in it
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise TrialFileError(f"Cannot write {path}: {(error.strerror or str(error)).lower()}.") from error
    except RuntimeError as error:  # netCDF's, with no more of a reason: most likely the disk is full
        raise TrialFileError(f"Cannot write {path}: {error}; is the disk full?") from error
