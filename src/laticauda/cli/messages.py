"""Error messages in the words of the command line: an argument's name becomes the option that was typed."""

import dataclasses
import math
import re
from typing import Any, cast

# Arguments of the calls behind a command that its options call otherwise.
OTHERWISE = {
    "kind": "gait",
    "trial": "resume",
    "trials": "files",
    "measurements": "files",
    "points": "vary",
    "bounds": "vary",
    "objectives": "objective",
}
POSITIONAL = ("file", "files", "output", "name")
DEGREES = ("_deg", "_deg_s")


def options(command: object) -> dict[str, Any]:
    """The options of a command by name, those of its groups too."""
    if not dataclasses.is_dataclass(command) or isinstance(command, type):
        return {}
    found: dict[str, Any] = {}
    for field in dataclasses.fields(command):
        value = getattr(command, field.name)
        found |= options(value) if dataclasses.is_dataclass(value) else {field.name: value}
    return found


def given(command: object) -> dict[str, Any]:
    """The options that the user typed; those that were left out are None or False."""
    return {name: value for name, value in options(command).items() if value is not None and value is not False}


def flag(name: str) -> str:
    """How an option is typed."""
    return name.upper() if name in POSITIONAL else "--" + name.replace("_", "-")


def in_flags(message: str, command: object) -> str:
    """A message about an argument, as one about the option that the user typed.

    Where the option is in degrees, the rule and the value are, too: "`amplitude` must be >= 0 rad, got -0.05." becomes
    "--amplitude-deg must be >= 0 deg, got -3."

    Args:
        message: Of a `ValueError` of the house, with the names of arguments in backticks.
        command: What was running, with its options; None if there was none.
    """
    known = options(command)
    first = re.match(r"`(\w+)`", message)
    spelled = _option(first[1], known) if first else None
    if spelled is not None and spelled.endswith(DEGREES):
        message = re.sub(r"between (\S+) and (\S+) rad", _range_in_degrees, message)
        message = re.sub(r"(\d[\d.e+-]*) rad\b", _in_degrees, message)
        message = re.sub(r"\brad\b", "deg", message)
        value: Any = known[spelled]
        values = cast("tuple[float, ...]", value if isinstance(value, tuple) else (value,))
        typed = " and ".join(f"{each:g}" for each in values)
        message = re.sub(r"([,;]) got .*$", rf"\1 got {typed}.", message)
    return re.sub(r"`(\w+)(?:\[\d+\])?`", lambda found: _typed(found, known), message)


def _range_in_degrees(found: re.Match[str]) -> str:
    low, high = (math.degrees(float(bound)) for bound in found.groups())
    return f"between {low:g} and {high:g} deg"


def _in_degrees(found: re.Match[str]) -> str:
    return f"{math.degrees(float(found[1])):.3g} deg"  # the message has four digits of the angle


def _option(name: str, known: dict[str, Any]) -> str | None:
    name = OTHERWISE.get(name, name)
    return next((name + suffix for suffix in ("", *DEGREES) if name + suffix in known), None)


def _typed(found: re.Match[str], known: dict[str, Any]) -> str:
    option = _option(found[1], known)
    return found[0] if option is None else flag(option)


def reason(error: OSError) -> str:
    """What the system refused, and for which file."""
    text = (error.strerror or str(error)).lower()
    return f"{text}." if error.filename is None else f"{error.filename}: {text}."
