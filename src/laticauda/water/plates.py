"""Flat plates across the flow.

What their proportions do to their added mass and their lift is in `laticauda.water.fluid.edges`.

References:
    DNV-RP-C205, Environmental conditions and environmental loads, 2010, table E-2 (as quoted in
    secondary sources).
"""

import numpy as np

SHORT_OVER_LONG_SIDE = (0.0, 0.1, 0.2, 1.0)
DRAG_ACROSS_FLOW = (1.90, 1.50, 1.20, 1.16)
"""C_D of rectangular plates across the flow."""


def plate_drag(height: float, length: float) -> float:
    """Return C_D of a rectangular plate across the flow, based on its area [-].

    Args:
        height: One side [m].
        length: The other side [m].
    """
    proportion = min(height, length) / max(height, length)
    return float(np.interp(proportion, SHORT_OVER_LONG_SIDE, DRAG_ACROSS_FLOW))
