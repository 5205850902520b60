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
from typing import Any, cast

from laticauda.control.estimation import Learner
from laticauda.tank.operate.drivers.base import Frame
from laticauda.tank.operate.recording.entries import Entry, Event, Header
from laticauda.tank.operate.recording.log import OperationRecorder, Sink
from laticauda.values.errors import LaticaudaError, StorageFailed

MOST_WAITING = (
    1 << 26
)  # bytes that the pipe has not yet taken; beyond this, the disk does not keep up


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
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        # In a separate session: Ctrl-C is for the operator, and this goes on until there is nothing
        # more to write.
        self._process: Any = subprocess.Popen(
            [sys.executable, "-P", "-c", code], start_new_session=True, **pipes
        )
        self._pipe, self._waiting = self._process.stdin.fileno(), bytearray()
        self._listener = threading.Thread(target=self._listen, name="recording", daemon=True)
        self._send((path, header, frames, learner, epoch))
        said = _heard(self._process.stdout)
        if said != "":
            self.close()
            raise StorageFailed(said or "The program that writes the recording does not start.")
        os.set_blocking(self._pipe, False)
        self._listener.start()

    def keep(self, now: float, found: Sequence[Entry | Frame]) -> None:
        """Record what a tick at `now` [s] `found`, in this order; after an error, nothing more is written."""
        if len(self._waiting) > MOST_WAITING:
            self.trouble = self.trouble or "the disk cannot keep up with the recording"
        if not self.trouble:
            self._send((now, found))

    def flush(self) -> None:
        """Hand over everything that waits, such as a tick with all that came while the computer stood still."""
        os.set_blocking(self._pipe, True)
        while self._waiting and self._process.poll() is None:
            self._pass_on()
        os.set_blocking(self._pipe, False)

    def close(self) -> None:
        """Have everything written, and wait until it is done."""
        self.flush()
        self._process.stdin.close()
        self._process.wait()
        if self._listener.ident is not None:
            self._listener.join()
        self._process.stdout.close()

    def _send(self, what: object) -> None:
        self._waiting += pickle.dumps(what, protocol=-1)
        self._pass_on()

    def _pass_on(self) -> None:
        try:
            del self._waiting[: os.write(self._pipe, self._waiting)]
        except BlockingIOError:  # later
            pass
        except OSError:
            self.trouble = self.trouble or "the program that writes the recording has ended"
            self._waiting.clear()

    def _listen(self) -> None:
        while (said := _heard(self._process.stdout)) is not None:
            if isinstance(said, str):
                self.trouble = said
            else:
                self.news.extend(said)

    def __exit__(self, *_: object) -> None:
        """Close the recording."""
        self.close()


def main() -> None:
    """Run the separate program: read the arguments of `Writer` first, then tick after tick."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    given = sys.stdin.buffer
    path, header, frames, learner, epoch = cast(
        "tuple[Path, Header, bool, Learner | None, int]", pickle.load(given)
    )
    try:
        with OperationRecorder(path, header, epoch=epoch) as recorder:
            sink = Sink(recorder, frames=frames, learner=learner)
            _say("")
            _write(sink, given)
    except (LaticaudaError, OSError) as error:
        _say(str(error))


def _write(sink: Sink, given: Any) -> None:
    """Write ticks until there are no more."""
    while (tick := _heard(given)) is not None:
        sink.keep(*tick)
        if sink.trouble:
            _say(sink.trouble)
        if sink.news:
            _say(tuple(sink.news))
            sink.news.clear()


def _say(what: object) -> None:
    os.write(sys.stdout.fileno(), pickle.dumps(what))


def _heard(stream: Any) -> Any:
    """Return the next object that the other program sent; None if it has ended, or was killed while sending."""
    try:
        return pickle.load(stream)
    except (EOFError, pickle.UnpicklingError):
        return None
