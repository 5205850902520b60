"""The operator's keys: space, q or Ctrl-C straighten and stop the robot, the second one is the emergency stop."""

import contextlib
import os
import select
import signal
import sys
import threading
from types import FrameType
from typing import Any, Self, TextIO

STOP, EMERGENCY = "operator_key", "emergency_key"
WORDS = {b" ": "by space", b"q": "by q", b"Q": "by q"}
"""Keys of a terminal that stop, and how the log calls them."""
LOOK = 0.1  # how often a terminal's thread looks whether it is to end [s, wall clock]


class Keys:
    """What the operator has pressed so far; within a `with` block, also by signals."""

    def __init__(self) -> None:
        self._pressed: dict[str, str] = {}
        self._before: dict[int, Any] = {}

    @property
    def events(self) -> dict[str, str]:
        """For the supervisor: a key that was pressed stays pressed."""
        return dict(self._pressed)

    def stop(self, how: str = "by key") -> None:
        """Straighten and stop; the second time, the emergency stop.

        Args:
            how: It was asked for.
        """
        self._pressed.setdefault(EMERGENCY if STOP in self._pressed else STOP, how)

    def emergency(self, how: str = "by key") -> None:
        """The emergency stop.

        Args:
            how: It was asked for.
        """
        self._pressed.setdefault(EMERGENCY, how)

    def _signalled(self, number: int, frame: FrameType | None) -> None:
        self.stop(f"by {signal.Signals(number).name}")

    def __enter__(self) -> Self:
        """Take the signals; only the main thread of a program can."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._before[number] = signal.signal(number, self._signalled)
        return self

    def __exit__(self, *_: object) -> None:
        """Give the signals back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before.clear()


class Terminal:
    """Single keys of a terminal, without Enter, as long as a `with` block lasts; nothing where there is no terminal.

    The terminal is as it was afterwards. Ctrl-C stays a signal. Who runs the program in the background has no keys.

    Args:
        keys: What is told of them.
        stream: The terminal; None: standard input.
    """

    def __init__(self, keys: Keys, stream: TextIO | None = None) -> None:
        self._keys, self._stream = keys, sys.stdin if stream is None else stream
        self._before: list[Any] | None = None
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def __enter__(self) -> Self:
        """Take the keys one by one, unseen."""
        try:
            import termios
            import tty

            number = self._stream.fileno()
            if self._stream.isatty() and _in_front(number):
                self._before = termios.tcgetattr(number)
                tty.setcbreak(number)
                self._thread = threading.Thread(target=self._run, args=(number,), name="laticauda-keys", daemon=True)
                self._thread.start()
        except (ImportError, AttributeError, OSError, ValueError):
            pass  # another operating system, or no terminal: Ctrl-C is left
        return self

    def __exit__(self, *_: object) -> None:
        """Give the terminal back as it was."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join(10.0 * LOOK)
        if self._before is not None:
            import termios

            with contextlib.suppress(OSError, ValueError, termios.error):
                termios.tcsetattr(self._stream.fileno(), termios.TCSADRAIN, self._before)

    def _run(self, number: int) -> None:
        while not self._ended.is_set():
            try:
                if not select.select([number], [], [], LOOK)[0]:
                    continue
                pressed = os.read(number, 1)
            except (OSError, ValueError):
                return
            if not pressed:  # the terminal is gone
                return
            if pressed in WORDS:
                self._keys.stop(WORDS[pressed])


def _in_front(number: int) -> bool:
    """Whether this program is the one that its terminal listens to; one in the background must not touch it."""
    try:
        return os.tcgetpgrp(number) == os.getpgrp()
    except OSError:  # not the terminal that controls this program: nobody else is in front of it
        return True
