"""Aligned tables of plain text, numbers with their units, and words that assign numbers to names."""

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from laticauda.values import BadArgument, display_unit

WIDTH = 110
"""Width of texts [characters]."""
MISSING = "-"
"""What stands in a table for a missing value."""
NOISE = 1e-6
"""Numbers below this are shown as zero: they are rounding noise."""
SHORT = (1e-3, 1e6)
"""Numbers from the first to below the second are short enough without an exponent."""
SIGNIFICANT_DIGITS = 4
_NUMBER = re.compile(r"(?:^|(?<=\.))(?:robot|water|ground|gait|joints|measured|start)\..*")
"""Name of a number in a name that may begin with a kind of gait, a group or a measurement."""
_DASH_IN_WORD = re.compile(r"(?<=[a-z])-(?=[a-z])")


class Figure(NamedTuple):
    """A figure as a table shows it."""

    number: str
    unit: str


class Assignment(NamedTuple):
    """A word NAME=NUMBERS, taken apart."""

    name: str
    sign: str
    """Sign between the numbers; "" for a single one."""
    numbers: list[float]


def wrap_rows(rows: Sequence[tuple[str, str]]) -> str:
    """Return rows of a name and a text; a long text goes on below its beginning."""
    width = max(len(name) for name, _ in rows) + 2
    lines: list[str] = []
    for name, text in rows:
        wrapped = textwrap.fill(
            text,
            WIDTH,
            initial_indent=name.ljust(width),
            subsequent_indent=" " * width,
        )
        lines.append(wrapped)
    return "\n".join(lines)


def align_columns(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Return rows as lines with left-aligned columns.

    Args:
        rows: Texts of the cells, row by row.
        right: Numbers of the columns that are right-aligned, from 0.
    """
    columns = zip(*rows, strict=True)
    widths = [max(map(len, column)) for column in columns]
    lines = [_align_row(row, widths, right) for row in rows]
    return "\n".join(lines)


def _align_row(row: Sequence[str], widths: Sequence[int], right: Sequence[int]) -> str:
    cells: list[str] = []
    for i, (cell, width) in enumerate(zip(row, widths, strict=True)):
        if i in right:
            cells.append(cell.rjust(width))
        else:
            cells.append(cell.ljust(width))
    return "  ".join(cells).rstrip()


def format_table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return a table of texts and numbers under their names; numbers are right-aligned, missing values are "-"."""
    if not rows:
        return MISSING
    names = list(rows[0])
    right = [i for i, name in enumerate(names) if _holds_numbers(rows, name)]
    lines = [[_format_cell(row[name]) for name in names] for row in rows]
    return align_columns([names, *lines], right)


def _holds_numbers(rows: Sequence[Mapping[str, Any]], name: str) -> bool:
    return not any(isinstance(row[name], str) for row in rows)


def _format_cell(content: Any) -> str:
    if isinstance(content, str):
        return content
    return format_number(content)


def format_figure(value: float | None, unit: str) -> Figure:
    """Return a figure as a table shows it: the number, and the unit in which it is shown."""
    display = display_unit(unit)
    if value is None:
        return Figure(MISSING, display.name)
    return Figure(format_number(display.from_si(value)), display.name)


def format_number(value: float | None) -> str:
    """Format a number with four significant digits, without an exponent if that is short; rounding noise is zero."""
    if value is None or not math.isfinite(value):
        return MISSING
    size = abs(value)
    if size < NOISE:
        return "0"
    if not SHORT[0] <= size < SHORT[1]:
        return f"{value:.3e}"
    decimals = max(0, SIGNIFICANT_DIGITS - 1 - math.floor(math.log10(size)))
    return f"{value:.{decimals}f}"


def format_digits(value: float, digits: int) -> str:
    """Format a number with so many significant digits, trailing zeros included; whole numbers have no fewer digits."""
    if not math.isfinite(value):
        return MISSING
    if abs(value) >= 10.0**digits:
        return f"{value:.0f}"
    return f"{value:#.{digits}g}".removesuffix(".")


def format_percent(value: float | None) -> str:
    """Format a difference in percent, with its sign."""
    if value is None:
        return MISSING
    return f"{value:+.1f} %"


def spell_with_underscores(typed_name: str) -> str:
    """Return the name of a number that may have been typed with dashes, as for a sweep.

    Args:
        typed_name: The name; dashes in a group or a measurement before it stay.
    """
    number = _NUMBER.search(typed_name)
    if number is None:
        return typed_name
    scope = typed_name[: number.start()]
    return scope + _DASH_IN_WORD.sub("_", number.group())


def parse_numbers(option: str, text: str, form: str, *signs: str) -> Assignment:
    """Parse a word NAME=NUMBERS into the name, the sign between the numbers ("" for a single one), and the numbers.

    Args:
        option: Option to which the word belongs, for messages.
        text: The word that was typed.
        form: Expected form of the word, for messages.
        signs: Signs that may separate numbers.

    Raises:
        ValueError: If the word does not have this form.
    """
    name, _, right_side = text.rpartition("=")
    present_signs = [sign for sign in signs if sign in right_side]
    sign = ""
    parts = [right_side]
    if present_signs:
        sign = present_signs[0]
        parts = right_side.split(sign)
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        numbers = []
    if not name or not numbers or not all(map(math.isfinite, numbers)):
        raise BadArgument(option, f"must be {form}, got {text!r}")
    return Assignment(name, sign, numbers)
