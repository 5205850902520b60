"""Tables of somebody's log: columns of numbers by name, and those of a text with separators."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from laticauda.errors import nearest
from laticauda.trial.arrays import Samples

MISSING = ("", "nan", "null", "none", "na", "n/a", "-")
"""Cells that stand for a missing number, in small letters."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Columns of numbers by name, nan where one is missing."""

    columns: Mapping[str, Samples | str]
    """The numbers; of a column that holds something else, a sentence that says so."""
    units: Mapping[str, str] = field(default_factory=dict[str, str])
    """Units of columns, where the file states them."""
    rate: float | None = None
    """Rows per second, where the file states it [Hz]."""

    def __getitem__(self, name: str) -> Samples:
        """The column of that name.

        Raises:
            ValueError: If there is none, or it does not hold numbers.
        """
        found = self.columns.get(name)
        if found is None:
            names = list(self.columns)
            shown = ", ".join(names[:20]) + (f" and {len(names) - 20} more" if len(names) > 20 else "")
            raise ValueError(f"The file has no column `{name}`{nearest(name, names).rstrip('.')}; it has {shown}.")
        if isinstance(found, str):
            raise ValueError(found)
        return found

    @property
    def n_rows(self) -> int:
        """How many rows there are."""
        return next((len(one) for one in self.columns.values() if not isinstance(one, str)), 0)


def numbers(name: str, cells: Sequence[str], first_row: int, decimal: str = ".") -> Samples | str:
    """A column of cells as numbers, or the sentence that says which cell is none.

    Args:
        name: Of the column.
        cells: Their texts.
        first_row: Number of the row of the first cell, in the file.
        decimal: Point or comma.
    """
    found = np.empty(len(cells))
    for i, cell in enumerate(cells):
        text = cell.strip()
        if decimal == ",":
            text = text.replace(",", ".")
        try:
            found[i] = np.nan if text.lower() in MISSING else float(text)
        except ValueError:
            hint = "; is `decimal` a comma?" if re.fullmatch(r"[-+]?\d+,\d+", text) else ""
            return f"Column `{name}` must hold numbers, got {text[:40]!r} in row {first_row + i}{hint}."
    return found


def csv_table(lines: Sequence[str], separator: str | None, decimal: str) -> Table:
    """The columns of a text whose first row, comments apart, has their names.

    Args:
        lines: Of the text.
        separator: Between cells; found by itself if None.
        decimal: Point or comma.

    Raises:
        ValueError: If it makes no sense.
    """
    rows = [(i, line) for i, line in enumerate(lines, start=1) if line.strip() and not line.lstrip().startswith("#")]
    if len(rows) < 2:
        raise ValueError("it must have a row of names and a row of numbers at least.")
    if separator is None:
        separator = max("\t;,", key=rows[0][1].count)
    cells = list(csv.reader([line for _, line in rows], delimiter=separator))
    header = [name.strip() for name in cells[0]]
    while header and not header[-1]:  # some programs end every line with a separator
        header.pop()
    _check_header(header, rows[0][0])
    width = len(header)
    for (number, _), row in zip(rows[1:], cells[1:], strict=True):
        if len(row) < width or any(cell.strip() for cell in row[width:]):
            raise ValueError(f"row {number} must have {width} cells as row {rows[0][0]} has, got {len(row)}.")
    first = rows[1][0]
    columns = {name: numbers(name, [row[i] for row in cells[1:]], first, decimal) for i, name in enumerate(header)}
    return Table(columns=columns)


def _check_header(header: Sequence[str], row: int) -> None:
    if all(re.fullmatch(r"[-+\d.eE]+", name) for name in header):
        raise ValueError(f"row {row} must have the names of the columns, got {', '.join(header[:3])}.")
    twice = next((name for name in header if header.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"row {row} must name every column once, got `{twice}` twice.")
