"""Pose and appearance of every part of the robot: meshes in frames, without any graphics engine."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.spatial import appearance
from laticauda.models.spatial.bodies import AXES, build_bodies
from laticauda.robot import Robot, kinematics
from laticauda.scenarios import interfaces
from laticauda.show.pictures.camera import to_space
from laticauda.values import series

Color = tuple[int, int, int]


class Shape(NamedTuple):
    """A surface in the frame of a part."""

    part: int
    mesh: appearance.Mesh
    color: Color


@dataclass(frozen=True, kw_only=True, eq=False)
class Poses:
    """Poses of all parts at one instant: the modules, tail first, each at its tail end; then the pieces of the fin."""

    position: Float[np.ndarray, "n_parts 3"]
    """Positions [m]."""
    orientation: Float[np.ndarray, "n_parts 4"]
    """Quaternions (w, x, y, z) [-]."""
    middle: Float[np.ndarray, "n_links 3"]
    """Midpoint of every module [m]."""


def build_shapes(robot: Robot) -> list[Shape]:
    """Return the shapes of the robot: housings with their bands, a head, a plate for the fin.

    Args:
        robot: The robot as its plant has it.
    """
    found = [
        Shape(i, build(module), _color(material))
        for i, module in enumerate(robot.modules)
        for material, build in appearance.mesh_builders(is_head=i == robot.n_links - 1).items()
    ]
    fin = robot.caudal_fin
    for k, piece in enumerate(fin.pieces if fin is not None else ()):
        assert fin is not None
        boxes = [
            *filter(None, [appearance.build_fin_plate(fin, piece)]),
            *appearance.rods(fin, piece),
        ]
        found.append(
            Shape(
                robot.n_links + k, appearance.joined(*(_mesh(box) for box in boxes)), _color("fin")
            )
        )
    return found


def compute_poses(robot: Robot, sample: series.Log, height: float = 0.0) -> Poses:
    """Compute the poses of the robot's parts.

    Args:
        robot: The robot as its plant has it: with all of its modules in space, `Robot.planar` of
            them in the plane.
        sample: One sample of the plant's log, or of a trial.
        height: Height of a robot in the plane [m].
    """
    if sample.center_of_mass.size == 3:
        root = kinematics.from_quaternion(
            *(float(sample.signals[name]) for name in interfaces.ORIENTATION)
        )
    else:
        root = kinematics.turn("yaw", float(sample.link_angle[0]))
    pieces = robot.caudal_fin.pieces if robot.caudal_fin is not None else ()
    bends = [float(sample.signals.get(f"fin_angle_{k}", np.zeros(()))) for k in range(len(pieces))]
    parts, angles = build_bodies(robot), [0.0, *sample.joint_angle.tolist(), *np.negative(bends)]
    places, turns = {"": np.zeros(3)}, {"": root}
    for body, angle in zip(parts, angles, strict=True):
        before = turns[body.parent]
        places[body.name] = places[body.parent] + before @ body.position
        turns[body.name] = before @ kinematics.turn(
            "pitch" if body.axis == AXES["pitch"] else "yaw", angle
        )
    position, rotation = (
        np.array([found[body.name] for body in parts]) for found in (places, turns)
    )
    ahead, mass = rotation[:, :, 0], np.array([body.mass for body in parts])
    center = mass @ (position + np.array([[body.center] for body in parts]) * ahead) / mass.sum()
    position += to_space(sample.center_of_mass, height) - center
    middle = (
        position[: robot.n_links]
        + np.array([[one.half_length] for one in robot.modules]) * ahead[: robot.n_links]
    )
    return Poses(
        position=position,
        orientation=np.array([*map(kinematics.to_quaternion, rotation)]),
        middle=middle,
    )


def _color(material: str) -> Color:
    r, g, b, _ = appearance.MATERIALS[material][0]
    return round(255 * r), round(255 * g), round(255 * b)


def _mesh(box: appearance.Box) -> appearance.Mesh:
    """Return the mesh of a box; each face has its own corners, so that edges stay sharp."""
    corner = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    vertices = corner * box.half_size + box.position
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))]
    return appearance.Mesh(
        vertices=vertices[np.array(faces).ravel()], faces=np.arange(3 * len(faces)).reshape(-1, 3)
    )
