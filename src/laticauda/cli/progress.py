"""Progress bars: shown on standard error if it is a terminal."""

import math
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any

PATIENCE = 2.0
"""Time for which a progress bar is not yet shown [s]."""
# ---- forms of a bar, as in tqdm ------------------------------------------------------------------

SECONDS = "{desc} {n:.0f} of {total:.0f} s |{bar}| {remaining} left"
"""Simulated or filmed time."""
TRIALS = "{desc} {n_fmt} of {total_fmt} trials |{bar}| {remaining} left"
"""Number of trials."""
SHARE = "{desc} {percentage:3.0f} % |{bar}| {remaining} left"
"""Share of the work, between 0 and 1."""


def show_progress(
    form: str, total: float = 1.0, what: str = "swam", *, patience: float = 0.0
) -> Callable[..., None]:
    """Return a callback for the amount done, optionally with `total` and `what`; each `what` has its own bar.

    Args:
        form: Format of the bar, as in tqdm.
        total: Total amount of work.
        what: Text at the beginning of the bar.
        patience: Time for which nothing is shown [s].
    """
    began = time.monotonic()
    bars: dict[str, Any] = {}

    def show(done: float, total: float = total, what: str = what) -> None:
        if what not in bars:
            is_early = time.monotonic() - began < patience
            if is_early or not sys.stderr.isatty():
                return
            bars[what] = _open_bar(form, total, what, done)
        bar = bars[what]
        bar.n = done
        bar.refresh()
        if done >= total:
            bar.close()

    return show


def _open_bar(form: str, total: float, what: str, done: float) -> Any:
    from tqdm import tqdm

    return tqdm(
        total=total,
        initial=done,
        desc=what,
        bar_format=form,
        leave=False,
        file=sys.stderr,
    )


def run_bar(duration: float, what: str = "swam") -> Callable[..., None]:
    """Return a callback for the time that a run has reached [s]; short runs show nothing.

    Args:
        duration: Simulated time of the whole run [s].
        what: Text of the bar before the time reached.
    """
    return show_progress(SECONDS, duration, what, patience=PATIENCE)


def film_bar(duration: float) -> Callable[[float], None]:
    """Return a callback for the time that has been filmed; without a terminal, it prints a line for every tenth.

    Args:
        duration: Time span of the trial that is filmed [s].
    """
    show_bar = run_bar(duration, "filmed")
    began = time.monotonic()
    printed_tenths = 0

    def show(done: float) -> None:
        nonlocal printed_tenths
        show_bar(done)
        tenths = _tenths_of(done, duration)
        if tenths <= printed_tenths or sys.stderr.isatty():
            return
        printed_tenths = tenths
        if time.monotonic() - began > PATIENCE:
            reached = f"{10 * tenths} % filmed, {done:.1f} of {duration:.1f} s"
            print(f"laticauda: {reached}", file=sys.stderr, flush=True)

    return show


def _tenths_of(done: float, total: float) -> int:
    if not total:
        return 10
    return math.floor(10.0 * done / total + 1e-9)


@contextmanager
def stored_trials(folder: object) -> Generator[Callable[[int, int], None]]:
    """Show the progress of trials that are stored as they finish; Ctrl-C reports their number and how to resume.

    Args:
        folder: Folder where they are stored.
    """
    show_bar = show_progress(TRIALS)
    n_stored, n_trials = 0, 0

    def show(done: int, total: int) -> None:
        nonlocal n_stored, n_trials
        n_stored = done
        n_trials = total
        show_bar(done, total)

    try:
        yield show
    except KeyboardInterrupt:
        stored = f"{n_stored} of {n_trials} trials are stored in {folder}"
        message = f"stopped; {stored}. Run the same command again to resume."
        raise KeyboardInterrupt(message) from None
