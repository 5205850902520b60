"""The program: finds the requested command, reads its options, runs it and turns errors into messages.

Exit status: 0 for success, 1 for a failed run, 2 for bad input, 130 if stopped by the user.
"""

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, make_dataclass
from importlib import import_module
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Any, Union

import tyro

from laticauda.cli.command import Command
from laticauda.cli.flags import BadFlag, spell_field, wrap_text
from laticauda.values import (
    BadArgument,
    LaticaudaError,
    SimulationFailed,
    read_toml,
    suggest_nearest,
)

PROGRAM = "laticauda"
DESCRIPTION = (
    "Simulate swimming snake robots, with and without a caudal fin. `laticauda COMMAND --help` explains a command, "
    "`laticauda --version` prints the version."
)

COMMANDS: dict[str, tuple[str, str]] = read_toml(Path(__file__).parent / "commands.toml")
"""By the words of a command: the location of its class, and its text in the list of commands."""
LISTED = "; `laticauda --help` lists all commands."
GROUPS = {
    "export": "Write robots to files for other programs.",
    "trial": "Show, compare, plot and convert stored trials.",
}


def main(args: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        args: Arguments after the program name; None uses those of this process.

    Returns:
        The exit status.
    """
    typed = sys.argv[1:]
    if args is not None:
        typed = list(args)
    for stream in (sys.stdout, sys.stderr):
        # File names need not be UTF-8, and messages contain them.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    command: Command | None = None
    try:
        if typed == ["--version"]:
            return _print_version()
        command = _read_command(typed)
        status = command()
        sys.stdout.flush()  # a closed pipe is noticed here, not after the end
        return status
    except SystemExit as end:  # tyro has printed its help or an error
        if isinstance(end.code, int):
            return end.code
        return 2
    except KeyboardInterrupt as stop:
        return _complain(str(stop) or "stopped.", 130)
    except BrokenPipeError:
        # The reader of our output has gone. Nothing may be written to it any more, not even at
        # exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except BadArgument as error:
        sentence = f"{spell_field(error.name, command)} {error.rule}"
        if not error.rule.endswith("?"):
            sentence += "."
        return _complain(sentence, 2)
    except SimulationFailed as error:
        return _complain(str(error), 1)
    except (BadFlag, LaticaudaError, ValueError) as error:
        return _complain(str(error), 2)
    except OSError as error:
        return _complain(_reason(error), 2)
    except OverflowError as error:
        return _complain(f"a number is out of range: {error}.", 2)
    except MemoryError:
        return _complain("there is not enough memory; try a shorter run, or fewer samples.", 2)


def _print_version() -> int:
    from laticauda.values import __version__

    print(f"{PROGRAM} {__version__}")
    return 0


def _read_command(typed: list[str]) -> Command:
    """Return the command that was typed, with its options; end the program if there is none."""
    for length in (2, 1):  # words of its name
        name = " ".join(typed[:length])
        if name in COMMANDS and len(typed) >= length:
            command_class = _import_command(name)
            return command_class.read(typed[length:], f"{PROGRAM} {name}")
    if not typed or typed[0].startswith("-"):
        return _choose(PROGRAM, DESCRIPTION, _commands_of_group("") | GROUPS, typed)
    first = typed[0]
    if first in GROUPS:
        prog = f"{PROGRAM} {first}"
        return _choose(prog, GROUPS[first], _commands_of_group(first), typed[1:])
    hint = suggest_nearest(first, [*COMMANDS, *GROUPS]) or LISTED
    raise BadFlag(f"there is no command `{first}`{hint}")


def _import_command(name: str) -> type[Command]:
    location, _ = COMMANDS[name]
    module, class_name = location.split(":")
    return getattr(import_module(f".{module}", "laticauda.cli"), class_name)


def _commands_of_group(group: str) -> dict[str, str]:
    """Return the last word of each command in a group, with the description of the command."""
    descriptions: dict[str, str] = {}
    for name, (_, description) in COMMANDS.items():
        own_group, _, last_word = name.rpartition(" ")
        if own_group == group:
            descriptions[last_word] = description
    return descriptions


def _choose(prog: str, description: str, choices: dict[str, str], typed: list[str]) -> Command:
    """Print the list of commands, or report what is wrong with the arguments, which name no command."""
    subcommands: list[Any] = [
        Annotated[Any, tyro.conf.subcommand(name, description=text, constructor=_NoCommand)]
        for name, text in choices.items()
    ]
    any_of_them: Any = Annotated[Union[tuple(subcommands)], tyro.conf.arg(name="")]  # noqa: UP007  # made while it runs
    # For a bare union, tyro parses its own source to find a help text; this class has neither help
    # text nor source.
    chosen: Any = make_dataclass(
        "Chosen", [("command", any_of_them)], namespace={"__module__": "builtins"}
    )
    quiet = (tyro.conf.HelptextFromCommentsOff,)
    tyro.cli(chosen, prog=prog, description=wrap_text(description), args=typed, config=quiet)
    raise SystemExit(2)  # pragma: no cover - tyro has ended the program


@dataclass
class _NoCommand:
    """Placeholder for a command in the list of commands; a class because tyro inspects functions by a slow import."""


def _reason(error: OSError) -> str:
    """Return what the system refused, and for which file."""
    text = (error.strerror or str(error)).lower()
    if error.filename is None:
        return f"{text}."
    return f"{error.filename}: {text}."


def _complain(message: str, status: int) -> int:
    print(f"{PROGRAM}: {message}", file=sys.stderr)
    return status
