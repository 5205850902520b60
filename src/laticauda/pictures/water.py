"""Water that moves, in pictures: arrows around the robot, and a surface that rises and falls."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from laticauda.extras import load_mujoco
from laticauda.fluid.arrows import Surface, arrows_of, grid, has_waves
from laticauda.pictures.lines import add_piece
from laticauda.pictures.surroundings import AIR, CLEAR
from laticauda.robot import Environment, Water

SHAFT = 0.004  # width of an arrow, in lengths of the robot
FAINT = 0.05  # length of an arrow that is left out, to the way from one to the next [-]
COLOR = np.array((0.80, 0.95, 1.0))
CORNERS = 81  # of the surface, along a side
NAME = "waves"


class MovingWater:
    """The water of a picture, if it moves.

    Args:
        environment: Where the robot is.
        length: Of the robot [m].
        way: Two corners of where it will be shown, in the plane or in space, world axes [m].
        times: In which it is shown [s].
    """

    def __init__(
        self,
        environment: Environment,
        length: float,
        way: np.ndarray,
        times: Sequence[float],
    ) -> None:
        self._length, self._arrows, flow = length, None, None
        if isinstance(environment, Water):
            flow = environment.flow
            self._arrows = arrows_of(environment.velocity, way[0], way[1], times, length, flow)
        self.words = [self._arrows.words] if self._arrows else []
        """What there is to say of the arrows."""
        self.surface: Surface | None = None
        """If it moves."""
        if flow is not None and has_waves(flow, way[0]):
            self.surface = Surface(flow, max(1.0, CLEAR * length) * AIR.fog[1], CORNERS)

    def mesh(self, model: Any) -> str | None:
        """Put a mesh into a `MjSpec` that `move` makes the surface; its name, or None if that is level."""
        if self.surface is None:
            return None
        # Upright and oblong for now: so the axes of its inertia, which MuJoCo takes for its own, are the world's.
        x, y = grid(self.surface.line, self.surface.line).T
        faces, inertia = self.surface.faces, load_mujoco().mjtMeshInertia.mjMESH_INERTIA_SHELL
        upright = np.column_stack((0.0 * x, x, 2.0 * y)).ravel()
        model.add_mesh(name=NAME, uservert=upright, userface=np.append(faces, faces[:, ::-1]), inertia=inertia)
        return NAME

    def move(self, model: Any, center: np.ndarray, t: float) -> int | None:
        """Let the surface of a model rise and fall.

        Args:
            model: A `MjModel` with that mesh.
            center: Of the robot [m].
            t: Since the start of the run [s].

        Returns:
            The mesh that has to be sent to the renderer, if any.
        """
        if self.surface is None:
            return None
        mesh, line, corners = model.mesh(NAME), self.surface.line, self.surface.at(center, t)
        slopes = np.gradient(corners[:, 2].reshape(CORNERS, CORNERS), line, line)
        normal = np.column_stack((-slopes[0].ravel(), -slopes[1].ravel(), np.ones(len(corners))))
        own = slice(mesh.vertadr[0], mesh.vertadr[0] + len(corners))
        model.mesh_vert[own], model.mesh_normal[own] = corners, normal / np.linalg.norm(normal, axis=1, keepdims=True)
        return int(mesh.id)

    def draw(self, scene: Any, center: np.ndarray, t: float) -> None:
        """Draw the arrows into a `MjvScene`; arguments as for `move`."""
        if self._arrows is None:
            return
        for tail, tip in self._arrows.around(center, t):
            if np.linalg.norm(tip - tail) > FAINT * self._arrows.spacing:
                add_piece(scene, tail, tip, SHAFT * self._length, COLOR, "ARROW")
