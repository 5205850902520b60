"""Common part of all drivers: a thread that survives exceptions and ends on request."""

import threading
import warnings
from collections import deque
from typing import Any, Generic, Self, TypeVar

from laticauda.values import LaticaudaError, optional_import

T = TypeVar("T")
MOST_WAITING_ITEMS = 100_000
"""Items waiting to be received at most; beyond this, the oldest are dropped."""
CLOSE_TIMEOUT = 5.0
"""How long `close` waits for the thread to end [s]."""
RETRY_DELAY = 0.5
"""Delay between an error and the next attempt, by the wall clock [s]."""
THREAD_PREFIX = "laticauda-"
"""Beginning of the names of all workers' threads."""


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
        self._received: deque[T] = deque(maxlen=MOST_WAITING_ITEMS)
        self._trouble = ""
        self._ended = threading.Event()
        self._thread = threading.Thread(
            target=self._run, name=f"{THREAD_PREFIX}{name}", daemon=True
        )

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
        return tuple(self._received.popleft() for _ in range(len(self._received)))

    @property
    def _found(self) -> deque[T]:
        """Former name of `_received`, for drivers written before 0.3."""
        warnings.warn("Worker._found is now Worker._received", DeprecationWarning, stacklevel=2)
        return self._received

    def close(self) -> None:
        """End the thread and release the device."""
        if self._ended.is_set():
            return
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join(CLOSE_TIMEOUT)
        self.release()

    def _start(self) -> None:
        self._thread.start()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self.work()
                self._trouble = ""
            except Exception as error:
                self._trouble = _sentence_of(error)
                self._ended.wait(RETRY_DELAY)

    def __enter__(self) -> Self:
        """Return the worker itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the worker."""
        self.close()


def _sentence_of(error: Exception) -> str:
    """Return what went wrong, in words."""
    if isinstance(error, LaticaudaError):
        return str(error)
    return f"{type(error).__name__}: {error}".removesuffix(": ")
