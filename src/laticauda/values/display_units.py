"""The units that people read and type: angles and their rates are in degrees at all interfaces.

Inside, everything is in SI units. Files, flags, pages and tables give an angle in degrees, under its
name with an ending, such as ``amplitude_deg``. This is the only table of these units.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class DisplayUnit:
    """How a quantity is read and typed."""

    name: str
    """The unit, such as deg/s; "" for a pure number."""
    ending: str = ""
    """End of names of numbers in this unit, such as _deg_s; "" if it is the unit of calculations."""
    per_si_unit: float = 1.0
    """What one of the SI unit is in this unit."""
    in_si_unit: float = 1.0
    """What one of this unit is in the SI unit."""

    @property
    def differs_from_si(self) -> bool:
        """Whether it differs from the unit of calculations."""
        return bool(self.ending)

    def from_si(self, number: float) -> float:
        """Return a number in this unit, given in the SI unit."""
        return number * self.per_si_unit

    def to_si(self, number: float) -> float:
        """Return a number in the SI unit, given in this unit."""
        return number * self.in_si_unit


def _in_degrees(name: str, ending: str) -> DisplayUnit:
    return DisplayUnit(
        name=name,
        ending=ending,
        per_si_unit=math.degrees(1.0),
        in_si_unit=math.radians(1.0),
    )


DISPLAY_UNITS: Mapping[str, DisplayUnit] = MappingProxyType(
    {
        "rad": _in_degrees("deg", "_deg"),
        "rad/s": _in_degrees("deg/s", "_deg_s"),
    }
)
"""Units of calculations that people never see, with those that stand for them."""


CYCLES_PER_SECOND = DisplayUnit(
    name="Hz",
    ending="_hz",
    per_si_unit=1.0 / math.tau,
    in_si_unit=math.tau,
)
"""Unit in which the angular frequency of something that repeats may be given, too."""


def display_unit(unit: str) -> DisplayUnit:
    """Return the unit in which people read and type a quantity.

    Args:
        unit: Its unit in calculations; "" for a pure number.
    """
    return DISPLAY_UNITS.get(unit, DisplayUnit(unit))
