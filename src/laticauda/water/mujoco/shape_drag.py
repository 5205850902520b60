"""Drag coefficients of boxes and rods that move along one of their axes, on the projected area.

Values for sharp edges and subcritical Reynolds numbers; between them straight lines.

References:
    DNV-RP-C205, Environmental conditions and environmental loads, 2010, table E-2 (as quoted in
    secondary sources).
"""

import numpy as np

from laticauda.water.mujoco.elements import Three
from laticauda.water.plates import plate_drag

SQUARE_ROD_LENGTH = (0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)
"""Length along the flow over the side [-]."""
SQUARE_ROD = (1.16, 1.15, 0.97, 0.87, 0.90, 0.93, 0.95)
"""C_D of rods of square section along the flow."""
ROUND_ROD_LENGTH = (0.0, 1.0, 2.0, 4.0, 7.0)
"""Length over diameter [-]."""
ROUND_ROD = (1.12, 0.91, 0.85, 0.87, 0.99)
"""C_D of round rods along the flow."""
LONG_ROUND_ROD = 1.2
"""C_D of an endless cylinder across the flow."""
DIAMETER_OVER_LENGTH = (0.0, 0.01, 0.02, 0.025, 0.05, 0.1, 0.2, 0.5)
SHARE_OF_LONG_ROD = (1.0, 0.98, 0.87, 0.82, 0.74, 0.68, 0.62, 0.58)
"""C_D of a cylinder with two free ends over that of an endless one."""


def drag_of_box(half: Three, axis: int) -> float:
    """Return C_D of a box along an axis: the plate that it shows, times the effect of its length along the flow."""
    side_1 = half[(axis + 1) % 3]
    side_2 = half[(axis + 2) % 3]
    of_rod = np.interp(half[axis] / min(side_1, side_2), SQUARE_ROD_LENGTH, SQUARE_ROD)
    return float(plate_drag(side_1, side_2) * of_rod / SQUARE_ROD[0])


def drag_along_rod(slenderness: float) -> float:
    """Return C_D of a cylinder along its axis; length over diameter."""
    return float(np.interp(slenderness, ROUND_ROD_LENGTH, ROUND_ROD))


def drag_across_rod(slenderness: float) -> float:
    """Return C_D of a cylinder across its axis; length over diameter."""
    share = np.interp(1.0 / slenderness, DIAMETER_OVER_LENGTH, SHARE_OF_LONG_ROD)
    return float(LONG_ROUND_ROD * share)
