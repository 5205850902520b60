"""Moving water in the scene: arrows around the robot, and a surface that rises and falls."""

from typing import Any

import numpy as np

from laticauda.fluid.arrows import MOMENTS, Arrows, Surface, arrows_of, has_waves
from laticauda.robot import Environment, Robot, Water

WIDE, CORNERS = 10.0, 29  # of the surface: from the robot to its sides [m], and its corners along one of these
ARROW = (205, 240, 255)
SIZES: Any = {"shaft_radius": 0.006, "head_radius": 0.018, "head_length": 0.05}  # of an arrow [m]
LOOK: Any = {
    "wireframe": True,
    "opacity": 0.35,
    "color": (120, 200, 220),
    "cast_shadow": False,
    "receive_shadow": False,
}


class MovingWater:
    """The water of a scene, if it moves.

    Args:
        scene: Of the page's server.
    """

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._shown: tuple[Environment, Robot] | None = None
        self._drawn: object = None
        self._arrows: Arrows | None = None
        self.surface: Surface | None = None
        """If it moves."""
        self._handles: list[Any] = []  # of the arrows, and of that

    def show(self, environment: Environment, robot: Robot, place: np.ndarray, t: float) -> None:
        """Bring it up to date.

        Args:
            environment: Where the robot is.
            robot: Around which it is shown.
            place: Its center of mass, in the plane or in space [m].
            t: Since the start of the run [s].
        """
        if (environment, robot) != self._shown:
            self._shown = environment, robot
            self._begin(environment, robot, place, t)
        if not isinstance(environment, Water) or self._arrows is None:
            return
        step, axes = self._arrows.spacing, self._arrows.axes
        near = np.array((*(step * np.round(place[:2] / step)), 0.0 if axes == 2 else place[2]))
        now = (near.tolist(), None if environment.flow is None else t)
        if now != self._drawn:  # a uniform current is sent once
            self._drawn, self._handles[0].points = now, self._arrows.around(near, t).astype(np.float32)
            if self.surface is not None:  # above a robot in the plane, which is at 0
                level = np.array((0.0, 0.0, (environment.depth or 0.0) if axes == 2 else 0.0))
                self._handles[1].vertices = (self.surface.at(near, t) + level).astype(np.float32)

    def _begin(self, environment: Environment, robot: Robot, place: np.ndarray, t: float) -> None:
        """With other water, or another robot."""
        for handle in self._handles:
            handle.remove()
        self._handles, self.surface, self._arrows, self._drawn = [], None, None, None
        if not isinstance(environment, Water):
            return
        flow, times = environment.flow, [t + moment for moment in MOMENTS]
        self._arrows = arrows_of(environment.velocity, place, place, times, robot.reach, flow)
        if self._arrows is not None:
            arrows = self._arrows.around(np.append(place, 0.0)[:3], t).astype(np.float32)
            self._handles.append(self._scene.add_arrows("/water/arrows", arrows, ARROW, **SIZES))
        if self._arrows is not None and flow is not None and has_waves(flow, place):
            self.surface = Surface(flow, WIDE, CORNERS)
            corners, faces = self.surface.at(place, t).astype(np.float32), self.surface.faces.astype(np.uint32)
            self._handles.append(self._scene.add_mesh_simple("/water/surface", corners, faces, **LOOK))
