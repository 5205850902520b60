"""The surface of moving water, as it is drawn: its height at places, and a patch of triangles around a robot.

Figures, films and the live page all use this module, so that the same water looks the same in each.
"""

import math
from typing import Any

import numpy as np

from laticauda.water.fluid.flow import Flow

MOMENTS = (0.0, 0.31, 0.83, 1.7, 3.1, 5.3, 9.1, 17.0)
"""Default times at which the water is sampled [s]."""
FINE = 0.25
"""Spacing in the middle of the surface patch, relative to that of an even one [-]."""
WAVE_PROBE_REACH = 5.0
"""Distance along x and y within which points are drawn to see whether the surface moves [m]."""
N_WAVE_PROBES = 64
"""Number of these points."""


def grid_points(x: Any, y: Any) -> np.ndarray:
    """Return all points with one of these x and one of these y, shape (n, 2); y varies fastest."""
    return np.column_stack((np.repeat(x, y.size), np.tile(y, x.size)))


def surface_elevation(flow: Flow | None, places: np.ndarray, t: float) -> np.ndarray:
    """Return the height of the surface above its mean; infinite without a flow.

    Args:
        flow: Flow of the water.
        places: Points, shape (n, 2) [m].
        t: Time since the start of the run [s].
    """
    if flow is None:
        return np.full(len(places), math.inf)
    x, y = places.T
    motion = flow.motion(x, y, 0.0 * x, t)
    return np.broadcast_to(motion.elevation, x.shape)


def has_waves(flow: Flow | None, middle: np.ndarray) -> bool:
    """Return whether the surface of a flow moves near a point in the plane [m]."""
    if flow is None:
        return False
    random = np.random.default_rng(0)
    offsets = random.uniform(-WAVE_PROBE_REACH, WAVE_PROBE_REACH, (N_WAVE_PROBES, 2))
    places = middle[:2] + offsets
    return any(np.any(surface_elevation(flow, places, moment)) for moment in MOMENTS)


class Surface:
    """The surface around a robot as triangles, finer in the middle.

    Args:
        flow: Flow that moves the surface.
        reach: Distance from the middle to the sides [m].
        count: Number of corners along a side.
    """

    def __init__(self, flow: Flow, reach: float, count: int) -> None:
        self._flow = flow
        even = np.linspace(-1.0, 1.0, count)
        self.line = reach * (FINE * even + (1.0 - FINE) * even**3)
        """Positions of the corners along x and y, from the middle [m]."""
        self.faces = _triangles_of_grid(count)
        """Corners of each triangle, counter-clockwise as seen from above."""

    def at(self, middle: np.ndarray, t: float) -> np.ndarray:
        """Return the corners for a given middle and time, shape (count^2, 3) [m]; y varies fastest."""
        places = middle[:2] + grid_points(self.line, self.line)
        return np.column_stack((places, surface_elevation(self._flow, places, t)))


def _triangles_of_grid(count: int) -> np.ndarray:
    """Return the corners of two triangles for each cell of a square grid, shape (n, 3)."""
    corners = np.arange(count * count).reshape(count, count)
    a = corners[:-1, :-1]
    b = corners[1:, :-1]
    c = corners[1:, 1:]
    d = corners[:-1, 1:]
    return np.stack((a, b, c, a, c, d), axis=-1).reshape(-1, 3)
