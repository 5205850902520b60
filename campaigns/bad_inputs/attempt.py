"""One bad input: tried in a process of its own, with limits of time and memory, and judged."""

import contextlib
import io
import json
import os
import pickle
import re
import resource
import select
import shutil
import signal
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

from laticauda.cli import main
from laticauda.values import LaticaudaError

GIGABYTES = 6
"""Memory that a bad input may take, beside what its process has at the beginning [GiB]."""
PROCESSOR_SECONDS = 60
"""Time of a core that it may take [s]."""
PATIENCE = 20.0
"""Time after which work that still goes on is stopped as if by Ctrl-C [s]."""
LONGEST = 200.0
"""Time after which a process counts as hanging: on a busy computer it does not run all the time [s]."""
SERVING = 2.0
"""Time for which a command may serve before it is stopped [s]."""
STOPPED_STATUS = 130
"""Exit status of a command after Ctrl-C."""


class Answer(NamedTuple):
    """What came of a bad input."""

    verdict: str
    """`refused`, `accepted`, `stopped` (it worked on, and ended at Ctrl-C), `differs` or `fault`."""
    detail: str = ""
    """What is wrong, for a fault."""
    n_inputs: int = 1
    """Inputs that were tried."""


REFUSED = Answer("refused")
ACCEPTED = Answer("accepted")
STOPPED = Answer("stopped")


def fault(detail: str) -> Answer:
    """Return the answer to an input that did harm.

    Args:
        detail: What is wrong.
    """
    return Answer("fault", detail)


class Case(NamedTuple):
    """One bad input."""

    kind: str
    shown: str
    attack: Callable[[], Answer]
    """Tries it in a folder of its own."""


# ---- a process for each --------------------------------------------------------------------------


def attempt(case: Case) -> Answer:
    """Return what comes of a bad input, in a process of its own.

    Args:
        case: The input.
    """
    folder = tempfile.mkdtemp(prefix="bad-input-")
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        _attack_and_tell(case, folder, writing)
    os.close(writing)
    try:
        content = _read_in_time(reading, child)
    finally:
        os.close(reading)
        _, status = os.waitpid(child, 0)
        shutil.rmtree(folder, ignore_errors=True)
    if content:
        return pickle.loads(content)
    ended = os.waitstatus_to_exitcode(status)
    if ended == STOPPED_STATUS:  # Ctrl-C during an import, at which the program ends at once
        return STOPPED
    if ended == -signal.SIGKILL:
        return fault(f"hangs: it was killed after {LONGEST:g} s")
    return fault(f"its process ended with {ended}")


def _attack_and_tell(case: Case, folder: str, pipe: int) -> None:
    """Try an input, write the answer to a pipe, and end this process."""
    os.setsid()
    memory_now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    most_memory = memory_now + (GIGABYTES << 30)
    limit(resource.RLIMIT_AS, most_memory)
    limit(resource.RLIMIT_CPU, PROCESSOR_SECONDS)
    os.chdir(folder)
    try:
        answer = case.attack()
    except BaseException as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        answer = fault(f"{type(error).__name__}: {str(error)[:1000]} at {place}")
    os.write(pipe, pickle.dumps(answer._replace(detail=answer.detail[:2000])))
    os._exit(0)


def limit(kind: int, most: int) -> None:
    """Limit what this process may take; a program that it starts can lift the limit again.

    Args:
        kind: What is limited.
        most: The limit.
    """
    resource.setrlimit(kind, (most, resource.getrlimit(kind)[1]))


def _read_in_time(pipe: int, child: int) -> bytes:
    """Return what a child wrote until its end; it is killed, with all its children, after `LONGEST`."""
    content = b""
    end = time.monotonic() + LONGEST
    while True:
        ready, _, _ = select.select([pipe], [], [], max(0.0, end - time.monotonic()))
        if not ready:
            os.killpg(child, signal.SIGKILL)
            return b""
        part = os.read(pipe, 1 << 16)
        content += part
        if not part or content.endswith(
            b"."
        ):  # the end of a pickle: children may keep the pipe open
            return content


