"""No driver may leave a thread or an open file behind."""

import gc
import os
import threading
import time
from collections.abc import Iterator

import pytest


def open_files() -> set[str]:
    """What this process has open and a driver may have opened: sockets, terminals."""
    found: set[str] = set()
    for name in os.listdir("/proc/self/fd"):
        try:
            target = os.readlink(f"/proc/self/fd/{name}")
        except OSError:
            continue
        if target.startswith(("socket:", "/dev/pts", "/dev/ptmx")):
            found.add(f"{name} {target}")
    return found


@pytest.fixture(autouse=True)
def nothing_is_left() -> Iterator[None]:
    threads, files = set(threading.enumerate()), open_files()
    yield
    end = time.monotonic() + 10.0
    while time.monotonic() < end:
        left = [thread.name for thread in threading.enumerate() if thread not in threads]
        more = open_files() - files
        if not left and not more:
            return
        gc.collect()
        time.sleep(0.02)
    pytest.fail(f"left behind: threads {left}, files {more}")
