"""Times of rows: their unit, clocks that count from 1970, and that they increase."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from laticauda.values.errors import BadArgument
from laticauda.values.tables.columns import Samples, Table
from laticauda.values.tables.units import TIMES, split_unit, unit_in_name, unknown_unit

SLOWEST_SAMPLING = 1.0
"""Longest usual step between samples [s]; anything longer is in another unit."""
EARLIEST_DATE = 6.3e8
"""The end of 1989: times since 1970 below this are those of no log [s]."""
LATEST_DATE = 4.1e9
"""The end of 2099, likewise [s]."""
UNITS_OF_NOTE = ("ms", "us", "ns")
"""Units that times are often in without saying so, the longest first."""


class FileTimes(NamedTuple):
    """Times of all rows of a file."""

    seconds: Samples
    """As the file counts them [s]."""
    remark: str
    """How they were recognized, if they do not simply count seconds; else ""."""


def read_times(table: Table, name: str, stated_unit: str | None = None) -> FileTimes:
    """Return the times in a column, in s.

    Their unit is the stated one, or that in the name of the column. Times since 1970 are so large
    that their unit shows: they are recognized if no unit is stated, or the stated one cannot be
    right.

    Args:
        table: The table.
        name: Name of the column.
        stated_unit: Unit that somebody who knows the file states.

    Raises:
        ValueError: If a time is missing, or they do not increase strictly.
    """
    times = table[name]
    _check_complete(table, name, times)
    unit_in_file = table.unit_of(name) or unknown_unit(name)
    if unit_in_file not in TIMES:
        if stated_unit is None and unit_in_file is not None and not _is_guess(name, unit_in_file):
            units = ", ".join(TIMES)
            raise BadArgument(name, f"must be in {units}, but the file says {unit_in_file}")
        unit_in_file = None
    unit = stated_unit or unit_in_file
    if table.find(name) in table.clocks:
        unit = stated_unit = "s"
    unit_by_size = _recognize_date(times)
    if stated_unit is None and unit_by_size is not None and not _is_possible(times, unit):
        unit = unit_by_size
    seconds = TIMES[unit or "s"] * times
    remark = ""
    if unit == unit_by_size and unit is not None:
        remark = f"`{name}` counts {unit} since 1970; time 0 is its first row"
    return FileTimes(seconds=seconds, remark=remark)


def _is_guess(name: str, unit: str) -> bool:
    """Return whether a unit is only the end of a name, as in `t_m`."""
    return split_unit(name)[1] is None and unit == unit_in_name(name)


def _recognize_date(times: Samples) -> str | None:
    """Return the unit in which all times would be moments between 1990 and 2100."""
    if not times.size:
        return None
    for unit, factor in TIMES.items():
        if factor * times.min() > EARLIEST_DATE and factor * times.max() < LATEST_DATE:
            return unit
    return None


def _is_possible(times: Samples, unit: str | None) -> bool:
    """Return whether times in a unit are moments of a run or since 1970; those without a unit may be anything."""
    if unit is None:
        return False
    return float(TIMES[unit] * times.max()) < LATEST_DATE


def _check_complete(table: Table, name: str, times: Samples) -> None:
    is_finite = np.isfinite(times)
    if not np.all(is_finite):
        row = table.describe_row(int(np.argmin(is_finite)))
        raise BadArgument(name, f"must hold numbers, but has none in {row}")


def check_increasing(name: str, seconds: Samples, row_numbers: Sequence[int] = ()) -> None:
    """Reject times that do not increase strictly.

    Args:
        name: Name of the column of times.
        seconds: Times of the rows [s].
        row_numbers: Numbers of these rows in the file, for the message.

    Raises:
        ValueError: If they do not.
    """
    increases = np.diff(seconds) > 0.0
    if np.all(increases):
        return
    i = int(np.argmin(increases))
    rule = f"must increase strictly, got {seconds[i]} s and then {seconds[i + 1]} s"
    if len(row_numbers):
        rule += f" in row {row_numbers[i + 1]}"
    raise BadArgument(name, rule)


def check_sampling(name: str, seconds: Samples) -> None:
    """Reject times whose steps are too long for samples of a motion, mostly because of their unit.

    Args:
        name: Name of the times.
        seconds: Times of the rows [s], increasing.

    Raises:
        ValueError: If the usual step is too long; the message names the unit that was probably meant.
    """
    usual_step = float(np.median(np.diff(seconds)))
    if usual_step <= SLOWEST_SAMPLING:
        return
    rule = f"must have steps of at most {SLOWEST_SAMPLING:g} s, got {usual_step:g} s"
    for unit in UNITS_OF_NOTE:
        if TIMES[unit] * usual_step <= SLOWEST_SAMPLING:
            rule += f"; is its unit {unit}?"
            break
    raise BadArgument(name, rule)
