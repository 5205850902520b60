"""What a field of a value declares: one `Field` record for each, made once and read by everything.

Checks, files, flags, sweeps, FMUs, pages and help all read these records, so that a field's unit,
range, text, default and type are stated in one place: where the class is defined. `quantity` and
`option` of `laticauda.values.quantities` put the declaration into the metadata of a dataclass
field; `fields_of` reads it back.
"""

import dataclasses
import functools
import math
import types
import typing
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass
from typing import Any

from laticauda.values.annotations import Annotation
from laticauda.values.declared_quantities import Quantity
from laticauda.values.display_units import CYCLES_PER_SECOND, DisplayUnit, display_unit

Check = Callable[[str, Any], Any]
"""`check(name, value)` returns the cleaned value of a field, or raises a `BadArgument`."""

DEGREES_DIGITS = 9
"""Decimals of an angle as it is written [deg]."""


@dataclass(frozen=True)
class Field:
    """What one field of a class declares."""

    owner: type
    """The class."""
    name: str
    text: str
    """Description, a phrase without a final period; "" if undeclared."""
    quantity: Quantity | None
    """Unit and range, if the field holds a number or several numbers."""
    default: Any
    """Default; `dataclasses.MISSING` if there is none, or a function makes it."""
    default_factory: Any
    """Function that makes the default; `dataclasses.MISSING` if there is none."""
    own_check: Check | None
    """Check that replaces the one implied by the type."""
    in_hz: bool
    """Whether it is the angular frequency of something that repeats."""

    @property
    def is_required(self) -> bool:
        """Whether there is no default."""
        return self.default is MISSING and self.default_factory is MISSING

    @property
    def unit(self) -> str:
        """Unit of its numbers; "" for pure numbers, and for a field that holds none."""
        if self.quantity is None:
            return ""
        return self.quantity.unit

    @property
    def display(self) -> DisplayUnit:
        """The unit in which people read and type it."""
        return display_unit(self.unit)

    @property
    def display_name(self) -> str | None:
        """Name that gives it in degrees, if it is an angle or the rate of one."""
        if not self.display.differs_from_si:
            return None
        return self.name + self.display.ending

    @property
    def argument_units(self) -> Mapping[str, DisplayUnit]:
        """Units in which it may be given other than that of calculations, by the name of the argument."""
        units: dict[str, DisplayUnit] = {}
        if self.display_name is not None:
            units[self.display_name] = self.display
        if self.in_hz:
            units[self.name + CYCLES_PER_SECOND.ending] = CYCLES_PER_SECOND
        return units

    def exact_in_display_unit(self, content: object) -> float | None:
        """Return an angle in degrees if that converts back to exactly the same number, otherwise None.

        Args:
            content: Content of the field.
        """
        if self.display_name is None or not isinstance(content, float):
            return None
        degrees = round(math.degrees(content), DEGREES_DIGITS)
        if math.radians(degrees) != content:
            return None
        return degrees

    # Annotations may name classes that are defined later: they are resolved when first asked for.
    @functools.cached_property
    def hint(self) -> Any:
        """Its type as a type, such as ``float | None``; marks of `typing.Annotated` are left out."""
        return _types_of(self.owner)[self.name]

    @functools.cached_property
    def annotation(self) -> Annotation:
        """The same type taken apart, for whoever asks which values it allows."""
        return Annotation.of(self.hint)

    def make_default(self) -> Any:
        """Return the default, made anew if a function makes it."""
        if self.default_factory is MISSING:
            return self.default
        return self.default_factory()


@functools.cache
def fields_of(kind: type) -> Mapping[str, Field]:
    """Return the fields of a class by name; there are none if it is no dataclass, like a stand-in.

    Args:
        kind: Any class.
    """
    declared: dict[str, Field] = {}
    if not dataclasses.is_dataclass(kind):
        return types.MappingProxyType(declared)
    for field in dataclasses.fields(kind):
        declared[field.name] = Field(
            owner=kind,
            name=field.name,
            text=field.metadata.get("text", ""),
            quantity=field.metadata.get("quantity"),
            default=field.default,
            default_factory=field.default_factory,
            own_check=field.metadata.get("check"),
            in_hz=field.metadata.get("in_hz", False),
        )
    return types.MappingProxyType(declared)


@functools.cache
def _types_of(kind: type) -> Mapping[str, Any]:
    return typing.get_type_hints(kind)


@functools.cache
def quantities_of(kind: type) -> Mapping[str, Quantity]:
    """Return the declared numbers of a class by field."""
    quantities: dict[str, Quantity] = {}
    for name, field in fields_of(kind).items():
        if field.quantity is not None:
            quantities[name] = field.quantity
    return types.MappingProxyType(quantities)


@functools.cache
def display_names_of(kind: type) -> Mapping[str, str]:
    """Return the names that give a class's angles and their rates in degrees, with the fields that they stand for."""
    names: dict[str, str] = {}
    for name, field in fields_of(kind).items():
        if field.display_name is not None:
            names[field.display_name] = name
    return types.MappingProxyType(names)


@functools.cache
def texts_of(kind: type) -> Mapping[str, str]:
    """Return the description of every field of a class, "" if undeclared. A stand-in for an unknown class has none."""
    return types.MappingProxyType({name: field.text for name, field in fields_of(kind).items()})


@functools.cache
def hints_of(kind: type) -> Mapping[str, Any]:
    """Return the types of a class's fields by name, see `Field.hint`."""
    return types.MappingProxyType({name: field.hint for name, field in fields_of(kind).items()})
