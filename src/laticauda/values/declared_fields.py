"""What a field of a value declares: one `Field` record for each, made once and read by everything.

Checks, files, flags, sweeps, FMUs, pages and help all read these records, so that a field's unit,
range, text, default and type are stated in one place: where the class is defined.
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
from laticauda.values.checks import check_finite, show_value
from laticauda.values.display_units import DisplayUnit, display_unit
from laticauda.values.errors import BadArgument

Check = Callable[[str, Any], Any]
"""`check(name, value)` returns the cleaned value of a field, or raises a `BadArgument`."""

LIMITS = {
    "kg/m^3": 25e3,  # osmium has 22 590
    **dict.fromkeys(("A", "V", "deg C", "degC", "m/s"), 1e4),
    **dict.fromkeys(("Hz", "K/W", "m/s^2", "m^2", "ohm", "rad"), 1e6),
    "m": 1e7,  # survey coordinates, such as UTM, come near this
    **dict.fromkeys(("deg", "kg", "m^3"), 1e9),
}
"""Largest magnitude by unit, if the field declares no bound on that side; anything larger is taken as a mistake."""
LARGEST = 1e12
"""The largest for all other units: far beyond any swimmer, and far from overflow of sums and squares of numbers."""
LEAST = {"m": 1e-9, "kg": 1e-9, "kg/m^3": 1e-9}
"""Smallest value by unit, if the field declares that it is above 0; anything smaller is taken as a mistake."""
SMALLEST = 1e-12
"""The smallest for all other units: far below any swimmer, and far from overflow of quotients and squares."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A finite number with a unit and a range; if no bound is declared, that of its unit applies (`LIMITS`)."""

    unit: str
    """Unit of the number; "" for a pure number."""
    text: str
    """Description, a phrase without a final period."""
    ge: float = -math.inf
    """Minimum, inclusive."""
    gt: float = -math.inf
    """Minimum, exclusive."""
    le: float = math.inf
    """Maximum, inclusive."""

    def checked(self, name: str, value: object) -> float:
        """Return `value` as a float.

        Args:
            name: Name of the argument.
            value: The value given.

        Raises:
            ValueError: If it is not a finite number, or out of range.
        """
        number = check_finite(name, value, self.unit)
        lowest, highest = self.ends
        if lowest <= number <= highest:
            return number
        rule = self._broken_rule(number)
        if self.unit:
            rule = f"{rule} {self.unit}"
        hint = self._hint_of_degrees(name, number)
        raise BadArgument(name, f"must be {rule}, got {show_value(value)}{hint}")

    def _broken_rule(self, number: float) -> str:
        """Return the rule that a number out of range breaks."""
        lowest, highest = self.ends
        if number <= self.gt:
            return f"> {self.gt:g}"
        if not self.ge <= number <= self.le:
            return self.range
        if number > highest:
            return f"<= {highest:g}"
        return f">= {lowest:g}"

    def _hint_of_degrees(self, name: str, number: float) -> str:
        """Return the end of a message about an angle that was probably meant in degrees, or ""."""
        has_largest = math.isfinite(self.le)
        if self.unit != "rad" or not has_largest or abs(number) <= math.pi:
            return ""
        lowest, highest = self.in_display_unit.ends
        if not lowest <= number <= highest:
            return ""
        degrees = math.degrees(number)
        return f": {number:g} rad is {degrees:.4g} deg; did you mean {name}_deg={number:g}?"

    @property
    def in_display_unit(self) -> "Quantity":
        """The same quantity in the unit in which people read and type it."""
        display = self.display
        return dataclasses.replace(
            self,
            unit=display.name,
            ge=display.from_si(self.ge),
            gt=display.from_si(self.gt),
            le=display.from_si(self.le),
        )

    @property
    def display(self) -> DisplayUnit:
        """The unit in which people read and type it."""
        return display_unit(self.unit)

    @property
    def as_typed(self) -> "Quantity":
        """The quantity as people type it: angles in degrees."""
        if self.display.differs_from_si:
            return self.in_display_unit
        return self

    @property
    def ends(self) -> tuple[float, float]:
        """The smallest and the largest accepted number, both finite."""
        limit = LIMITS.get(self.unit, LARGEST)
        lowest, highest = self.least, self.le
        if not math.isfinite(lowest):
            lowest = -limit
        if not math.isfinite(highest):
            highest = limit
        return lowest, highest

    @property
    def least(self) -> float:
        """The smallest number accepted by declaration; minus infinity if there is none."""
        if not math.isfinite(self.gt):
            return max(self.ge, self.gt)
        if self.gt == 0.0:
            return max(self.ge, LEAST.get(self.unit, SMALLEST))
        return max(self.ge, math.nextafter(self.gt, math.inf))

    @property
    def range(self) -> str:
        """The declared range in words, "" if there is none."""
        low = max(self.ge, self.gt)
        if math.isfinite(low) and math.isfinite(self.le):
            return f"between {low:g} and {self.le:g}"
        if math.isfinite(self.le):
            return f"<= {self.le:g}"
        if math.isfinite(self.gt) and self.gt >= self.ge:
            return f"> {self.gt:g}"
        if math.isfinite(self.ge):
            return f">= {self.ge:g}"
        return ""


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

    # Annotations may name classes that are defined later: they are resolved when first asked for.
    @functools.cached_property
    def hint(self) -> Any:
        """Its type, without the marks of `typing.Annotated`."""
        return _types_of(self.owner)[self.name]

    @functools.cached_property
    def annotation(self) -> Annotation:
        """Its type, taken apart."""
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
    """Return the types of a class's fields."""
    return types.MappingProxyType({name: field.hint for name, field in fields_of(kind).items()})
