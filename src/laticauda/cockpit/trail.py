"""A trail: where a robot has been."""

from typing import Any

import numpy as np

from laticauda.cockpit.shapes import Color

N_POINTS = 600  # of a trail [-]
LEAST_STEP = 0.01  # between two of them [m]


class Trail:
    """A line that grows, and never gets longer than `N_POINTS`.

    Args:
        scene: Of the page's server.
        name: Of the line in the scene's tree.
        color: Of the line.
    """

    def __init__(self, scene: Any, name: str, color: Color) -> None:
        self._scene, self._name, self._color = scene, name, color
        self._points: list[np.ndarray] = []
        self._line: Any = None

    def grow(self, place: np.ndarray) -> None:
        """Let it grow to a place, in the plane or in space [m]."""
        place = np.array([*place, 0.0]) if place.size == 2 else np.asarray(place)
        if self._points and float(np.linalg.norm(place - self._points[-1])) < LEAST_STEP:
            return
        self._points = [*self._points[1 - N_POINTS :], place]
        if len(self._points) < 2:
            return
        points = np.stack((self._points[:-1], self._points[1:]), axis=1).astype(np.float32)
        if self._line is None:
            self._line = self._scene.add_line_segments(self._name, points=points, colors=self._color, thickness=0.012)
        else:
            self._line.points = points

    def forget(self) -> None:
        """Begin anew."""
        self._points = []
        if self._line is not None:
            self._line.remove()
            self._line = None
