"""Short forms that people type, written out before a command line is read.

`swim mamba` is `swim --robot mamba`, and so is a robot's file; `--frequency-hz 0.5` is `--frequency-deg-s 180`.
"""

import tomllib
from collections.abc import Sequence
from pathlib import Path

from laticauda.cli.flag_names import spell_typed_flag
from laticauda.cli.flag_types import BadFlag
from laticauda.robot import robot_names
from laticauda.values import suggest_nearest

DEGREES_PER_CYCLE = 360.0
FREQUENCIES_IN_HZ = ("--frequency-hz", "--pitch-frequency-hz", "--fin-frequency-hz")
"""Options in deg/s, as they are typed in Hz."""
LISTED = "; `laticauda robots` lists them"


def write_out(arguments: Sequence[str], *, accepts_file: bool) -> list[str]:
    """Return arguments without short forms.

    Args:
        arguments: What was typed after the name of a command about a scenario.
        accepts_file: Whether the first word may be a file, which goes before a robot of that name.

    Raises:
        BadFlag: If a frequency in Hz is no number, or the first word is neither a robot nor a file.
    """
    return _with_robot_option(write_out_frequencies(arguments), accepts_file=accepts_file)


def _with_robot_option(arguments: list[str], *, accepts_file: bool) -> list[str]:
    """Return arguments with an option instead of a first word that names a robot."""
    if not arguments:
        return arguments
    first = arguments[0]
    if _is_robot_file(first):
        return ["--robot", *arguments]
    looks_like_file = first.startswith("-") or bool(Path(first).suffix)
    if looks_like_file or (accepts_file and Path(first).exists()):
        return arguments
    if first not in robot_names():
        hint = suggest_nearest(first, robot_names()) or LISTED
        raise BadFlag(f"there is neither a robot nor a file {first!r}{hint}")
    return ["--robot", *arguments]


def _is_robot_file(word: str) -> bool:
    """Return whether a word is a TOML file that says of itself that it is a robot."""
    path = Path(word)
    if path.suffix != ".toml":
        return False
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):  # who reads it as a scenario says what is wrong with it
        return False
    return table.get("kind") == "robot"


def write_out_frequencies(arguments: Sequence[str]) -> list[str]:
    """Return arguments with every frequency in deg/s.

    Args:
        arguments: What was typed after the name of a command.

    Raises:
        BadFlag: If a frequency in Hz is no number.
    """
    written_out: list[str] = []
    words = iter(arguments)
    for word in words:
        name = spell_typed_flag(word)
        _, equals_sign, value = word.partition("=")
        if name not in FREQUENCIES_IN_HZ:
            written_out.append(word)
            continue
        if not equals_sign:
            value = next(words, "")
        written_out += [name.removesuffix("hz") + "deg-s", _in_degrees(name, value)]
    return written_out


def _in_degrees(name: str, text: str) -> str:
    """Return a number in Hz as one in deg/s."""
    try:
        return repr(DEGREES_PER_CYCLE * float(text))
    except ValueError:
        rule = "must be a number of cycles per second"
        raise BadFlag(f"{name} {rule}, got {text!r}.") from None
