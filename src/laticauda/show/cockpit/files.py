"""Trials in files, as the page plays them back: those of this computer, and those that a page uploads.

An uploaded file is first read by another process, see `load_uploaded_trial`.
"""

import contextlib
import os
import subprocess
import sys
from pathlib import Path

from laticauda.tank import operate
from laticauda.tank.operate.recording import HEADER
from laticauda.trials import Format, Trial, logs
from laticauda.values import LaticaudaError, TrialFileError

ENDINGS = tuple(ending for ending in Format.endings() if ending != ".csv")
"""Endings of the files that can be played back; a CSV file does not say what robot it is of."""
TIME_LIMIT = 60.0
"""Time limit for reading an uploaded file [s]."""
MEMORY_LIMIT = 2 << 30
"""Memory limit for reading it [bytes]."""
FILE_SHARE = 8
"""The converted file may have this fraction of the memory limit: it is read by this process."""
REFUSED = 3
"""Exit status of the reading process if it refuses the file and says why."""
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Environment of the reading process: each thread would reserve memory."""


def load_played_trial(path: Path, name: str) -> Trial:
    """Load the trial, or the run of a recorded operation, from a file.

    Args:
        path: The file.
        name: Name of the file in messages.

    Raises:
        TrialFileError: If the file is neither; the message gives the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    if not path.exists():
        raise TrialFileError(f"Cannot load {name}: there is no such file.")
    if path.suffix not in ENDINGS:
        endings = ", ".join(ENDINGS)
        raise TrialFileError(f"Cannot load {name}: a trial file ends in one of {endings}.")
    try:
        if path.suffix == ".mcap" and HEADER in logs.open_recording(path).metadata:
            return operate.trial_of(operate.read_operation(path))
        return logs.load_trial(path)
    except TrialFileError as error:
        raise TrialFileError(str(error).replace(str(path), name)) from error


def load_uploaded_trial(path: Path, name: str) -> Trial:
    """Load an uploaded file as `load_played_trial` does, from what another process makes of it.

    The readers of HDF5, zip and other formats are not designed for malicious files. Therefore
    another process reads the file first, and converts it to one of ours. The process is limited to
    `TIME_LIMIT` and, where the system supports such a limit, to `MEMORY_LIMIT`.

    Args:
        path: The file, in a separate folder.
        name: Name of the file in messages.

    Raises:
        TrialFileError: If it is not such a file, or cannot be read within the limits; the message
            gives the reason.
    """
    converted = path.with_name("read.nc")
    code = f"from {__name__} import convert_uploaded; convert_uploaded()"
    arguments = [str(path), str(converted), name, str(MEMORY_LIMIT)]
    try:
        process = subprocess.run(
            [sys.executable, "-P", "-c", code, *arguments],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=TIME_LIMIT,
            env=os.environ | ONE_THREAD,
        )
    except subprocess.TimeoutExpired:
        raise TrialFileError(
            f"Cannot load {name}: reading it takes longer than {TIME_LIMIT:g} s."
        ) from None
    if process.returncode == REFUSED:
        raise TrialFileError(process.stderr.decode(errors="replace"))
    if process.returncode != 0:
        limit = f"{MEMORY_LIMIT >> 20} MiB"
        raise TrialFileError(f"Cannot load {name}: its reader ended at once, or exceeded {limit}.")
    return load_played_trial(converted, name)


def convert_uploaded() -> None:
    """Run in that process; its command line contains the two files, the name, and the memory limit."""
    source, target, name, memory_limit = sys.argv[1:]
    _limit_memory(int(memory_limit))
    try:
        load_played_trial(Path(source), name).save(target)
    except (ValueError, LaticaudaError) as error:
        # HDF5 reports a file as damaged when out of memory; then this allocation ends the process.
        bytes(1 << 24)
        sys.stderr.write(str(error))
        sys.exit(REFUSED)


def _limit_memory(limit: int) -> None:
    """Limit the memory of this process, and the files that it writes [bytes]."""
    with contextlib.suppress(ImportError):  # not available on Windows
        import resource

        file_limit = limit // FILE_SHARE
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
        resource.setrlimit(resource.RLIMIT_FSIZE, (file_limit, file_limit))
