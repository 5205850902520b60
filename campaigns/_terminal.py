"""The program in a terminal, for other campaigns."""

import contextlib
import math
import os
import pty
import signal
import subprocess
import sys
import termios
import threading
import time
from pathlib import Path

import _program
from _program import PATIENCE, left_over_of


class Running:
    """A program that runs in a terminal of its own, whose Ctrl-C all its processes get.

    Args:
        words: What is typed.
        folder: Where.
        is_cut: Whether its work is cut down.
    """

    def __init__(self, words: str, folder: Path, *, is_cut: bool = False) -> None:
        if (
            signal.getsignal(signal.SIGINT) is signal.SIG_IGN
        ):  # a shell starts its background jobs, and theirs, deaf
            signal.signal(signal.SIGINT, signal.default_int_handler)
        run = [
            "setsid",
            "--ctty",
            sys.executable,
            _program.__file__,
            *(["--cut"] if is_cut else []),
            *words.split(),
        ]
        self.ended = math.inf
        """When it has ended, by the clock `time.monotonic` [s]."""
        self._terminal, inner = pty.openpty()
        how = termios.tcgetattr(inner)
        how[3] |= termios.NOFLSH  # Ctrl-C does not take away what was said before
        termios.tcsetattr(inner, termios.TCSANOW, how)
        self._process = subprocess.Popen(
            run, cwd=folder, stdin=inner, stdout=subprocess.PIPE, stderr=inner
        )
        os.close(inner)
        assert self._process.stdout is not None
        places = {"out": self._process.stdout.fileno(), "err": self._terminal}
        self._told, self._news, self._is_over = (
            dict.fromkeys(places, b""),
            threading.Condition(),
            False,
        )
        self._readers = [
            threading.Thread(target=self._read, args=place, daemon=True) for place in places.items()
        ]
        for reader in self._readers:
            reader.start()

    def _read(self, name: str, place: int) -> None:
        """Take what the program says, until it has no more."""
        content = b"."
        while content:
            try:
                content = os.read(place, 65536)
            except OSError:  # nobody is left at the terminal
                content = b""
            with self._news:
                self._told[name] += content
                self._is_over = self._is_over or not content
                self._news.notify_all()

    def wait_for(self, lines: int) -> None:
        """Wait until so many lines are on standard output, or the end of the program; the first says "begun"."""
        with self._news:
            self._news.wait_for(
                lambda: self._told["out"].count(b"\n") >= lines or self._is_over, PATIENCE
            )

    def interrupt(self) -> None:
        """Press Ctrl-C."""
        with contextlib.suppress(OSError):
            os.write(self._terminal, b"\x03")

    def end(self) -> tuple[int, str]:
        """Wait for its end; returns its status, and what stands on standard error."""
        status = self._process.wait(PATIENCE)
        self.ended = time.monotonic()
        for reader in self._readers:
            reader.join(PATIENCE)
        assert self._process.stdout is not None
        self._process.stdout.close()
        os.close(self._terminal)
        return status, self._told["err"].decode(errors="replace").replace("\r\n", "\n")

    def left_over(self) -> int:
        """How many processes are left of it when it has ended."""
        return left_over_of(self._process.pid)
