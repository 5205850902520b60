"""Units as tables state them: in a row of units, in brackets behind a name, or as its last part, such as `x_mm`."""

import math
import re

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254}
"""Length of each unit [m]; as in all these tables, the first unit is the default."""
ANGLES = {"rad": 1.0, "deg": math.pi / 180.0}
"""Angle of each unit [rad]."""
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""Time of each unit [s]."""
RATES = {"rad/s": 1.0, "deg/s": math.pi / 180.0}
"""Angular rate of each unit [rad/s]."""
TORQUES = {"N m": 1.0, "N cm": 1e-2, "N mm": 1e-3}
"""Torque of each unit [N m]."""
SPELLINGS = {
    "\N{DEGREE SIGN}": "deg",
    "\N{DEGREE SIGN}/s": "deg/s",
    "centimeter": "cm",
    "degree": "deg",
    "inch": "in",
    "meter": "m",
    "metre": "m",
    "\N{MICRO SIGN}s": "us",
    "\N{GREEK SMALL LETTER MU}s": "us",
    "millimeter": "mm",
    "millimetre": "mm",
    "nm": "N m",
    "radian": "rad",
    "sec": "s",
    "second": "s",
}
"""Units by other ways to write them, in lower case and without the s of the plural."""
OTHER_UNITS = frozenset(
    "m/s cm/s mm/s km/h ft/s in/s kn knots bl/s hz rpm rev/s turns/s cycles/s a ma v mv w mw kw n "
    "kg g km um ft yd bl min h hours grad rev turns".split()
)
"""Further units that people write in brackets or in a row of units, in lower case; none of them is converted."""
NO_UNIT = ("", "-", "1", "n/a")
"""What stands in a row of units below a column without one."""
SUFFIXES = {
    "deg": "deg",
    "deg_s": "deg/s",
    "rad": "rad",
    "rad_s": "rad/s",
    "m_s": "m/s",
    "cm_s": "cm/s",
    "mm_s": "mm/s",
    "mm": "mm",
    "cm": "cm",
    "m": "m",
    "s": "s",
    "ms": "ms",
    "us": "us",
    "ns": "ns",
    "W": "W",
}
"""Units by the last part of a name."""
_IN_BRACKETS = re.compile(r"(.*\S)\s*[\[(]([^\[\]()]*)[\])]")
_IN_SQUARE_BRACKETS = re.compile(r".*\S\s*\[([^\[\]]*)\]")
_BY_LENGTH = sorted(SUFFIXES, key=len, reverse=True)


def read_unit(text: str) -> str | None:
    """Return the unit that a text means, as it is written here; None if it is none.

    Args:
        text: Text from a file, such as `MM`, `[deg]` or `meters`.
    """
    stripped = text.strip().strip("[]()").strip()
    for units in (LENGTHS, ANGLES, TIMES, RATES, TORQUES):
        if stripped in units:
            return stripped
    lowered = stripped.lower()
    for spelling in (lowered, lowered.removesuffix("s")):
        if spelling in SPELLINGS:
            return SPELLINGS[spelling]
    for units in (LENGTHS, ANGLES, TIMES, RATES):
        if lowered in units:
            return lowered
    if lowered in OTHER_UNITS:
        return stripped
    return None


def split_unit(name: str) -> tuple[str, str | None]:
    """Return the name of a column without the unit in brackets behind it, and that unit if there is one.

    Args:
        name: Name in the file, such as `joint_1 [deg]`.
    """
    match = _IN_BRACKETS.fullmatch(name)
    if match is None:
        return name, None
    unit = read_unit(match[2])
    if unit is None:
        return name, None
    return match[1], unit


def unknown_unit(name: str) -> str | None:
    """Return the text in square brackets behind a name if it is no unit that is known here.

    Args:
        name: Name in the file; the number in `angle[0]` is none.
    """
    match = _IN_SQUARE_BRACKETS.fullmatch(name)
    if match is None:
        return None
    text = match[1].strip()
    if text.lower() in NO_UNIT or text.isdecimal() or read_unit(text) is not None:
        return None
    return text


def unit_in_name(name: str) -> str | None:
    """Return the unit that a name states, in brackets or as its last part; None if it states none.

    Args:
        name: Name of a column, such as `x_mm` or `x [mm]`.
    """
    _, unit = split_unit(name)
    if unit is not None:
        return unit
    for suffix in _BY_LENGTH:
        if name.endswith(f"_{suffix}"):
            return SUFFIXES[suffix]
    return None
