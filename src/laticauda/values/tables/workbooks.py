"""The cells of the first sheet of an Excel workbook (.xlsx), read with the package `openpyxl`."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import datetime
import io
import zipfile
from typing import Any

from laticauda.values.optional import optional_import
from laticauda.values.tables.splitting import SheetRow

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
    """Return the rows of the first sheet that are neither empty nor comments.

    Args:
        content: All bytes of the file.

    Raises:
        MissingExtra: If openpyxl is not installed.
        ValueError: If the file is no workbook.
    """
    library = optional_import("Reading Excel files", "openpyxl", "logs")
    try:
        workbook = library.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
        cells = list(workbook.worksheets[0].iter_rows(values_only=True))
    except (KeyError, ValueError, IndexError, OSError, zipfile.BadZipFile) as error:
        raise ValueError(f"it is not an intact Excel file ({error}).") from error
    rows: list[SheetRow] = []
    for number, values in enumerate(cells, start=1):
        row = SheetRow(number=number, cells=[_show_cell(value) for value in values])
        if any(row.cells) and not row.cells[0].startswith("#"):
            rows.append(row)
    return rows


def _show_cell(value: Any) -> str:
    """Return the text of a cell that gives the same number again."""
    if value is None:
        return ""
    if isinstance(value, datetime.datetime | datetime.time):
        return value.isoformat()
    return str(value).strip()
