"""A doubt about something described, and the unit in which a number was probably meant."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from laticauda.values import BadArgument

Range: TypeAlias = tuple[float, float]
"""Smallest and largest value."""


@dataclass(frozen=True, kw_only=True)
class Doubt:
    """Something in a description that cannot be, or hardly is."""

    name: str
    """Name of the argument."""
    rule: str
    """The rule with its unit, and the value, without a final period; it may end in a suggestion."""
    refuses: bool = False
    """Whether it cannot be; otherwise it hardly is."""

    @property
    def error(self) -> BadArgument:
        """The doubt as an error, whose text is also that of a warning."""
        return BadArgument(self.name, self.rule)


class Unit(NamedTuple):
    """A unit that people use instead of ours."""

    name: str
    size: float
    """How much of our unit it is."""


LENGTHS = (Unit("mm", 1e-3), Unit("cm", 1e-2))
"""Other units than m."""
MASSES = (Unit("g", 1e-3), Unit("t", 1e3))
"""Other units than kg."""
INERTIAS = (
    Unit("kg cm^2", 1e-4),
    Unit("kg mm^2", 1e-6),
    Unit("g cm^2", 1e-7),
    Unit("g mm^2", 1e-9),
)
"""Other units than kg m^2."""
DENSITIES = (Unit("g/cm^3", 1e3),)
"""Other units than kg/m^3."""
SPEEDS = (Unit("cm/s", 1e-2), Unit("mm/s", 1e-3))
"""Other units than m/s."""
TIMES = (Unit("ms", 1e-3),)
"""Other units than s."""


def must_be(name: str, rule: str, value: float, hint: str = "") -> Doubt:
    """Return a doubt about something that cannot be.

    Args:
        name: Name of the argument.
        rule: What it must be, with its unit.
        value: The value given.
        hint: What was probably meant, or "".
    """
    return Doubt(name=name, rule=f"must be {rule}, got {value:.6g}{hint}", refuses=True)


def hardly_is(name: str, value: float, unit: str, remark: str, hint: str = "") -> Doubt:
    """Return a doubt about something that hardly is.

    Args:
        name: Name of the argument.
        value: The value given.
        unit: Its unit, or "".
        remark: What it means, after the value.
        hint: What was probably meant, or "".
    """
    amount = f"{value:.4g} {unit}".rstrip()
    return Doubt(name=name, rule=f"of {amount} {remark}{hint}")


def suggest_unit(value: float, units: Sequence[Unit], usual: Range) -> str:
    """Return the end of a rule: "; did you mean 0.1 (100 mm)?", or "" if no unit makes the value usual.

    Args:
        value: The value given.
        units: Units in which it may have been meant.
        usual: Smallest and largest value that somebody means, in our unit.
    """
    for unit in units:
        meant = value * unit.size
        if is_within(abs(meant), usual):
            return f"; did you mean {meant:.4g} ({value:g} {unit.name})?"
    return ""


def is_within(value: float, limits: Range) -> bool:
    """Return whether a value lies between two others.

    Args:
        value: The value.
        limits: The smallest and the largest.
    """
    low, high = limits
    return low <= value <= high
