"""The cells of the only sheet of an Excel workbook (.xlsx), read with the package `openpyxl`."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import datetime
import io
import zipfile
from typing import Any

from laticauda.values.optional import optional_import
from laticauda.values.tables.splitting import SheetRow, is_comment

ZIP = b"PK\x03\x04"
"""First bytes of a .xlsx file, which is a zip archive."""
OLD_EXCEL = b"\xd0\xcf\x11\xe0"
"""First bytes of a .xls file."""


def is_workbook(content: bytes) -> bool:
    """Return whether bytes are those of an Excel workbook.

    Args:
        content: All bytes of the file.

    Raises:
        ValueError: If they are those of an old one (.xls).
    """
    if content.startswith(OLD_EXCEL):
        raise ValueError("it is an old Excel file; save it as .xlsx or as CSV.")
    return content.startswith(ZIP)


def read_workbook(content: bytes) -> list[SheetRow]:
    """Return the rows of the only sheet with cells that are neither empty nor comments.

    Args:
        content: All bytes of the file.

    Raises:
        MissingExtra: If openpyxl is not installed.
        ValueError: If the file is no workbook, has several such sheets, or formulas without results.
    """
    library = optional_import("Reading Excel files", "openpyxl", "logs")
    try:
        sheets = _read_sheets(library, content, results=True)
        name = _find_only_sheet(sheets)
        rows = sheets.get(name, [])
        if any(None in row for row in rows):  # what has no result looks like an empty cell
            _check_formulas(name, _read_sheets(library, content, results=False)[name], rows)
    except (KeyError, TypeError, IndexError, OSError, zipfile.BadZipFile, SyntaxError) as error:
        raise ValueError(f"it is not an intact Excel file ({error}).") from error
    width = max(map(len, rows), default=0)
    table: list[SheetRow] = []
    for number, cells in enumerate(rows, start=1):
        texts = [_show_cell(cell) for cell in cells]
        texts += [""] * (width - len(texts))
        if any(texts) and not is_comment(texts[0]):
            table.append(SheetRow(number=number, cells=texts))
    return table


def _read_sheets(library: Any, content: bytes, *, results: bool) -> dict[str, list[Any]]:
    """Return the cells of all sheets by name: results of formulas, or the formulas."""
    workbook = library.load_workbook(io.BytesIO(content), read_only=True, data_only=results)
    sheets: dict[str, list[Any]] = {}
    for sheet in workbook.worksheets:
        sheet.reset_dimensions()  # what a file states about its size need not be right
        sheets[sheet.title] = list(sheet.iter_rows(values_only=True))
    return sheets


def _find_only_sheet(sheets: dict[str, list[Any]]) -> str:
    """Return the name of the only sheet that is not empty; "" if all are."""
    names = [
        name
        for name, rows in sheets.items()
        if any(cell is not None for row in rows for cell in row)
    ]
    if len(names) > 1:
        listed = ", ".join(f"`{name}`" for name in names)
        raise ValueError(
            f"it has several sheets, {listed}: save the one with the table alone, or as CSV."
        )
    return "".join(names)


def _check_formulas(name: str, formulas: list[Any], rows: list[Any]) -> None:
    """Reject formulas of a sheet whose results the file does not hold."""
    for number, (cells, results) in enumerate(zip(formulas, rows, strict=True), start=1):
        for i, (cell, result) in enumerate(zip(cells, results, strict=True)):
            if cell is not None and result is None:
                raise ValueError(
                    f"row {number} of sheet `{name}` has a formula without its result in column {i + 1}: open "
                    "the file in Excel and save it, or save it as CSV."
                )


def _show_cell(value: Any) -> str:
    """Return the text of a cell that gives the same number again."""
    if value is None:
        return ""
    if isinstance(value, datetime.datetime | datetime.time):
        return value.isoformat()
    if isinstance(value, datetime.timedelta):
        return repr(value.total_seconds())
    return str(value).strip()
