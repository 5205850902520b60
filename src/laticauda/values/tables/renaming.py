"""Columns of a table under our names, where the file calls them otherwise, and how that is typed.

Pairs of names may stand for numbered columns: `joint_{}` = `Phi {}`, where the first number in the
file, 0 or 1, becomes 1.
"""

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, cast

from laticauda.values.checks import show_value, suggest_nearest
from laticauda.values.errors import BadArgument
from laticauda.values.tables.sheets import Sheet
from laticauda.values.tables.units import LENGTHS, TIMES, split_unit, unit_in_name, unknown_unit

NUMBER = "{}"
"""Stands for a number in both names of a pair."""
N_LISTED_COLUMNS = 12
"""Names of columns that a message lists at most."""
FORM = 'NAME=HEADER, such as time="t [s]"'


class _Pair(NamedTuple):
    """A column by our name, and by the file's."""

    name: str
    header: str


def parse_columns(words: Sequence[str]) -> dict[str, str]:
    """Return the names of columns in a file by ours, from words NAME=HEADER.

    Args:
        words: What was typed.

    Raises:
        ValueError: If a word has another form, or gives a name twice.
    """
    columns: dict[str, str] = {}
    for word in words:
        name, _, header = word.partition("=")
        name = name.strip()
        if not name or not header.strip():
            raise BadArgument("column", f"must be {FORM}, got {word!r}")
        if name in columns:
            raise BadArgument("column", f"must give `{name}` once, got {word!r}, too")
        columns[name] = header.strip()
    return columns


def check_columns(name: str, columns: object) -> dict[str, str]:
    """Return names of columns in a file by ours, as a file of ours states them.

    Args:
        name: Name of the key.
        columns: What stands there.

    Raises:
        ValueError: If it is not a table of texts.
    """
    if not isinstance(columns, Mapping):
        raise BadArgument(name, f"must be a table of names of columns, got {show_value(columns)}")
    table = cast("Mapping[str, object]", columns)
    for header in table.values():
        if not isinstance(header, str):
            raise BadArgument(name, f"must hold names of columns, got {show_value(header)}")
    return cast("dict[str, str]", dict(table))


def spell_columns(columns: Mapping[str, str]) -> str:
    """Return how columns are typed behind `--column`.

    Args:
        columns: Names in the file by ours.
    """
    return " ".join(shlex.quote(f"{name}={header}") for name, header in columns.items())


def rename_columns(sheet: Sheet, columns: Mapping[str, str]) -> Sheet:
    """Return a sheet with our names.

    Args:
        sheet: The sheet.
        columns: Names in the file by ours; the file's may lack the unit in brackets.

    Raises:
        ValueError: If the file has no such column, names would stand for two columns, or the unit
            in our name is not that of the file.
    """
    if not columns:
        return sheet
    names_by_header = _expand(sheet.names, columns)
    headers: dict[str, str] = {}
    units: dict[str, str] = {}
    for header in sheet.names:
        name = names_by_header.get(header, header)
        if name in headers:
            raise ValueError(f"`{name}` would be two columns, `{headers[name]}` and `{header}`.")
        headers[name] = header
        unit = sheet.units.get(header)
        if header in names_by_header:
            unit = _unit_of_pair(_Pair(name, header), unit)
        if unit is not None:
            units[name] = unit
    names = list(headers)
    return replace(sheet, names=names, units=units)


def _unit_of_pair(pair: _Pair, unit_in_file: str | None) -> str | None:
    """Return the unit of a column: that in our name, unless the file states another one.

    Raises:
        ValueError: If it does.
    """
    unit = unit_in_name(pair.name)
    unknown = unknown_unit(pair.header)
    if unknown is not None:
        raise ValueError(f"column `{pair.header}` is in {unknown}, which is no unit known here.")
    if unit is None or unit_in_file is None or unit == unit_in_file:
        return unit or unit_in_file
    # The last letter of a name, as in `v_m`, need not be a unit.
    is_guess = unit_in_file == pair.header[-1:]
    if is_guess and not _are_of_one_kind(unit, unit_in_file):
        return unit
    raise ValueError(
        f"column `{pair.header}` is in {unit_in_file}, but `{pair.name}` in {unit}: convert it, "
        "or correct the unit."
    )


def _are_of_one_kind(unit: str, other: str) -> bool:
    return any(unit in units and other in units for units in (LENGTHS, TIMES))


def _expand(names_in_file: Sequence[str], columns: Mapping[str, str]) -> dict[str, str]:
    """Return our names by those in the file: no column has two, and none stands for several."""
    pairs: list[_Pair] = []
    for name, header in columns.items():
        if NUMBER in name or NUMBER in header:
            pairs += _number_pairs(names_in_file, _Pair(name, header))
        else:
            pairs.append(_Pair(name, header))
    names_by_header: dict[str, str] = {}
    for pair in pairs:
        header = _find_header(names_in_file, pair)
        if header in names_by_header:
            first = names_by_header[header]
            raise ValueError(
                f"column `{header}` must have one name, got `{first}` and `{pair.name}`."
            )
        names_by_header[header] = pair.name
    return names_by_header


def _number_pairs(names_in_file: Sequence[str], pair: _Pair) -> list[_Pair]:
    """Return a pair for every number in the file; the first is 1."""
    if pair.name.count(NUMBER) != 1 or pair.header.count(NUMBER) != 1:
        raise ValueError(f"`{pair.name}` and `{pair.header}` must both hold {NUMBER}, once.")
    prefix, suffix = pair.header.split(NUMBER)
    pattern = re.compile(rf"{re.escape(prefix)}(\d+){re.escape(suffix)}")
    headers: dict[int, str] = {}
    for header in names_in_file:
        match = pattern.fullmatch(header) or pattern.fullmatch(split_unit(header)[0])
        if match is not None:
            number = int(match[1])
            if number in headers:
                raise ValueError(f"`{headers[number]}` and `{header}` have the same number.")
            headers[number] = header
    numbers = sorted(headers)
    if not numbers:
        raise ValueError(_describe_missing(names_in_file, pair))
    first = numbers[0]
    if first > 1 or numbers != list(range(first, first + len(numbers))):
        listed = ", ".join(headers[number] for number in numbers)
        raise ValueError(
            f"`{pair.header}` must count from 0 or 1 without a gap, got {listed}: name each of them."
        )
    return [
        _Pair(pair.name.replace(NUMBER, str(number - first + 1)), headers[number])
        for number in numbers
    ]


def _find_header(names_in_file: Sequence[str], pair: _Pair) -> str:
    """Return the name in the file, with its unit in brackets if there is one."""
    if pair.header in names_in_file:
        return pair.header
    matches = [name for name in names_in_file if split_unit(name)[0] == pair.header]
    if len(matches) != 1:
        raise ValueError(_describe_missing(names_in_file, pair))
    return matches[0]


def _describe_missing(names_in_file: Sequence[str], pair: _Pair) -> str:
    suggestion = suggest_nearest(pair.header, names_in_file).rstrip(".")
    return (
        f"the file has no column `{pair.header}` for `{pair.name}`{suggestion}; "
        f"it has {list_names(names_in_file)}."
    )


def list_names(names: Sequence[str]) -> str:
    """Return names for a message, not too many of them.

    Args:
        names: Names of the columns of a file.
    """
    listed = ", ".join(names[:N_LISTED_COLUMNS])
    n_not_listed = len(names) - N_LISTED_COLUMNS
    if n_not_listed > 0:
        listed += f" and {n_not_listed} more"
    return listed
