"""A progress bar for runs that take long."""

import sys
import time
from collections.abc import Callable
from typing import Any

PATIENCE = 2.0  # nobody wants a bar for less [s]
FORMAT = "{desc} {n:.0f} of {total:.0f} s |{bar}| {remaining} left"
COUNT_FORMAT = "{desc} {n_fmt} of {total_fmt} trials |{bar}| {remaining} left"


def progress(duration: float, *, done: str = "swam") -> Callable[[float], None]:
    """What a run calls now and then with the time it has reached [s].

    After a while, a bar appears on standard error, if that is a terminal.

    Args:
        duration: Simulated time of the whole run [s].
        done: What the bar says before the time that has been reached.
    """
    began = time.monotonic()
    bar: Any = None

    def show(reached: float) -> None:
        nonlocal bar
        if bar is None and sys.stderr.isatty() and time.monotonic() - began > PATIENCE:
            from tqdm import tqdm

            bar = tqdm(total=duration, initial=reached, desc=done, bar_format=FORMAT, leave=False, file=sys.stderr)
        if bar is not None:
            bar.n = reached
            bar.refresh()
            if reached >= duration:
                bar.close()

    return show


def trials_bar() -> Callable[[int, int], None]:
    """What many trials call now and then with the number of them that are done, and of all.

    A bar appears on standard error, if that is a terminal.
    """
    bars: list[Any] = []

    def show(done: int, total: int) -> None:
        if not sys.stderr.isatty():
            return
        if not bars:
            from tqdm import tqdm

            bars.append(
                tqdm(total=total, initial=done, desc="swam", bar_format=COUNT_FORMAT, leave=False, file=sys.stderr)
            )
        bars[0].update(done - bars[0].n)
        if done >= total:
            bars[0].close()

    return show
