"""Checks of arguments: each returns the cleaned value, so that a dataclass can check and convert in one line."""

import math
import sys
from collections.abc import Sequence, Sized
from contextlib import suppress
from numbers import Integral, Real

from laticauda.values.errors import BadArgument

LONGEST_VALUE = 60
"""Characters of a value in a message at most."""
SHORTEST_BEGINNING = 3
"""Characters of a name that show which one is meant, at least."""


def check_finite(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float if it is a single finite number.

    NumPy numbers are accepted like Python's. Truth values, texts, arrays, nan and infinities are
    rejected.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.
        unit: Unit of the argument, "" for a pure number.

    Raises:
        ValueError: If `value` is not a finite number.
    """
    in_unit = f" in {unit}" if unit else ""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise BadArgument(name, f"must be a number{in_unit}, got {show_value(value)}")
    try:
        number = float(value)
    except OverflowError:  # a Python integer beyond the largest float
        number = math.inf
    if not math.isfinite(number):
        raise BadArgument(name, f"must be a finite number{in_unit}, got {number}")
    return number


def check_positive(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float if it is a finite number > 0.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.
        unit: Unit of the argument, "" for a pure number.

    Raises:
        ValueError: If it is not.
    """
    number = check_finite(name, value, unit)
    if number <= 0.0:
        raise BadArgument(name, f"must be > 0{_spaced(unit)}, got {value}")
    return number


def check_not_negative(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float if it is a finite number >= 0.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.
        unit: Unit of the argument, "" for a pure number.

    Raises:
        ValueError: If it is not.
    """
    number = check_finite(name, value, unit)
    if number < 0.0:
        raise BadArgument(name, f"must be >= 0{_spaced(unit)}, got {value}")
    return number


def check_within(name: str, value: object, low: float, high: float, unit: str = "") -> float:
    """Return `value` as a float if `low <= value <= high`.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.
        low: Smallest accepted number.
        high: Largest accepted number.
        unit: Unit of the argument, "" for a pure number.

    Raises:
        ValueError: If it is not a finite number, or out of range.
    """
    number = check_finite(name, value, unit)
    if not low <= number <= high:
        raise BadArgument(name, f"must be between {low:g} and {high:g}{_spaced(unit)}, got {value}")
    return number


def check_whole_number(name: str, value: object, least: int, most: int = sys.maxsize) -> int:
    """Return `value` as an int if it is a whole number >= `least`.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.
        least: Smallest accepted number.
        most: Largest accepted number; a number beyond any memory size is always a mistake.

    Raises:
        ValueError: If `value` is not an integer (2.0 is not one either), or out of range.
    """
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise BadArgument(name, f"must be a whole number >= {least}, got {show_value(value)}")
    number = int(value)
    if number > most:
        raise BadArgument(
            name, f"must be a whole number between {least} and {most}, got {show_value(value)}"
        )
    return number


def check_choice(name: str, value: object, choices: Sequence[str]) -> str:
    """Return `value` if it is one of the texts in `choices`.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.
        choices: Accepted texts.

    Raises:
        ValueError: If it is not; the message lists the choices and suggests the nearest.
    """
    if isinstance(value, str) and value in choices:
        return value
    hint = suggest_nearest(value, choices) if isinstance(value, str) else ""
    listed = ", ".join(f"`{choice}`" for choice in choices)
    raise BadArgument(name, f"must be one of {listed}, got {show_value(value)}{hint}")


def check_not_empty(name: str, items: Sized, item_name: str) -> None:
    """Reject an empty list or mapping.

    Args:
        name: Name of the argument, as the user knows it.
        items: The list or mapping given.
        item_name: What it must hold, in a word.

    Raises:
        ValueError: If it is empty.
    """
    if len(items) == 0:
        raise BadArgument(name, f"must hold at least one {item_name}, got none")


def check_instance(name: str, value: object, *kinds: type) -> object:
    """Return `value` if it is an instance of one of these classes.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.
        kinds: Accepted classes.

    Raises:
        ValueError: If it is not.
    """
    if not isinstance(value, kinds):
        expected = " or ".join(kind.__name__ for kind in kinds)
        raise BadArgument(name, f"must be of class {expected}, got {type(value).__name__}")
    return value


def check_flag(name: str, value: object) -> bool:
    """Return `value` if it is a truth value, not just something that looks like one.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.

    Raises:
        ValueError: If it is not.
    """
    if not isinstance(value, bool):
        raise BadArgument(name, f"must be true or false, got {show_value(value)}")
    return value


def check_text(name: str, value: object) -> str:
    """Return `value` if it is a text.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.

    Raises:
        ValueError: If it is not.
    """
    if not isinstance(value, str):
        raise BadArgument(name, f"must be a text, got {show_value(value)}")
    return value


def check_label(name: str, value: object) -> str:
    """Return `value` if it can serve as a name: a single line that is not blank.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.

    Raises:
        ValueError: If it cannot.
    """
    label = check_text(name, value)
    if not label.strip() or not label.isprintable():
        raise BadArgument(name, f"must be a text on one line that is not blank, got {label!r}")
    return label


def check_hostname(name: str, value: object) -> str:
    """Return `value` if it can be the name or address of a host.

    Args:
        name: Name of the argument, as the user knows it.
        value: The value given.

    Raises:
        ValueError: If it cannot.
    """
    host = check_text(name, value)
    with suppress(UnicodeError):
        host.encode("idna")
        if host and host.isprintable():
            return host
    raise BadArgument(name, f"must be the name or address of a host, got {host!r}")


def suggest_nearest(typed: str, choices: Sequence[str]) -> str:
    """Return the end of a message about a mistyped name: "; did you mean `x`?", or "" if none is close.

    Args:
        typed: The name as typed.
        choices: Known names.
    """
    import difflib

    choice_of_simplified = {_simplify(choice): choice for choice in choices}
    simplified = _simplify(typed)
    nearest = difflib.get_close_matches(simplified, choice_of_simplified, n=1)
    if not nearest and len(simplified) >= SHORTEST_BEGINNING:
        nearest = [choice for choice in choice_of_simplified if choice.startswith(simplified)]
    if not nearest:
        return ""
    return f"; did you mean `{choice_of_simplified[nearest[0]]}`?"


def _simplify(name: str) -> str:
    """Return a name without differences that people confuse: capitals, hyphens and underscores."""
    return name.casefold().replace("-", "_")


def _spaced(unit: str) -> str:
    return f" {unit}" if unit else ""


def show_value(value: object) -> str:
    """Return `value` as shown in a message: on one line, and short; for an array, its shape."""
    shape = getattr(value, "shape", ())
    if shape:
        return f"an array of shape {shape}"
    if isinstance(value, Real):  # NumPy's numbers look like Python's
        return str(value)
    text = repr(value)
    if len(text) <= LONGEST_VALUE:
        return text
    return f"{text[: LONGEST_VALUE - 3]}..."
