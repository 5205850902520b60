"""The cells of delimited text: separators, a `sep=` line, comments, quotes, and names behind a # sign."""

import csv
import re
from collections.abc import Sequence
from typing import NamedTuple

SEPARATORS = "\t;,|"
"""Separators of cells that are detected; the most frequent one in the row of names counts."""
BLANKS = " "
"""Stands for any number of blanks between cells."""
SEPARATOR_NAMES = {"\t": "tabs", ";": "semicolons", "|": "bars", BLANKS: "blanks"}
"""What separators other than the comma are called."""
COMMENT = "#"
"""First sign of a line that is a comment."""
ERRORS = ("#DIV/0!", "#N/A", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!", "#SPILL!")
"""What Excel writes for results that it does not have."""
NUMBER = re.compile(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?")
"""A number with either decimal sign."""
_BETWEEN_BLANKS = re.compile(r'"[^"]*"(?!\S)|\S+')
_LINE_END = re.compile("\r\n|\r|\n")
_QUOTED = re.compile('"[^"]*"')


class SheetRow(NamedTuple):
    """A row of a table."""

    number: int
    """Its number in the file, counted from 1 as in a spreadsheet."""
    cells: Sequence[str]


class SplitText(NamedTuple):
    """The cells of a text, and by what they were separated."""

    rows: list[SheetRow]
    separator: str


class _Line(NamedTuple):
    number: int
    text: str


def split_text(text: str, separator: str | None) -> SplitText:
    """Return the cells of all rows that are neither empty nor comments, the row of names first.

    Args:
        text: Text of the file.
        separator: Separator between cells; detected if None.

    Raises:
        ValueError: If a quote is not closed.
    """
    lines = [_Line(number, line) for number, line in enumerate(_LINE_END.split(text), start=1)]
    stated = _take_stated_separator(lines)
    rows = [line for line in lines if line.text.strip() and not _is_comment(line)]
    if not rows:
        return SplitText(rows=[], separator=",")
    separator = separator or stated or detect_separator([line.text for line in rows[:2]])
    names_in_comment = _find_names_in_comment(lines, rows[0], separator)
    if names_in_comment is not None:
        rows.insert(0, names_in_comment)
    return SplitText(rows=_split_lines(rows, separator), separator=separator)


def detect_separator(lines: Sequence[str]) -> str:
    """Return the separator of the cells of a table.

    Args:
        lines: The row of names, and the one below it if there is one.
    """
    names, *below = lines
    names_outside_quotes = _QUOTED.sub("", names)
    separator = max(SEPARATORS, key=names_outside_quotes.count)
    if names_outside_quotes.count(separator):
        return separator
    n_words = len(split_at_blanks(names))
    if n_words > 1 and all(len(split_at_blanks(line)) == n_words for line in below):
        return BLANKS
    return ","


def is_comment(text: str) -> bool:
    """Return whether a line, or the first cell of a row, is a comment; Excel's errors, such as #N/A, are none.

    Args:
        text: Its text.
    """
    stripped = text.lstrip()
    return stripped.startswith(COMMENT) and not stripped.upper().startswith(ERRORS)


def split_at_blanks(line: str) -> list[str]:
    """Return the cells between blanks; those in quotes may hold some.

    Args:
        line: A line of a text.
    """
    return [word.strip('"') for word in _BETWEEN_BLANKS.findall(line)]


def _is_comment(line: _Line) -> bool:
    return is_comment(line.text)


def _take_stated_separator(lines: list[_Line]) -> str | None:
    """Remove the line by which a file tells Excel its separator, and return that."""
    if not lines:
        return None
    match = re.fullmatch(r'"?sep=(.)"?\s*', lines[0].text, re.IGNORECASE)
    if match is None:
        return None
    lines.pop(0)
    return match[1]


def _find_names_in_comment(
    lines: Sequence[_Line], first_row: _Line, separator: str
) -> _Line | None:
    """Return the comment right above numbers if it has as many cells: names, as NumPy writes them."""
    first_cells = _split_line(first_row.text, separator)
    n_numbers = sum(NUMBER.fullmatch(cell.strip()) is not None for cell in first_cells)
    if n_numbers <= len(first_cells) // 2:
        return None
    above = [line for line in lines if line.number == first_row.number - 1]
    if not above or not _is_comment(above[0]):
        return None
    names = above[0].text.lstrip().lstrip(COMMENT).strip()
    if len(_split_line(names, separator)) != len(first_cells):
        return None
    return _Line(number=above[0].number, text=names)


def _split_line(line: str, separator: str) -> list[str]:
    if separator == BLANKS:
        return split_at_blanks(line)
    return next(csv.reader([line], delimiter=separator))


def _split_lines(lines: Sequence[_Line], separator: str) -> list[SheetRow]:
    if separator == BLANKS:
        return [SheetRow(number=line.number, cells=split_at_blanks(line.text)) for line in lines]
    reader = csv.reader((line.text for line in lines), delimiter=separator, strict=True)
    rows: list[SheetRow] = []
    n_lines_before = 0
    try:
        for cells in reader:
            number = lines[n_lines_before].number
            n_lines_before = reader.line_num
            row = SheetRow(number=number, cells=[cell.strip() for cell in cells])
            if any(row.cells):
                rows.append(row)
    except csv.Error as error:
        raise ValueError(f"row {lines[n_lines_before].number}: {error}.") from None
    return rows
