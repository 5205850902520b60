"""The program: finds the requested command, reads its options, runs it and turns errors into messages."""

import gc
import sys
from collections.abc import Sequence
from dataclasses import dataclass, make_dataclass
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, NamedTuple, NoReturn, Union

import tyro

from laticauda.cli.command import Command, warnings_as_lines
from laticauda.cli.flags import (
    BadFlag,
    options_of,
    spell_field,
    spell_fields_in,
    spell_part_of_file,
    wrap_text,
)
from laticauda.cli.surroundings import (
    check_memory,
    settle_streams,
    silence,
    widen_narrow_terminal,
)
from laticauda.values import (
    BadArgument,
    LaticaudaError,
    SimulationFailed,
    read_toml,
    suggest_nearest,
)

PROGRAM = "laticauda"
DESCRIPTION = (
    "A Python toolkit for swimming snake robots: simulate them, fit the model to measurements, optimize their "
    "gaits, and operate them. `laticauda COMMAND --help` explains a command, `laticauda --version` prints the version."
)

STATUS_FAILED = 1
"""Exit status after a run that failed."""
STATUS_BAD_INPUT = 2
STATUS_STOPPED = 130
"""Exit status if the user stopped the program, as shells have it: 128 and the number of the signal."""
STATUS_BROKEN_PIPE = 141
"""Exit status if the reader of the output has gone, likewise."""


class ListedCommand(NamedTuple):
    """An entry of ``commands.toml``."""

    location: str
    """MODULE:CLASS in this package; with a dot in front, in laticauda."""
    description: str
    """Text in the list of commands."""


def _read_commands() -> dict[str, ListedCommand]:
    table = read_toml(Path(__file__).parent / "commands.toml")
    return {name: ListedCommand(*entry) for name, entry in table.items()}


COMMANDS = _read_commands()
"""All commands by the words that are typed, such as `trial show`."""
FIRST_TO_TRY = "laticauda swim mamba"
COMMANDS_BY_PURPOSE: dict[str, tuple[str, ...]] = {
    "Swim": ("swim", "follow", "mission", "cockpit", "robots"),
    "Look at trials": ("view", "trial"),
    "Study": ("sweep", "optimize", "reproduce"),
    "Measure": ("identify", "predict", "design-experiment", "lab", "operate", "drivers", "replay"),
    "Film": ("tags", "lens", "camera", "track", "inverse"),
    "Use elsewhere": ("export", "import", "serve"),
}
"""Commands in the order in which a newcomer needs them; others come last."""
GROUPS = {
    "export": "Write robots to files for other programs.",
    "import": "Read robots of other programs.",
    "trial": "Show, compare, plot and convert stored trials.",
}
"""First words that several commands have in common."""


MEANT_COMMANDS = {
    "animate": "view",
    "compare": "trial compare",
    "convert": "trial convert",
    "fit": "identify",
    "list": "robots",
    "plot": "trial plot",
    "presets": "robots",
    "run": "swim",
    "show": "trial show",
    "sim": "swim",
    "simulate": "swim",
    "start": "swim",
}
"""Commands by other words that people try."""


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
    command: Command | None = None
    try:
        settle_streams()
        widen_narrow_terminal()
        if typed == ["--version"]:
            return _print_version()
        with warnings_as_lines():
            command = _read_command(typed)
        check_memory()
        if not gc.isenabled():  # see `laticauda.cli.main`
            gc.freeze()
            gc.enable()
        status = command()
        sys.stdout.flush()  # a closed pipe is noticed here, not after the end
        return status
    except SystemExit as end:  # tyro has printed its help or an error
        if isinstance(end.code, int):
            return end.code
        return STATUS_BAD_INPUT
    except KeyboardInterrupt as stop:
        return _complain(str(stop) or "stopped.", STATUS_STOPPED)
    except BrokenPipeError:
        silence("stdout")  # its reader has gone
        return STATUS_BROKEN_PIPE
    except BadArgument as error:
        return _complain(_describe_bad_argument(error, command, typed), STATUS_BAD_INPUT)
    except SimulationFailed as error:
        return _complain(str(error), STATUS_FAILED)
    except (BadFlag, LaticaudaError, ValueError) as error:
        return _complain(str(error), STATUS_BAD_INPUT)
    except OSError as error:
        return _complain(_describe_refusal(error), STATUS_BAD_INPUT)
    except OverflowError as error:
        return _complain(f"a number is out of range: {error}.", STATUS_BAD_INPUT)
    except MemoryError:
        problem = "there is not enough memory; try a shorter run, or fewer samples."
        return _complain(problem, STATUS_BAD_INPUT)


def _print_version() -> int:
    from laticauda.values import __version__

    print(f"{PROGRAM} {__version__}")
    return 0


