"""The check of a field that its type implies, together with its declared unit and range."""

import functools
import math
import sys
from collections.abc import Iterable, Mapping
from itertools import islice
from types import NoneType
from typing import Any, NamedTuple, cast

from laticauda.values.annotations import Annotation, TupleAnnotation, is_tuple
from laticauda.values.checks import (
    check_choice,
    check_flag,
    check_instance,
    check_text,
    check_whole_number,
    show_value,
)
from laticauda.values.declared_fields import Check, Field, fields_of
from laticauda.values.declared_quantities import Quantity
from laticauda.values.errors import BadArgument

MOST_ITEMS = 10_000_000
"""Maximum length of a list of numbers given by a user, which also guards against endless ones."""
_COUNTS_IN_WORDS = {2: "two", 3: "three"}
_TYPES_IN_WORDS = {str: "text"}


class FieldCheck(NamedTuple):
    """How a field is checked whenever a value is made."""

    name: str
    low: float
    """A float from `low` to `high` needs no further check; the range is empty where floats do."""
    high: float
    check: Check | None
    """Check of everything else; None: anything is accepted."""


@functools.cache
def checks_of(kind: type) -> tuple[FieldCheck, ...]:
    """Return the checks of all fields of a class.

    Args:
        kind: A dataclass.
    """
    return tuple(_check_of_field(field) for field in fields_of(kind).values())


def _check_of_field(field: Field) -> FieldCheck:
    low, high = math.inf, -math.inf  # an empty range
    if field.quantity is not None and float in field.annotation.members:
        low, high = field.quantity.ends
        if field.default == math.inf:
            high = math.inf
    check = field.own_check or find_check(field.annotation, field.quantity)
    return FieldCheck(field.name, low=low, high=high, check=check)


def find_check(annotation: Annotation, quantity: Quantity | None) -> Check | None:
    """Return the check that a type implies; None: anything is accepted.

    Args:
        annotation: The type.
        quantity: Unit and range of its numbers, if it holds any.
    """
    if not annotation.is_union:
        return _check_of_type(annotation.whole, quantity)
    if annotation.only_member is not None:
        return _or_none(_check_of_type(annotation.only_member, quantity))
    n_tuples, n_classes = len(annotation.tuples), len(annotation.classes)
    if n_tuples + n_classes < len(annotation.members):  # some are neither
        return None
    if n_tuples:
        return _check_of_tuples_or_objects(annotation, quantity)
    if quantity is not None:
        return None
    accepted = annotation.classes
    if annotation.accepts_none:
        accepted = (*accepted, NoneType)
    return lambda name, value: check_instance(name, value, *accepted)


def _or_none(check: Check | None) -> Check | None:
    """Return a check that accepts None, too."""
    if check is None:
        return None

    def check_unless_none(name: str, value: Any) -> Any:
        if value is None:
            return None
        return check(name, value)

    return check_unless_none


def _check_of_tuples_or_objects(annotation: Annotation, quantity: Quantity | None) -> Check:
    """Return the check of, for instance, two or three numbers, or an object instead."""
    item = annotation.tuples[0].item
    counts = tuple(kind.count for kind in annotation.tuples if kind.count is not None)
    alternatives = [_describe_items(item, counts, quantity)]
    alternatives += [_TYPES_IN_WORDS.get(kind, kind.__name__) for kind in annotation.classes]
    required = " or a ".join(alternatives)
    item_check = find_check(Annotation.of(item), quantity)
    objects = annotation.classes
    if annotation.accepts_none:
        objects = (*objects, NoneType)

    def check(name: str, value: Any) -> Any:
        if isinstance(value, objects):
            return value
        return check_items(item_check, required, counts, name, value)

    return check


def _check_of_type(kind: Any, quantity: Quantity | None) -> Check | None:
    """Return the check of a type that is no union."""
    if is_tuple(kind):
        return _check_of_tuple(TupleAnnotation.of(kind), quantity)
    choices = Annotation.of(kind).choices
    if choices:
        return check_one_among(*choices)
    if quantity is not None and kind is int:
        return functools.partial(_check_whole_quantity, quantity)
    if quantity is not None:
        return quantity.checked
    if kind is bool:
        return check_flag
    if kind is str:
        return check_text
    if not isinstance(kind, type) or kind is Any or getattr(kind, "_is_protocol", False):
        return None
    return lambda name, value: check_instance(name, value, kind)


def _check_of_tuple(kind: TupleAnnotation, quantity: Quantity | None) -> Check:
    counts = _accepted_counts(kind)
    required = _describe_items(kind.item, counts, quantity)
    item_check = find_check(Annotation.of(kind.item), quantity)
    return functools.partial(check_items, item_check, required, counts)


def _accepted_counts(kind: TupleAnnotation) -> tuple[int, ...]:
    if kind.count is None:
        return ()
    return (kind.count,)


def _check_whole_quantity(quantity: Quantity, name: str, value: Any) -> int:
    least = math.ceil(max(quantity.least, -sys.maxsize))
    number = check_whole_number(name, value, least)
    quantity.checked(name, number)
    return number


def check_one_among(*choices: str) -> Check:
    """Return a check for a text that is one of `choices`, with hyphens equivalent to underscores."""

    def check(name: str, value: Any) -> str:
        if isinstance(value, str):
            plain = value.replace("-", "_")
            if plain in choices:
                return plain
        return check_choice(name, value, choices)

    return check


def check_items(
    item: Check | None, required: str, counts: tuple[int, ...], name: str, value: Any
) -> tuple[Any, ...]:
    """Return an iterable as a tuple of checked items.

    Args:
        item: Check of each item.
        required: Description of the required items, in words.
        counts: Accepted numbers of items; none: any number up to `MOST_ITEMS`.
        name: Name of the argument.
        value: The value given.

    Raises:
        ValueError: If it is not iterable, has another length, or an item is rejected.
    """
    is_scalar = getattr(value, "shape", None) == ()  # an array without axes is not iterable
    if is_scalar or isinstance(value, str | Mapping) or not isinstance(value, Iterable):
        raise BadArgument(name, f"must be {required}, got {show_value(cast(object, value))}")
    items: tuple[Any, ...] = tuple(islice(cast("Iterable[Any]", value), MOST_ITEMS + 1))
    if len(items) > MOST_ITEMS:
        raise BadArgument(name, f"must be {required}, got more than {MOST_ITEMS} of them")
    if counts and len(items) not in counts:
        raise BadArgument(name, f"must be {required}, got {len(items)} of them")
    if item is None:
        return items
    return tuple(item(f"{name}[{i}]", entry) for i, entry in enumerate(items))


def _describe_items(item: Any, counts: tuple[int, ...], quantity: Quantity | None) -> str:
    """Return the required content of a tuple, in words."""
    if quantity is None:
        return _describe_objects(item, counts)
    numbers = "numbers"
    if quantity.unit:
        numbers = f"numbers in {quantity.unit}"
    if is_tuple(item):
        count = TupleAnnotation.of(item).count
        if count is None:
            return f"a list of lists of {numbers}"
        return f"a list of {_COUNTS_IN_WORDS.get(count, count)} {numbers}"
    amounts = [_COUNTS_IN_WORDS.get(count, str(count)) for count in counts]
    amount = " or ".join(amounts) or "a list of"
    return f"{amount} {numbers}"


def _describe_objects(item: Any, counts: tuple[int, ...]) -> str:
    if item is not str:
        return f"a tuple of {getattr(item, '__name__', 'tuples')}"
    if not counts:
        return "a list of texts"
    amount = " or ".join(map(str, counts))
    return f"a list of {amount} texts"
