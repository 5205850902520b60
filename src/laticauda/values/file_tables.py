"""Tables as TOML and JSON hold them: their headers, their keys, and errors that name the key.

A path to a key is written from the top level of the file, such as ``water.drag.linear``.
"""

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, TypeAlias, cast

from laticauda.values.checks import show_value, suggest_nearest
from laticauda.values.errors import BadArgument

Table: TypeAlias = dict[str, Any]

FORMAT = 2
"""Format of the files written; increases when their keys change. Version 0.1 wrote none, which counts as current."""


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
    except BadKey as bad_key:
        key = ""
        if bad_key.name:
            key = f"key `{bad_key.name}`: "
        raise error(f"{file}: {key}{bad_key.rule}") from None


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
    except BadArgument as error:
        raise BadKey(path_to(at, error.name), error.rule) from error
    except ValueError as error:
        raise BadKey(at, str(error)) from error


def path_to(at: str, key: str) -> str:
    """Return the path to a key of the table at `at`.

    Args:
        at: Path to the table; "" for the top level.
        key: One of its keys.
    """
    if not at:
        return key
    return f"{at}.{key}"


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
            raise BadKey(path_to(at, key), f"is not known{hint}")


def merge_tables(common: Table, own: Table) -> Table:
    """Merge two tables recursively; the second one takes precedence.

    Args:
        common: Values used where the other table has none.
        own: Values that differ.
    """
    merged = dict(common)
    for key, value in own.items():
        if isinstance(value, dict) and isinstance(merged.get(key), dict):
            merged[key] = merge_tables(merged[key], cast("Table", value))
        else:
            merged[key] = value
    return merged


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
    listed = ", ".join(f'"{kind}"' for kind in kinds)
    rule = f"must be one of {listed}"
    if len(kinds) == 1:
        rule = f"must be {listed} here"
    if "kind" not in table:
        raise BadKey("kind", f"is missing; it {rule}")
    kind = table.pop("kind")
    if kind not in kinds:
        hint = ""
        if isinstance(kind, str):
            hint = suggest_nearest(kind, kinds)
        raise BadKey("kind", f"{rule}, got {show_value(kind)}{hint}")
    file_format = table.pop("format", FORMAT)
    if file_format not in range(1, FORMAT + 1):
        rule = f"must be 1 to {FORMAT}, which this version of laticauda reads"
        raise BadKey("format", f"{rule}, got {show_value(file_format)}")
    return kind
