"""Column maps: small TOML files that say what the columns of somebody's log are.

    kind = "columns"
    robot = "mamba-fin"
    start = 2.0                        # the part of the log that is the trial [s]
    stop = 32.0

    [gait]
    kind = "lateral-undulation"
    amplitude_deg = 30
    frequency_deg_s = 130
    phase_shift_deg = 40

    [body]                             # what motion capture followed
    position = ["tail x", "tail y"]
    length_unit = "mm"
    yaw = "tail yaw"
    angle_unit = "deg"

    [joint_angle]
    columns = "phi {}"                 # phi 0 is the tail-most joint
    unit = "deg"

They are read strictly: what is unknown, missing or out of range is refused with its key.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from laticauda.codec import BadKey, decode
from laticauda.errors import LaticaudaError, TrialFileError
from laticauda.gaits import Gait
from laticauda.logs.column_maps import SECTIONS, ColumnMap
from laticauda.robot import Ground, Water, load_ground, load_robot, load_water

KIND = "columns"


def load_column_map(path: str | Path) -> ColumnMap:
    """Load a column map.

    Args:
        path: Of the TOML file; presets and files that it names are found as `load_robot` finds them.

    Raises:
        TrialFileError: If there is no such file, or anything in it is wrong; the message has the file, the key, the
            rule and the value.
    """
    path = Path(path)
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise TrialFileError(f"Cannot read {path}: {(error.strerror or str(error)).lower()}.") from error
    except ValueError as error:  # no TOML, or no UTF-8
        raise TrialFileError(f"{path}: {error}") from error
    try:
        return _column_map(table, path.parent)
    except BadKey as error:
        raise TrialFileError(f"{path}: key `{error.key}`: {error.rule}") from None


def _column_map(table: dict[str, Any], folder: Path) -> ColumnMap:
    if table.pop("kind", None) != KIND:
        raise BadKey("kind", f'must be "{KIND}" here')
    if "robot" not in table:
        raise BadKey("robot", "is missing; every column map needs it")
    values: dict[str, Any] = {
        name: decode(kind, table.pop(name), name) for name, kind in SECTIONS.items() if name in table
    }
    gait = _gait(table.pop("gait")) if "gait" in table else None
    values |= {
        "gait": gait,
        "robot": _loaded("robot", load_robot, table.pop("robot"), folder),
        "environment": _environment(table, gait, folder),
    }
    known = {one.name for one in fields(ColumnMap)} | {"water", "ground"}
    for key in table:
        if key not in known:
            raise BadKey(key, f"is not known; the keys here are {', '.join(sorted(known))}")
    signals = table.get("signals", {})
    if not isinstance(signals, dict) or not all(isinstance(one, str) for one in signals.values()):  # pyright: ignore
        raise BadKey("signals", f"must be a table of names of columns, got {signals!r}")
    return _checked({**table, **values})


def _checked(values: Mapping[str, Any]) -> ColumnMap:
    """The map of these values; what is wrong with them is said of their key."""
    try:
        return ColumnMap(**values)
    except ValueError as error:
        key, _, rule = str(error).removeprefix("`").partition("` ")
        raise BadKey(key, rule.removesuffix(".")) from error


def _gait(table: Any) -> Gait:
    words = decode(_GaitWords, table, "gait")
    try:
        return Gait(
            kind=words.kind,
            amplitude=math.radians(words.amplitude_deg),
            frequency=math.radians(words.frequency_deg_s),
            phase_shift=math.radians(words.phase_shift_deg),
            offset=math.radians(words.offset_deg),
            envelope=None if words.envelope is None else tuple(words.envelope),
        )
    except (ValueError, TypeError) as error:
        raise BadKey("gait", str(error).removesuffix(".")) from error


@dataclass(frozen=True, kw_only=True)
class _GaitWords:
    kind: str
    amplitude_deg: float
    frequency_deg_s: float
    phase_shift_deg: float
    offset_deg: float = 0.0
    envelope: Sequence[float] | None = None


def _environment(table: dict[str, Any], gait: Gait | None, folder: Path) -> Water | Ground:
    """What the file names, or the paper's water for the gait."""
    if "ground" in table:
        if "water" in table:
            raise BadKey("ground", "must not be given beside `water`")
        return _loaded("ground", load_ground, table.pop("ground"), folder)
    standard = "paper-eel" if gait is not None and gait.kind == "eel_like" else "paper-lateral"
    return _loaded("water", load_water, table.pop("water", standard), folder)


def _loaded(key: str, load: Any, name: Any, folder: Path) -> Any:
    if not isinstance(name, str):
        raise BadKey(key, f"must be the name of a preset or a path, got {name!r}")
    beside = folder / name
    try:
        return load(beside if name.endswith(".toml") and beside.is_file() else name)
    except LaticaudaError as error:
        raise BadKey(key, str(error)) from error
