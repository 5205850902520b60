"""Variable of an exported robot: one number that another tool may set or read, and the kernel rows behind it."""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

from laticauda.values import Quantity

Causality = Literal["independent", "parameter", "input", "output"]
"""Independent: time; parameter: set before the start; input: set at any time; output: read."""

LARGEST_POSITION = 1e5
"""Largest position [m] and angle [rad] that may be set, as for `Start`."""
SMALLEST_POSITIVE = 1e-9
"""Smallest accepted value of what must be positive, in its unit."""


class RowShare(NamedTuple):
    """A row of the kernels, and the factor between it and a variable."""

    row: int
    """Index of the row [-]."""
    factor: float
    """Factor of the row in an output, or of the variable in a row that it sets."""


class SensorFormula(NamedTuple):
    """What a sensor measures; see `laticauda.connect.native.sensor_formulas`."""

    kind: int
    """What it is."""
    numbers: tuple[float, ...] = ()
    """Numbers of the sensor that it needs."""


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One number that is exchanged with another tool."""

    name: str
    """Name that other tools show; joints and links are numbered from 0 at the tail [-]."""
    causality: Causality
    """independent (time), parameter (set before the start), input (set at any time) or output [-]."""
    unit: str
    """Unit, as in `laticauda.connect.fmu.units.UNITS`; 1: dimensionless [-]."""
    description: str
    """Description [-]."""
    symbol: str = ""
    """Symbol in the formulas of the docs [-]."""
    start: float = 0.0
    """Value if it is not set [unit]."""
    least: float = -math.inf
    """Smallest accepted value [unit]."""
    most: float = math.inf
    """Largest accepted value [unit]."""
    rows: tuple[RowShare, ...] = ()
    """Rows and factors: an output is their weighted sum; for others, each row is set to its factor times the value."""
    start_rows: tuple[RowShare, ...] = ()
    """Rows and factors of an input that apply only at the start."""
    formula: SensorFormula | None = None
    """What a sensor measures, of an output that is not a sum of rows."""
    coefficient: str = ""
    """Name of the field of `Water` that a parameter represents, if no single row holds it [-]."""

    @property
    def is_settable(self) -> bool:
        """Whether another tool may set the variable."""
        return self.causality in ("parameter", "input")

    @property
    def shown_unit(self) -> str:
        """Unit as shown to people; "-" if it is dimensionless [-]."""
        return "-" if self.unit == "1" else self.unit


def one_row(row: int) -> tuple[RowShare, ...]:
    """Return the shares of a variable that is a single row.

    Args:
        row: Index of the row.
    """
    return (RowShare(row=row, factor=1.0),)


def unit_of(quantity: Quantity) -> str:
    """Return the unit of a declared number, as in files of the compiled function.

    Args:
        quantity: What is declared of the number.
    """
    return quantity.unit.replace(" ", ".").replace("^", "") or "1"
