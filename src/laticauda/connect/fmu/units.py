"""Units of the variables of an FMU."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit as a product of powers of base units."""

    name: str
    """Name [-]."""
    kg: int = 0
    """Exponent of the kilogram [-]."""
    m: int = 0
    """Exponent of the meter [-]."""
    s: int = 0
    """Exponent of the second [-]."""
    rad: int = 0
    """Exponent of the radian [-]."""
    display_name: str = ""
    """Unit with degrees in which angles and their rates are shown; empty for others [-]."""


DEGREES_PER_RADIAN = 180.0 / math.pi
"""Factor from a unit with radians to its display unit [deg/rad]."""

_ALL_UNITS = (
    Unit(name="1"),
    Unit(name="rad", rad=1, display_name="deg"),
    Unit(name="rad/s", s=-1, rad=1, display_name="deg/s"),
    Unit(name="m", m=1),
    Unit(name="m/s", m=1, s=-1),
    Unit(name="s", s=1),
    Unit(name="kg/m3", kg=1, m=-3),
    Unit(name="N.m", kg=1, m=2, s=-2),
    Unit(name="N.m2", kg=1, m=3, s=-2),
    Unit(name="N.m/rad", kg=1, m=2, s=-2, rad=-1),
    Unit(name="N.m.s/rad", kg=1, m=2, s=-1, rad=-1),
    Unit(name="1/rad", rad=-1),
    Unit(name="kg", kg=1),
    Unit(name="kg.m2", kg=1, m=2),
    Unit(name="W", kg=1, m=2, s=-3),
    Unit(name="J", kg=1, m=2, s=-2),
)
UNITS = {unit.name: unit for unit in _ALL_UNITS}
"""Units by name; a variable in another unit is described without one."""
