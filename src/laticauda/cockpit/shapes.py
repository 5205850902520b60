"""Where every part of the robot is, and what it looks like: meshes in frames, without any engine."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.interfaces import ORIENTATION
from laticauda.kinematics import Posture, from_quaternion, module_poses, to_quaternion, turned_about_vertical
from laticauda.robot import CaudalFin, Robot
from laticauda.series import Log
from laticauda.spatial.appearance import MATERIALS, Box, Mesh, joined, parts, plate, rods

Color = tuple[int, int, int]


class Shape(NamedTuple):
    """A surface in the frame of a part."""

    part: int
    mesh: Mesh
    color: Color


@dataclass(frozen=True, kw_only=True, eq=False)
class Poses:
    """All parts at one instant: the modules, tail first, each at its tail end; then the pieces of the fin."""

    position: Float[np.ndarray, "n_parts 3"]
    """[m]."""
    orientation: Float[np.ndarray, "n_parts 4"]
    """Quaternions (w, x, y, z) [-]."""
    middle: Float[np.ndarray, "n_links 3"]
    """Of every module [m]."""


def shapes(robot: Robot) -> list[Shape]:
    """What the robot looks like: housings with their bands, a head, a plate for the fin.

    Args:
        robot: As its plant has it.
    """
    found = [
        Shape(i, build(module), _color(material))
        for i, module in enumerate(robot.modules)
        for material, build in parts(is_head=i == robot.n_links - 1).items()
    ]
    fin = robot.caudal_fin
    for k, piece in enumerate(fin.pieces if fin is not None else ()):
        assert fin is not None
        boxes = [*filter(None, [plate(fin, piece)]), *rods(fin, piece)]
        found.append(Shape(robot.n_links + k, joined(*(_mesh(box) for box in boxes)), _color("fin")))
    return found


def poses(robot: Robot, sample: Log, height: float = 0.0) -> Poses:
    """Where its parts are.

    Args:
        robot: As its plant has it: all of its modules in space, `Robot.planar` of them in the plane.
        sample: One sample of the plant's log, or of a trial.
        height: Of a robot in the plane [m].
    """
    center, half = sample.center_of_mass, np.array([module.half_length for module in robot.modules])
    bends = _fin_angles(robot.caudal_fin, sample)
    if center.size == 3:
        orientation = np.array([sample.signals[name] for name in ORIENTATION], dtype=float)
        found = module_poses(robot, center, from_quaternion(*orientation.tolist()), sample.joint_angle)
        middle, rotation = found.position, found.rotation
    else:
        own = np.array([bends[k] for k in robot.fin_joints])
        flat = Posture(robot, center, sample.link_angle, fin_angle=own if own.size else None).link_centers
        middle = np.column_stack((flat, np.full(len(flat), height)))
        rotation = np.array([turned_about_vertical(float(angle)) for angle in sample.link_angle])
    rear = middle - half[:, np.newaxis] * rotation[:, :, 0]
    parts, turns = list(rear), list(rotation)
    if robot.caudal_fin is not None:
        at, turned = rear[0], rotation[0]
        for piece, bend in zip(robot.caudal_fin.pieces, bends, strict=True):
            turned = turned @ turned_about_vertical(-bend)
            parts.append(at)
            turns.append(turned)
            at = at - (piece.end - piece.begin) * turned[:, 0]
    return Poses(position=np.array(parts), orientation=np.array([to_quaternion(turn) for turn in turns]), middle=middle)


def _color(material: str) -> Color:
    r, g, b, _ = MATERIALS[material][0]
    return round(255 * r), round(255 * g), round(255 * b)


def _mesh(box: Box) -> Mesh:
    """Every face has corners of its own, so that edges stay sharp."""
    corner = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    vertices = corner * box.half_size + box.position
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))]
    return Mesh(vertices=vertices[np.array(faces).ravel()], faces=np.arange(3 * len(faces)).reshape(-1, 3))


def _fin_angles(fin: CaudalFin | None, sample: Log) -> list[float]:
    """The angle in front of every piece of the fin [rad]."""
    if fin is None:
        return []
    return [float(sample.signals.get(f"fin_angle_{k}", np.zeros(()))) for k in range(len(fin.pieces))]
