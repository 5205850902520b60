"""Lines of JSON: one object is one message, and what is wrong with a line is said in words."""

import json
import math
from collections.abc import Iterable, Mapping
from typing import Any, NoReturn, TypeAlias, cast

import numpy as np

from laticauda.errors import BadArgument, nearest

PROTOCOL_VERSION = 1
"""Goes up when a message that was answered is answered otherwise; new fields do not count."""
MESSAGE_BYTES = 1 << 20
"""A request may be so long, its end of line included."""
MOST_NUMBERS = 2_000_000  # in one answer: some 40 MB of text

Message: TypeAlias = Mapping[str, Any]


def read_message(line: bytes) -> dict[str, Any]:
    """The request that a line holds.

    Args:
        line: Without its end.

    Raises:
        ValueError: If it is no JSON object, or holds a number that JSON does not know.
    """
    try:
        found = json.loads(line.decode("utf-8"), parse_constant=_refuse, parse_float=_finite)
    except UnicodeDecodeError:
        raise ValueError("A message must be one line of JSON in UTF-8, got bytes that are no text.") from None
    except RecursionError:
        raise ValueError("A message must be one line of JSON, got brackets that are nested too deep.") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"A message must be one line of JSON; it is not: {error}.") from None
    if not isinstance(found, dict):
        raise ValueError(f"A message must be a JSON object with the field `do`, got {type(found).__name__}.")
    return cast("dict[str, Any]", found)


def write_message(message: Message) -> bytes:
    """An answer as one line, its end included.

    Raises:
        ValueError: If it has too many numbers.
    """
    count = sum(np.size(values) for values in message.get("series", {}).values())
    if count > MOST_NUMBERS:
        raise BadArgument("series", f"must hold {MOST_NUMBERS} numbers or fewer in one answer, got {count}")
    return json.dumps(message, default=_plain, allow_nan=False, separators=(",", ":")).encode() + b"\n"


def known(where: str, fields: Iterable[str], choices: Iterable[str]) -> None:
    """Refuse fields that nobody reads.

    Args:
        where: What they are fields of, as the message calls it.
        fields: The names that were given.
        choices: The names that there are.

    Raises:
        ValueError: If one is unknown; the message suggests the nearest.
    """
    there = tuple(choices)
    for name in fields:
        if name not in there:
            hint = nearest(name, there) or f"; there are {', '.join(f'`{choice}`' for choice in there)}."
            raise ValueError(f"`{name}` is not a field of {where}{hint}")


def table(name: str, value: object) -> dict[str, Any]:
    """`value` if it is a JSON object.

    Raises:
        ValueError: If not.
    """
    if not isinstance(value, dict):
        raise BadArgument(name, f"must be a JSON object, got {_shown(value)}")
    return cast("dict[str, Any]", value)


def numbers(name: str, value: object, count: int | None = None) -> tuple[Any, ...]:
    """`value` as a tuple, if it is an array; a single number counts as an array of one.

    Octave and MATLAB write arrays of one number as the number.

    Raises:
        ValueError: If it is none, or has another number of entries than `count`.
    """
    entries: list[Any] = cast("list[Any]", value) if isinstance(value, list) else [value]
    if isinstance(value, str | dict | bool) or value is None or (count is not None and len(entries) != count):
        wanted = "an array of numbers" if count is None else f"an array of {count} numbers"
        raise BadArgument(name, f"must be {wanted}, got {_shown(cast(object, value))}")
    return tuple(entries)


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"A message must hold finite numbers only, got {constant}.")


def _finite(digits: str) -> float:
    number = float(digits)
    return number if math.isfinite(number) else _refuse(digits)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in JSON")


def _shown(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
