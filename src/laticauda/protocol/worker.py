"""What every driver has: a thread that never dies of an exception and ends when it is to, and the operator's clock."""

import gc
import sys
import threading
import time
from collections import deque
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any, Generic, Self, TypeVar

from laticauda.errors import LaticaudaError, positive
from laticauda.extras import optional_import

T = TypeVar("T")
MOST_WAITING = 100_000  # items that nobody asks for; then the oldest are dropped
GIVE_UP = 5.0  # a thread that does not end by then is reported [s]
RETRY = 0.5  # after an error, before the next try [s, wall clock]


class DeviceFailed(LaticaudaError, OSError):
    """A device cannot be reached: it says which, why, and what to check."""


def hardware(package: str, module: str) -> Any:
    """A device's library, which comes with the extra `hardware`.

    Args:
        package: As it is installed.
        module: As it is imported.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("Operating a robot", package, "hardware", module)


class Worker(Generic[T]):
    """Runs `work` again and again in a thread of its own.

    What it finds goes into a queue; what goes wrong becomes a sentence in `trouble`, and it tries again.

    Args:
        name: Of the thread.
    """

    def __init__(self, name: str) -> None:
        self._found: deque[T] = deque(maxlen=MOST_WAITING)
        self._trouble = ""
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"laticauda-{name}", daemon=True)

    def work(self) -> None:
        """One piece of work, which must come back within some tenths of a second."""
        raise NotImplementedError

    def release(self) -> None:
        """Give back what the device holds, if it holds anything; called after the thread has ended."""

    @property
    def trouble(self) -> str:
        """What is wrong now, in a sentence; "" if nothing is."""
        return self._trouble

    def receive(self) -> tuple[T, ...]:
        """What came in since the last call, oldest first."""
        items: list[T] = []
        while self._found:
            items.append(self._found.popleft())
        return tuple(items)

    def close(self) -> None:
        """End the thread and give the device back."""
        if self._ended.is_set():
            return
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join(GIVE_UP)
        self.release()

    def _start(self) -> None:
        self._thread.start()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self.work()
                self._trouble = ""
            except Exception as error:
                ours = isinstance(error, LaticaudaError)
                self._trouble = str(error) if ours else f"{type(error).__name__}: {error}".removesuffix(": ")
                self._ended.wait(RETRY)

    def __enter__(self) -> Self:
        """Itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()


SWITCH_INTERVAL = 0.0005  # between threads of this program; Python's own 5 ms are half a period [s]


class Clock:
    """Seconds since it was made.

    Args:
        speed: Seconds of the tank per second of the wall clock [-].
    """

    is_real = True
    """Whether its time goes on by itself, so that a loop may be late."""

    def __init__(self, *, speed: float = 1.0) -> None:
        self.speed = positive("speed", speed)
        self._origin = time.monotonic()

    def now(self) -> float:
        """[s]."""
        return (time.monotonic() - self._origin) * self.speed

    def wait_until(self, moment: float) -> None:
        """Sleep until then, if it is still to come.

        Args:
            moment: By this clock [s].
        """
        left = (moment - self.now()) / self.speed
        if left > 0.0:
            time.sleep(left)

    @contextmanager
    def undisturbed(self) -> Generator[None]:
        """Within it, no collection of garbage stops the program for long, and threads take turns quickly."""
        switch, was_on = sys.getswitchinterval(), gc.isenabled()
        gc.collect()
        gc.disable()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            yield
        finally:
            sys.setswitchinterval(switch)
            if was_on:
                gc.enable()
