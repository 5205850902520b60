"""Aligned tables of plain text, numbers with their units, and words that give numbers to names."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from laticauda.errors import BadArgument

# Units of the SI that people read in others: factor and name.
READ_IN = {"rad": (math.degrees(1.0), "deg"), "rad/s": (math.degrees(1.0), "deg/s")}
MISSING = "-"


def aligned(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Rows as lines whose columns begin (or, for the columns `right`, end) one below the other."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join(
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
    return "\n".join(lines)


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Rows of texts and numbers under their names; numbers end one below the other, what is missing is "-"."""
    if not rows:
        return MISSING
    names = list(rows[0])
    right = [i for i, name in enumerate(names) if not any(isinstance(row[name], str) for row in rows)]
    cells = [[row[name] if isinstance(row[name], str) else number(row[name]) for name in names] for row in rows]
    return aligned([names, *cells], right)


def read_in(value: float | None, unit: str) -> tuple[str, str]:
    """A figure as a table shows it: the number, and the unit that it is read in."""
    factor, shown = READ_IN.get(unit, (1.0, unit))
    return number(None if value is None else value * factor), shown


def number(value: float | None) -> str:
    """Four significant digits, without an exponent where that stays short; rounding noise is zero."""
    if value is None or not math.isfinite(value):
        return MISSING
    if abs(value) < 1e-6:
        return "0"
    if not 1e-3 <= abs(value) < 1e6:
        return f"{value:.3e}"
    decimals = max(0, 3 - math.floor(math.log10(abs(value))))
    return f"{value:.{decimals}f}"


def percent(value: float | None) -> str:
    """A difference in percent, with its sign."""
    return MISSING if value is None else f"{value:+.1f} %"


def numbers(option: str, word: str, form: str, *signs: str) -> tuple[str, str, list[float]]:
    """What a word NAME=NUMBERS says: the name, the sign between the numbers ("" for a single one), and the numbers.

    Args:
        option: Whose word it is, for messages.
        word: What was typed.
        form: What it should look like, for messages.
        signs: What may stand between numbers.

    Raises:
        ValueError: If it does not look so.
    """
    name, _, text = word.rpartition("=")
    sign = next((one for one in signs if one in text), "")
    try:
        values = [float(part) for part in (text.split(sign) if sign else [text])]
    except ValueError:
        values = []
    if not (name and values and all(map(math.isfinite, values))):
        raise BadArgument(option, f"must be {form}, got {word!r}")
    return name, sign, values
