"""Tables of joint angles over time, with what a person should know about how they were read.

A table has a column of times and one for every yaw joint, in any order:

    time_s,joint_1_deg,joint_2_deg
    0.00,0.0,0.0
    0.05,1.2,-0.4

Joint 1 is the tail-most. The last part of a name is its unit (s, ms, us or ns; deg or rad); it may
stand in brackets, or in a row below the names. Times since 1970 are recognized; whatever the file
counts from, the first row is time 0, unless it is within a step of 0 already. Other columns are ignored.
Columns that the file calls otherwise are given by name (`laticauda.values.tables.renaming`).
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits.angle_columns import JOINT, TIME, find_columns
from laticauda.values import TableWarning, TrialFileError, warn_caller
from laticauda.values.tables import (
    ANGLES,
    Table,
    build_table,
    check_increasing,
    check_jumps,
    check_sampling,
    check_unit,
    failures_of_table,
    mend_turns,
    open_sheet,
    read_times,
)

MOST_LISTED_JOINTS = 3
"""Columns that a remark names at most."""


class RecordedAngles(NamedTuple):
    """Joint angles in a table."""

    time: Float[np.ndarray, " n_times"]
    """Since the first row [s]."""
    angle: Float[np.ndarray, "n_joints n_times"]
    """Tail first [rad]."""
    reading: str
    """What was read, in one line: rows, span, and what was not taken as it is written."""


def read_angles(path: str | Path, columns: Mapping[str, str] | None = None) -> RecordedAngles:
    """Read a table of joint angles.

    Args:
        path: Path of the file: text of any usual form, or an Excel workbook.
        columns: Names in the file by ours, for columns that it calls otherwise.

    Warns:
        TableWarning: If times or angles were not taken as they are written.

    Raises:
        TrialFileError: If the file cannot be read or is invalid.
    """
    sheet = open_sheet(path, TrialFileError, columns)
    with failures_of_table(path, TrialFileError):
        table = build_table(sheet)
        stated = list(columns or {})
        _check_names(stated)
        time_name, joint_columns = find_columns(table, stated)
        file_times = read_times(table, time_name)
        check_increasing(time_name, file_times.seconds, table.row_numbers)
        if len(file_times.seconds) < 2:
            raise ValueError(f"column `{time_name}` must have at least two times, got one.")
        check_sampling(time_name, file_times.seconds)
        start = _find_start(file_times.seconds)
        time = file_times.seconds - start
        angles: list[Float[np.ndarray, " n_times"]] = []
        turned: list[str] = []
        for joint_column in joint_columns:
            radians = ANGLES[joint_column.unit] * _read_complete(table, joint_column.name)
            mended = mend_turns(radians)
            if mended.n_turns:
                turned.append(joint_column.name)
            if joint_column.unit == "rad":
                check_unit(joint_column.name, mended.radians, "rad")
            check_jumps(joint_column.name, time, mended.radians, table.row_numbers)
            angles.append(mended.radians)
        in_deg = [i for i, column in enumerate(joint_columns) if column.unit == "deg"]
        check_unit("joint_1_deg", np.array(angles)[in_deg], "deg")
        remarks = _list_remarks(file_times.remark, start, turned)
    if remarks:
        warn_caller(f"{path}: {'; '.join(remarks)}", TableWarning)
    rows = f"{time.size} of {table.n_rows} rows, from {time[0]:.6g} to {time[-1]:.6g} s, no gaps"
    reading = "; ".join(
        [f"{Path(path).name}: {rows}", *_list_names(columns), *table.remarks, *remarks]
    )
    return RecordedAngles(time=time, angle=np.array(angles), reading=reading)


def _list_names(columns: Mapping[str, str] | None) -> list[str]:
    """Return what columns are called that have other names in the file."""
    if not columns:
        return []
    pairs = [f"{name} is `{header}`" for name, header in columns.items()]
    return [", ".join(pairs)]


def _check_names(names: Iterable[str]) -> None:
    """Reject names for columns that no table of joint angles has."""
    for name in names:
        joint = name.replace("{}", "1")
        if not TIME.fullmatch(name) and not JOINT.fullmatch(joint):
            raise ValueError(
                f"column `{name}` is not known; name columns time, joint_1, joint_2, ... with or "
                "without a unit, such as joint_1_deg."
            )


def _find_start(seconds: Float[np.ndarray, " n_times"]) -> float:
    """Return the time in the file that is time 0: that of the first row, unless it is within a step of 0."""
    first = float(seconds[0])
    usual_step = float(np.median(np.diff(seconds)))
    if 0.0 <= first <= usual_step:
        return 0.0
    return first


def _read_complete(table: Table, name: str) -> Float[np.ndarray, " n_times"]:
    """Return a column that has a number in every row."""
    values = table[name]
    is_missing = ~np.isfinite(values)
    if np.any(is_missing):
        rows = [table.describe_row(int(i)) for i in np.flatnonzero(is_missing)]
        listed = ", ".join(rows[:MOST_LISTED_JOINTS])
        if len(rows) > MOST_LISTED_JOINTS:
            listed += f" and {len(rows) - MOST_LISTED_JOINTS} more"
        raise ValueError(
            f"column `{name}` must hold a number in every row, but has none in {listed}."
        )
    return values


def _list_remarks(remark_on_time: str, start: float, turned: Sequence[str]) -> list[str]:
    """Return what was not taken as it is written."""
    remarks: list[str] = []
    if remark_on_time:
        remarks.append(remark_on_time)
    elif start != 0.0:
        remarks.append(f"its times begin at {start:.6g} s; time 0 is its first row")
    if turned:
        listed = ", ".join(turned[:MOST_LISTED_JOINTS])
        if len(turned) > MOST_LISTED_JOINTS:
            listed += f" and {len(turned) - MOST_LISTED_JOINTS} more"
        remarks.append(f"whole turns were taken out of {listed}")
    return remarks
