"""What all commands share: files are refused before the work and not after it, and one outcome is told or is JSON."""

import json
import os
import sys
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, get_type_hints

from laticauda.access import LOCAL as LOCAL
from laticauda.cli.flags import Written, is_declared, read
from laticauda.errors import BadArgument
from laticauda.quantities import option, value


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What a command came to."""

    facts: Mapping[str, Any]
    """For programs, in SI units."""
    text: str
    """For people."""
    problem: str = ""
    """What went wrong, for standard error."""
    succeeded: bool = True
    """Whether the exit status is 0, and not 1."""


@value
class Command:
    """A command: a value whose fields are its flags."""

    json: bool = option("Print one JSON object in SI units instead of text", default=False)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """The command that was typed.

        Args:
            words: Behind its name.
            prog: What the help calls it.
        """
        return read(cls, words, prog)

    def run(self) -> Outcome | None:
        """Do the work; None if all has been said already."""
        raise NotImplementedError

    def __call__(self) -> int:
        """Do the work, print what it came to, and return the exit status."""
        for name, path, endings in files_of(self):
            check_output(name, path, endings)
        done = self.run()
        if done is None:
            return 0
        if done.problem:
            print(done.problem, file=sys.stderr)
        print(json.dumps(done.facts, indent=2, allow_nan=False) if self.json else done.text)
        return 0 if done.succeeded else 1

    def announce(self, facts: Mapping[str, Any], text: str) -> None:
        """Print a line while the command goes on.

        Args:
            facts: For programs.
            text: For people.
        """
        print(json.dumps(facts) if self.json else text, flush=True)


@contextmanager
def until_stopped(close: Callable[[], None]) -> Generator[None]:
    """Serve until Ctrl-C, which is no failure.

    Args:
        close: What is to be done in the end, however that comes.
    """
    try:
        yield
    except KeyboardInterrupt:
        print("stopped.", file=sys.stderr)
    finally:
        close()


def files_of(command: Any) -> Iterator[tuple[str, str | None, Sequence[str]]]:
    """The files that a command will write: name of the option, what was typed, and what it may end in.

    Args:
        command: The command, or a part of it.
    """
    hints = get_type_hints(command.__class__, include_extras=True)
    for field in fields(command):
        one = getattr(command, field.name)
        if is_declared(one):
            yield from files_of(one)
        for written in getattr(hints[field.name], "__metadata__", ()):
            if isinstance(written, Written):
                yield field.name, one, written.endings


def check_output(option: str, path: str | None, endings: Sequence[str]) -> None:
    """Refuse a file that cannot be written.

    Args:
        option: Name of the option.
        path: What was given; None is fine.
        endings: What the file's name may end in.

    Raises:
        ValueError: If it ends otherwise, its folder does not exist, it is a folder, or may not be written.
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
    # A new file is put in the place of an old one, so the folder counts.
    if not os.access(file.parent, os.W_OK) or (file.exists() and not os.access(file, os.W_OK)):
        raise BadArgument(option, f"must be a file that may be written, got {path}: permission denied")
    if file.suffix.lower() == ".mp4":
        from laticauda.pictures.render import check_video

        check_video()
