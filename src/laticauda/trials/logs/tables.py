"""Tables from external logs: columns of numbers by name, and their reading from delimited text.

Other sources have modules of their own: `qtm` reads exports of Qualisys Track Manager, `c3d` files
of motion capture, `tabular` and `mat` files of columns in binary formats.
"""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from laticauda.trials.arrays import Samples
from laticauda.values import suggest_nearest

MISSING = ("", "nan", "null", "none", "na", "n/a", "-")
"""Cells that stand for a missing number, in lower case."""
LARGEST = 1e30
"""A number beyond this is not a measurement, whatever its unit: nanoseconds since 1970 are 2e18."""
SEPARATORS = "\t;,"
"""Separators of cells that are detected; the most frequent one in the row of names counts."""
N_LISTED_COLUMNS = 20
"""Names of columns that a message lists at most."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Columns of numbers by name, nan where one is missing."""

    columns: Mapping[str, Samples | str]
    """The numbers; for a column that holds anything else, a sentence that says so."""
    units: Mapping[str, str] = field(default_factory=dict[str, str])
    """Units of the columns, if stated in the file."""
    rate: float | None = None
    """Rows per second, if stated in the file [Hz]."""

    def __getitem__(self, name: str) -> Samples:
        """Return the column of that name.

        Raises:
            ValueError: If there is no such column, or it does not hold numbers, or holds absurd
                ones.
        """
        if name not in self.columns:
            raise ValueError(self._describe_missing(name))
        column = self.columns[name]
        if isinstance(column, str):
            raise ValueError(column)
        measured = np.where(np.isfinite(column), column, np.nan)  # infinity was not measured
        is_absurd = np.abs(measured) > LARGEST
        if np.any(is_absurd):
            first = measured[is_absurd][0]
            raise ValueError(f"Column `{name}` must hold numbers up to {LARGEST:g}, got {first:g}.")
        return measured

    def _describe_missing(self, name: str) -> str:
        """Return a sentence that says which columns there are instead."""
        names = list(self.columns)
        listed = ", ".join(names[:N_LISTED_COLUMNS])
        n_not_listed = len(names) - N_LISTED_COLUMNS
        if n_not_listed > 0:
            listed += f" and {n_not_listed} more"
        printable_name = repr(name)[1:-1]
        suggestion = suggest_nearest(name, names).rstrip(".")
        return f"The file has no column `{printable_name}`{suggestion}; it has {listed}."

    @property
    def n_rows(self) -> int:
        """Number of rows."""
        for column in self.columns.values():
            if not isinstance(column, str):
                return len(column)
        return 0


def convert_numbers(
    name: str, cells: Sequence[str], first_row: int, decimal: str = "."
) -> Samples | str:
    """Convert a column of cells to numbers; otherwise return a sentence that states which cell is not a number.

    Args:
        name: Name of the column.
        cells: Texts of the cells.
        first_row: Row number of the first cell in the file.
        decimal: Decimal separator, point or comma.
    """
    numbers = np.empty(len(cells))
    for i, cell in enumerate(cells):
        text = cell.strip()
        if decimal == ",":
            text = text.replace(",", ".")
        if text.lower() in MISSING:
            numbers[i] = np.nan
            continue
        try:
            numbers[i] = float(text)
        except ValueError:
            return _describe_bad_cell(name, text, row=first_row + i)
    return numbers


def _describe_bad_cell(name: str, text: str, row: int) -> str:
    hint = ""
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        hint = "; is `decimal` a comma?"
    return f"Column `{name}` must hold numbers, got {text[:40]!r} in row {row}{hint}."


# ---- delimited text ------------------------------------------------------------------------------


class _Row(NamedTuple):
    """A row of a text with columns."""

    number: int
    """Number of its line, counted from 1."""
    line: str


def parse_csv(lines: Sequence[str], separator: str | None, decimal: str) -> Table:
    """Read the columns of a text whose first row, apart from comments, has their names.

    Args:
        lines: Lines of the text.
        separator: Separator between cells; detected if None.
        decimal: Decimal separator, point or comma.

    Raises:
        ValueError: If the text is not a valid table.
    """
    rows = list(_rows_with_cells(lines))
    if len(rows) < 2:
        raise ValueError("it must have at least a row of names and a row of numbers.")
    header_row, *number_rows = rows
    if separator is None:
        separator = max(SEPARATORS, key=header_row.line.count)
    header_cells, *cells = csv.reader([row.line for row in rows], delimiter=separator)
    header = [name.strip() for name in header_cells]
    while header and not header[-1]:  # some programs end every line with a separator
        header.pop()
    _check_header(header, header_row.number)
    width = len(header)
    for row, row_cells in zip(number_rows, cells, strict=True):
        has_more = any(cell.strip() for cell in row_cells[width:])
        if len(row_cells) < width or has_more:
            raise ValueError(
                f"row {row.number} must have {width} cells, as row {header_row.number} has, "
                f"got {len(row_cells)}."
            )
    first_row = number_rows[0].number
    columns: dict[str, Samples | str] = {}
    for i, name in enumerate(header):
        column = [row_cells[i] for row_cells in cells]
        columns[name] = convert_numbers(name, column, first_row, decimal)
    return Table(columns=columns)


def _rows_with_cells(lines: Sequence[str]) -> Iterator[_Row]:
    """Yield the lines that are neither empty nor comments."""
    for number, line in enumerate(lines, start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            yield _Row(number=number, line=line)


def _check_header(header: Sequence[str], row: int) -> None:
    if all(re.fullmatch(r"[-+\d.eE]+", name) for name in header):
        raise ValueError(
            f"row {row} must have the names of the columns, got {', '.join(header[:3])}."
        )
    for name in header:
        if header.count(name) > 1:
            raise ValueError(f"row {row} must name every column once, got `{name}` twice.")
