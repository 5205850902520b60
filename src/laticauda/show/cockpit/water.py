"""Moving water in the scene of the page: arrows around the robot, and a surface that rises and falls."""

from typing import Any, NamedTuple

import numpy as np

from laticauda.robot import Environment, Robot, Water
from laticauda.show.pictures import lift_to_space
from laticauda.water.fluid import MOMENTS, Arrows, Surface, arrows_of, has_waves

SURFACE_REACH = 10.0
"""Distance from the robot to the sides of the surface that is drawn [m]."""
SURFACE_CORNERS = 29
"""Corners along one side of it."""
ARROW_COLOR = (205, 240, 255)
ARROW_LOOK: dict[str, Any] = {
    "shaft_radius": 0.006,
    "head_radius": 0.018,
    "head_length": 0.05,
}
"""Arguments of viser for the arrows; lengths in m."""
SURFACE_LOOK: dict[str, Any] = {
    "wireframe": True,
    "opacity": 0.35,
    "color": [120, 200, 220],
    "cast_shadow": False,
    "receive_shadow": False,
}
"""Arguments of viser for the surface."""


class WaterShown(NamedTuple):
    """What arrows and surface depend on, once they are created."""

    center: list[float]
    """Grid point of the arrows that is nearest to the robot [m]."""
    time: float | None
    """Time since the start of the run; None in a uniform current, which is sent once [s]."""


class MovingWater:
    """The water of a scene, if it moves.

    Args:
        scene: Scene of the page's server.
    """

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._environment: Environment | None = None
        self._robot: Robot | None = None
        self._shown: WaterShown | None = None
        self._arrows: Arrows | None = None
        self._arrows_handle: Any = None
        self.surface: Surface | None = None
        """Surface of the water, if it moves."""
        self._surface_handle: Any = None

    def show(
        self, environment: Environment, robot: Robot, position: np.ndarray, time: float
    ) -> None:
        """Update arrows and surface.

        Args:
            environment: Environment of the robot.
            robot: Robot around which the water is shown.
            position: Center of mass of the robot, in the plane or in space [m].
            time: Time since the start of the run [s].
        """
        if environment != self._environment or robot != self._robot:
            self._environment = environment
            self._robot = robot
            self._remove()
            if isinstance(environment, Water):
                self._add(environment, robot, position, time)
        if not isinstance(environment, Water) or self._arrows is None:
            return
        center = _nearest_grid_point(self._arrows, position)
        shown = WaterShown(center.tolist(), None if environment.flow is None else time)
        if shown == self._shown:
            return
        self._shown = shown
        self._arrows_handle.points = self._arrows.around(center, time).astype(np.float32)
        if self.surface is not None:
            corners = self.surface.at(center, time) + _surface_offset(environment, self._arrows)
            self._surface_handle.vertices = corners.astype(np.float32)

    def _remove(self) -> None:
        """Remove arrows and surface from the scene."""
        if self._arrows_handle is not None:
            self._arrows_handle.remove()
        if self._surface_handle is not None:
            self._surface_handle.remove()
        self._arrows_handle = None
        self._surface_handle = None
        self._arrows = None
        self.surface = None
        self._shown = None

    def _add(self, water: Water, robot: Robot, position: np.ndarray, time: float) -> None:
        """Create arrows and surface, if this water moves."""
        flow = water.flow
        times = [time + moment for moment in MOMENTS]
        self._arrows = arrows_of(water.velocity, position, position, times, robot.reach, flow)
        if self._arrows is None:
            return
        arrows = self._arrows.around(lift_to_space(position, 0.0), time).astype(np.float32)
        self._arrows_handle = self._scene.add_arrows(
            "/water/arrows", arrows, ARROW_COLOR, **ARROW_LOOK
        )
        if flow is not None and has_waves(flow, position):
            self.surface = Surface(flow, SURFACE_REACH, SURFACE_CORNERS)
            self._surface_handle = self._scene.add_mesh_simple(
                "/water/surface",
                self.surface.at(position, time).astype(np.float32),
                self.surface.faces.astype(np.uint32),
                **SURFACE_LOOK,
            )


def _nearest_grid_point(arrows: Arrows, position: np.ndarray) -> np.ndarray:
    """Return the point of the arrows' grid that is nearest to a robot, at its height [m]."""
    x, y = arrows.spacing * np.round(position[:2] / arrows.spacing)
    height = 0.0 if arrows.axes == 2 else position[2]
    return np.array((x, y, height))


def _surface_offset(water: Water, arrows: Arrows) -> np.ndarray:
    """Return the shift of the surface [m]: a robot in the plane is drawn at height 0, below it."""
    height = 0.0
    if arrows.axes == 2:
        height = water.depth or 0.0
    return np.array((0.0, 0.0, height))
