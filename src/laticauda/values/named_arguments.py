"""Arguments of values with units: which names they have, and what is wrong with a call that uses others.

An angle may be given in degrees, and the frequency of something that repeats in Hz, each under a
name of its own: `Field.argument_units` says which.
"""

import functools
import types
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, ParamSpec, TypeVar, cast

from laticauda.values.checks import show_value, suggest_nearest
from laticauda.values.declared_fields import Field, fields_of
from laticauda.values.display_units import DisplayUnit
from laticauda.values.errors import BadArgument

P = ParamSpec("P")
T = TypeVar("T")


class _ArgumentUnit(NamedTuple):
    """What an argument stands for."""

    field: Field
    unit: DisplayUnit
    """The unit of its number."""


@functools.cache
def argument_units_of(kind: type) -> Mapping[str, _ArgumentUnit]:
    """Return the arguments that give a class's fields in other units, by name.

    Args:
        kind: A class with declared fields.
    """
    units: dict[str, _ArgumentUnit] = {}
    for field in fields_of(kind).values():
        for name, unit in field.argument_units.items():
            units[name] = _ArgumentUnit(field, unit)
    return types.MappingProxyType(units)


def in_si_units(kind: type, arguments: dict[str, Any]) -> dict[str, Any]:
    """Return arguments by the names of their fields, in the units of calculations.

    Args:
        kind: A class with declared fields.
        arguments: Arguments for it.

    Raises:
        ValueError: If a field is given twice, or a number is out of range.
    """
    units = argument_units_of(kind)
    converted: dict[str, Any] = {}
    names_given: dict[str, str] = {}
    for name, value in arguments.items():
        field_name = name
        if name in units:
            field_name = units[name].field.name
            value = _in_si_unit(units[name], name, value)
        if field_name in converted:
            _refuse_both(kind, name, names_given[field_name])
        converted[field_name] = value
        names_given[field_name] = name
    return converted


def _in_si_unit(argument: _ArgumentUnit, name: str, number: Any) -> Any:
    """Return a number, or each of several, in the unit of calculations; None stays None."""
    quantity = argument.field.quantity
    if number is None or quantity is None:
        return None
    quantity_in_unit = quantity.in_unit(argument.unit)
    if argument.field.annotation.tuples and isinstance(number, list | tuple):
        numbers = cast("Sequence[Any]", number)
        converted: list[float] = []
        for k, unchecked in enumerate(numbers):
            checked = quantity_in_unit.checked(f"{name}[{k}]", unchecked)
            converted.append(argument.unit.to_si(checked))
        return tuple(converted)
    return argument.unit.to_si(quantity_in_unit.checked(name, number))


def _refuse_both(kind: type, *names: str) -> None:
    """Say that two arguments mean the same; the one with the plain name of the field comes second."""
    units = argument_units_of(kind)
    first, second = sorted(names, key=lambda name: name not in units)
    unit = fields_of(kind)[second].unit if second not in units else units[second].unit.name
    rule = f"must not be given together with `{second}`, the same in {unit}"
    raise BadArgument(first, rule)


def find_argument_error(kind: type, arguments: Mapping[str, Any]) -> TypeError | None:
    """Return an error for an argument that does not exist, or is missing; None if there is none.

    Args:
        kind: A class with declared fields.
        arguments: Arguments for it, by the names of its fields.
    """
    fields = fields_of(kind)
    for name in arguments:
        if name not in fields:
            return TypeError(f"There is no argument `{name}`{_hint_at_argument(kind, name)}")
    missing = [
        _spell_out(field)
        for field in fields.values()
        if field.is_required and field.name not in arguments
    ]
    if missing:
        return TypeError(f"{kind.__name__} also needs {', and '.join(missing)}.")
    return None


def _hint_at_argument(kind: type, name: str) -> str:
    """Return the end of a message about an argument that does not exist, or ""."""
    fields = fields_of(kind)
    meant: Mapping[str, tuple[str, ...]] = getattr(kind, "_meant", {})
    names = [*meant.get(name.casefold(), ())]
    if not names or names[0] not in fields:
        nearest = suggest_nearest(name, [*fields]).split("`")
        names = nearest[1:2]
    if not names:
        return f"; they are {', '.join(fields)}."
    return f"; did you mean {_spell_out(fields[names[0]])}?"


def _spell_out(field: Field) -> str:
    """Return all names of a field with their units: `amplitude` [rad], or `amplitude_deg`."""
    text = f"`{field.name}`"
    if field.unit:
        text += f" [{field.unit}]"
    names_in_units = [f"`{name}`" for name in field.argument_units]
    if not names_in_units:
        return text
    return f"{text}, or {' or '.join(names_in_units)}"


def by_name_only(kind: type) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Let a function that takes the fields of a class by name alone say so (decorator).

    Args:
        kind: The class.
    """

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        @functools.wraps(function)
        def call(*arguments: P.args, **fields: P.kwargs) -> T:
            if arguments:
                raise refuse_positional(function.__name__, kind, arguments)
            return function(*arguments, **fields)

        return call

    return decorate


def refuse_positional(name: str, kind: type, arguments: tuple[Any, ...]) -> TypeError:
    """Return an error that writes out a call whose arguments had no names.

    Args:
        name: Name of what was called.
        kind: The class whose fields the arguments are.
        arguments: The arguments.
    """
    named: list[str] = []
    names_in_si: list[str] = []
    units: list[str] = []
    for field, value in zip(fields_of(kind).values(), arguments, strict=False):
        display_name = field.display_name or field.name
        named.append(f"{display_name}={show_value(value)}")
        if field.display_name is not None:
            names_in_si.append(f"{field.name}=")
            units.append(field.unit)
    rule = f"{name} takes its arguments by name, which states the unit"
    in_other_units = ""
    if names_in_si:
        in_other_units = f", or in {' and '.join(dict.fromkeys(units))}: {', '.join(names_in_si)}"
    return TypeError(f"{rule}: {name}({', '.join(named)}){in_other_units}")
