"""The meter's serial line: a pseudo-terminal, of which pyserial opens the other end."""

import os
import select
import threading
from collections.abc import Callable

from laticauda.lab.qtm_server import ServerFailed
from laticauda.protocol.meter import LineReader


class SerialLine:
    """Answers lines in a thread of its own.

    Args:
        answer: What to say to a line.
    """

    def __init__(self, answer: Callable[[str], bytes]) -> None:
        self._answer = answer
        self._reader = LineReader()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="meter", daemon=True)
        self.path = ""

    def start(self) -> None:
        """Make the pseudo-terminal; its `path` is what pyserial opens.

        Raises:
            ServerFailed: If the operating system has none.
        """
        try:
            import tty

            self._ours, self._theirs = os.openpty()
        except (ImportError, OSError) as error:
            raise ServerFailed(f"The meter's line cannot be opened: {error}.") from error
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.path = os.ttyname(self._theirs)
        self._thread.start()

    def stop(self) -> None:
        """Hang up."""
        self._ended.set()
        self._thread.join(2.0)
        for end in (self._ours, self._theirs):
            os.close(end)

    def _run(self) -> None:
        while not self._ended.is_set():
            ready, _, _ = select.select([self._ours], [], [], 0.1)
            if not ready:
                continue
            try:
                data = os.read(self._ours, 4096)
            except OSError:  # nobody has the other end open
                self._ended.wait(0.1)
                continue
            for line in self._reader.feed(data):
                self._write(self._answer(line))

    def _write(self, data: bytes) -> None:
        try:
            os.write(self._ours, data)
        except OSError:  # nobody reads, and the line is full
            pass
