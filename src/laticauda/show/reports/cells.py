"""Numbers and tables of a report: rounded on a page, with all digits in a CSV file."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from laticauda.values import csv_text

Row = dict[str, Any]
"""Row of a table, by column; all rows have the columns of the first."""

MISSING = "NA"
"""What a page shows for None and for values that are not finite."""
MINUS = "\N{MINUS SIGN}"


def format_number(value: float, form: str = "") -> str:
    """Format a number for a page: with a true minus sign, and without a sign if it is rounded to zero.

    Args:
        value: Any number.
        form: Format of the number, as Python's `format` takes it; "" shows six digits.
    """
    text = format(value, form or "g")
    is_zero = not any(digit in text for digit in "123456789")
    if is_zero:
        text = text.lstrip("+-")
    return text.replace("-", MINUS)


def format_cell(cell: Any, form: str = "") -> str:
    """Format a cell of a table for a page.

    Args:
        cell: Text, number, truth value or None; None and values that are not finite are shown as
            NA.
        form: Format of a number, as Python's `format` takes it.
    """
    if cell is None:
        return MISSING
    if isinstance(cell, float) and not math.isfinite(cell):
        return MISSING
    if isinstance(cell, str):
        return cell
    if _is_truth(cell):
        return _format_truth(bool(cell))
    return format_number(cell, form)


def _is_truth(cell: Any) -> bool:
    return isinstance(cell, bool | np.bool_)


def _format_truth(is_true: bool) -> str:
    return "yes" if is_true else "no"


def is_numeric(rows: Iterable[Row], column: str) -> bool:
    """Return whether a column holds numbers, which are right-aligned.

    Args:
        rows: Rows of the table.
        column: Name of the column.
    """
    all_cells = [row[column] for row in rows]
    cells = [cell for cell in all_cells if format_cell(cell) != MISSING]
    if not cells:
        return False
    return not any(isinstance(cell, str) or _is_truth(cell) for cell in cells)


def find_form(column: str, forms: Mapping[str, str]) -> str:
    """Return the format of a column's numbers: that of the longest key with which its name ends.

    Args:
        column: Name of the column.
        forms: Formats by the end of a column's name, as Python's `format` takes them.
    """
    endings = [ending for ending in forms if column.endswith(ending)]
    if not endings:
        return ""
    return forms[max(endings, key=len)]


def format_span(values: Iterable[float], form: str = "") -> str:
    """Format the range from the smallest to the largest of several values.

    Args:
        values: At least one value.
        form: Format of the numbers, as Python's `format` takes it.
    """
    all_values = list(values)
    low = format_number(min(all_values), form)
    high = format_number(max(all_values), form)
    if low == high:
        return low
    return f"{low} to {high}"


def format_share(part: int, whole: int) -> str:
    """Format a part of a total: "all 12", "none of the 12", "3 of the 12".

    Args:
        part: Number of items in the part.
        whole: Total number.
    """
    if part == whole:
        return f"all {whole}"
    if part == 0:
        return f"none of the {whole}"
    return f"{part} of the {whole}"


def write_csv(rows: Sequence[Row]) -> str:
    """Return the content of a table's CSV file; ten digits hide noise in the last bits, and missing cells are empty.

    Args:
        rows: Rows of the table.
    """
    columns: list[str] = []
    if rows:
        columns = list(rows[0])
    lines: list[list[Any]] = [columns]
    for row in rows:
        lines.append([_csv_cell(row[column]) for column in columns])
    return csv_text(lines, "\n")


def _csv_cell(cell: Any) -> Any:
    """Return a cell as it appears in a CSV file."""
    if _is_truth(cell):
        return _format_truth(bool(cell))
    if not isinstance(cell, float):
        return cell
    if not math.isfinite(cell):
        return ""
    return f"{cell:.10g}"
