"""A progress bar for runs that take long."""

import sys
import time
from collections.abc import Callable
from typing import Any

PATIENCE = 2.0  # nobody wants a bar for less [s]


def progress(duration: float) -> Callable[[float], None]:
    """What a run calls with the time it has reached [s]; a bar appears on a terminal's standard error, after a while.

    Args:
        duration: Of the run, simulated [s].
    """
    began = time.monotonic()
    bar: Any = None

    def show(reached: float) -> None:
        nonlocal bar
        if not sys.stderr.isatty():
            return
        if bar is None and time.monotonic() - began > PATIENCE:
            from tqdm import tqdm

            bar = tqdm(total=duration, unit="s", desc="simulated", leave=False, bar_format=_FORMAT, file=sys.stderr)
        if bar is not None:
            bar.update(reached - bar.n)
            if reached >= duration:
                bar.close()

    return show


_FORMAT = "{desc} {n:.0f} of {total:.0f} s |{bar}| {remaining} left"
