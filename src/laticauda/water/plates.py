"""Flat plates in water: what their proportions do to added mass, lift and drag.

A plate of height h across its chord c, with A = h / c, carries the added mass k(A) rho pi h^2 / 4 c
across itself, and lifts k_s(A) times as much as a slender one of its height at a small incidence,
rho pi h^2 / 4 u w. Both are 1 for a slender plate; for a broad one k = 1 / A and k_s = 4 / A. The table
is of a vortex lattice, extrapolated to rings of no size; its k of .579, .757 and .872 at c / h = 1, 2
and 4 are those of the handbook [1].

References:
    [1] DNV-RP-C205, Environmental conditions and environmental loads, 2010: added mass of rectangular plates
        (table D-2, from memory), drag of rectangular plates (table E-2, as quoted in secondary sources).
"""

from typing import NamedTuple

import numpy as np


class PlateRow(NamedTuple):
    """Shares of a rectangular plate of one proportion."""

    aspect: float
    """A = h / c [-]."""
    added_mass: float
    """k [-]."""
    lift: float
    """k_s [-]."""


PLATES = (
    PlateRow(0.08, 0.958, 1.000),
    PlateRow(0.24, 0.879, 0.997),
    PlateRow(0.5, 0.757, 0.985),
    PlateRow(1.0, 0.579, 0.929),
    PlateRow(2.0, 0.378, 0.787),
    PlateRow(3.0, 0.277, 0.667),
    PlateRow(4.0, 0.218, 0.575),
    PlateRow(5.56, 0.163, 0.470),
    PlateRow(8.0, 0.117, 0.365),
    PlateRow(16.0, 0.060, 0.210),
)
"""Vortex lattice of a rectangular plate, by its proportion."""
SLENDER_OVER_LONG = (0.0, 0.1, 0.2, 1.0)
"""Shorter over longer side of a plate across the flow [-]."""
DRAG_ACROSS_FLOW = (1.90, 1.50, 1.20, 1.16)
"""C_D of rectangular plates across the flow [1]."""


def plate_mass_share(aspect: float) -> float:
    """Return k, the added mass of a plate across itself over that of a slender one of its height [-].

    Args:
        aspect: A, height over length [-].
    """
    shares = [row.added_mass for row in PLATES]
    return _interpolate(aspect, shares, slope=1.0)


def plate_lift_share(aspect: float) -> float:
    """Return k_s, the lift of a plate at a small incidence over that of a slender one of its height [-].

    Args:
        aspect: A, height over length [-].
    """
    shares = [row.lift for row in PLATES]
    return _interpolate(aspect, shares, slope=0.25)


def plate_drag(height: float, length: float) -> float:
    """Return C_D of a rectangular plate across the flow, based on its area [-].

    Args:
        height: One side [m].
        length: The other side [m].
    """
    proportion = min(height, length) / max(height, length)
    return float(np.interp(proportion, SLENDER_OVER_LONG, DRAG_ACROSS_FLOW))


def _interpolate(aspect: float, shares: list[float], *, slope: float) -> float:
    """Interpolate a share, which is 1 for A = 0 and 1 / (slope A) for large A.

    The share times (1 + slope A) is 1 at both ends and varies little between. It is linear in
    A / (1 + A).
    """
    places = [0.0]
    corrected = [1.0]
    for row, share in zip(PLATES, shares, strict=True):
        places.append(row.aspect / (1.0 + row.aspect))
        corrected.append(share * (1.0 + slope * row.aspect))
    places.append(1.0)
    corrected.append(1.0)
    at_aspect = float(np.interp(aspect / (1.0 + aspect), places, corrected))
    return at_aspect / (1.0 + slope * aspect)
