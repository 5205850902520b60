"""What every driver has: a thread that never dies of an exception and ends when it is to, and the operator's clock."""

import ctypes
import gc
import os
import sys
import threading
import time
from collections import deque
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import Any, Generic, Self, TypeVar

from laticauda.errors import LaticaudaError, optional_import, positive

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
        self._thread = threading.Thread(target=self._run, name=f"{NAME}{name}", daemon=True)

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
        return tuple(self._found.popleft() for _ in range(len(self._found)))

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


NAME = "laticauda-"
DEVICES, LOOP = 10, 20  # priorities in real time
PRESENT = 1 | 4  # MCL_CURRENT and MCL_ONFAULT: what is in memory stays there, and nothing is fetched for it
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
    def undisturbed(self) -> Generator[str]:
        """Within it no garbage is collected, threads take turns quickly, and all is as urgent as the system allows.

        Yields:
            What the system allowed, see `urgent`.
        """
        switch, was_on = sys.getswitchinterval(), gc.isenabled()
        gc.collect()
        gc.freeze()
        gc.disable()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            with urgent() as granted:
                yield granted
        finally:
            sys.setswitchinterval(switch)
            gc.unfreeze()
            if was_on:
                gc.enable()


@contextmanager
def urgent() -> Generator[str]:
    """Within it this thread comes before those of all `Worker`, and these before other programs; memory stays in place.

    As far as the system allows: Linux does for root, and for whom `ulimit -r` and `ulimit -l` say so.

    Yields:
        What it allowed, in a sentence.
    """
    workers = [thread.native_id for thread in threading.enumerate() if thread.name.startswith(NAME)]
    urgency = {**{number: DEVICES for number in workers if number}, threading.get_native_id(): LOOP}
    fixed, real_time = False, False
    with suppress(AttributeError, OSError, TypeError):  # TypeError: Windows has no library without a name
        fixed = ctypes.CDLL(None).mlockall(PRESENT) == 0
    with suppress(AttributeError, OSError):
        for number, priority in urgency.items():
            os.sched_setscheduler(number, os.SCHED_FIFO, os.sched_param(priority))
        real_time = True
    try:
        granted = "real-time priority" if real_time else "the priority of any program, for the system allows no other"
        yield f"The loop has {granted}, and memory that {'stays in place' if fixed else 'may be swapped out'}."
    finally:
        for number in urgency:
            with suppress(AttributeError, OSError):  # a worker may have ended
                os.sched_setscheduler(number, os.SCHED_OTHER, os.sched_param(0))
        if fixed:
            ctypes.CDLL(None).munlockall()
