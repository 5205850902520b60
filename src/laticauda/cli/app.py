"""The program: finds the command that is meant, reads its options, runs it, and turns errors into messages.

Exit status: 0 success, 1 a run that failed, 2 bad input, 130 stopped by the user.
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
from laticauda.cli.flags import BadFlag, spelled, wrapped
from laticauda.errors import BadArgument, LaticaudaError, SimulationFailed, nearest
from laticauda.files import read_toml

PROGRAM = "laticauda"
DESCRIPTION = (
    "Simulate swimming snake robots, with and without a caudal fin. `laticauda COMMAND --help` explains a command, "
    "`laticauda --version` prints the version."
)

COMMANDS: dict[str, tuple[str, str]] = read_toml(Path(__file__).parent / "commands.toml")
"""A command's words, where its class is, and what the list of commands says about it."""
LISTED = "; `laticauda --help` lists those that there are."
GROUPS = {
    "export": "Write robots to files for other programs.",
    "trial": "Show, compare, plot and convert stored trials.",
}


def main(args: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        args: The words behind the program's name; None takes those of this process.

    Returns:
        The exit status.
    """
    words = sys.argv[1:] if args is None else list(args)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # names of files need not be UTF-8, and messages say them
            stream.reconfigure(errors="backslashreplace")
    command: Command | None = None
    try:
        if words == ["--version"]:
            from laticauda.packaging import __version__

            print(f"{PROGRAM} {__version__}")
            return 0
        command = _read(words)
        status = command()
        sys.stdout.flush()  # a closed pipe shows here, and not after the end
        return status
    except SystemExit as end:  # tyro printed its help or its complaint
        return end.code if isinstance(end.code, int) else 2
    except KeyboardInterrupt as stop:
        return _complain(str(stop) or "stopped.", 130)
    except BrokenPipeError:
        # Whoever read our output has gone. Nothing may be written there any more, not even at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except BadArgument as error:
        return _complain(f"{spelled(error.name, command)} {error.rule}{'' if error.rule.endswith('?') else '.'}", 2)
    except SimulationFailed as error:
        return _complain(str(error), 1)
    except (BadFlag, LaticaudaError, ValueError) as error:
        return _complain(str(error), 2)
    except OSError as error:
        return _complain(_reason(error), 2)
    except OverflowError as error:
        return _complain(f"a number is out of every range: {error}.", 2)
    except MemoryError:
        return _complain("there is not enough memory; try a shorter run, or fewer samples.", 2)


def _read(words: list[str]) -> Command:
    """The command that the words ask for, with its options; ends the program where there is none."""
    for length in (2, 1):
        place = COMMANDS.get(" ".join(words[:length]))
        if len(words) >= length and place is not None:
            module, name = place[0].split(":")
            command: type[Command] = getattr(import_module(f".{module}", "laticauda.cli"), name)
            prog = " ".join([PROGRAM, *words[:length]])
            return command.read(words[length:], prog)
    if words and words[0] in GROUPS:
        return _choose(f"{PROGRAM} {words[0]}", GROUPS[words[0]], _commands(words[0]), words[1:])
    if words and not words[0].startswith("-"):
        raise BadFlag(f"there is no command `{words[0]}`{nearest(words[0], [*COMMANDS, *GROUPS]) or LISTED}")
    return _choose(PROGRAM, DESCRIPTION, _commands("") | GROUPS, words)


def _commands(group: str) -> dict[str, str]:
    """The last words of a group's commands, and what they do."""
    listed = ((*name.rpartition(" "), text) for name, (_, text) in COMMANDS.items())
    return {word: text for of, _, word, text in listed if of == group}


def _choose(prog: str, description: str, choices: dict[str, str], words: list[str]) -> Command:
    """Print the help that lists the commands, or say what is wrong with the words; none of them is a command."""
    subcommands: list[Any] = [
        Annotated[Any, tyro.conf.subcommand(name, description=text, constructor=_NoCommand)]
        for name, text in choices.items()
    ]
    any_of_them: Any = Annotated[Union[tuple(subcommands)], tyro.conf.arg(name="")]  # noqa: UP007  # made while it runs
    # Of a bare union tyro parses its own source, in search of a help for it; this class has none, and no source.
    chosen: Any = make_dataclass("Chosen", [("command", any_of_them)], namespace={"__module__": "builtins"})
    quiet = (tyro.conf.HelptextFromCommentsOff,)
    tyro.cli(chosen, prog=prog, description=wrapped(description), args=words, config=quiet)
    raise SystemExit(2)  # pragma: no cover - tyro has ended the program


@dataclass
class _NoCommand:
    """Stands for a command in the list of commands; a class, because tyro looks at functions by a slow import."""


def _reason(error: OSError) -> str:
    """What the system refused, and for which file."""
    text = (error.strerror or str(error)).lower()
    return f"{text}." if error.filename is None else f"{error.filename}: {text}."


def _complain(message: str, status: int) -> int:
    print(f"{PROGRAM}: {message}", file=sys.stderr)
    return status
