"""Conversion between values and the plain tables of TOML and JSON, based only on field types; it knows no classes.

`decode` is strict: anything unknown or unusable is rejected with the key and the rule. `encode` is
its inverse. A table has the fields of a class as keys, with these short forms:

- a number in rad or rad/s may be given in degrees, under its name with ``_deg`` or ``_deg_s``;
- where several classes are possible (a union, or an `Extensible` base), the key ``kind`` selects
  one; a text in place of the table is that kind with its defaults;
- entries of a list of a class that is `counted` may have a ``count``; keys that the class lists
  under that name may be lists, through which the ``count`` objects cycle.

A class may list the keys of older files in `former`, each with its current place ("" for none), or
provide a function that converts such a table to the current form. Those of version 0.1 are in
``codec.toml``, by class name.
"""

import math
import tomllib
import types
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import MISSING, fields, is_dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, Union, cast, get_args, get_origin, overload

from laticauda.errors import BadArgument, check_choice, show_value, suggest_nearest
from laticauda.extensions import Extensible, Unknown, name_of
from laticauda.quantities import degrees_of, hints_of

Table: TypeAlias = dict[str, Any]
T = TypeVar("T")

FORMAT = 2
"""Format of the files written; increases when their keys change. Version 0.1 wrote none, which counts as current."""
OLDER: Mapping[str, dict[str, str]] = tomllib.loads(
    Path(__file__).with_suffix(".toml").read_text("utf-8")
)
MOST_COUNTED = 1000  # a typing error must not fill the memory


class BadKey(BadArgument):
    """A key of a file that breaks a rule, given as its path from the top level; the reader adds the file's name."""


@contextmanager
def keys_of(file: object, error: type[Exception]) -> Generator[None]:
    """Convert a `BadKey` raised within this context to an error that also names the file.

    Args:
        file: Name of the file in messages.
        error: Class of the new error.
    """
    try:
        yield
    except BadKey as bad:
        key = f"key `{bad.name}`: " if bad.name else ""
        raise error(f"{file}: {key}{bad.rule}") from None


_keeps_unknown = ContextVar("_keeps_unknown", default=False)


@contextmanager
def keeping_unknown() -> Generator[None]:
    """Within this context, keep an unknown `kind` of an `Extensible` base as a stand-in instead of rejecting it."""
    before = _keeps_unknown.set(True)
    try:
        yield
    finally:
        _keeps_unknown.reset(before)


@overload
def decode(hint: type[T], value: object, at: str = "", default: object = ...) -> T: ...
@overload
def decode(hint: Any, value: object, at: str = "", default: object = ...) -> Any: ...
def decode(hint: Any, value: object, at: str = "", default: object = None) -> Any:
    """Convert a value from a file to a field of the given type; its class checks values that are not tables.

    Args:
        hint: The type: a dataclass, or the annotation of one of its fields.
        value: Value as returned by a TOML or JSON reader.
        at: Path to the value in the file, "" for the top level.
        default: Default of the field; a table without `kind` has the kind of this default.

    Raises:
        BadKey: If a key is unknown, missing, of the wrong type or out of range.
    """
    if is_dataclass(value) or isinstance(value, Unknown):
        return value  # already converted
    find = _kinds(hint)
    if find is not None:
        return _member(find, value, at, default, get_origin(hint) or hint)
    if is_dataclass(hint):
        return _object(cast("type[Any]", hint), table_of(value, at), at)
    origin, inner = get_origin(hint), get_args(hint)
    several = next((one for one in (hint, *inner) if get_origin(one) is tuple), None)
    listed: object = value
    if several is not None and isinstance(listed, list):
        kind, things = get_args(several)[0], cast("list[object]", listed)
        if not is_dataclass(kind) and _kinds(kind) is None:  # numbers or texts, or tuples of them
            return tuple(decode(kind, one) for one in things)
    if origin in (types.UnionType, Union):
        holds = [one for one in inner if is_dataclass(one) or _kinds(one) is not None]
        # Where numbers are possible too, only these stand for an object.
        is_table = several is None or any(isinstance(value, kind) for kind in (dict, Mapping, str))
        return decode(holds[0], value, at) if holds and value is not None and is_table else value
    if origin is tuple and (is_dataclass(inner[0]) or _kinds(inner[0]) is not None):
        if not isinstance(value, list | tuple):
            raise BadKey(at, f"must be a list of tables, got {show_value(value)}")
        entries = cast("Sequence[object]", value)
        return tuple(
            one for i, entry in enumerate(entries) for one in _entry(inner[0], entry, f"{at}[{i}]")
        )
    return value


