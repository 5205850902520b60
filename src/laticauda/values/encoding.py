"""From values to plain tables, which `laticauda.values.decoding` converts back to equal values."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, is_dataclass, replace
from itertools import groupby
from typing import Any, cast

from laticauda.values.annotations import Annotation
from laticauda.values.class_choice import class_choice_of, class_of
from laticauda.values.decoding import MOST_COUNTED
from laticauda.values.extensions import Unknown, name_of
from laticauda.values.file_tables import Table
from laticauda.values.quantities import Field, fields_of


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
        return _encode_object(value, hint)
    if isinstance(value, Unknown):
        return value.written
    if isinstance(value, Mapping):
        entries = cast("Mapping[str, Any]", value)
        return {key: encode(entry) for key, entry in entries.items()}
    if isinstance(value, tuple | list):
        return _encode_items(cast("Sequence[Any]", value), hint)
    return value


def _encode_object(value: Any, hint: Any) -> Table:
    if not _needs_kind(value, hint):
        return _table_of_fields(value)
    return {"kind": name_of(value.__class__), **_table_of_fields(value)}


def _needs_kind(value: Any, hint: Any) -> bool:
    """Return whether the type of a field leaves a choice, so that the table must name the class."""
    if class_choice_of(hint) is not None:
        return True
    for member in Annotation.of(hint).members:  # of `X | None`, and of `X | Y` the matching type
        if class_choice_of(member) is not None and isinstance(value, class_of(member)):
            return True
    return False


def _encode_items(items: Sequence[Any], hint: Any) -> list[Any]:
    if items:
        cycling_keys = getattr(items[0], "counted", None)
        if cycling_keys is not None:
            return _encode_counted(items, cycling_keys)
    item_hint = None
    tuples = Annotation.of(hint).tuples
    if tuples:
        item_hint = tuples[0].item
    return [encode(item, item_hint) for item in items]


def _table_of_fields(value: Any) -> Table:
    table: Table = {}
    for name, field in fields_of(value.__class__).items():
        content = getattr(value, name)
        if _is_omitted(content, field):
            continue
        degrees = field.exact_in_display_unit(content)
        if degrees is not None and field.display_name is not None:
            table[field.display_name] = degrees
            continue
        encoded = encode(content, field.hint)
        if encoded != {} or field.default_factory is MISSING:
            table[name] = encoded
    return table


def _is_omitted(content: Any, field: Field) -> bool:
    """Return whether a file need not state a field: it is absent, or zero, empty or infinite by default."""
    if content is None:
        return True
    is_default = content == field.default
    return is_default and (not content or content == math.inf)  # JSON has no infinity


def _encode_counted(objects: Sequence[Any], cycling_keys: tuple[str, ...]) -> list[Table]:
    """Return one entry per run of objects that are alike except for the fields that their class lists as cycling."""
    of_first = {key: getattr(objects[0], key) for key in cycling_keys}

    def without_cycle(counted: Any) -> Any:
        return replace(counted, **of_first)

    entries: list[Table] = []
    for _, alike in groupby(objects, key=without_cycle):
        run = list(alike)
        for start in range(0, len(run), MOST_COUNTED):
            entries.append(_encode_run(run[start : start + MOST_COUNTED], cycling_keys))
    return entries


def _encode_run(run: Sequence[Any], cycling_keys: tuple[str, ...]) -> Table:
    entry = _table_of_fields(run[0])
    for key in cycling_keys:
        entry[key] = _shortest_cycle([getattr(value, key) for value in run])
    if len(run) == 1:
        return entry
    return {"count": len(run), **entry}


def _shortest_cycle(texts: Sequence[str]) -> str | list[str]:
    """Return the texts through which these cycle; one of them if they are all alike."""
    length = 1
    while any(text != texts[i % length] for i, text in enumerate(texts)):
        length += 1
    if length == 1:
        return texts[0]
    return list(texts[:length])
