"""A number with a unit and a range, and the sentence that refuses one out of range."""

import dataclasses
import math
from dataclasses import dataclass

from laticauda.values.checks import check_finite, show_value
from laticauda.values.display_units import DisplayUnit, display_unit
from laticauda.values.errors import BadArgument

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
        field_name, _, _ = name.partition("[")
        return f": {number:g} rad is {degrees:.4g} deg; did you mean {field_name}_deg={number:g}?"

    @property
    def in_display_unit(self) -> "Quantity":
        """The same quantity as people read and type it: angles in degrees, all others unchanged."""
        return self.in_unit(self.display)

    def in_unit(self, unit: DisplayUnit) -> "Quantity":
        """Return the same quantity in another unit.

        Args:
            unit: The unit.
        """
        return dataclasses.replace(
            self,
            unit=unit.name,
            ge=unit.from_si(self.ge),
            gt=unit.from_si(self.gt),
            le=unit.from_si(self.le),
        )

    @property
    def display(self) -> DisplayUnit:
        """The unit in which people read and type it."""
        return display_unit(self.unit)

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
