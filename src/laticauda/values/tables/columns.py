"""Columns of numbers by name."""

import datetime
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.values.checks import suggest_nearest
from laticauda.values.tables.sheets import Sheet
from laticauda.values.tables.units import split_unit

Samples: TypeAlias = Float[np.ndarray, " n_samples"]

MISSING = ("", "nan", "null", "none", "na", "n/a", "-")
"""Cells that stand for a missing number, in lower case."""
LARGEST = 1e30
"""A number beyond this is not a measurement, whatever its unit: nanoseconds since 1970 are 2e18."""
N_LISTED_COLUMNS = 20
"""Names of columns that a message lists at most."""
LONGEST_CELL = 40
"""Signs of a cell that a message shows at most."""
_CALENDAR_TIME = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d([.,]\d+)?)?(Z|[-+]\d\d:?\d\d)?")
_CLOCK_TIME = re.compile(r"(\d{1,2}):(\d\d):(\d\d(?:[.,]\d+)?)")


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Columns of numbers by name, nan where one is missing."""

    columns: Mapping[str, Samples | str]
    """The numbers; for a column that holds anything else, a sentence that says so."""
    units: Mapping[str, str] = field(default_factory=dict[str, str])
    """Units of the columns, if stated in the file."""
    rate: float | None = None
    """Rows per second, if stated in the file [Hz]."""
    row_numbers: Sequence[int] = ()
    """Numbers of the rows in the file, if it has any."""
    clocks: Collection[str] = ()
    """Columns whose cells are times of a calendar or a clock, which are in s whatever their names say."""
    remarks: Sequence[str] = ()
    """What a person should know about how it was read, such as `decimal commas`."""

    def __getitem__(self, name: str) -> Samples:
        """Return the column of that name, which may lack the unit in brackets behind it.

        Raises:
            ValueError: If there is no such column, or it does not hold numbers, or holds absurd
                ones.
        """
        column = self.columns[self.find(name)]
        if isinstance(column, str):
            raise ValueError(column)
        measured = np.where(np.isfinite(column), column, np.nan)  # infinity was not measured
        is_absurd = np.abs(measured) > LARGEST
        if np.any(is_absurd):
            first = measured[is_absurd][0]
            raise ValueError(f"Column `{name}` must hold numbers up to {LARGEST:g}, got {first:g}.")
        return measured

    def find(self, name: str) -> str:
        """Return the name of a column in the file.

        Args:
            name: The same, or without the unit in brackets behind it.

        Raises:
            ValueError: If there is no such column.
        """
        if name in self.columns:
            return name
        matches = [column for column in self.columns if split_unit(column)[0] == name]
        if len(matches) == 1:
            return matches[0]
        raise ValueError(self._describe_missing(name))

    def unit_of(self, name: str) -> str | None:
        """Return the unit that the file states for a column; None if it states none.

        Args:
            name: Name of the column.
        """
        return self.units.get(self.find(name))

    def describe_row(self, sample: int) -> str:
        """Return what a row is called in a message.

        Args:
            sample: Its index, from 0.
        """
        if not self.row_numbers:
            return f"sample {sample}"
        return f"row {self.row_numbers[sample]}"

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


def build_table(sheet: Sheet) -> Table:
    """Return the columns of numbers of a sheet.

    Args:
        sheet: The sheet.

    Raises:
        ValueError: If it has no rows.
    """
    if not sheet.rows:
        raise ValueError("it must have at least a row of names and a row of numbers.")
    row_numbers = sheet.row_numbers
    columns = {
        name: convert_numbers(name, sheet.cells_of(name), row_numbers) for name in sheet.names
    }
    clocks = [name for name in sheet.names if any(map(_is_clock, sheet.cells_of(name)))]
    return Table(
        columns=columns,
        units=sheet.units,
        row_numbers=row_numbers,
        clocks=clocks,
        remarks=sheet.remarks,
    )


def convert_numbers(name: str, cells: Sequence[str], row_numbers: Sequence[int]) -> Samples | str:
    """Convert a column of cells to numbers; otherwise return a sentence that states which cell is not a number.

    Times of a calendar, such as 2026-11-29T17:30:00.5, become seconds since 1970, and those of a
    clock, such as 17:30:00.5, seconds since midnight.

    Args:
        name: Name of the column.
        cells: Texts of the cells.
        row_numbers: Their rows in the file.
    """
    numbers = np.empty(len(cells))
    for i, cell in enumerate(cells):
        text = cell.strip()
        if text.lower() in MISSING:
            numbers[i] = np.nan
            continue
        try:
            numbers[i] = _parse_number(text)
        except ValueError:
            return _describe_bad_cell(name, text, row=row_numbers[i])
    return numbers


def add_column(
    columns: dict[str, Samples | str], name: str, values: Samples | str, owner: str | None = None
) -> None:
    """Add a column of a file to those before it; one whose name was there already cannot be used.

    Args:
        columns: Columns by name, which are changed.
        name: Name of the column.
        values: Its numbers, or the sentence that says why it has none.
        owner: Name of the marker or channel that it belongs to; None: that of the column.
    """
    if name in columns:
        values = (
            f"The file has `{owner or name}` more than once: "
            "name every column and every marker once."
        )
    columns[name] = values


def _parse_number(text: str) -> float:
    if _CALENDAR_TIME.fullmatch(text):
        moment = datetime.datetime.fromisoformat(text.replace(",", "."))
        if moment.tzinfo is None:
            moment = moment.replace(tzinfo=datetime.UTC)
        return moment.timestamp()
    clock = _CLOCK_TIME.fullmatch(text)
    if clock is not None:
        minutes = 60.0 * float(clock[1]) + float(clock[2])
        return 60.0 * minutes + float(clock[3].replace(",", "."))
    return parse_float(text)


def parse_float(text: str) -> float:
    """Return the number in a text; Python's own 1_0 for 10 is none.

    Args:
        text: Text of a cell.

    Raises:
        ValueError: If it is no number.
    """
    if "_" in text:
        raise ValueError(f"must be a number, got {text!r}")
    return float(text)


def _is_clock(text: str) -> bool:
    """Return whether a cell is a time of a calendar or a clock."""
    if ":" not in text:
        return False
    return bool(_CALENDAR_TIME.fullmatch(text) or _CLOCK_TIME.fullmatch(text))


def _describe_bad_cell(name: str, text: str, row: int) -> str:
    hint = ""
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        hint = "; is `decimal` a comma?"
    elif re.fullmatch(r"[-+]?\d{1,3}([., ']\d{3})+([.,]\d+)?", text):
        hint = "; write it without separators of thousands"
    return f"Column `{name}` must hold numbers, got {text[:LONGEST_CELL]!r} in row {row}{hint}."
