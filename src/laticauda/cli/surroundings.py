"""What the program finds when it starts: its streams, the width of the terminal, and how much memory it may use."""

import io
import os
import shutil
import sys

from laticauda.values import LaticaudaError

N_STANDARD_STREAMS = 3
"""Standard input, output and error, which have the file descriptors 0 to 2."""
LEAST_WIDTH = 20
"""Width of the terminal below which tyro breaks the lines of its help forever [characters]."""
LEAST_MEMORY = 512
"""Address space that a short run needs: 482 MiB with two threads; with less, OpenBLAS waits forever [MiB]."""


class UnsuitableProcess(LaticaudaError):
    """Raised if the program cannot work in the process that somebody has started; the message says what to change."""


def settle_streams() -> None:
    """Replace closed standard streams, and keep file names that are not UTF-8 from breaking messages.

    Raises:
        UnsuitableProcess: If standard output is closed.
    """
    is_output_closed = sys.stdout is None
    _occupy_closed_descriptors()
    if sys.stderr is None:
        sys.stderr = _open_nowhere()
    if is_output_closed:
        sys.stdout = _open_nowhere()
        raise UnsuitableProcess(
            "standard output is closed; if nobody is to see it, send it to /dev/null."
        )
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _occupy_closed_descriptors() -> None:
    """Let no file that is opened later get the descriptor of a standard stream, and with it what libraries print."""
    if os.name != "posix":
        return
    descriptor = os.open(os.devnull, os.O_RDWR)
    while descriptor < N_STANDARD_STREAMS:
        descriptor = os.dup(descriptor)
    os.close(descriptor)


def _open_nowhere() -> io.TextIOWrapper:
    return open(os.devnull, "w", encoding="utf-8")  # for the rest of the process


def silence(stream_name: str) -> None:
    """Send what is still to be written to a stream nowhere, even at exit, as it cannot be written.

    Args:
        stream_name: "stdout" or "stderr".
    """
    stream = getattr(sys, stream_name)
    try:
        descriptor = stream.fileno()
    except (OSError, ValueError):  # a stream of a program that runs us, which is not a file
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)


def widen_narrow_terminal() -> None:
    """Let the help be as wide as its words at least: tyro would not end in a terminal of fewer columns."""
    if shutil.get_terminal_size().columns < LEAST_WIDTH:
        os.environ["COLUMNS"] = str(LEAST_WIDTH)


def check_memory() -> None:
    """Refuse a process that may use less memory than a short run needs.

    Raises:
        UnsuitableProcess: If its limit is below `LEAST_MEMORY`.
    """
    if sys.platform == "win32":
        return
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    allowed = limit >> 20
    if limit != resource.RLIM_INFINITY and allowed < LEAST_MEMORY:
        raise UnsuitableProcess(
            f"this process may use {allowed} MiB of memory; "
            f"it needs {LEAST_MEMORY} MiB: raise the limit (`ulimit -v`)."
        )
