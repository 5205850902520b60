"""How far a command is: bars on standard error, if that is a terminal."""

import math
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any

PATIENCE = 2.0
"""Nobody wants a bar for less [s]."""
SECONDS = "{desc} {n:.0f} of {total:.0f} s |{bar}| {remaining} left"
TRIALS = "{desc} {n_fmt} of {total_fmt} trials |{bar}| {remaining} left"
SHARE = "{desc} {percentage:3.0f} % |{bar}| {remaining} left"


def progress(form: str, total: float = 1.0, what: str = "swam", *, patience: float = 0.0) -> Callable[..., None]:
    """What work calls now and then with how much is done; also with `total` and `what`, a bar for each `what`.

    Args:
        form: Of the bar, as tqdm has it.
        total: How much there is to do.
        what: What the bar says before that.
        patience: How long nothing is shown [s].
    """
    began = time.monotonic()
    bars: dict[str, Any] = {}

    def show(done: float, total: float = total, what: str = what) -> None:
        if what not in bars:
            if not sys.stderr.isatty() or time.monotonic() - began < patience:
                return
            from tqdm import tqdm

            bars[what] = tqdm(total=total, initial=done, desc=what, bar_format=form, leave=False, file=sys.stderr)
        bars[what].n = done
        bars[what].refresh()
        if done >= total:
            bars[what].close()

    return show


def run_bar(duration: float, what: str = "swam") -> Callable[..., None]:
    """What a run calls now and then with the time it has reached [s]; short ones show nothing.

    Args:
        duration: Simulated time of the whole run [s].
        what: What the bar says before the time that has been reached.
    """
    return progress(SECONDS, duration, what, patience=PATIENCE)


def film_bar(duration: float) -> Callable[[float], None]:
    """The same of a film that becomes longer; where there is no terminal, a line for every tenth.

    Args:
        duration: Time of the trial that is filmed [s].
    """
    bar, began, tenths = run_bar(duration, "filmed"), time.monotonic(), [0]

    def show(done: float) -> None:
        bar(done)
        tenth = math.floor(10.0 * done / duration + 1e-9) if duration else 10
        if tenth > tenths[0] and not sys.stderr.isatty():
            tenths[0] = tenth
            if time.monotonic() - began > PATIENCE:
                print(f"laticauda: {10 * tenth} % filmed, {done:.1f} of {duration:.1f} s", file=sys.stderr, flush=True)

    return show


@contextmanager
def stored_trials(folder: object) -> Generator[Callable[[int, int], None]]:
    """The progress of many trials that are stored as they are done: Ctrl-C says how many, and how to go on.

    Args:
        folder: Where they are stored.
    """
    bar, reached = progress(TRIALS), [0, 0]

    def show(done: int, total: int) -> None:
        reached[:] = done, total
        bar(done, total)

    try:
        yield show
    except KeyboardInterrupt:
        stored = f"{reached[0]} of {reached[1]} trials are stored in {folder}"
        raise KeyboardInterrupt(f"stopped; {stored}. Run the same command again to go on.") from None