def _read_command(typed: list[str]) -> Command:
    """Return the command that was typed, with its options; end the program if there is none."""
    for n_words in (2, 1):
        name = " ".join(typed[:n_words])
        if name in COMMANDS and len(typed) >= n_words:
            command_class = _import_command(name)
            return command_class.read(typed[n_words:], f"{PROGRAM} {name}")
    if not typed:
        print(_overview(), file=sys.stderr)
        raise SystemExit(STATUS_BAD_INPUT)
    if typed[0].startswith("-"):
        return _refuse_with_list(PROGRAM, DESCRIPTION, _commands_of_group("") | GROUPS, typed)
    first_word = typed[0]
    if first_word in GROUPS:
        prog = f"{PROGRAM} {first_word}"
        description = GROUPS[first_word]
        return _refuse_with_list(prog, description, _commands_of_group(first_word), typed[1:])
    hint = suggest_nearest(first_word, [*COMMANDS, *GROUPS])
    if first_word in MEANT_COMMANDS:
        hint = f"; did you mean `{MEANT_COMMANDS[first_word]}`?"
    if not hint:
        hint = f"; `{PROGRAM} --help` lists all commands."
    raise BadFlag(f"there is no command `{first_word}`{hint}")


def _overview() -> str:
    """Return all commands by purpose, below one to begin with."""
    descriptions = _commands_of_group("") | GROUPS
    width = max(map(len, descriptions))
    lines = [DESCRIPTION.partition(". ")[0] + ".", "", f"Try first:  {FIRST_TO_TRY}"]
    purposes = dict(COMMANDS_BY_PURPOSE)
    placed = [name for names in purposes.values() for name in names]
    purposes["More"] = tuple(name for name in descriptions if name not in placed)
    for purpose, names in purposes.items():
        rows = [
            f"  {name:<{width}}  {descriptions[name]}" for name in names if name in descriptions
        ]
        if rows:
            lines += ["", purpose, *rows]
    return "\n".join([*lines, "", f"`{PROGRAM} COMMAND --help` explains a command."])


def _import_command(name: str) -> type[Command]:
    module, class_name = COMMANDS[name].location.split(":")
    return getattr(import_module(f".{module}", "laticauda.cli"), class_name)


def _commands_of_group(group: str) -> dict[str, str]:
    """Return the last word of each command in a group, "" for none, with the description of the command."""
    descriptions: dict[str, str] = {}
    for name, command in COMMANDS.items():
        own_group, _, last_word = name.rpartition(" ")
        if own_group == group:
            descriptions[last_word] = command.description
    return descriptions


def _refuse_with_list(
    prog: str, description: str, choices: dict[str, str], typed: list[str]
) -> NoReturn:
    """Let tyro print the list of commands, or what is wrong with words that name no command, and end the program.

    Args:
        prog: What was typed so far.
        description: Text above the list.
        choices: Descriptions of the commands by the next word.
        typed: The words after `prog`.
    """
    if len(choices) == 1:
        _refuse_with_only_command(prog, description, choices, typed)
    subcommands: list[Any] = []
    for name, text in choices.items():
        subcommand = tyro.conf.subcommand(name, description=text, constructor=_NoCommand)
        subcommands.append(Annotated[Any, subcommand])
    any_of_them = Union[tuple(subcommands)]  # noqa: UP007  # the alternatives are known only here
    # For a bare union, tyro parses its own source to find a help text; this class has neither help
    # text nor source.
    chosen: Any = make_dataclass(
        "Chosen",
        [("command", Annotated[any_of_them, tyro.conf.arg(name="")])],
        namespace={"__module__": "builtins"},
    )
    quiet = (tyro.conf.HelptextFromCommentsOff,)
    tyro.cli(chosen, prog=prog, description=wrap_text(description), args=typed, config=quiet)
    raise SystemExit(STATUS_BAD_INPUT)  # pragma: no cover - tyro has ended the program


def _refuse_with_only_command(
    prog: str, description: str, choices: dict[str, str], typed: list[str]
) -> NoReturn:
    """Name the only command of a group, of which tyro would make no list; see `_refuse_with_list`."""
    [(name, text)] = choices.items()
    if typed in (["--help"], ["-h"]):
        print(f"usage: {prog} {name} ...\n\n{description}\n\n  {name}  {text}")
        raise SystemExit(0)
    raise BadFlag(f"`{prog}` has one command, {name}; `{prog} {name} --help` explains it.")


@dataclass
class _NoCommand:
    """Placeholder for a command in the list of commands; a class because tyro inspects functions by a slow import."""


def _describe_bad_argument(
    error: BadArgument, command: Command | None, typed: Sequence[str]
) -> str:
    """Return the sentence about an argument, which names options as they are typed."""
    part_of_file = spell_part_of_file(error.name, typed)
    if part_of_file:
        return error.sentence_about(part_of_file)
    subject = spell_field(error.name, command)
    if command is None:
        return error.sentence_about(subject)
    return error.sentence_about(subject, spell_fields_in(error.rule, options_of(command)))


def _describe_refusal(error: OSError) -> str:
    """Return what the system refused, and for which file."""
    text = (error.strerror or str(error)).lower()
    if error.filename is None:
        return f"{text}."
    return f"{error.filename}: {text}."


def _complain(message: str, status: int) -> int:
    try:
        print(f"{PROGRAM}: {message}", file=sys.stderr, flush=True)
    except OSError:  # the status still tells
        silence("stderr")
    return status
