"""Aligned tables of plain text, and numbers with their units."""

import math
from collections.abc import Sequence

# Units of the SI that people read in others: factor and name.
READ_IN = {"rad": (math.degrees(1.0), "deg"), "rad/s": (math.degrees(1.0), "deg/s")}
MISSING = "-"


def aligned(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Rows as lines whose columns begin (or, for the columns `right`, end) one below the other."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join(
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
    return "\n".join(lines)


def read_in(value: float | None, unit: str) -> tuple[str, str]:
    """A figure as a table shows it: the number, and the unit that it is read in."""
    factor, shown = READ_IN.get(unit, (1.0, unit))
    if value is None:
        return MISSING, shown
    return number(value * factor), shown


def number(value: float) -> str:
    """Four significant digits, without an exponent where that stays short; rounding noise is zero."""
    if abs(value) < 1e-6:
        return "0"
    if not 1e-3 <= abs(value) < 1e6:
        return f"{value:.3e}"
    decimals = max(0, 3 - math.floor(math.log10(abs(value))))
    return f"{value:.{decimals}f}"


def percent(value: float | None) -> str:
    """A difference in percent, with its sign."""
    return MISSING if value is None else f"{value:+.1f} %"
