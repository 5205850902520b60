"""The operator's clock, and what a loop may ask of the computer: priority, one core, memory that stays."""

import ctypes
import gc
import os
import sys
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress

from laticauda.tank.protocol.worker import THREAD_PREFIX
from laticauda.values import check_positive

DEVICE_PRIORITY = 10
"""Real-time priority of the workers' threads."""
LOOP_PRIORITY = 20
"""Real-time priority of the loop, above theirs."""
MCL_CURRENT = 1
"""Flag of mlockall: pages in memory stay there."""
MCL_ONFAULT = 4
"""Flag of mlockall: no others are loaded for it."""
SWITCH_INTERVAL = 0.0005
"""Time between switches of this program's threads; Python's default of 5 ms is half a period [s]."""


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
        remaining = (moment - self.now()) / self.speed
        if remaining > 0.0:
            time.sleep(remaining)

    @contextmanager
    def undisturbed(self) -> Generator[str]:
        """Disable garbage collection, switch threads quickly, and raise priorities as far as the system allows.

        Yields:
            What the system allowed; see `urgent`.
        """
        switch_interval = sys.getswitchinterval()
        was_collecting = gc.isenabled()
        gc.collect()
        gc.freeze()
        gc.disable()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            with urgent() as sentence:
                yield sentence
        finally:
            sys.setswitchinterval(switch_interval)
            gc.unfreeze()
            if was_collecting:
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
    priorities = _priorities_by_thread()
    is_memory_locked = _lock_memory()
    usual_cores = _raise_priorities(priorities)
    try:
        yield _describe(has_priority=bool(usual_cores), is_memory_locked=is_memory_locked)
    finally:
        for thread in priorities:
            with suppress(AttributeError, OSError):  # a worker may have ended
                os.sched_setscheduler(thread, os.SCHED_OTHER, os.sched_param(0))
                os.sched_setaffinity(thread, usual_cores)
        if is_memory_locked:
            ctypes.CDLL(None).munlockall()


def _priorities_by_thread() -> dict[int, int]:
    """Return the priorities of all workers and, last, of this thread, by the system's numbers of threads."""
    priorities: dict[int, int] = {}
    for thread in threading.enumerate():
        if thread.name.startswith(THREAD_PREFIX) and thread.native_id:
            priorities[thread.native_id] = DEVICE_PRIORITY
    priorities[threading.get_native_id()] = LOOP_PRIORITY
    return priorities


def _lock_memory() -> bool:
    """Keep this program's pages in memory; return whether the system allowed it."""
    # TypeError: on Windows, a library must have a name.
    with suppress(AttributeError, OSError, TypeError):
        return ctypes.CDLL(None).mlockall(MCL_CURRENT | MCL_ONFAULT) == 0
    return False


def _raise_priorities(priorities: dict[int, int]) -> list[int]:
    """Give threads their priorities and one core; return the cores that they had, none if it was not allowed."""
    usual_cores: list[int] = []
    with suppress(AttributeError, OSError):
        for thread, priority in priorities.items():
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(priority))
        usual_cores = list(os.sched_getaffinity(0))
        core = ctypes.CDLL(None).sched_getcpu()
        for thread in priorities:
            os.sched_setaffinity(thread, {core})
    return usual_cores


def _describe(*, has_priority: bool, is_memory_locked: bool) -> str:
    """Return what the system allowed, in a sentence."""
    priority = "normal priority, as the system allows no other"
    if has_priority:
        priority = "real-time priority"
    memory = "may be swapped out"
    if is_memory_locked:
        memory = "stays in place"
    return f"The loop has {priority}, and memory that {memory}."