def table_of(value: object, at: str) -> Table:
    """Return `value` as a table if it is one.

    Args:
        value: Value from a file or a call.
        at: Path to it, for the message.

    Raises:
        BadKey: If it is not a table.
    """
    if not isinstance(value, Mapping):
        raise BadKey(at, f"must be a table, got {show_value(value)}")
    return dict(cast("Mapping[str, Any]", value))


def stamped(kind: str, table: Mapping[str, Any]) -> Table:
    """Return a table that starts with the header of a file: its kind and its format.

    Args:
        kind: Kind of the file's content, such as `robot`.
        table: The remaining content.
    """
    return {"kind": kind, "format": FORMAT, **table}


def take_kind(table: Table, *kinds: str) -> str:
    """Remove the header from the table of a file, and return the kind.

    Args:
        table: The whole file; ``kind`` and ``format`` are removed. Without a format, the current
            one is assumed.
        kinds: Accepted kinds.

    Raises:
        BadKey: If it is of another kind, or of a newer format.
    """
    listed = ", ".join(f'"{word}"' for word in kinds)
    rule = f"must be {listed} here" if len(kinds) == 1 else f"must be one of {listed}"
    if "kind" not in table:
        raise BadKey("kind", f"is missing; it {rule}")
    word = table.pop("kind")
    if word not in kinds:
        raise BadKey(
            "kind",
            f"{rule}, got {show_value(word)}{suggest_nearest(word, kinds) if isinstance(word, str) else ''}",
        )
    number = table.pop("format", FORMAT)
    if number not in range(1, FORMAT + 1):
        raise BadKey(
            "format",
            f"must be 1 to {FORMAT}, which this version of laticauda reads, got {show_value(number)}",
        )
    return word


def check_keys(table: Mapping[str, object], allowed: Sequence[str], at: str = "") -> None:
    """Reject keys that are not among the `allowed`, suggesting the nearest one.

    Args:
        table: Table from a file or a call.
        allowed: Known keys.
        at: Path to the table, for the message; "" for the top level.

    Raises:
        BadKey: If there is an unknown key, or `table` is not a table.
    """
    for key in table_of(table, at):
        if key not in allowed:
            hint = suggest_nearest(key, allowed) or f"; the keys here are {', '.join(allowed)}"
            raise BadKey(join(at, key), f"is not known{hint}")


@contextmanager
def arguments_of(at: str) -> Generator[None]:
    """Convert an error about an argument raised within this context to one about a key of the file.

    Args:
        at: Path to the table that holds the keys.
    """
    try:
        yield
    except BadKey:
        raise
    except ValueError as error:
        if not isinstance(error, BadArgument):
            raise BadKey(at, str(error)) from error
        raise BadKey(join(at, error.name), error.rule) from error


def merge_tables(common: Table, own: Table) -> Table:
    """Merge two tables recursively; the second one takes precedence.

    Args:
        common: Values used where the other table has none.
        own: Values that differ.
    """
    found = dict(common)
    for key, value in own.items():
        both = isinstance(value, dict) and isinstance(found.get(key), dict)
        found[key] = merge_tables(found[key], cast("Table", value)) if both else value
    return found


def join(at: str, key: str) -> str:
    """Return the path to a key of the table at `at`.

    Args:
        at: Path to the table; "" for the top level.
        key: One of its keys.
    """
    return f"{at}.{key}" if at else key


