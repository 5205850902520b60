"""Common parts of all drivers: a thread that survives exceptions and ends on request, and the operator's clock."""

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

from laticauda.values.checks import check_positive
from laticauda.values.errors import LaticaudaError
from laticauda.values.optional import optional_import

T = TypeVar("T")
MOST_WAITING = 100_000  # items waiting to be received; beyond this, the oldest are dropped
GIVE_UP = 5.0  # how long `close` waits for the thread to end [s]
RETRY = 0.5  # delay between an error and the next attempt [s, wall clock]


class DeviceFailed(LaticaudaError, OSError):
    """Raised if a device cannot be reached; the message says which, why, and what to check."""


def hardware(package: str, module: str) -> Any:
    """Return a device's library, which belongs to the extra `hardware`.

    Args:
        package: Name under which it is installed.
        module: Name under which it is imported.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("Operating a robot", package, "hardware", module)


class Worker(Generic[T]):
    """Repeatedly runs `work` in a separate thread.

    Results go into a queue; an error becomes a sentence in `trouble`, and the work is retried.

    Args:
        name: Name of the thread.
    """

    def __init__(self, name: str) -> None:
        self._found: deque[T] = deque(maxlen=MOST_WAITING)
        self._trouble = ""
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"{NAME}{name}", daemon=True)

    def work(self) -> None:
        """Do one piece of work, which must return within a few tenths of a second."""
        raise NotImplementedError

    def release(self) -> None:
        """Release the resources of the device, if it holds any; called after the thread has ended."""

    @property
    def trouble(self) -> str:
        """Current problem, in a sentence; "" if there is none."""
        return self._trouble

    def receive(self) -> tuple[T, ...]:
        """Return the items that came in since the last call, oldest first."""
        return tuple(self._found.popleft() for _ in range(len(self._found)))

    def close(self) -> None:
        """End the thread and release the device."""
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
                self._trouble = (
                    str(error) if ours else f"{type(error).__name__}: {error}".removesuffix(": ")
                )
                self._ended.wait(RETRY)

    def __enter__(self) -> Self:
        """Return the worker itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the worker."""
        self.close()


NAME = "laticauda-"
DEVICES, LOOP = 10, 20  # real-time priorities
PRESENT = (
    1 | 4
)  # MCL_CURRENT and MCL_ONFAULT: pages in memory stay there, and no others are loaded for it
SWITCH_INTERVAL = (
    0.0005  # between threads of this program; Python's default of 5 ms is half a period [s]
)


class Clock:
    """Clock that counts the seconds since it was created.

    Args:
        speed: Seconds in the tank per second of the wall clock [-].
    """

    is_real = True
    """Whether its time advances by itself, so that a loop may be late."""

    def __init__(self, *, speed: float = 1.0) -> None:
        self.speed = check_positive("speed", speed)
        self._origin = time.monotonic()

    def now(self) -> float:
        """Return the current time [s]."""
        return (time.monotonic() - self._origin) * self.speed

    def wait_until(self, moment: float) -> None:
        """Sleep until a given time, unless it has already passed.

        Args:
            moment: Time on this clock [s].
        """
        left = (moment - self.now()) / self.speed
        if left > 0.0:
            time.sleep(left)

    @contextmanager
    def undisturbed(self) -> Generator[str]:
        """Disable garbage collection, switch threads quickly, and raise priorities as far as the system allows.

        Yields:
            What the system allowed; see `urgent`.
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
    """Give this thread priority over those of all `Worker`, and these over other programs; lock memory.

    With it they share one core: only one of them runs at a time anyway (Python's lock), and on two
    cores the others would take turns with this one, which doubles the time of a tick.

    This is done as far as the system allows: Linux does for root, and for users permitted by
    `ulimit -r` and `-l`.

    Yields:
        What the system allowed, in a sentence.
    """
    workers = [thread.native_id for thread in threading.enumerate() if thread.name.startswith(NAME)]
    urgency = {**{number: DEVICES for number in workers if number}, threading.get_native_id(): LOOP}
    fixed, cores = False, list[int]()
    with suppress(
        AttributeError, OSError, TypeError
    ):  # TypeError: on Windows, a library must have a name
        fixed = ctypes.CDLL(None).mlockall(PRESENT) == 0
    with suppress(AttributeError, OSError):
        for number, priority in urgency.items():
            os.sched_setscheduler(number, os.SCHED_FIFO, os.sched_param(priority))
        cores, core = list(os.sched_getaffinity(0)), ctypes.CDLL(None).sched_getcpu()
        for number in urgency:
            os.sched_setaffinity(number, {core})
    try:
        granted = (
            "real-time priority" if cores else "normal priority, as the system allows no other"
        )
        yield f"The loop has {granted}, and memory that {'stays in place' if fixed else 'may be swapped out'}."
    finally:
        for number in urgency:
            with suppress(AttributeError, OSError):  # a worker may have ended
                os.sched_setscheduler(number, os.SCHED_OTHER, os.sched_param(0))
                os.sched_setaffinity(number, cores)
        if fixed:
            ctypes.CDLL(None).munlockall()
