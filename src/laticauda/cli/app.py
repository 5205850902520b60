"""The program: finds the command that is meant, reads its options, runs it, and turns errors into messages.

Exit status: 0 success, 1 a run that failed, 2 bad input, 130 stopped by the user.
"""

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, make_dataclass
from importlib import import_module
from typing import Annotated, Any, Union

import tyro

from laticauda.cli.command import Command
from laticauda.cli.flags import BadFlag, spelled, wrapped
from laticauda.errors import BadArgument, LaticaudaError, SimulationFailed

PROGRAM = "laticauda"
DESCRIPTION = (
    "Simulate swimming snake robots, with and without a caudal fin. `laticauda COMMAND --help` explains a command, "
    "`laticauda --version` prints the version."
)

# A command's words, where its class is (beside this module; with a dot, beside this package), and what the list of
# commands says about it. Only the module of the command that runs is imported.
COMMANDS: dict[str, tuple[str, str]] = {
    "swim": ("swim:Swim", "Let a robot swim a gait, and print its speed and power."),
    "follow": ("follow:Follow", "Let a robot follow a path, and print how soon and how well."),
    "reproduce": (
        ".paper.command:Reproduce",
        "Repeat the paper's experiments, and write figures, tables and a report.",
    ),
    "sweep": ("studies:SweepCommand", "Run a trial at every point of a grid, a list or of samples."),
    "optimize": ("studies:Optimize", "Search for the best gait, fin or number of links."),
    "identify": ("identify:Identify", "Identify parameters with their uncertainty from measured trials."),
    "design-experiment": ("design:DesignExperiment", "Find the next trials that would tell the most."),
    "view": ("view:View", "Show a stored trial in 3D: in a window, as a film or as a picture."),
    "export mjcf": ("export:Mjcf", "Write a robot to an MJCF file, for MuJoCo."),
    "export urdf": ("export:Urdf", "Write a robot to a URDF file, for ROS and others."),
    "export fmu": ("export:Fmu", "Write a robot in water to an FMU, for Simulink, OpenModelica and others."),
    "export c": ("export:C", "Write a robot in water to a library in C, for robots' own computers and others."),
    "export web": ("export:Web", "Write a page on which robots swim in a browser, without a server."),
    "lab": ("lab:LabCommand", "Run the virtual tank: the robot on a CAN bus, cameras and a power meter."),
    "operate": ("operate:Operate", "Operate the robot, virtual or real: a trial file or a series file."),
    "replay": ("replay:Replay", "Make a trial of a recorded operation, and print its figures."),
    "cockpit": ("cockpit:CockpitCommand", "Serve a live page on which the robot swims."),
    "serve": ("serve:Serve", "Let Octave, MATLAB and other programs drive robots over TCP."),
    "robots": ("robots:Robots", "List the robots, waters, grounds, currents and parameters there are, or show one."),
    "trial show": ("trial:Show", "Print the figures of a stored trial."),
    "trial compare": ("trial:Compare", "Print the figures of stored trials side by side."),
    "trial convert": ("trial:Convert", "Write a stored trial as MCAP, Parquet, .mat, netCDF or CSV."),
}
GROUPS = {
    "export": "Write robots to files for other programs.",
    "trial": "Show, compare and convert stored trials.",
}


def main(args: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        args: The words behind the program's name; None takes those of this process.

    Returns:
        The exit status.
    """
    words = sys.argv[1:] if args is None else list(args)
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
