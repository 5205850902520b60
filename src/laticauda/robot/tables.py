"""Between the dataclasses of this package and the plain tables of a TOML file.

`decode` is strict: what it does not know or cannot use, it refuses with the key and the rule. `encode` is its inverse.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass, replace
from itertools import groupby
from typing import Any, TypeAlias, TypeVar, cast

from laticauda.errors import finite, nearest
from laticauda.robot.effectors import CaudalFin, PectoralFin, Tether, Thruster
from laticauda.robot.joints import Actuator, Joint
from laticauda.robot.modules import Module, Section
from laticauda.robot.robot import Robot

Table: TypeAlias = dict[str, Any]
T = TypeVar("T")

# Where one class holds another: as one table, or as a list of tables.
TABLES: dict[type, dict[str, type]] = {
    Robot: {"caudal_fin": CaudalFin, "tether": Tether},
    Module: {"section": Section},
    CaudalFin: {"joint": Joint},
    Joint: {"actuator": Actuator},
}
LISTS: dict[type, dict[str, type]] = {
    Robot: {"modules": Module, "joints": Joint, "thrusters": Thruster, "pectoral_fins": PectoralFin},
}
COUNTED = (Module, Joint)
ANGLES: dict[type, tuple[str, ...]] = {
    Joint: ("limit",),
    Thruster: ("angle",),
    PectoralFin: ("angle", "stall_angle"),
}
MOST_COUNTED = 1000  # a slip of the finger must not fill the memory


class BadKey(Exception):
    """A key of a file that breaks a rule; the reader of the file says which file."""

    def __init__(self, key: str, rule: str) -> None:
        super().__init__(key, rule)
        self.key = key
        self.rule = rule


def decode(kind: type[T], table: object, path: str = "") -> T:
    """Make an object of class `kind` from a table.

    Args:
        kind: One of this package's dataclasses.
        table: Its fields by name, as TOML gives them.
        path: Where the table stands in the file, "" for the top.

    Raises:
        BadKey: If a key is unknown, missing, of the wrong type or out of range.
    """
    entries = _table(table, path)
    known = {field.name: field for field in fields(kind)}  # pyright: ignore[reportArgumentType]
    angles = ANGLES.get(kind, ())
    _check_keys(kind, entries, known, angles, path)
    values: Table = {}
    for key, value in entries.items():
        where = _join(path, key)
        if key in TABLES.get(kind, {}):
            values[key] = decode(TABLES[kind][key], value, where)
        elif key in LISTS.get(kind, {}):
            values[key] = _decode_list(LISTS[kind][key], value, where)
        elif key not in known:  # the only other spelling is an angle in degrees
            values[key.removesuffix("_deg")] = _radians(value, where)
        else:
            values[key] = value
    return _make(kind, values, entries, path)


def _check_keys(kind: type, entries: Table, known: Mapping[str, Field[Any]], angles: Sequence[str], path: str) -> None:
    """Refuse unknown keys, angles given twice, and missing keys."""
    allowed = [*known, *(f"{name}_deg" for name in angles)]
    for key in entries:
        if key not in allowed:
            hint = nearest(key, allowed) or f"; the keys here are {', '.join(allowed)}"
            raise BadKey(_join(path, key), f"is not known{hint}")
    for name in angles:
        if name in entries and f"{name}_deg" in entries:
            raise BadKey(_join(path, f"{name}_deg"), f"must not be given beside `{name}`, which says the same in rad")
    for name, field in known.items():
        needed = field.default is MISSING and field.default_factory is MISSING
        if needed and name not in entries and not (name in angles and f"{name}_deg" in entries):
            raise BadKey(_join(path, name), f"is missing; every {kind.__name__} needs it")


def _make(kind: type[T], values: Table, entries: Table, path: str) -> T:
    """Call the class, and turn its complaint about an argument into one about a key of the file."""
    try:
        return kind(**values)
    except ValueError as error:
        found = re.fullmatch(r"`([^`]+)` (.*?)\.?", str(error), re.DOTALL)
        if found is None:
            raise BadKey(path, str(error)) from error
        key, rule = found.groups()
        if f"{key}_deg" in entries:
            key, rule = f"{key}_deg", f"{rule} ({entries[f'{key}_deg']} deg)"
        raise BadKey(_join(path, key), rule) from error


def _decode_list(kind: type, value: object, path: str) -> tuple[Any, ...]:
    entries = _list(value)
    if entries is None:
        raise BadKey(path, f"must be a list of tables, got {_shown(value)}")
    found: list[Any] = []
    for i, entry in enumerate(entries):
        where = f"{path}[{i}]"
        if kind in COUNTED:
            found.extend(_decode_counted(kind, _table(entry, where), where))
        else:
            found.append(decode(kind, entry, where))
    return tuple(found)


def _decode_counted(kind: type, entry: Table, path: str) -> list[Any]:
    """The objects that one entry with a `count`, and perhaps a list of axes, stands for."""
    entry = dict(entry)
    axes = _list(entry.get("axis")) if kind is Joint else None
    count: Any = entry.pop("count", 1 if axes is None else len(axes))
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_COUNTED:
        raise BadKey(_join(path, "count"), f"must be a whole number from 1 to {MOST_COUNTED}, got {_shown(count)}")
    if axes is None:
        return [decode(kind, entry, path)] * count
    if not 1 <= len(axes) <= count:
        raise BadKey(_join(path, "axis"), f"must be a text or a list of 1 to `count` = {count} texts, got {len(axes)}")
    distinct: list[Any] = [decode(kind, {**entry, "axis": axis}, path) for axis in axes]
    return [distinct[i % len(distinct)] for i in range(count)]


def _radians(value: object, path: str) -> float:
    try:
        return math.radians(finite(path, value, "deg"))
    except ValueError as error:
        raise BadKey(path, str(error).removeprefix(f"`{path}` ").removesuffix(".")) from error


def _list(value: object) -> list[Any] | None:
    return cast("list[Any]", value) if isinstance(value, list) else None


def _table(value: object, path: str) -> Table:
    if not isinstance(value, dict):
        raise BadKey(path, f"must be a table, got {_shown(value)}")
    return cast("Table", value)


def _join(path: str, key: str) -> str:
    return f"{path}.{key}" if path else key


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def encode(thing: object) -> Table:
    """The table that `decode` turns back into an equal object.

    Fields that are zero, empty or absent by default are left out where they are so; all others are written, so that a
    file keeps its meaning when a default changes.
    """
    if not is_dataclass(thing) or isinstance(thing, type):
        raise TypeError(f"only dataclasses can be encoded, got {type(thing).__name__}.")
    angles = ANGLES.get(type(thing), ())
    table: Table = {}
    for field in fields(thing):
        value: Any = getattr(thing, field.name)
        if value == Tether() or (value == field.default and not value):
            continue
        if field.name in angles:
            _put_angle(table, field.name, value)
        elif field.name in LISTS.get(type(thing), {}):
            table[field.name] = _encode_list(value)
        elif is_dataclass(value):
            table[field.name] = encode(value)
        else:
            table[field.name] = list(value) if isinstance(value, tuple) else value  # pyright: ignore[reportUnknownArgumentType]
    return table


def _put_angle(table: Table, name: str, angle: float) -> None:
    """Write an angle in degrees if that is the very same number, else in radians."""
    degrees = round(math.degrees(angle), 9)
    if math.radians(degrees) == angle:
        table[f"{name}_deg"] = degrees
    else:
        table[name] = angle


def _encode_list(things: Sequence[Any]) -> list[Table]:
    """One entry per thing, or per run of like things where the class is counted."""
    if not isinstance(things[0], COUNTED):
        return [encode(thing) for thing in things]
    entries: list[Table] = []
    for _, group in groupby(things, key=_without_axis):
        run = list(group)
        for start in range(0, len(run), MOST_COUNTED):
            entries.append(_encode_run(run[start : start + MOST_COUNTED]))
    return entries


def _without_axis(thing: Any) -> Any:
    return replace(thing, axis="yaw") if isinstance(thing, Joint) else thing


def _encode_run(run: Sequence[Any]) -> Table:
    """The entry for things that differ in their axes at most."""
    entry = encode(run[0])
    if isinstance(run[0], Joint):
        entry["axis"] = _shortest_cycle([joint.axis for joint in run])
    return {"count": len(run), **entry} if len(run) > 1 else entry


def _shortest_cycle(axes: Sequence[str]) -> str | list[str]:
    for length in range(1, len(axes)):
        if all(axis == axes[i % length] for i, axis in enumerate(axes)):
            return axes[0] if length == 1 else list(axes[:length])
    return axes[0] if len(axes) == 1 else list(axes)
