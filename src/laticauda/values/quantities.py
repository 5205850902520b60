"""Declarations of numbers: a field's unit, text, range and default stand together, and everything reads them here.

    @value_class
    class PolynomialDrag:
        reference_speed: float = quantity("m/s", "U_ref, where both parts are equal", ge=0.0, default=1.0)
        linear: bool = option("Whether there is a part that is linear in the speed", default=True)

Such a value is a frozen, keyword-only dataclass that checks each of its fields once, by type and
declared range. Files, flags, sweeps, FMUs, pages, the reference and help read the declarations
with `fields_of`, a `Field` by name; `quantities_of`, `texts_of`, `hints_of` and `display_names_of` give
single parts of these.
"""

import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import MISSING, dataclass
from typing import Any, TypeVar, dataclass_transform, overload

from laticauda.values.declared_fields import (
    Check,
    Field as Field,
    display_names_of as display_names_of,
    fields_of as fields_of,
    hints_of as hints_of,
    quantities_of as quantities_of,
    texts_of as texts_of,
)
from laticauda.values.declared_quantities import (
    LARGEST as LARGEST,
    LIMITS as LIMITS,
    Quantity as Quantity,
)
from laticauda.values.descriptions import (
    describe_field as describe_field,
    describe_fields as describe_fields,
    docstring_with_fields,
    docstring_without_fields as docstring_without_fields,
    html_table as html_table,
    show_call as show_call,
    value_as_table,
)
from laticauda.values.field_checks import (
    MOST_ITEMS as MOST_ITEMS,
    check_items as check_items,
    check_one_among as check_one_among,
    checks_of,
)
from laticauda.values.named_arguments import (
    argument_units_of,
    find_argument_error,
    in_si_units,
    refuse_positional,
)
from laticauda.values.packaging import renamed_names

T = TypeVar("T")
Kind = TypeVar("Kind", bound=type[Any])


@overload
def quantity(
    unit: str,
    text: str,
    *,
    default: T,
    ge: float = ...,
    gt: float = ...,
    le: float = ...,
    in_hz: bool = ...,
) -> T: ...
@overload
def quantity(
    unit: str,
    text: str,
    *,
    ge: float = ...,
    gt: float = ...,
    le: float = ...,
    in_hz: bool = ...,
) -> Any: ...
def quantity(
    unit: str,
    text: str,
    *,
    default: Any = MISSING,
    ge: float = -math.inf,
    gt: float = -math.inf,
    le: float = math.inf,
    in_hz: bool = False,
) -> Any:
    """Declare a field that holds a number, several numbers, or None if its type allows it.

    Args:
        unit: Unit; "" for a pure number.
        text: Description, a phrase without a final period.
        default: Default; if omitted, the field is required.
        ge: Minimum, inclusive.
        gt: Minimum, exclusive.
        le: Maximum, inclusive.
        in_hz: Whether it is the angular frequency of something that repeats, which may be given in
            Hz, too, under its name with ``_hz``.
    """
    declared = Quantity(unit=unit, text=text, ge=ge, gt=gt, le=le)
    metadata = {"quantity": declared, "text": text, "in_hz": in_hz}
    return dataclasses.field(default=default, metadata=metadata)


@overload
def option(text: str, *, default: T, check: Check | None = ..., is_compared: bool = ...) -> T: ...
@overload
def option(text: str, *, default_factory: Callable[[], T], check: Check | None = ...) -> T: ...
@overload
def option(text: str, *, check: Check | None = ...) -> Any: ...
def option(
    text: str,
    *,
    default: Any = MISSING,
    default_factory: Any = MISSING,
    check: Check | None = None,
    is_compared: bool = True,
) -> Any:
    """Declare a field that is not a number: a text, a truth value, a choice or another value.

    Args:
        text: Description, a phrase without a final period.
        default: Default; if omitted, the field is required.
        default_factory: Function that makes the default.
        check: Replaces the check implied by the type: `check(name, value)` returns the cleaned
            value.
        is_compared: Whether values that differ in this field alone are unequal.
    """
    metadata = {"text": text, "check": check}
    if default_factory is not MISSING:
        return dataclasses.field(default_factory=default_factory, metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata, compare=is_compared)


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(quantity, option))
def value_class(kind: Kind) -> Kind:
    """Make a frozen, keyword-only dataclass whose fields are checked before its own ``__post_init__`` (decorator).

    Numbers become floats within their range, whole numbers ints; texts of a `Literal` must be among
    its choices, with hyphens equivalent to underscores; truth values are true or false; a field of
    a class holds an instance of it; lists become tuples. A default is always valid, even infinity.
    Further checks are left to the class. An angle or its rate may be given in degrees, under its
    name with ``_deg`` or ``_deg_s``: `amplitude_deg=30`.

    Args:
        kind: The class; its docstring gets a list of the fields.
    """
    own_post_init: Callable[[Any], None] | None = getattr(kind, "__post_init__", None)

    def check_fields(self: Any) -> None:
        for name, low, high, check in checks_of(self.__class__):
            value = getattr(self, name)
            if type(value) is float and low <= value <= high:
                continue  # as most fields, in most values
            if check is not None:
                cleaned = check(name, value)
                if cleaned is not value:
                    object.__setattr__(self, name, cleaned)
        if own_post_init is not None:
            own_post_init(self)

    kind.__post_init__ = check_fields  # type: ignore[attr-defined]
    checked_class: Any = dataclass(frozen=True, kw_only=True)(kind)
    if display_names_of(checked_class):
        checked_class.__init__ = _accepting_display_units(checked_class.__init__)
    checked_class.__doc__ = docstring_with_fields(checked_class)
    if "_repr_html_" not in vars(kind):
        checked_class._repr_html_ = value_as_table
    return checked_class


def _accepting_display_units(init: Callable[..., None]) -> Callable[..., None]:
    """Return an ``__init__`` that also takes numbers in other units, such as angles in degrees."""

    @functools.wraps(init)
    def init_from_display_units(self: Any, *unnamed: Any, **arguments: Any) -> None:
        kind: type = self.__class__
        if unnamed:
            raise refuse_positional(kind.__name__, kind, unnamed)
        if not arguments.keys().isdisjoint(argument_units_of(kind)):
            arguments = in_si_units(kind, arguments)
        try:
            init(self, **arguments)
        except TypeError:
            argument_error = find_argument_error(kind, arguments)
            if argument_error is None:
                raise
            raise argument_error from None

    return init_from_display_units


# Names of 0.2, for one release.
__getattr__ = renamed_names(__name__, {"value": "value_class"})
