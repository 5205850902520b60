"""Recording in a separate program, so that neither the disk nor the encoding makes the loop late.

The loop puts its data into a pipe, as far as there is room, and never waits. The program writes
until its input ends, even if the loop's program was killed.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, cast

from laticauda.control.estimation import Learner
from laticauda.tank.operate.drivers.base import Frame
from laticauda.tank.operate.recording.entries import Entry, Event
from laticauda.tank.operate.recording.header import Header
from laticauda.tank.operate.recording.recorder import OperationRecorder, Sink
from laticauda.values import LaticaudaError, StorageFailed

MOST_WAITING = 1 << 26
"""Bytes that the pipe has not yet taken; beyond this, the disk does not keep up."""


class Assignment(NamedTuple):
    """What the separate program is to write, and where: the first object in the pipe."""

    path: Path
    """Path of the file."""
    header: Header
    """What is known at the start."""
    keeps_frames: bool
    """Whether to keep the raw frames of the bus."""
    learner: Learner | None
    """Learner that learns from the entries; None: nothing is learned."""
    epoch: int
    """Wall-clock time at time 0 of the operation's clock [ns since 1970]; 0: unknown."""


TickRecord: TypeAlias = tuple[float, Sequence[Entry | Frame]]
"""Time of a tick [s], and what is to be recorded of it in this order: every further object.

A plain tuple is short: what the pipe does not hold yet is lost if the loop's program is killed.
"""
Answer: TypeAlias = str | tuple[Event, ...]
"""What the program answers: why it cannot go on, "" once it can, or news."""


class Writer(AbstractContextManager["Writer"]):
    """Keeps a record of every tick, as `Sink` does, but in a separate program; a context manager.

    Args:
        path: Path of the file; an existing file is never replaced.
        header: What is known at the start; written to disk at once.
        frames: Whether to keep the raw frames of the bus.
        learner: Learner that learns from the entries, also in that program; None: nothing is
            learned.
        epoch: Wall-clock time at time 0 of the operation's clock [ns since 1970]; 0: unknown.

    Raises:
        StorageFailed: If the file exists, or cannot be written.
    """

    trouble = ""
    """Why nothing is recorded any more; "" while recording works."""

    def __init__(
        self,
        path: Path,
        header: Header,
        *,
        frames: bool = True,
        learner: Learner | None = None,
        epoch: int = 0,
    ) -> None:
        self.news = deque[Event]()
        """Events about what was learned and what has changed, as in `Sink`."""
        code = f"from {__name__} import main; main()"
        # In a separate session: Ctrl-C is for the operator, and this goes on until there is nothing
        # more to write.
        self._process: Any = subprocess.Popen(
            [sys.executable, "-P", "-c", code],
            start_new_session=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        self._pipe = self._process.stdin.fileno()
        self._waiting = bytearray()
        self._listener = threading.Thread(target=self._listen, name="recording", daemon=True)
        self._send(
            Assignment(
                path=path,
                header=header,
                keeps_frames=frames,
                learner=learner,
                epoch=epoch,
            )
        )
        trouble = _receive(self._process.stdout)
        if trouble != "":
            self.close()
            raise StorageFailed(trouble or "The program that writes the recording does not start.")
        os.set_blocking(self._pipe, False)
        self._listener.start()

    def keep(self, now: float, entries: Sequence[Entry | Frame]) -> None:
        """Record the entries of a tick, in this order; after an error, nothing more is written.

        Args:
            now: Time of the tick [s].
            entries: Its entries, and raw frames of the bus.
        """
        if len(self._waiting) > MOST_WAITING:
            self.trouble = self.trouble or "the disk cannot keep up with the recording"
        if not self.trouble:
            self._send((now, entries))

    def flush(self) -> None:
        """Hand over everything that waits: a tick with all that came while the computer stood still."""
        os.set_blocking(self._pipe, True)
        while self._waiting and self._process.poll() is None:
            self._write_to_pipe()
        os.set_blocking(self._pipe, False)

    def close(self) -> None:
        """Have everything written, and wait until it is done."""
        self.flush()
        self._process.stdin.close()
        self._process.wait()
        if self._listener.ident is not None:
            self._listener.join()
        self._process.stdout.close()

    def _send(self, message: object) -> None:
        self._waiting += pickle.dumps(message, protocol=-1)
        self._write_to_pipe()

    def _write_to_pipe(self) -> None:
        """Put as much into the pipe as it takes."""
        try:
            n_written = os.write(self._pipe, self._waiting)
            del self._waiting[:n_written]
        except BlockingIOError:  # later
            pass
        except OSError:
            self.trouble = self.trouble or "the program that writes the recording has ended"
            self._waiting.clear()

    def _listen(self) -> None:
        """Take in what the program answers, until it ends."""
        while True:
            message: Answer | None = _receive(self._process.stdout)
            if message is None:
                return
            if isinstance(message, str):
                self.trouble = message
            else:
                self.news.extend(message)

    def __exit__(self, *_: object) -> None:
        """Close the recording."""
        self.close()


# ---- the separate program ------------------------------------------------------------------------


def main() -> None:
    """Run the separate program: read its assignment first, then tick after tick."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    stream = sys.stdin.buffer
    assignment = cast("Assignment", pickle.load(stream))
    try:
        with OperationRecorder(
            assignment.path, assignment.header, epoch=assignment.epoch
        ) as recorder:
            sink = Sink(recorder, frames=assignment.keeps_frames, learner=assignment.learner)
            _answer("")
            _write_ticks(sink, stream)
    except (LaticaudaError, OSError) as error:
        _answer(str(error))


def _write_ticks(sink: Sink, stream: Any) -> None:
    """Write ticks until there are no more."""
    while True:
        tick: TickRecord | None = _receive(stream)
        if tick is None:
            return
        now, entries = tick
        sink.keep(now, entries)
        if sink.trouble:
            _answer(sink.trouble)
        if sink.news:
            _answer(tuple(sink.news))
            sink.news.clear()


def _answer(message: Answer) -> None:
    os.write(sys.stdout.fileno(), pickle.dumps(message))


def _receive(stream: Any) -> Any:
    """Return the next object that the other program sent; None if it has ended.

    It may also have been killed while sending.
    """
    try:
        return pickle.load(stream)
    except (EOFError, pickle.UnpicklingError):
        return None
