"""Columns of a table of joint angles: which hold times, and which the angles of which joint.

In a table with names of its own, they are guessed, for the message that asks for them.
"""

import re
from collections import defaultdict
from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from laticauda.values.tables import (
    ANGLES,
    LARGEST_BEND,
    Table,
    list_names,
    spell_columns,
    split_unit,
    unknown_unit,
)

TIME = re.compile(r"(t|time)(_(s|ms|us|ns))?", re.IGNORECASE)
"""Pattern for the name of the column of times."""
JOINT = re.compile(r"joint_(\d+)(_deg|_rad)?")
"""Pattern for the names of angle columns; 1 is the tail-most joint."""
FORM = "a column `time_s` and columns `joint_1_deg`, `joint_2_deg`, ... starting at the tail"
WORDS_OF_TIME = frozenset(
    "clock date datetime elapsed ms ns sec secs seconds stamp t temps tempo tiempo time timestamp us zeit".split()
)
"""Words in the names of columns that hold times, in lower case."""
_WORD = re.compile(r"[a-z]+|[A-Z][a-z]*")
_NUMBERED = re.compile(r"(.*?)(\d+)(\D*)")


class JointColumn(NamedTuple):
    """A column with the angles of a joint."""

    number: int
    """Number of the joint; 1 is the tail-most."""
    name: str
    unit: str


class AngleColumns(NamedTuple):
    """The columns of a table of joint angles."""

    time: str
    """Name of the column of times."""
    joints: Sequence[JointColumn]
    """Columns of the joints, tail first."""


def find_columns(table: Table, stated: Collection[str]) -> AngleColumns:
    """Return the columns of times and of joints.

    Args:
        table: The table.
        stated: Names of columns that a person says they have.

    Raises:
        ValueError: If they are not there; the message says how to name those that are.
    """
    joints = _find_joints(table)
    time = _find_time(table, stated)
    if time is None or not _are_numbered(joints):
        names = list_names(list(table.columns))
        raise ValueError(f"must have {FORM}, got {names}{_advise(table)}")
    return AngleColumns(time=time, joints=joints)


def _find_time(table: Table, stated: Collection[str] = ()) -> str | None:
    for name in (*stated, "time_s"):
        if name in table.columns and TIME.fullmatch(name):
            return name
    names = [name for name in table.columns if TIME.fullmatch(split_unit(name)[0])]
    if len(names) == 1:
        return names[0]
    return None


def _find_joints(table: Table) -> list[JointColumn]:
    """Return the columns of joints among all columns, tail first."""
    joints: list[JointColumn] = []
    for name in table.columns:
        match = JOINT.fullmatch(split_unit(name)[0])
        if match is None:
            continue
        unit = table.unit_of(name) or unknown_unit(name) or "rad"
        if unit not in ANGLES:
            raise ValueError(f"column `{name}` must be in deg or rad, but the file says {unit}.")
        joints.append(JointColumn(number=int(match[1]), name=name, unit=unit))
    return sorted(joints)


def _are_numbered(joints: Sequence[JointColumn]) -> bool:
    """Return whether there is one column for each joint from the tail on."""
    numbers = [joint.number for joint in joints]
    return numbers == list(range(1, max(len(numbers), 1) + 1))


# ---- names of the file's own ---------------------------------------------------------------------


def _advise(table: Table) -> str:
    """Return the end of a message: how to say which columns are which, if that can be guessed."""
    columns = _guess_columns(table)
    if not columns:
        return ""
    return f"; say which are which, such as --column {spell_columns(columns)}"


def _guess_columns(table: Table) -> dict[str, str]:
    """Return the probable names in the file by ours; {} if there are none."""
    names = [name for name, column in table.columns.items() if not isinstance(column, str)]
    time = _find_time(table) or _guess_time(table, names)
    if time is None:
        return {}
    names.remove(time)
    header = _largest_group(names)
    if header is None:
        return {}
    columns: dict[str, str] = {}
    if TIME.fullmatch(split_unit(time)[0]) is None:
        columns["time"] = time
    columns["joint_{}" + _guess_ending(table, header)] = header
    return columns


def _guess_time(table: Table, names: Sequence[str]) -> str | None:
    for name in names:
        words_of_name = {word.lower() for word in _WORD.findall(split_unit(name)[0])}
        if words_of_name & WORDS_OF_TIME:
            return name
    for name in names:
        if table[name].size > 1 and np.all(np.diff(table[name]) > 0.0):
            return name
    return None


def _largest_group(names: Sequence[str]) -> str | None:
    """Return what most names have in common, with {} for their number; None if none has one."""
    groups: dict[str, list[str]] = defaultdict(list)
    for name in names:
        match = _NUMBERED.fullmatch(split_unit(name)[0])
        if match is not None:
            groups[f"{match[1]}{{}}{match[3]}"].append(name)
    return max(groups, key=lambda header: len(groups[header]), default=None)


def _guess_ending(table: Table, header: str) -> str:
    """Return the unit at the end of our names, if the file states none."""
    prefix, suffix = header.split("{}")
    largest = 0.0
    for name in table.columns:
        if name.startswith(prefix) and split_unit(name)[0].endswith(suffix):
            if table.unit_of(name) is not None:
                return ""
            column = table.columns[name]
            if not isinstance(column, str) and column.size:
                largest = max(largest, float(np.nanmax(np.abs(column))))
    if largest > LARGEST_BEND:
        return "_deg"
    return "_rad"
