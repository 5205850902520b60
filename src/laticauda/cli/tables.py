"""Aligned tables of plain text, numbers with their units, and words that assign numbers to names."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from laticauda.values.display_units import display_unit
from laticauda.values.errors import BadArgument

MISSING = "-"


def aligned(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Return rows as lines with left-aligned columns; the columns `right` are right-aligned."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join(
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
    return "\n".join(lines)


def format_table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return a table of texts and numbers under their names; numbers are right-aligned, missing values are "-"."""
    if not rows:
        return MISSING
    names = list(rows[0])
    right = [
        i for i, name in enumerate(names) if not any(isinstance(row[name], str) for row in rows)
    ]
    cells = [
        [row[name] if isinstance(row[name], str) else format_number(row[name]) for name in names]
        for row in rows
    ]
    return aligned([names, *cells], right)


def read_in(value: float | None, unit: str) -> tuple[str, str]:
    """Return a figure as a table shows it: the number, and the unit in which it is shown."""
    display = display_unit(unit)
    if value is None:
        return MISSING, display.name
    return format_number(display.from_si(value)), display.name


def format_number(value: float | None) -> str:
    """Format a number with four significant digits, without an exponent if that is short; rounding noise is zero."""
    if value is None or not math.isfinite(value):
        return MISSING
    if abs(value) < 1e-6:
        return "0"
    if not 1e-3 <= abs(value) < 1e6:
        return f"{value:.3e}"
    decimals = max(0, 3 - math.floor(math.log10(abs(value))))
    return f"{value:.{decimals}f}"


def percent(value: float | None) -> str:
    """Format a difference in percent, with its sign."""
    return MISSING if value is None else f"{value:+.1f} %"


def parse_numbers(option: str, word: str, form: str, *signs: str) -> tuple[str, str, list[float]]:
    """Parse a word NAME=NUMBERS into the name, the sign between the numbers ("" for a single one), and the numbers.

    Args:
        option: Option to which the word belongs, for messages.
        word: Word that was typed.
        form: Expected form of the word, for messages.
        signs: Signs that may separate numbers.

    Raises:
        ValueError: If the word does not have this form.
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