def updated(held: T, table: object, at: str = "") -> T:
    """Return a dataclass updated from a table; nested tables update nested values, unless they have another `kind`.

    Args:
        held: The original dataclass.
        table: Keys and values that differ.
        at: Path to the table, for the message.

    Raises:
        BadKey: If a key is unknown, or its value is invalid.
    """
    return _object(type(held), table_of(table, at), at, held)


def _object(kind: type[Any], table: Table, at: str, held: Any = None) -> Any:
    """Create an object of this class; fields missing from the table are taken from `held`, if given."""
    table = with_new_names(kind, table)
    hints, degrees = hints_of(kind), degrees_of(kind)
    check_keys(table, [*hints, *degrees], at)
    in_degrees = {key: one for key, one in table.items() if key in degrees}
    given = {degrees[key] for key in in_degrees}
    values = (
        {} if held is None else {name: getattr(held, name) for name in hints if name not in given}
    )
    for field in fields(kind):
        is_said = field.name in given or field.name in table or field.name in values
        if not is_said and field.default is MISSING and field.default_factory is MISSING:
            raise BadKey(join(at, field.name), f"is missing; every {kind.__name__} needs it")
    for name in (name for name in table if name not in in_degrees):
        if _is_of(table[name], values.get(name)):
            own = {word: one for word, one in table[name].items() if word != "kind"}
            values[name] = updated(values[name], own, join(at, name))
        else:
            default = kind.__dataclass_fields__[name].default
            values[name] = decode(hints[name], table[name], join(at, name), default)
    with arguments_of(at):
        return kind(**values, **in_degrees)


def _is_of(given: Any, held: Any) -> bool:
    """Return whether a table describes the value that is held, rather than one of another kind."""
    if not isinstance(given, Mapping) or not is_dataclass(held):
        return False
    own, table = name_of(cast(type, type(held))), cast("Table", given)
    return table.get("kind", own) == own


def with_new_names(kind: type, table: Table) -> Table:
    """Return a table of an older file with the current keys, for an object of class `kind`.

    Args:
        kind: Class that the table describes; its `former`, if any, defines the changes.
        table: Table as in the file.
    """
    former: Mapping[str, str] | Callable[[Table], Table] = getattr(
        kind, "former", OLDER.get(kind.__name__, {})
    )
    if callable(former):
        return former(table)
    for old in former.keys() & table.keys():
        inner = table = dict(table)
        given = table.pop(old)
        *way, last = former[old].split(".")
        for step in way:
            held = inner.get(step, {})
            inner[step] = {"kind": held} if isinstance(held, str) else dict(held)
            inner = inner[step]
        if last:
            inner.setdefault(last, given)
    return table


def _kinds(hint: Any) -> Callable[[Any], type] | None:
    """Return a function that finds the class named by a table's `kind`; None: the type leaves no choice."""
    base = get_origin(hint) or hint
    if isinstance(base, type) and Extensible in base.__bases__:
        group: type[Extensible] = base
        return lambda word: group.named(word if isinstance(word, str) else show_value(word))
    if get_origin(hint) in (types.UnionType, Union):
        several = {
            name_of(one): one
            for one in get_args(hint)
            if is_dataclass(one) and isinstance(one, type)
        }
        return (
            (lambda word: several[check_choice("kind", word, tuple(several))])
            if len(several) > 1
            else None
        )
    return None


def _member(find: Callable[[Any], type], value: object, at: str, default: object, base: Any) -> Any:
    if value is None:
        return value
    table = {"kind": value} if isinstance(value, str) else table_of(value, at)
    otherwise = name_of(type(default)) if is_dataclass(default) else None
    word = table.pop("kind", otherwise)
    try:
        with arguments_of(at):
            found = find(word)
    except BadKey:
        if _keeps_unknown.get() and isinstance(word, str) and hasattr(base, "stand_in"):
            return cast("type[Extensible]", base).stand_in(word, table)
        raise
    return _object(found, table, at)


