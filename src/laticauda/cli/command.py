"""Base of all commands: output files are checked before the work starts, and the outcome is printed as text or JSON."""

import signal
import sys
import threading
import warnings
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from laticauda.cli.flags import Options, parse_command
from laticauda.cli.output_files import check_output, files_of
from laticauda.values import (
    ImplausibleWarning,
    SkippedRowsWarning,
    StoredResultsWarning,
    TableWarning,
    UnitWarning,
    option,
    to_json,
    value_class,
)
from laticauda.values.packaging import renamed_names


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """Outcome of a command."""

    facts: Mapping[str, Any]
    """Facts for programs, in SI units: what ``--json`` prints."""
    text: str
    """Text for people."""
    problem: str = ""
    """What went wrong, for standard error."""
    succeeded: bool = True
    """Whether the exit status is 0 rather than 1."""


@value_class
class Command(Options):
    """A command: a value whose fields are its options.

    `read` makes it of what was typed; calling it does the work.
    """

    json: bool = option("Print one JSON object in SI units instead of text", default=False)

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> Any:
        """Return the command that was typed.

        Args:
            arguments: What was typed after its name.
            prog: Name of the command in the help.
        """
        return parse_command(cls, arguments, prog)

    def run(self) -> Outcome | None:
        """Do the work; return None if everything has already been printed."""
        raise NotImplementedError

    def __call__(self) -> int:
        """Do the work, print the outcome and return the exit status."""
        for file in files_of(self):
            check_output(file.option, file.path, file.endings)
            if file.is_rendered and file.path is not None:
                from laticauda.show.pictures import check_video

                check_video()
        with warnings_as_lines():
            outcome = self.run()
        if outcome is None:
            return 0
        if outcome.problem:
            print(outcome.problem, file=sys.stderr)
        print(to_json(outcome.facts) if self.json else outcome.text)
        return 0 if outcome.succeeded else 1

    def announce(self, facts: Mapping[str, Any], text: str) -> None:
        """Print a line while the command continues.

        Args:
            facts: Facts for programs.
            text: Text for people.
        """
        print(to_json(facts, None) if self.json else text, flush=True)


ABOUT_WHAT_WAS_GIVEN = (
    SkippedRowsWarning,
    StoredResultsWarning,
    ImplausibleWarning,
    TableWarning,
    UnitWarning,
)
"""Warnings that are printed as one line each."""


@contextmanager
def warnings_as_lines() -> Generator[None]:
    """Print warnings about what the user gave as one line each, without the code that found it."""

    def print_line(message: Warning | str, category: type[Warning], *details: Any) -> None:
        if issubclass(category, ABOUT_WHAT_WAS_GIVEN):
            print(f"laticauda: {message}", file=sys.stderr)
        else:
            print_as_usual(message, category, *details)

    with warnings.catch_warnings():
        print_as_usual = warnings.showwarning
        warnings.simplefilter("always", SkippedRowsWarning)
        warnings.simplefilter("once", ImplausibleWarning)
        warnings.simplefilter("always", TableWarning)
        warnings.showwarning = print_line
        yield


@contextmanager
def until_stopped(close: Callable[[], None]) -> Generator[None]:
    """Serve until Ctrl-C or SIGTERM, neither of which counts as a failure.

    Args:
        close: Called at the end, however it comes about.
    """
    # Ctrl-C too: `laticauda.cli` would exit at once during compilation, and results to be saved
    # would be lost.
    handlers_before = {number: signal.getsignal(number) for number in _stop_signals()}
    for number in handlers_before:
        signal.signal(number, signal.default_int_handler)
    try:
        yield
    except KeyboardInterrupt:
        print("stopped.", file=sys.stderr)
    finally:
        for number, handler in handlers_before.items():
            signal.signal(number, handler)
        close()


def _stop_signals() -> list[signal.Signals]:
    """Return the signals that stop a server; those that a script ignores in the background do not."""
    if threading.current_thread() is not threading.main_thread():
        return []
    numbers = (signal.SIGINT, signal.SIGTERM)
    return [number for number in numbers if signal.getsignal(number) != signal.SIG_IGN]


# Names of 0.2, for one release.
__getattr__ = renamed_names(
    __name__,
    {
        "SHARE": "laticauda.cli.progress:SHARE",
        "progress": "laticauda.cli.progress:show_progress",
        "show_progress": "laticauda.cli.progress:show_progress",
    },
)
