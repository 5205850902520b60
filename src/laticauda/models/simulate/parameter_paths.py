"""Steps of a parameter's dotted name: which field of an object each leads to, and which part of it.

robot.module[3].mass    of the robot's modules the item 3, of that the mass
robot.module[:5].mass   the same of the five modules 0 to 4 alike
robot.module.mass       the same of all modules alike
water.current_x         of the pair `current` the first number

Items count from 0 at the tail, and ranges are those of Python: `[2:5]` is 2, 3 and 4, `[::2]` every
second.
"""

import functools
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeAlias, cast

from laticauda.values import hints_of

Changes: TypeAlias = dict[str, Any]
"""New values by step; a value is a number, or the changes of the object that the step leads to."""

SINGULARS = {
    "modules": "module",
    "joints": "joint",
    "thrusters": "thruster",
    "pectoral_fins": "pectoral_fin",
    "drag_areas": "drag_area",
}
"""Fields whose items may be changed all alike, and the step that stands for them."""
SINGULARS_OF_SEPARATE = {"flows": "flow"}
"""Fields whose items are changed only one by one."""
PLURALS = {step: field for field, step in (SINGULARS | SINGULARS_OF_SEPARATE).items()}
"""Fields by the step that leads to their items."""
AXIS_ENDINGS = ("_x", "_y", "_z")
"""Endings of the steps that lead to a single number of a pair or a triple."""
COUNT_TYPES = (int, int | None)
"""Types of the fields that hold a whole number."""
_INDEXED = re.compile(r"(\w+)\[(?:(\d+)|(\d*):(\d*)(?::([1-9]\d*))?)\]")
_BRACKETS = re.compile(r"\[[^\]]*\]")
MOST_ITEMS = 1000
"""More items than any part of a robot has."""


class FieldPart(NamedTuple):
    """The field that a step leads to, and which part of it."""

    name: str
    """Name of the field."""
    items: slice | None
    """Which items, or numbers of a pair; None if the field is no sequence, and meant as a whole."""


def find_part(owner: Any, step: str) -> FieldPart:
    """Return what a step of a name leads to.

    Args:
        owner: The object from which the step leads on.
        step: A part of a parameter's name.
    """
    items = items_of(step)
    if items is not None:
        return FieldPart(PLURALS[strip_items(step)], items)
    if step in PLURALS and hasattr(owner, PLURALS[step]):  # a driven fin has a single joint
        return FieldPart(PLURALS[step], slice(None))
    if step.endswith(AXIS_ENDINGS) and not hasattr(owner, step):
        axis = AXIS_ENDINGS.index(step[-2:])
        return FieldPart(step[:-2], slice(axis, axis + 1))
    return FieldPart(step, None)


def items_of(step: str) -> slice | None:
    """Return which items a step of a name is about; None without brackets, or if these hold something else.

    Args:
        step: A part of a parameter's name.
    """
    indexed = _INDEXED.fullmatch(step)
    if indexed is None:
        return None
    _, index, first, end, stride = indexed.groups()
    if index is not None:
        return slice(int(index), int(index) + 1)
    return slice(_int_or_none(first), _int_or_none(end), _int_or_none(stride))


def _int_or_none(digits: str | None) -> int | None:
    return int(digits) if digits else None


def strip_items(name: str) -> str:
    """Return a name without the brackets that select items.

    Args:
        name: Name of a parameter, or a step of it.
    """
    return _BRACKETS.sub("", name)


def list_brackets(step: str) -> list[str]:
    """Return the brackets in a step of a name, such as [3].

    Args:
        step: A part of a parameter's name.
    """
    return _BRACKETS.findall(step)


def have_common_items(name: str, other: str) -> bool:
    """Return whether two names that differ in their brackets alone are partly about the same number.

    Args:
        name: Name of a parameter.
        other: Another one.
    """
    for step, other_step in zip(name.split("."), other.split("."), strict=True):
        if not _item_numbers(step) & _item_numbers(other_step):
            return False
    return True


def _item_numbers(step: str) -> set[int]:
    """Return the numbers of the items that a step is about."""
    return set(range(MOST_ITEMS)[items_of(step) or slice(None)])


def find_objects(owner: Any, step: str) -> Sequence[Any]:
    """Return the objects or numbers that a step of a name leads to.

    Args:
        owner: The object from which the step leads on.
        step: A part of a parameter's name.
    """
    part = find_part(owner, step)
    value = getattr(owner, part.name)
    if part.items is None:
        return [value]
    return value[part.items]


def describe_step(step: str) -> str:
    """Return what a step of a name stands for, in words.

    Args:
        step: A part of a parameter's name.
    """
    items = items_of(step)
    if items is None:
        return f"the {PLURALS.get(step, step)}".replace("_", " ")
    brackets = step[len(strip_items(step)) :]
    singular = strip_items(step).replace("_", " ")
    if ":" not in brackets:
        return f"{singular} {brackets[1:-1]}"
    return f"{PLURALS.get(singular, singular)} {brackets}"


def nest_by_step(values: Mapping[str, float]) -> Changes:
    """Return values by dotted name as nested changes, one level per step.

    Args:
        values: New values by parameter name.
    """
    changes: Changes = {}
    for name, value in values.items():
        *owners, last = name.split(".")
        changes_of_owner = changes
        for step in owners:
            changes_of_owner = changes_of_owner.setdefault(step, {})
        changes_of_owner[last] = value
    return changes


def apply_changes(owner: Any, changes: Changes) -> Any:
    """Return a dataclass with other numbers, all validated at once; unchanged parts remain the same objects.

    Args:
        owner: The dataclass.
        changes: What changes in it.
    """
    if not changes:
        return owner
    new_fields: dict[str, Any] = {}
    for step, change in changes.items():
        part = find_part(owner, step)
        value = new_fields.get(part.name, getattr(owner, part.name))
        if part.items is None:
            new_fields[part.name] = _changed(value, change)
        else:
            if items_of(step) and not value[part.items]:
                raise ValueError(f"There is no `{step}`: {part.name} are {len(value)}.")
            new_fields[part.name] = _with_changed_items(value, part.items, change)
    for name in new_fields.keys() & _count_fields(owner.__class__):
        new_fields[name] = int(new_fields[name])
    return replace(owner, **new_fields)


def _changed(value: Any, change: Any) -> Any:
    """Return what takes the place of a number, or of an object whose numbers change."""
    if isinstance(change, dict):
        return apply_changes(value, cast("Changes", change))
    return change


def _with_changed_items(sequence: Sequence[Any], items: slice, change: Any) -> tuple[Any, ...]:
    """Return a sequence in which some items change alike; items that were one object remain one."""
    members = list(sequence)
    changed_by_id = {id(member): _changed(member, change) for member in members[items]}
    members[items] = [changed_by_id[id(member)] for member in members[items]]
    return tuple(members)


@functools.cache
def _count_fields(kind: type) -> frozenset[str]:
    return frozenset(name for name, hint in hints_of(kind).items() if hint in COUNT_TYPES)
