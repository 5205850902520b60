"""Interruption by Ctrl-C, which is handled by this process and not by those that it starts."""

import signal
from collections.abc import Generator
from contextlib import contextmanager


@contextmanager
def defer_interrupts() -> Generator[None]:
    """Defer Ctrl-C to the end of this context, and to this process: processes started within it never receive it."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
