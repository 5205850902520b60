"""Tables of joint angles over time, with what a person should know about how they were read.

A table has a column of times and one for every yaw joint, in any order:

    time_s,joint_1_deg,joint_2_deg
    0.00,0.0,0.0
    0.05,1.2,-0.4

Joint 1 is the tail-most. The last part of a name is its unit (s, ms, us or ns; deg or rad); it may
stand in brackets, or in a row below the names. Times since 1970 are recognized; whatever the file
counts from, the first row is time 0, unless it is within a step of 0 already. Other columns are ignored.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

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
    split_unit,
)

TIME = re.compile(r"(t|time)(_(s|ms|us|ns))?", re.IGNORECASE)
"""Pattern for the name of the column of times."""
JOINT = re.compile(r"joint_(\d+)(_deg|_rad)?")
"""Pattern for the names of angle columns; 1 is the tail-most joint."""
FORM = "a column `time_s` and columns `joint_1_deg`, `joint_2_deg`, ... starting at the tail"
MOST_LISTED_JOINTS = 3
"""Columns that a remark names at most."""


class RecordedAngles(NamedTuple):
    """Joint angles in a table."""

    time: Float[np.ndarray, " n_times"]
    """Since the first row [s]."""
    angle: Float[np.ndarray, "n_joints n_times"]
    """Tail first [rad]."""


class _JointColumn(NamedTuple):
    """A column with the angles of a joint."""

    number: int
    """Number of the joint; 1 is the tail-most."""
    name: str
    unit: str


def read_angles(path: str | Path) -> RecordedAngles:
    """Read a table of joint angles.

    Args:
        path: Path of the file: text of any usual form, or an Excel workbook.

    Warns:
        TableWarning: If times or angles were not taken as they are written.

    Raises:
        TrialFileError: If the file cannot be read or is invalid.
    """
    sheet = open_sheet(path, TrialFileError)
    with failures_of_table(path, TrialFileError):
        table = build_table(sheet)
        joint_columns = _find_joint_columns(table)
        time_name = _find_time(table)
        if time_name is None or not _are_numbered(joint_columns):
            raise ValueError(f"must have {FORM}, got {', '.join(sheet.names)}")
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
        _warn_of_remarks(path, file_times.remark, start, turned)
    return RecordedAngles(time=time, angle=np.array(angles))


def _find_time(table: Table) -> str | None:
    if "time_s" in table.columns:
        return "time_s"
    names = [name for name in table.columns if TIME.fullmatch(split_unit(name)[0])]
    if len(names) == 1:
        return names[0]
    return None


def _find_start(seconds: Float[np.ndarray, " n_times"]) -> float:
    """Return the time in the file that is time 0: that of the first row, unless it is within a step of 0."""
    first = float(seconds[0])
    usual_step = float(np.median(np.diff(seconds)))
    if 0.0 <= first <= usual_step:
        return 0.0
    return first


def _find_joint_columns(table: Table) -> list[_JointColumn]:
    """Return the columns of joints among all columns, tail first."""
    joint_columns: list[_JointColumn] = []
    for name in table.columns:
        match = JOINT.fullmatch(split_unit(name)[0])
        if match is None:
            continue
        unit = table.unit_of(name) or "rad"
        if unit not in ANGLES:
            raise ValueError(f"column `{name}` must be in deg or rad, but the file says {unit}.")
        joint_columns.append(_JointColumn(number=int(match[1]), name=name, unit=unit))
    return sorted(joint_columns)


def _are_numbered(joint_columns: Sequence[_JointColumn]) -> bool:
    """Return whether there is one column for each joint from the tail on."""
    numbers = [joint_column.number for joint_column in joint_columns]
    return numbers == list(range(1, max(len(numbers), 1) + 1))


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


def _warn_of_remarks(
    path: str | Path, remark_on_time: str, start: float, turned: Sequence[str]
) -> None:
    """Say what was not taken as it is written."""
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
    if remarks:
        warn_caller(f"{path}: {'; '.join(remarks)}", TableWarning)
