"""Files of rows, opened by name: whole tables, or the cells of each row or column."""

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path

from laticauda.values import files
from laticauda.values.errors import LaticaudaError, MissingExtra, StorageFailed
from laticauda.values.tables.renaming import rename_columns
from laticauda.values.tables.sheets import Sheet, parse_sheet


@contextmanager
def failures_of_table(path: object, error: type[LaticaudaError]) -> Generator[None]:
    """Convert errors about a table raised within this context to errors that name its file.

    Args:
        path: Name of the file in messages.
        error: Class of the new error.
    """
    try:
        yield
    except (LaticaudaError, MissingExtra):
        raise
    except ValueError as failure:
        raise error(f"{path}: {failure}") from None


def open_sheet(
    path: str | Path,
    error: type[LaticaudaError] = StorageFailed,
    columns: Mapping[str, str] | None = None,
) -> Sheet:
    """Read a table from a file.

    Args:
        path: Path of the file: text of any usual form, or an Excel workbook.
        error: Error raised if the file cannot be read, or is no table; the message gives file and
            reason.
        columns: Names in the file by ours, for columns that it calls otherwise.
    """
    content = files.read_content(path, error)
    with failures_of_table(path, error):
        return rename_columns(parse_sheet(content), columns or {})


def read_rows(
    path: str | Path,
    error: type[LaticaudaError] = StorageFailed,
    columns: Mapping[str, str] | None = None,
) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Read a table: its column names, and for each row below them its row number (from 1) and its cells by column.

    Empty rows and lines that begin with # are ignored.

    Args:
        path: Path of the file.
        error: Error raised if the file cannot be read, or its rows differ in length; the message
            gives file and reason.
        columns: Names in the file by ours, for columns that it calls otherwise.
    """
    sheet = open_sheet(path, error, columns)
    rows = [(row.number, dict(zip(sheet.names, row.cells, strict=True))) for row in sheet.rows]
    return list(sheet.names), rows


def read_columns(
    path: str | Path, error: type[LaticaudaError] = StorageFailed
) -> dict[str, list[str]]:
    """Read the cells of a table by column.

    Args:
        path: Path of the file.
        error: Error raised if the file cannot be read, or its rows differ in length; the message
            gives file and reason.
    """
    sheet = open_sheet(path, error)
    return {name: sheet.cells_of(name) for name in sheet.names}
