"""A table as people bring it: names, units and cells, however the file writes them."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from laticauda.values.tables import workbooks
from laticauda.values.tables.decoding import NO_TEXT, decode_text
from laticauda.values.tables.splitting import (
    NUMBER,
    SEPARATOR_NAMES,
    SheetRow,
    split_text,
)
from laticauda.values.tables.units import NO_UNIT, read_unit, unit_in_name

DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+([eE][-+]?\d+)?")
DECIMAL_POINT = re.compile(r"[-+]?\d*\.\d+([eE][-+]?\d+)?")
NAME_JOINT = " / "
"""Between the parts of a name that stands in several rows."""
N_NAMES_SHOWN = 3
"""Cells of a row without names that a message shows."""


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """The cells of a table; numbers have decimal points."""

    names: Sequence[str]
    """Names of the columns."""
    header_row: int
    """Number of the row of names."""
    rows: Sequence[SheetRow]
    """Rows below it, each with a cell for every column."""
    units: Mapping[str, str]
    """Units of columns that the file states in a row of units, or in their names."""
    remarks: Sequence[str] = ()
    """How it is written, as far as that is not usual, such as `decimal commas`."""

    def cells_of(self, name: str) -> list[str]:
        """Return the cells of a column.

        Args:
            name: Name of the column.
        """
        column = self.names.index(name)
        return [row.cells[column] for row in self.rows]

    @property
    def row_numbers(self) -> list[int]:
        """Numbers of the rows in the file."""
        return [row.number for row in self.rows]


def parse_sheet(
    content: bytes,
    separator: str | None = None,
    decimal: str | None = None,
    n_header_rows: int = 1,
) -> Sheet:
    """Read a table: delimited text in any usual form, or an Excel workbook.

    Args:
        content: All bytes of the file.
        separator: Separator between cells; detected if None.
        decimal: Decimal sign, point or comma; detected if None.
        n_header_rows: Rows that a name stands in; its parts are joined by `NAME_JOINT`.

    Raises:
        ValueError: If it is no table; the message names the row.
        MissingExtra: If it is an Excel workbook, and openpyxl is not installed.
    """
    if workbooks.is_workbook(content):
        rows = workbooks.read_workbook(content)
        rows = _join_header(rows, n_header_rows)
        return _build_sheet(rows, decimal, remarks=["an Excel workbook"])
    split = split_text(decode_text(content), separator)
    remarks: list[str] = []
    if split.separator in SEPARATOR_NAMES:
        remarks.append(f"{SEPARATOR_NAMES[split.separator]} between columns")
    return _build_sheet(_join_header(split.rows, n_header_rows), decimal, remarks=remarks)


def _join_header(rows: Sequence[SheetRow], n_header_rows: int) -> Sequence[SheetRow]:
    """Return the rows of a table with those of its names as one."""
    header = rows[:n_header_rows]
    if len(header) < 2:
        return rows
    widths = {len(row.cells) for row in header}
    if len(widths) > 1:
        raise ValueError(f"rows {header[0].number} to {header[-1].number} must be equally long.")
    columns = zip(*(row.cells for row in header), strict=True)
    names = [NAME_JOINT.join(cell.strip() for cell in column) for column in columns]
    return [SheetRow(header[-1].number, names), *rows[n_header_rows:]]


def _build_sheet(
    all_rows: Sequence[SheetRow], decimal: str | None, remarks: Sequence[str]
) -> Sheet:
    if not all_rows:
        raise ValueError(NO_TEXT)
    header, *rows = all_rows
    names = [name.strip() for name in header.cells]
    while names and not names[-1]:  # some programs end every line with a separator
        names.pop()
    _check_names(names, header.number)
    rows = [_fit_row(row, len(names), header.number) for row in rows]
    sheet = Sheet(names=names, header_row=header.number, rows=rows, units={}, remarks=list(remarks))
    sheet = _with_decimal_points(_without_index(sheet), decimal)
    return _with_units(sheet)


def _check_names(names: Sequence[str], row: int) -> None:
    if all(NUMBER.fullmatch(name) for name in names):
        shown = ", ".join(names[:N_NAMES_SHOWN])
        raise ValueError(f"row {row} must have the names of the columns, got {shown}.")
    for name, count in Counter(names).items():
        if name and count > 1:
            raise ValueError(f"row {row} must name every column once, got `{name}` twice.")


def _fit_row(row: SheetRow, width: int, header_row: int) -> SheetRow:
    """Return a row without empty cells beyond the columns that have names."""
    has_more = any(cell.strip() for cell in row.cells[width:])
    if len(row.cells) >= width and not has_more:
        return SheetRow(number=row.number, cells=row.cells[:width])
    hint = ""
    if width == 1:
        hint = f"; is row {header_row} a title?"
    elif len(row.cells) > width and len(row.cells) % width == 0:
        hint = "; are there commas in its numbers, too?"
    raise ValueError(
        f"row {row.number} must have {width} cells, as row {header_row} has, "
        f"got {len(row.cells)}{hint or '.'}"
    )


def _without_index(sheet: Sheet) -> Sheet:
    """Return a sheet without columns that have no name: empty ones, and a running number of the rows."""
    columns: list[int] = []
    for i, name in enumerate(sheet.names):
        if name:
            columns.append(i)
            continue
        cells = [row.cells[i] for row in sheet.rows]
        is_index = all(not cell or cell.isdecimal() for cell in cells)
        if not is_index:
            raise ValueError(f"row {sheet.header_row} has no name for column {i + 1}.")
    if len(columns) == len(sheet.names):
        return sheet
    rows = [SheetRow(row.number, [row.cells[i] for i in columns]) for row in sheet.rows]
    names = [sheet.names[i] for i in columns]
    return replace(sheet, names=names, rows=rows)


def _with_decimal_points(sheet: Sheet, decimal: str | None) -> Sheet:
    """Return a sheet whose numbers have points, if they have commas."""
    if decimal == "." or not _has_decimal_commas(sheet, decimal):
        return sheet
    rows: list[SheetRow] = []
    for row in sheet.rows:
        cells = [_with_point(cell) for cell in row.cells]
        rows.append(SheetRow(number=row.number, cells=cells))
    return replace(sheet, rows=rows, remarks=[*sheet.remarks, "decimal commas"])


def _has_decimal_commas(sheet: Sheet, decimal: str | None) -> bool:
    has_comma = False
    for row in sheet.rows:
        for cell in row.cells:
            has_comma = has_comma or DECIMAL_COMMA.fullmatch(cell) is not None
            if decimal is None and DECIMAL_POINT.fullmatch(cell):
                return False
    return has_comma


def _with_point(cell: str) -> str:
    if DECIMAL_COMMA.fullmatch(cell):
        return cell.replace(",", ".")
    return cell


# ---- units ---------------------------------------------------------------------------------------


def _with_units(sheet: Sheet) -> Sheet:
    """Return a sheet without its row of units, and with the units of its columns."""
    units: dict[str, str] = {}
    for name in sheet.names:
        unit = unit_in_name(name)
        if unit is not None:
            units[name] = unit
    if not sheet.rows or not _is_unit_row(sheet.rows[0]):
        return replace(sheet, units=units)
    unit_row = sheet.rows[0]
    for name, cell in zip(sheet.names, unit_row.cells, strict=True):
        unit = read_unit(cell)
        if unit is None:
            continue
        if units.get(name, unit) != unit:
            raise ValueError(
                f"row {unit_row.number} says {unit} for column `{name}`, whose name says {units[name]}."
            )
        units[name] = unit
    return replace(
        sheet, rows=sheet.rows[1:], units=units, remarks=[*sheet.remarks, "units below the names"]
    )


def _is_unit_row(row: SheetRow) -> bool:
    units = [cell for cell in row.cells if cell.strip().strip("[]()").lower() not in NO_UNIT]
    return bool(units) and all(read_unit(cell) is not None for cell in units)
