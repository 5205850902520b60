"""Lines of JSON: one object is one message, and what is wrong with a line is said in words."""

import json
import math
from collections.abc import Mapping
from typing import Any, NoReturn, TypeAlias, cast

import numpy as np

from laticauda.errors import BadArgument

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


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"A message must hold finite numbers only, got {constant}.")


def _finite(digits: str) -> float:
    number = float(digits)
    return number if math.isfinite(number) else _refuse(digits)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in JSON")
