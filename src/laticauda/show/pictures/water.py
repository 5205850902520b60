"""Moving water in a picture: arrows around the robot, and a surface that rises and falls."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from laticauda.robot import Environment, Water
from laticauda.show.pictures.looks import AIR, scale_fog
from laticauda.show.pictures.shapes import add_arrow
from laticauda.values import load_mujoco
from laticauda.water.fluid import Arrows, Surface, arrows_of, grid_points, has_waves

SHAFT = 0.004
"""Width of an arrow, in robot lengths."""
FAINT = 0.05
"""Length below which an arrow is omitted, relative to the spacing of arrows [-]."""
COLOR = np.array((0.80, 0.95, 1.0))
"""Red, green and blue of the arrows."""
CORNERS = 81
"""Vertices of the surface along a side."""
MESH = "waves"
"""Name of the mesh of the surface."""


class MovingWater:
    """The water of a picture, which may be moving.

    Args:
        environment: Environment of the robot.
        length: Length of the robot [m].
        region: Two corners of the region in which it will be shown, in the plane or in space, world
            axes [m].
        times: Times at which it is shown [s].
    """

    def __init__(
        self, environment: Environment, length: float, region: np.ndarray, times: Sequence[float]
    ) -> None:
        self._arrow_width = SHAFT * length
        self._arrows: Arrows | None = None
        self.surface: Surface | None = None
        """The surface of the water if it moves, else None."""
        self.captions: list[str] = []
        """Text about the arrows."""
        if not isinstance(environment, Water):
            return
        flow = environment.flow
        low, high = region
        self._arrows = arrows_of(environment.velocity, low, high, times, length, flow)
        if self._arrows is not None:
            self.captions.append(self._arrows.words)
        if flow is not None and has_waves(flow, low):
            self.surface = Surface(flow, scale_fog(length) * AIR.fog_end, CORNERS)

    def add_mesh(self, spec: Any) -> str | None:
        """Add the surface's mesh, shaped by `move`, to a `MjSpec`; return its name, or None if the surface is level.

        Args:
            spec: The `MjSpec`.
        """
        if self.surface is None:
            return None
        # Upright and oblong at first, so that its principal axes, which MuJoCo adopts as its own,
        # are the world's.
        x, y = grid_points(self.surface.line, self.surface.line).T
        upright = np.column_stack((0.0 * x, x, 2.0 * y)).ravel()
        faces = self.surface.faces
        faces_from_below = faces[:, ::-1]
        spec.add_mesh(
            name=MESH,
            uservert=upright,
            userface=np.append(faces, faces_from_below),
            inertia=load_mujoco().mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
        return MESH

    def move(self, model: Any, center: np.ndarray, time: float) -> int | None:
        """Move the surface of a model to its shape at some time.

        Args:
            model: A `MjModel` with that mesh.
            center: Position of the robot [m].
            time: Time since the start of the run [s].

        Returns:
            ID of the mesh that must be sent to the renderer, if any.
        """
        if self.surface is None:
            return None
        mesh = model.mesh(MESH)
        corners = self.surface.at(center, time)
        begin = mesh.vertadr[0]
        vertices = slice(begin, begin + len(corners))
        model.mesh_vert[vertices] = corners
        model.mesh_normal[vertices] = _surface_normals(corners, self.surface.line)
        return int(mesh.id)

    def draw(self, scene: Any, center: np.ndarray, time: float) -> None:
        """Draw the arrows.

        Args:
            scene: A `MjvScene` that is about to be drawn.
            center: Position of the robot [m].
            time: Time since the start of the run [s].
        """
        if self._arrows is None:
            return
        shortest = FAINT * self._arrows.spacing
        for tail, tip in self._arrows.around(center, time):
            if np.linalg.norm(tip - tail) > shortest:
                add_arrow(scene, tail, tip, width=self._arrow_width, color=COLOR)


def _surface_normals(corners: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Return unit normals of a surface at its corners; `line` holds the coordinates along a side [m]."""
    heights = corners[:, 2].reshape(CORNERS, CORNERS)
    slope_along_x, slope_along_y = np.gradient(heights, line, line)
    normals = np.column_stack(
        (-slope_along_x.ravel(), -slope_along_y.ravel(), np.ones(len(corners)))
    )
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
