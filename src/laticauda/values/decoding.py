"""From plain tables to values, based only on the types of their fields.

Everywhere here, `at` is the path from the top level of the file to what is decoded, "" for the top
level itself: errors name it.
"""

from collections.abc import Container, Generator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, is_dataclass
from typing import Any, TypeVar, cast, overload

from laticauda.values.annotations import Annotation, TupleAnnotation, is_tuple
from laticauda.values.checks import show_value
from laticauda.values.class_choice import ClassChoice, class_choice_of, class_of, is_of_objects
from laticauda.values.extensions import Extensible, Unknown, name_of
from laticauda.values.file_tables import BadKey, Table, arguments_of, check_keys, path_to, table_of
from laticauda.values.former_keys import with_new_names
from laticauda.values.quantities import Field, display_names_of, fields_of

T = TypeVar("T")

MOST_COUNTED = 1000
"""Largest `count` of an entry: a typing error must not fill the memory."""

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
    choice = class_choice_of(hint)
    if choice is not None:
        return _decode_chosen(hint, choice, value, at, default)
    if is_dataclass(hint):
        return _decode_object(cast("type[Any]", hint), table_of(value, at), at)
    annotation = Annotation.of(hint)
    if annotation.tuples and _is_list(value):
        item = annotation.tuples[0].item
        if not is_of_objects(item):  # numbers or texts, or tuples of them
            return tuple(decode(item, entry) for entry in cast("list[object]", value))
    if annotation.is_union:
        return _decode_one_of(annotation, value, at)
    if is_tuple(hint):
        return _decode_entries(TupleAnnotation.of(hint), value, at)
    return value


def _is_list(value: object) -> bool:
    return isinstance(value, list)


def _may_state_object(value: object) -> bool:
    return isinstance(value, Mapping | str)


def _decode_one_of(annotation: Annotation, value: Any, at: str) -> Any:
    """Decode a value that may be an object, or None, or numbers."""
    of_objects = [kind for kind in annotation.members if is_of_objects(kind)]
    if not of_objects or value is None:
        return value
    if annotation.tuples and not _may_state_object(value):  # but numbers
        return value
    return decode(of_objects[0], value, at)


def _decode_entries(annotation: TupleAnnotation, value: Any, at: str) -> Any:
    """Decode a list of tables; anything but objects is left to the check of the field."""
    if not is_of_objects(annotation.item):
        return value
    if not isinstance(value, list | tuple):
        raise BadKey(at, f"must be a list of tables, got {show_value(value)}")
    objects: list[Any] = []
    for i, entry in enumerate(cast("Sequence[object]", value)):
        objects += _decode_entry(annotation.item, entry, f"{at}[{i}]")
    return tuple(objects)


def _decode_entry(hint: Any, entry: object, at: str) -> list[Any]:
    """Return the objects that one entry of a list stands for."""
    cycling_keys: tuple[str, ...] | None = getattr(hint, "counted", None)
    if cycling_keys is None:
        return [decode(hint, entry, at)]
    run = _CountedEntry.of(table_of(entry, at), cycling_keys, at)
    objects = [decode(hint, table, at) for table in run.tables]
    return [objects[i % len(objects)] for i in range(run.count)]


@dataclass(frozen=True)
class _CountedEntry:
    """An entry of a list that stands for `count` objects, which cycle through some tables."""

    count: int
    tables: Sequence[Table]

    @classmethod
    def of(cls, table: Table, cycling_keys: Sequence[str], at: str) -> "_CountedEntry":
        for key in cycling_keys:
            if isinstance(table.get(key), list):
                return cls._of_cycle(table, key, at)
        count = _check_count(table.pop("count", 1), at)
        return cls(count, [table])

    @classmethod
    def _of_cycle(cls, table: Table, key: str, at: str) -> "_CountedEntry":
        """Return an entry of which one key is a list of texts, through which the objects cycle."""
        texts: list[object] = table[key]
        count = _check_count(table.pop("count", len(texts)), at)
        if not 1 <= len(texts) <= count:
            rule = f"must be a text or a list of 1 to `count` = {count} texts"
            raise BadKey(path_to(at, key), f"{rule}, got {len(texts)}")
        return cls(count, [table | {key: text} for text in texts])


def _check_count(count: object, at: str) -> int:
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_COUNTED:
        rule = f"must be a whole number from 1 to {MOST_COUNTED}"
        raise BadKey(path_to(at, "count"), f"{rule}, got {show_value(count)}")
    return count


def _decode_chosen(hint: Any, choice: ClassChoice, value: object, at: str, default: object) -> Any:
    """Decode an object whose class is named by its table; a text stands for a kind with its defaults."""
    if value is None:
        return None
    if isinstance(value, str):
        table: Table = {"kind": value}
    else:
        table = table_of(value, at)
    default_kind = None
    if is_dataclass(default):
        default_kind = name_of(cast(type, type(default)))
    kind = table.pop("kind", default_kind)
    try:
        with arguments_of(at):
            chosen_class = choice.find(kind)
    except BadKey:
        base = class_of(hint)
        if _keeps_unknown.get() and isinstance(kind, str) and hasattr(base, "stand_in"):
            return cast("type[Extensible]", base).stand_in(kind, table)
        raise
    return _decode_object(chosen_class, table, at)


def updated(original: T, table: object, at: str = "") -> T:
    """Return a dataclass updated from a table; nested tables update nested values, unless they have another `kind`.

    Args:
        original: The original dataclass.
        table: Keys and values that differ.
        at: Path to the table, for the message.

    Raises:
        BadKey: If a key is unknown, or its value is invalid.
    """
    return _decode_object(type(original), table_of(table, at), at, original)


def _decode_object(kind: type[Any], table: Table, at: str, original: Any = None) -> Any:
    """Make an object of this class; fields missing from the table are those of the original, if given."""
    table = with_new_names(kind, table)
    fields = fields_of(kind)
    display_names = display_names_of(kind)
    check_keys(table, [*fields, *display_names], at)
    in_display_units = {key: number for key, number in table.items() if key in display_names}
    fields_in_display_units = {display_names[key] for key in in_display_units}
    values: dict[str, Any] = {}
    if original is not None:
        for name in fields:
            if name not in fields_in_display_units:
                values[name] = getattr(original, name)
    _check_complete(kind, {*values, *table, *fields_in_display_units}, at)
    for name, value in table.items():
        if name not in in_display_units:
            path = path_to(at, name)
            values[name] = _decode_field(fields[name], value, path, values.get(name))
    with arguments_of(at):
        return kind(**values, **in_display_units)


def _check_complete(kind: type[Any], stated_names: Container[str], at: str) -> None:
    """Reject a table that lacks a field without default."""
    for name, field in fields_of(kind).items():
        if field.is_required and name not in stated_names:
            raise BadKey(path_to(at, name), f"is missing; every {kind.__name__} needs it")


def _decode_field(field: Field, value: Any, path: str, current: Any) -> Any:
    """Return the value of a field; a table of the same kind changes the current value, if there is one."""
    if _describes_change_of(current, value):
        changes = {key: change for key, change in value.items() if key != "kind"}
        return updated(current, changes, path)
    return decode(field.hint, value, path, field.default)


def _describes_change_of(original: Any, value: Any) -> bool:
    """Return whether a value of a file changes the original, rather than being one of another kind."""
    if not isinstance(value, Mapping) or not is_dataclass(original):
        return False
    own_kind = name_of(cast(type, type(original)))
    return cast("Table", value).get("kind", own_kind) == own_kind
