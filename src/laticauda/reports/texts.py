"""Numbers and tables as readers get them: rounded on a page, with all digits in a CSV file."""

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

Row = dict[str, Any]
"""Of a table, by column; all rows have the columns of the first."""


def in_digits(value: float, form: str = "") -> str:
    """A number as a page shows it: with a real minus, and what is rounded to zero without a sign.

    Args:
        value: Any number.
        form: As in `format`; "" shows six digits.
    """
    text = format(value, form or "g")
    if not any(digit in text for digit in "123456789"):
        text = text.lstrip("+-")
    return text.replace("-", "\N{MINUS SIGN}")


def shown(cell: Any, form: str = "") -> str:
    """A cell of a table as a page shows it.

    Args:
        cell: A text, a number, a truth, or None or nan, which are shown as NA.
        form: Of a number, as in `format`.
    """
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return "NA"
    plain = _plain(cell)
    return plain if isinstance(cell, str) or plain in ("yes", "no") else in_digits(cell, form)


def is_numeric(rows: Iterable[Row], column: str) -> bool:
    """Whether a column holds numbers: they end one below the other.

    Args:
        rows: The table.
        column: Its name.
    """
    known = [row[column] for row in rows if shown(row[column]) != "NA"]
    return bool(known) and not any(isinstance(cell, str | bool | np.bool_) for cell in known)


def form_of(column: str, forms: Mapping[str, str]) -> str:
    """How a column's numbers are shown: the form of the longest key that its name ends with.

    Args:
        column: Its name.
        forms: By the end of a column's name, as in `format`.
    """
    return max(((len(end), form) for end, form in forms.items() if column.endswith(end)), default=(0, ""))[1]


def span(values: Iterable[float], form: str = "") -> str:
    """From the smallest to the largest of several values.

    Args:
        values: At least one.
        form: As in `format`.
    """
    known = [*values]
    low, high = in_digits(min(known), form), in_digits(max(known), form)
    return low if low == high else f"{low} to {high}"


def share(part: int, whole: int) -> str:
    """How many of them: "all 12", "none of the 12", "3 of the 12".

    Args:
        part: How many.
        whole: Of how many.
    """
    return f"all {whole}" if part == whole else f"none of the {whole}" if part == 0 else f"{part} of the {whole}"


def as_csv(rows: Sequence[Row]) -> str:
    """The content of a table's CSV file; ten digits hide the noise of the last bits, and missing cells are empty.

    Args:
        rows: The table.
    """
    text = io.StringIO()
    lines = csv.DictWriter(text, [*rows[0]] if rows else [], lineterminator="\n")
    lines.writeheader()
    lines.writerows({column: _plain(cell) for column, cell in row.items()} for row in rows)
    return text.getvalue()


def _plain(cell: Any) -> Any:
    """A cell as a CSV file has it."""
    if isinstance(cell, bool | np.bool_):
        return "yes" if cell else "no"
    if not isinstance(cell, float):
        return cell
    return "" if math.isnan(cell) else f"{cell:.10g}"
