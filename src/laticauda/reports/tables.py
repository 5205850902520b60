"""Tables of a report: rows of texts and numbers, written to CSV in full and shown rounded."""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

from laticauda.errors import BadArgument

Cell = str | float | int | bool | None


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column of a table."""

    name: str
    """What its head says, with the unit in brackets."""
    form: str = ""
    """How a number is shown on a page, as in `format`; a CSV file has all digits."""
    wraps: bool = False
    """Whether its cells are long texts, which a page breaks into lines."""


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table, ready to be written or shown."""

    name: str
    """Of its CSV file, without the ending."""
    caption: str
    """What it shows, in a sentence or two."""
    columns: tuple[Column, ...]
    """From left to right."""
    rows: tuple[tuple[Cell, ...], ...]
    """A cell per column; None is shown as missing."""
    grouped: bool = False
    """Whether a page shows the first column as a line above the rows that have it in common."""

    def __post_init__(self) -> None:
        """Check that every row has all its cells."""
        for i, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise BadArgument(f"rows[{i}]", f"must have {len(self.columns)} cells, one per column, got {len(row)}")

    @property
    def csv(self) -> str:
        """The content of the CSV file: heads, then rows; missing cells are empty."""
        text = io.StringIO(newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([column.name for column in self.columns])
        writer.writerows([_plain(cell) for cell in row] for row in self.rows)
        return text.getvalue()

    @property
    def shown(self) -> list[list[str]]:
        """The rows as a page shows them."""
        return [[shown(cell, column.form) for cell, column in zip(row, self.columns, strict=True)] for row in self.rows]


def shown(cell: Cell, form: str = "") -> str:
    """A cell as a page shows it."""
    if cell is None:
        return "NA"
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    return cell if isinstance(cell, str) else in_digits(cell, form)


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


def _plain(cell: Cell) -> Cell:
    """A cell as a CSV file has it; ten digits hide the noise of the last bits."""
    if cell is None:
        return ""
    return shown(cell) if isinstance(cell, bool) else f"{cell:.10g}" if isinstance(cell, float) else cell


def numeric(table: Table) -> Sequence[bool]:
    """By column, whether it holds numbers: they end one below the other."""
    return [
        all(cell is None or not isinstance(cell, str | bool) for cell in cells)
        and any(cell is not None for cell in cells)
        for cells in zip(*table.rows, strict=True)
    ]
