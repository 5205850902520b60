"""Options that people try and no command has: what to type instead."""

from collections.abc import Collection, Sequence

from laticauda.cli.flag_names import spell_typed_flag
from laticauda.cli.flag_types import BadFlag

GAIT_DECIDES = (
    "is a result, not an option: the gait decides it, by --amplitude-deg, --frequency-deg-s and "
    "--phase-shift-deg"
)
SAVE = "--save run.nc for the trial, --plot run.png for a picture, or --video run.mp4 for a film"
MEANT = {
    "--amplitude": "--amplitude-deg",
    "--current-speed": "--current",
    "--fin": "the robot mamba-fin",
    "--frequency": "--frequency-deg-s, or --frequency-hz for cycles per second",
    "--length": "--duration for the time, or a robot file for the robot",
    "--links": "--n-links",
    "--offset": "--offset-deg",
    "--out": SAVE,
    "--output": SAVE,
    "--phase": "--phase-shift-deg",
    "--phase-shift": "--phase-shift-deg",
    "--seconds": "--duration",
    "--time": "--duration",
    "--timestep": "--dt",
}
"""What is meant by options that do not exist; the options of the unit come first."""
RESULTS = ("--forward-velocity", "--power", "--speed", "--velocity")
"""Results that people try to set."""


LISTS = ("--column",)
"""Options that hold all words behind them; given twice, the first would be lost."""


def refuse_repeated(arguments: Sequence[str]) -> None:
    """Reject an option of several words that is given twice.

    Args:
        arguments: What was typed.

    Raises:
        BadFlag: If there is one.
    """
    flags = [spell_typed_flag(argument) for argument in arguments]
    for flag in LISTS:
        if flags.count(flag) > 1:
            raise BadFlag(f"{flag} must be given once, with all its words behind it.")


def refuse_mistaken(arguments: Sequence[str], known_flags: Collection[str]) -> None:
    """Reject an option that no command has, and say which one is meant.

    Args:
        arguments: What was typed.
        known_flags: Options of the command; they mean what they say there.

    Raises:
        BadFlag: If there is one.
    """
    for argument in arguments:
        flag = spell_typed_flag(argument)
        if flag in known_flags:
            continue
        if flag in RESULTS:
            raise BadFlag(f"{flag} {GAIT_DECIDES}.")
        if flag in MEANT:
            raise BadFlag(f"there is no {flag}; did you mean {MEANT[flag]}?")
