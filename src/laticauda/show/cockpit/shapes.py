"""Pose and appearance of every part of the robot: meshes in frames, without any graphics engine.

A part is a module, or a piece of the fin. Parts are numbered from the tail: first the modules, then
the pieces of the fin, starting at its root.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.spatial import (
    AXES,
    MATERIALS,
    Body,
    Box,
    Mesh,
    build_bodies,
    build_fin_plate,
    build_fin_rods,
    choose_builders,
    join_meshes,
)
from laticauda.robot import CaudalFin, Module, Robot, kinematics
from laticauda.scenarios import interfaces
from laticauda.show.pictures import lift_to_space
from laticauda.values import series

Color = tuple[int, int, int]
"""Red, green and blue, each from 0 to 255."""


class Shape(NamedTuple):
    """A surface in the frame of a part."""

    part: int
    """Index of the part."""
    mesh: Mesh
    color: Color


@dataclass(frozen=True, kw_only=True, eq=False)
class Poses:
    """Poses of all parts at one instant; the origin of a module is its tail end."""

    position: Float[np.ndarray, "n_parts 3"]
    """Positions [m]."""
    orientation: Float[np.ndarray, "n_parts 4"]
    """Quaternions (w, x, y, z) [-]."""
    middle: Float[np.ndarray, "n_links 3"]
    """Midpoint of every module [m]."""


# ---- shapes --------------------------------------------------------------------------------------


def build_shapes(robot: Robot) -> list[Shape]:
    """Return the shapes of the robot: housings with their bands, a head, a plate for the fin.

    Args:
        robot: The robot as its plant has it.
    """
    shapes: list[Shape] = []
    for part, module in enumerate(robot.modules):
        shapes += _module_shapes(part, module, is_head=part == robot.n_links - 1)
    if robot.caudal_fin is not None:
        shapes += _fin_shapes(robot.n_links, robot.caudal_fin)
    return shapes


def _module_shapes(part: int, module: Module, *, is_head: bool) -> list[Shape]:
    builders = choose_builders(is_head=is_head)
    return [Shape(part, build(module), _color_of(name)) for name, build in builders.items()]


def _fin_shapes(first_part: int, fin: CaudalFin) -> list[Shape]:
    shapes: list[Shape] = []
    for part, piece in enumerate(fin.pieces, first_part):
        plate = build_fin_plate(fin, piece)
        boxes = build_fin_rods(fin, piece)
        if plate is not None:
            boxes = [plate, *boxes]
        mesh = join_meshes(*map(_box_mesh, boxes))
        shapes.append(Shape(part, mesh, _color_of("fin")))
    return shapes


def _color_of(material_name: str) -> Color:
    red, green, blue, _ = MATERIALS[material_name][0]
    return round(255 * red), round(255 * green), round(255 * blue)


BOX_CORNERS = np.array(
    [
        (-1.0, -1.0, -1.0),
        (-1.0, -1.0, 1.0),
        (-1.0, 1.0, -1.0),
        (-1.0, 1.0, 1.0),
        (1.0, -1.0, -1.0),
        (1.0, -1.0, 1.0),
        (1.0, 1.0, -1.0),
        (1.0, 1.0, 1.0),
    ]
)
"""Corners of a box, in half of its sizes."""
BOX_SIDES = (
    (0, 1, 3, 2),
    (4, 6, 7, 5),
    (0, 4, 5, 1),
    (2, 3, 7, 6),
    (0, 2, 6, 4),
    (1, 5, 7, 3),
)
"""Corners of every side, counterclockwise when seen from outside."""


def _box_mesh(box: Box) -> Mesh:
    """Return the mesh of a box; each triangle has its own corners, so that edges stay sharp."""
    corners = BOX_CORNERS * box.half_size + box.position
    triangles: list[tuple[int, int, int]] = []
    for a, b, c, d in BOX_SIDES:
        triangles += [(a, b, c), (a, c, d)]
    n_vertices = 3 * len(triangles)
    return Mesh(
        vertices=corners[np.array(triangles).ravel()],
        faces=np.arange(n_vertices).reshape(-1, 3),
    )


# ---- poses ---------------------------------------------------------------------------------------


def compute_poses(robot: Robot, sample: series.Log, height: float = 0.0) -> Poses:
    """Compute the poses of the robot's parts.

    Args:
        robot: The robot as its plant has it: with all of its modules in space, `Robot.planar` of
            them in the plane.
        sample: One sample of the plant's log, or of a trial.
        height: Height of a robot in the plane [m].
    """
    bodies = build_bodies(robot)
    position, rotation = _place_bodies(bodies, _tail_rotation(sample), _angles(robot, sample))
    ahead = rotation[:, :, 0]
    mass = np.array([body.mass for body in bodies])
    center_on_axis = np.array([[body.center] for body in bodies])
    center = mass @ (position + center_on_axis * ahead) / mass.sum()
    position += lift_to_space(sample.center_of_mass, height) - center
    half_length = np.array([[module.half_length] for module in robot.modules])
    n_links = robot.n_links
    return Poses(
        position=position,
        orientation=np.array([kinematics.to_quaternion(matrix) for matrix in rotation]),
        middle=position[:n_links] + half_length * ahead[:n_links],
    )


def _tail_rotation(sample: series.Log) -> np.ndarray:
    """Return the rotation matrix of module 0."""
    if sample.center_of_mass.size == 2:
        return kinematics.turn("yaw", float(sample.link_angle[0]))
    quaternion = [float(sample.signals[name]) for name in interfaces.ORIENTATION]
    return kinematics.from_quaternion(*quaternion)


def _angles(robot: Robot, sample: series.Log) -> list[float]:
    """Return the angle of every body relative to its parent [rad]; that of module 0 is 0."""
    n_pieces = 0
    if robot.caudal_fin is not None:
        n_pieces = len(robot.caudal_fin.pieces)
    straight = np.zeros(())
    bends = [float(sample.signals.get(f"fin_angle_{k}", straight)) for k in range(n_pieces)]
    return [0.0, *sample.joint_angle.tolist(), *np.negative(bends)]


def _place_bodies(
    bodies: Sequence[Body], tail_rotation: np.ndarray, angles: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions [m] and rotation matrices of all bodies, from an origin at module 0."""
    position_of = {"": np.zeros(3)}
    rotation_of = {"": tail_rotation}
    for body, angle in zip(bodies, angles, strict=True):
        axis = "pitch" if body.axis == AXES["pitch"] else "yaw"
        parent_rotation = rotation_of[body.parent]
        position_of[body.name] = position_of[body.parent] + parent_rotation @ body.position
        rotation_of[body.name] = parent_rotation @ kinematics.turn(axis, angle)
    position = np.array([position_of[body.name] for body in bodies])
    rotation = np.array([rotation_of[body.name] for body in bodies])
    return position, rotation
