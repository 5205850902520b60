"""Programs of their own, of packages that build on laticauda: one command each, with its flags, help and messages."""

import sys
from collections.abc import Sequence

from laticauda.cli.command import Command
from laticauda.cli.flags import BadFlag, parse_command
from laticauda.values import LaticaudaError

STATUS_BAD_INPUT = 2
"""Exit status of bad input, and of a run that diverged."""


def run_program(command_class: type[Command], name: str, words: Sequence[str] | None = None) -> int:
    """Run a program that is one command.

    Args:
        command_class: Class of the command.
        name: Name of the program.
        words: Words after the program's name; None takes those of this process.

    Returns:
        The exit status: 0 success, 2 bad input or a run that diverged.
    """
    if words is None:
        words = sys.argv[1:]
    try:
        return parse_command(command_class, list(words), name)()
    except SystemExit as end:  # tyro has printed its help or an error
        if isinstance(end.code, int):
            return end.code
        return STATUS_BAD_INPUT
    except (BadFlag, LaticaudaError, ValueError, OSError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return STATUS_BAD_INPUT