def _entry(hint: Any, entry: Any, at: str) -> list[Any]:
    """Return the objects that one entry of a list stands for."""
    cycled: tuple[str, ...] | None = getattr(hint, "counted", None)
    if cycled is None:
        return [decode(hint, entry, at)]
    table = table_of(entry, at)
    key, turns = next(
        ((key, table[key]) for key in cycled if isinstance(table.get(key), list)), ("count", [None])
    )
    count = table.pop("count", len(turns))
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_COUNTED:
        raise BadKey(
            join(at, "count"),
            f"must be a whole number from 1 to {MOST_COUNTED}, got {show_value(count)}",
        )
    if not 1 <= len(turns) <= count:
        rule = f"must be a text or a list of 1 to `count` = {count} texts, got {len(turns)}"
        raise BadKey(join(at, key), rule)
    distinct = [
        decode(hint, table if key == "count" else table | {key: turn}, at) for turn in turns
    ]
    return [distinct[i % len(distinct)] for i in range(count)]


def encode(value: Any, hint: Any = None) -> Any:
    """Return data that `decode` converts back to an equal value.

    Fields that are zero, infinite, empty or absent by default are omitted if they have that value;
    all others are written, so that a file keeps its meaning when a default changes.

    Args:
        value: A dataclass, or the value of one of its fields.
        hint: Its type, if the value alone does not determine what `decode` will be given; None: its
            own class.
    """
    if is_dataclass(value):
        thing: Any = value
        has_kind = _kinds(
            hint
        ) is not None or any(  # also for `X | None`, but in `X | Y` for the matching type
            _kinds(one) is not None and isinstance(value, get_origin(one) or one)
            for one in get_args(hint)
        )
        return {**({"kind": name_of(thing.__class__)} if has_kind else {}), **_table(thing)}
    if isinstance(value, Unknown):
        return value.written
    if isinstance(value, Mapping):
        return {key: encode(one) for key, one in cast("Mapping[str, Any]", value).items()}
    if isinstance(value, tuple | list):
        things = cast("Sequence[Any]", value)
        cycled = getattr(things[0], "counted", None) if things else None
        if cycled is not None:
            return _counted(things, cycled)
        inner = (
            next((one for one in get_args(hint) if one is not Ellipsis), None)
            if hint is not None
            else None
        )
        return [encode(thing, inner) for thing in things]
    return value


def _table(thing: Any) -> Table:
    kind: type[Any] = thing.__class__
    hints, degrees = hints_of(kind), {name: key for key, name in degrees_of(kind).items()}
    table: Table = {}
    for field in fields(kind):
        value = getattr(thing, field.name)
        if value is None or (value == field.default and (not value or value == math.inf)):
            continue  # JSON has no infinity
        name, written = field.name, encode(value, hints[field.name])
        if written == {} and field.default_factory is not MISSING:
            continue
        if (
            name in degrees
            and isinstance(value, float)
            and math.radians(round(math.degrees(value), 9)) == value
        ):
            name, written = (
                degrees[name],
                round(math.degrees(value), 9),
            )  # converts back to exactly the same number
        table[name] = written
    return table


def _counted(things: Sequence[Any], cycled: tuple[str, ...]) -> list[Table]:
    """Return one entry per run of objects that are alike except for the fields that their class lists as cycling."""
    entries: list[Table] = []
    first = {key: getattr(things[0], key) for key in cycled}
    for _, group in groupby(things, key=lambda thing: replace(thing, **first)):
        run = list(group)
        for start in range(0, len(run), MOST_COUNTED):
            part = run[start : start + MOST_COUNTED]
            entry = _table(part[0])
            for key in cycled:
                entry[key] = _shortest_cycle([getattr(thing, key) for thing in part])
            entries.append({"count": len(part), **entry} if len(part) > 1 else entry)
    return entries


def _shortest_cycle(texts: Sequence[str]) -> str | list[str]:
    lengths = range(1, len(texts) + 1)
    length = next(n for n in lengths if all(text == texts[i % n] for i, text in enumerate(texts)))
    return texts[0] if length == 1 else list(texts[:length])
