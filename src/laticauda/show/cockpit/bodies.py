"""A robot in the scene of the page."""

from typing import Any

import numpy as np

from laticauda.robot import Robot
from laticauda.show.cockpit.shapes import Color, Poses, Shape, build_shapes, compute_poses
from laticauda.values import series


class Body:
    """A robot in the scene: one frame per part, with the shapes in it.

    Args:
        scene: Scene of the page's server.
        name: Name of the body in the scene's tree.
        color: Color of all its shapes; None: their own.
        opacity: Opacity of its shapes; None: fully opaque [-].
    """

    def __init__(
        self, scene: Any, name: str, color: Color | None = None, opacity: float | None = None
    ) -> None:
        self._scene = scene
        self._name = name
        self._color = color
        self._opacity = opacity
        self._robot: Robot | None = None
        self._frames: list[Any] = []
        self._root = scene.add_frame(f"/{name}", show_axes=False)

    def show(self, robot: Robot, sample: series.Log) -> Poses:
        """Draw the robot as in a sample, and return the poses of its parts.

        Args:
            robot: The robot, as for `laticauda.show.cockpit.shapes.compute_poses`.
            sample: The sample.
        """
        if robot != self._robot:
            self._build(robot)
        poses = compute_poses(robot, sample)
        placed_frames = zip(self._frames, poses.position, poses.orientation, strict=True)
        for frame, position, orientation in placed_frames:
            frame.position = position
            frame.wxyz = orientation
        return poses

    def set_visible(self, is_visible: bool) -> None:
        """Show the body, or hide it in place."""
        self._root.visible = is_visible

    def remove(self) -> None:
        """Remove the body from the scene."""
        for frame in self._frames:
            frame.remove()
        self._frames = []
        self._robot = None

    def _build(self, robot: Robot) -> None:
        self.remove()
        shapes = build_shapes(robot)
        n_parts = 1 + max(shape.part for shape in shapes)
        for part in range(n_parts):
            frame = self._scene.add_frame(f"/{self._name}/part_{part}", show_axes=False)
            self._frames.append(frame)
        for index, shape in enumerate(shapes):
            self._add_shape(f"/{self._name}/part_{shape.part}/shape_{index}", shape)
        self._robot = robot

    def _add_shape(self, name: str, shape: Shape) -> None:
        self._scene.add_mesh_simple(
            name,
            vertices=shape.mesh.vertices.astype(np.float32),
            faces=shape.mesh.faces.astype(np.uint32),
            color=self._color or shape.color,
            opacity=self._opacity,
            side="double",
        )
