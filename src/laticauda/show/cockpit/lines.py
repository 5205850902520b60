"""Lines in the scene of the page: a path, and the trail of a robot."""

from collections import deque
from typing import Any

import numpy as np

from laticauda.show.cockpit.shapes import Color
from laticauda.show.pictures import lift_to_space

TRAIL_STEP = 0.02
"""Minimum distance between two points of a trail [m]."""
N_TRAIL = 600
"""Maximum number of points of a trail [-]."""
TRAIL_THICKNESS = 0.012
"""[m]."""


class Line:
    """A line through points, hidden if there are too few.

    Args:
        scene: Scene of the page's server.
        name: Name of the line in the scene's tree.
        color: Color of the line.
        thickness: Thickness of the line [m].
    """

    def __init__(self, scene: Any, name: str, color: Color, thickness: float) -> None:
        self._line = scene.add_line_segments(
            name,
            points=np.zeros((1, 2, 3), np.float32),
            colors=color,
            thickness=thickness,
            visible=False,
        )

    def draw(self, points: np.ndarray) -> None:
        """Draw the line through these points [m]; hide it if there are fewer than two."""
        if len(points) > 1:
            pieces = np.stack((points[:-1], points[1:]), axis=1)
            self._line.points = pieces.astype(np.float32)
        self._line.visible = len(points) > 1


class Trail:
    """Trail of a robot: a growing line with at most `N_TRAIL` points.

    Args:
        scene: Scene of the page's server.
        name: Name of the line in the scene's tree.
        color: Color of the line.
    """

    def __init__(self, scene: Any, name: str, color: Color) -> None:
        self._line = Line(scene, name, color, TRAIL_THICKNESS)
        self._points: deque[np.ndarray] = deque(maxlen=N_TRAIL)
        self._drawn_end: np.ndarray | None = None

    def grow(self, position: np.ndarray) -> None:
        """Extend the trail to a position, in the plane or in space [m]."""
        point = lift_to_space(position, 0.0)
        if self._points:
            distance = float(np.linalg.norm(point - self._points[-1]))
            if not distance > TRAIL_STEP:
                return
        self._points.append(point)

    def draw(self) -> None:
        """Draw the trail up to its last point."""
        if not self._points:
            return
        end = self._points[-1]
        if end is not self._drawn_end:
            self._drawn_end = end
            self._line.draw(np.array(self._points))

    def forget(self) -> None:
        """Clear the trail."""
        self._points.clear()
        self._line.draw(np.empty((0, 3)))
