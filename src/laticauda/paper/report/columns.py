"""Columns of the report's tables: `columns.toml` says what each shows; `build_row` fills them.

There, a column is its title and the path from the object that the row describes to the value that
the column shows, such as "measured.initial_heading deg". After the path stands what the stored
value is turned into, one of `CONVERSIONS`.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any, cast

from laticauda.show.reports import Row
from laticauda.values import read_toml


def build_row(table: str, subject: object) -> Row:
    """Return the columns of `columns.toml` for one row, or a part of it.

    Args:
        table: Name of the table there.
        subject: Object that the row describes; a mapping is read by its keys.
    """
    row: Row = {}
    for title, column in _read_columns()[table].items():
        path, _, conversion = column.partition(" ")
        row[title] = CONVERSIONS[conversion](_follow_path(subject, path))
    return row


@cache
def _read_columns() -> Mapping[str, Mapping[str, str]]:
    return read_toml(Path(__file__).with_name("columns.toml"))


def _follow_path(subject: object, path: str) -> Any:
    """Return what attributes and items lead to; None if one on the way is None."""
    value: Any = subject
    for name in path.split("."):
        if value is None:
            return None
        if isinstance(value, Mapping):
            value = cast("Mapping[str, Any]", value)[name]
        else:
            value = getattr(value, name)
    return value


# ---- conversions ---------------------------------------------------------------------------------


def convert_to_degrees(angle: float) -> float:
    """Convert an angle or a rate to degrees for display; a billionth of a degree is rounding noise.

    Args:
        angle: Angle or rate [rad, or rad/s].

    Returns:
        Angle or rate [deg, or deg/s].
    """
    return round(math.degrees(angle), 9)


def _leave_unchanged(value: Any) -> Any:
    return value


def _degrees_if_known(angle: float | None) -> float | None:
    if angle is None:
        return None
    return convert_to_degrees(angle)


def _percent_if_known(share: float | None) -> float | None:
    if share is None:
        return None
    return 100.0 * share


def _name_in_words(name: str | None) -> str:
    if name is None:
        return ""
    return name.replace("_", " ")


CONVERSIONS: Mapping[str, Callable[[Any], Any]] = {
    "": _leave_unchanged,
    "deg": _degrees_if_known,
    "%": _percent_if_known,
    "words": _name_in_words,
    "count": len,
}
"""What a stored value is turned into, by the word behind the path in `columns.toml`."""