@contextlib.contextmanager
def stopped_after(seconds: float) -> Iterator[None]:
    """Press Ctrl-C after this time.

    Args:
        seconds: The time [s].
    """

    def press(number: int, frame: FrameType | None) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGALRM, press)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


# ---- commands ------------------------------------------------------------------------------------


class Said(NamedTuple):
    """What a command said."""

    status: int
    out: str
    err: str


def type_command(*words: str, patience: float = PATIENCE) -> Said:
    """Run a command in this process.

    Args:
        words: What is typed after the program's name.
        patience: Time after which Ctrl-C is pressed [s].
    """
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        with stopped_after(patience):
            status = main(words)
    return Said(status, out.getvalue(), err.getvalue())


def judge_command(*words: str, names: tuple[str, ...] = (), patience: float = PATIENCE) -> Answer:
    """Run a command in this process: it works, or its message names what is wrong.

    Args:
        words: What is typed after the program's name.
        names: A refusal has to contain one of these; (): any will do.
        patience: Time after which Ctrl-C is pressed [s].
    """
    said = type_command(*words, patience=patience)
    message = " ".join(said.err.split())
    if "Traceback" in message or "Warning:" in message:
        return fault(f"{said.status}: {message[-300:]}")
    if said.status not in (0, 1, 2, STOPPED_STATUS):
        return fault(f"exit status {said.status}: {message[-300:]}")
    if said.status == STOPPED_STATUS:
        return STOPPED
    if said.status == 2:
        return _judge_refusal(message, names)
    if "--json" in words:
        json.loads(
            said.out.splitlines()[0] if patience == SERVING else said.out,
            parse_constant=_refuse_constant,
        )
    return ACCEPTED


def _judge_refusal(message: str, names: tuple[str, ...]) -> Answer:
    """Return whether a refusal names what is wrong; line breaks and frames around it do not count."""
    plain = re.sub(r"[│╭╮╰╯─\s]", "", message)
    plain_names = [re.sub(r"\s", "", name) for name in names]
    if not plain or (names and not any(name in plain for name in plain_names)):
        return fault(f"names nothing: {message[-300:]}")
    return REFUSED


def _refuse_constant(word: str) -> None:
    raise ArithmeticError(f"{word} in what is printed")


# ---- calls ---------------------------------------------------------------------------------------

SAID_BY_PYTHON = re.compile(
    r"missing \d+ required|unexpected keyword|positional argument|also needs `"
    r"|incompatible function arguments"
)
"""Messages of a TypeError that say what is wrong."""
UNWANTED_WARNING = re.compile(r"\b(?!ComplexWarning|InfeasibleWarning|UnitWarning)\w+Warning:")
"""A warning that does not say what is wrong with an argument."""

CHECKERS_OF_TYPES = ("beartype", "jaxtyping")
"""Packages with which the tests check types of calls: their errors count as refusals."""


def judge_call(function: Callable[..., Any], arguments: dict[str, Any]) -> Answer:
    """Call something with a bad argument: it works, or a ValueError or an error of our own says what is wrong.

    Args:
        function: What is called.
        arguments: Its arguments.
    """
    err = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(err):
        try:
            with stopped_after(PATIENCE):
                function(**arguments)
        except (ValueError, LaticaudaError) as error:
            if str(error).strip():
                return REFUSED
            return fault(f"{type(error).__name__} says nothing")
        except (OSError, MemoryError) as error:
            if isinstance(error, MemoryError) or error.filename is not None:
                return REFUSED
            raise
        except KeyboardInterrupt:
            return STOPPED
        except TypeError as error:
            if SAID_BY_PYTHON.search(str(error)):
                return REFUSED
            raise
        except Exception as error:
            if type(error).__module__.startswith(CHECKERS_OF_TYPES):
                return REFUSED
            raise
    if UNWANTED_WARNING.search(err.getvalue()):
        return fault(err.getvalue()[-300:])
    return ACCEPTED
