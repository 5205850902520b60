"""Base of all commands: output files are checked before the work starts, and the outcome is printed as text or JSON.

Progress bars are shown on standard error if it is a terminal.
"""

import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laticauda.cli.flags import Options, OutputFile, marks_of, parse_command, parts_of
from laticauda.values.access import LOCAL as LOCAL
from laticauda.values.errors import BadArgument
from laticauda.values.files import to_json
from laticauda.values.quantities import option, value_class


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """Outcome of a command."""

    facts: Mapping[str, Any]
    """Facts for programs, in SI units."""
    text: str
    """Text for people."""
    problem: str = ""
    """What went wrong, for standard error."""
    succeeded: bool = True
    """Whether the exit status is 0 rather than 1."""


@value_class
class Command(Options):
    """A command: a value whose fields are its flags."""

    json: bool = option("Print one JSON object in SI units instead of text", default=False)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """Return the command that was typed.

        Args:
            words: Words typed after its name.
            prog: Name of the command in the help.
        """
        return parse_command(cls, words, prog)

    def run(self) -> Outcome | None:
        """Do the work; return None if everything has already been printed."""
        raise NotImplementedError

    def __call__(self) -> int:
        """Do the work, print the outcome and return the exit status."""
        for name, path, endings in files_of(self):
            check_output(name, path, endings)
        done = self.run()
        if done is None:
            return 0
        if done.problem:
            print(done.problem, file=sys.stderr)
        print(to_json(done.facts) if self.json else done.text)
        return 0 if done.succeeded else 1

    def announce(self, facts: Mapping[str, Any], text: str) -> None:
        """Print a line while the command continues.

        Args:
            facts: Facts for programs.
            text: Text for people.
        """
        print(to_json(facts, None) if self.json else text, flush=True)


@contextmanager
def until_stopped(close: Callable[[], None]) -> Generator[None]:
    """Serve until Ctrl-C or SIGTERM, neither of which counts as a failure.

    Args:
        close: Called at the end, however it comes about.
    """
    # Ctrl-C too: `laticauda.cli` would exit at once during compilation, and results to be saved
    # would be lost.
    is_main = threading.current_thread() is threading.main_thread()
    both = [
        one
        for one in (signal.SIGINT, signal.SIGTERM)
        if is_main and signal.getsignal(one) != signal.SIG_IGN
    ]
    before = [signal.signal(one, signal.default_int_handler) for one in both]
    try:
        yield
    except KeyboardInterrupt:
        print("stopped.", file=sys.stderr)
    finally:
        for one, handler in zip(both, before, strict=True):
            signal.signal(one, handler)
        close()


def files_of(command: Any) -> Iterator[tuple[str, str | None, Sequence[str]]]:
    """Yield the files that a command will write: option name, typed value and allowed endings.

    Args:
        command: Command, or a part of it.
    """
    from laticauda.trials import Format

    for part in parts_of(command):
        for name, marks in marks_of(part.__class__).items():
            for written in (mark for mark in marks if isinstance(mark, OutputFile)):
                yield name, getattr(part, name), written.endings or Format.endings()


def check_output(option: str, path: str | None, endings: Sequence[str]) -> None:
    """Reject an output file that cannot be written.

    Args:
        option: Name of the option.
        path: Given path; None is accepted.
        endings: Allowed endings of the file name.

    Raises:
        ValueError: If it has another ending, its folder does not exist, it is a folder, or it is
            not writable.
    """
    if path is None:
        return
    file = Path(path)
    if file.suffix.lower() not in endings:
        raise BadArgument(option, f"must be a file that ends in {' or '.join(endings)}, got {path}")
    if not file.parent.is_dir():
        raise BadArgument(option, f"must be a file in a folder that exists, got {path}")
    if file.is_dir():
        raise BadArgument(option, f"must be a file, got the folder {path}")
    # A new file replaces an old one, so the folder must be writable.
    if not os.access(file.parent, os.W_OK) or (file.exists() and not os.access(file, os.W_OK)):
        raise BadArgument(option, f"must be a writable file, got {path}: permission denied")
    if file.suffix.lower() == ".mp4":
        from laticauda.show.pictures.render import check_video

        check_video()


# ---- progress ------------------------------------------------------------------------------------

PATIENCE = 2.0
"""Time for which a progress bar is not yet shown [s]."""
SECONDS = "{desc} {n:.0f} of {total:.0f} s |{bar}| {remaining} left"
TRIALS = "{desc} {n_fmt} of {total_fmt} trials |{bar}| {remaining} left"
SHARE = "{desc} {percentage:3.0f} % |{bar}| {remaining} left"


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
            if not sys.stderr.isatty() or time.monotonic() - began < patience:
                return
            from tqdm import tqdm

            bars[what] = tqdm(
                total=total, initial=done, desc=what, bar_format=form, leave=False, file=sys.stderr
            )
        bars[what].n = done
        bars[what].refresh()
        if done >= total:
            bars[what].close()

    return show


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
    bar, began, tenths = run_bar(duration, "filmed"), time.monotonic(), [0]

    def show(done: float) -> None:
        bar(done)
        tenth = math.floor(10.0 * done / duration + 1e-9) if duration else 10
        if tenth > tenths[0] and not sys.stderr.isatty():
            tenths[0] = tenth
            if time.monotonic() - began > PATIENCE:
                print(
                    f"laticauda: {10 * tenth} % filmed, {done:.1f} of {duration:.1f} s",
                    file=sys.stderr,
                    flush=True,
                )

    return show


@contextmanager
def stored_trials(folder: object) -> Generator[Callable[[int, int], None]]:
    """Show the progress of trials that are stored as they finish; Ctrl-C reports their number and how to resume.

    Args:
        folder: Folder where they are stored.
    """
    bar, reached = show_progress(TRIALS), [0, 0]

    def show(done: int, total: int) -> None:
        reached[:] = done, total
        bar(done, total)

    try:
        yield show
    except KeyboardInterrupt:
        stored = f"{reached[0]} of {reached[1]} trials are stored in {folder}"
        raise KeyboardInterrupt(
            f"stopped; {stored}. Run the same command again to resume."
        ) from None
