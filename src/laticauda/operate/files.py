"""Trial files and series files: TOML, read strictly.

    kind = "trial"
    name = "line-1"
    robot = "mamba"
    duration = 60.0

    [gait]
    kind = "lateral-undulation"
    amplitude_deg = 30
    frequency_deg_s = 90
    phase_shift_deg = 40

    [following]                    # left out: open loop
    look_ahead_distance = 0.18

Tables and keys are the fields of `Operation` and of what it holds. Units are SI; an angle may be given in degrees under
its name with ``_deg``, an angular rate with ``_deg_s``. A series file has the kind ``series``, the number of `repeats`,
the table ``[common]`` with what all trials share, and a list ``[[trials]]`` of what differs.
"""

import math
import types
import typing
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar, cast

from laticauda.errors import LaticaudaError, finite, instance, nearest, whole
from laticauda.fields import field_docs, split_unit
from laticauda.operate.settings import Operation

T = TypeVar("T")
Table = dict[str, Any]
DEGREES = {"rad": "_deg", "rad/s": "_deg_s"}


class OperationFileError(LaticaudaError, ValueError):
    """A trial or series file is wrong: it says which file, key, rule and value."""


class _BadKey(Exception):
    def __init__(self, key: str, rule: str) -> None:
        super().__init__(key, rule)
        self.key, self.rule = key, rule


@dataclass(frozen=True, kw_only=True)
class SeriesFile:
    """What a series file says."""

    name: str
    """What its folder is called."""
    repeats: int = 1
    """How often every setting is run."""
    retries: int = 1
    """How many rejected runs of a setting are run again."""
    operations: tuple[Operation, ...]
    """The settings, in their order."""

    def __post_init__(self) -> None:
        """Check every field once."""
        instance("name", self.name, str)
        whole("repeats", self.repeats, 1)
        whole("retries", self.retries, 0)
        if not self.operations:
            raise ValueError("`trials` must hold at least one trial, got none.")
        names = [operation.name for operation in self.operations]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"`trials` must have names of their own, got {name!r} twice.")


def load_operation(path: str | Path) -> Operation | SeriesFile:
    """Read a trial or series file.

    Args:
        path: Of the TOML file.

    Returns:
        The `Operation` of a trial file, or the `SeriesFile`.

    Raises:
        OperationFileError: If it cannot be read, or anything in it is wrong; the message has the file, the key, the
            rule and the value.
    """
    return parse_operation(_text(Path(path)), str(path))


def parse_operation(text: str, shown: str = "<text>") -> Operation | SeriesFile:
    """The same from a text.

    Args:
        text: TOML.
        shown: What messages call it.

    Raises:
        OperationFileError: As `load_operation`.
    """
    import tomllib

    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise OperationFileError(f"{shown}: is no TOML: {error}") from None
    try:
        kind = table.pop("kind", None)
        if kind == "trial":
            return _decode(Operation, table, "")
        if kind == "series":
            return _series(table)
        word = "is missing; it must be" if kind is None else f"must not be {kind!r}, but"
        raise _BadKey("kind", f'{word} "trial" or "series"')
    except _BadKey as error:
        raise OperationFileError(f"{shown}: key `{error.key}`: {error.rule}") from None


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise OperationFileError(f"{path}: no such file") from None
    except UnicodeDecodeError:
        raise OperationFileError(f"{path}: is not a text in UTF-8") from None
    except (OSError, ValueError) as error:
        raise OperationFileError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _series(table: Table) -> SeriesFile:
    known = ("name", "repeats", "retries", "common", "trials")
    for key in table:
        if key not in known:
            raise _BadKey(key, f"is not known{nearest(key, known) or '; the keys here are ' + ', '.join(known)}")
    common = _table(table.get("common", {}), "common")
    entries = table.get("trials")
    if not isinstance(entries, list):
        raise _BadKey("trials", "must be a list of tables, `[[trials]]`")
    operations = tuple(
        _decode(Operation, _merged(common, _table(entry, f"trials[{i}]")), f"trials[{i}]")
        for i, entry in enumerate(cast("list[object]", entries))
    )
    rest = {key: table[key] for key in ("name", "repeats", "retries") if key in table}
    if "name" not in rest:
        raise _BadKey("name", "is missing; every series needs it")
    return _made(SeriesFile, {**rest, "operations": operations}, rest, "")


def _merged(common: Table, own: Table) -> Table:
    """What all share, with what one trial has of its own put over it, table by table."""
    merged = dict(common)
    for key, value in own.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = _merged(merged[key], cast("Table", value)) if both else value
    return merged


def _decode(kind: type[T], table: Table, path: str) -> T:
    known: dict[str, Field[Any]] = {field.name: field for field in fields(kind)}  # pyright: ignore
    units = {name: split_unit(doc)[1] for name, doc in field_docs(kind).items()}
    spelled = {name + DEGREES[unit]: name for name, unit in units.items() if unit in DEGREES}
    hints = typing.get_type_hints(kind)
    values: Table = {}
    for key, value in table.items():
        where = f"{path}.{key}" if path else key
        name = spelled.get(key, key)
        if name not in known:
            allowed = [*known, *spelled]
            raise _BadKey(where, f"is not known{nearest(key, allowed) or '; the keys here are ' + ', '.join(allowed)}")
        if name in values:
            raise _BadKey(where, f"must not be given beside `{name}`, which says the same")
        inner = _class_in(hints[name])
        if inner is not None:
            values[name] = _decode(inner, _table(value, where), where)
        else:
            values[name] = _radians(value, where) if key in spelled else _fixed(value)
    for name, field in known.items():
        if field.default is MISSING and field.default_factory is MISSING and name not in values:
            raise _BadKey(f"{path}.{name}" if path else name, f"is missing; every {kind.__name__.lower()} needs it")
    return _made(kind, values, table, path)


def _made(kind: type[T], values: Table, table: Mapping[str, object], path: str) -> T:
    """Make the object, and turn its complaint about an argument into one about a key of the file."""
    import re

    try:
        return kind(**values)
    except ValueError as error:
        found = re.fullmatch(r"`([^`]+)` (.*?)\.?", str(error), re.DOTALL)
        key, rule = found.groups() if found else ("", str(error))
        for suffix in DEGREES.values():
            if key + suffix in table:
                key, rule = key + suffix, f"{rule} ({table[key + suffix]} deg)"
        raise _BadKey(".".join(part for part in (path, key) if part), rule) from None


def _class_in(hint: Any) -> type[Any] | None:
    """The dataclass that a field holds, also where it may be None."""
    if typing.get_origin(hint) is types.UnionType:
        hint = next((part for part in typing.get_args(hint) if is_dataclass(part)), hint)
    return hint if is_dataclass(hint) and isinstance(hint, type) else None


def _fixed(value: object) -> Any:
    """Lists as tuples: what is read does not change any more."""
    return tuple(_fixed(item) for item in cast("list[object]", value)) if isinstance(value, list) else value


def _radians(value: object, where: str) -> float:
    try:
        return math.radians(finite(where, value, "deg"))
    except ValueError as error:
        raise _BadKey(where, str(error).removeprefix(f"`{where}` ").removesuffix(".")) from None


def _table(value: object, where: str) -> Table:
    if not isinstance(value, dict):
        raise _BadKey(where, f"must be a table, got {value!r}")
    return cast("Table", value)
