"""The operator's clock: real time, or a multiple of it for a virtual tank that runs at that multiple, too."""

import gc
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager

from laticauda.errors import positive

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
