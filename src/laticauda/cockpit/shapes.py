"""Where every part of the robot is, and what it looks like: meshes in frames, without any engine."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.interfaces import Log
from laticauda.kinematics import from_quaternion, link_centers, module_poses, turned_about_vertical
from laticauda.robot import CaudalFin, Robot
from laticauda.spatial.appearance import MATERIALS, bands, collar, head, housing, seen_opening
from laticauda.spatial.meshes import Mesh, joined

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
    found: list[Shape] = []
    last = robot.n_links - 1
    for i, module in enumerate(robot.modules):
        if i == last:
            found += [Shape(i, head(module), _color("head")), Shape(i, collar(module), _color("collar"))]
        else:
            found += [Shape(i, housing(module), _color("housing")), Shape(i, bands(module), _color("band"))]
    if robot.caudal_fin is not None:
        found += _fin_shapes(robot.caudal_fin, robot.n_links)
    return found


def poses(robot: Robot, sample: Log, height: float = 0.0) -> Poses:
    """Where its parts are.

    Args:
        robot: As its plant has it: all of its modules in space, `Robot.planar` of them in the plane.
        sample: One sample of the plant's log, or of a trial, by name.
        height: Of a robot in the plane [m].
    """
    center, half = sample["center_of_mass"], np.array([module.half_length for module in robot.modules])
    bends = _fin_angles(robot.caudal_fin, sample)
    if center.size == 3:
        orientation = np.array([sample[f"signal_orientation_{part}"] for part in "wxyz"], dtype=float)
        found = module_poses(robot, center, from_quaternion(*orientation.tolist()), sample["joint_angle"])
        middle, rotation = found.position, found.rotation
    else:
        own = np.array([bends[k] for k in _moving(robot.caudal_fin)])
        flat = link_centers(robot, center, sample["link_angle"], fin_angle=own if own.size else None)
        middle = np.column_stack((flat, np.full(len(flat), height)))
        rotation = np.array([turned_about_vertical(float(angle)) for angle in sample["link_angle"]])
    rear = middle - half[:, np.newaxis] * rotation[:, :, 0]
    parts, turns = list(rear), list(rotation)
    if robot.caudal_fin is not None:
        at, turned = rear[0], rotation[0]
        for piece, bend in zip(robot.caudal_fin.pieces, bends, strict=True):
            turned = turned @ turned_about_vertical(-bend)
            parts.append(at)
            turns.append(turned)
            at = at - (piece.end - piece.begin) * turned[:, 0]
    return Poses(position=np.array(parts), orientation=np.array([quaternion(turn) for turn in turns]), middle=middle)


def quaternion(rotation: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "4"]:
    """A rotation matrix as (w, x, y, z), by the largest of the four so that no digits are lost."""
    m = rotation
    trace = (m[0, 0], m[1, 1], m[2, 2])
    squares = np.array(
        [
            1.0 + trace[0] + trace[1] + trace[2],
            1.0 + trace[0] - trace[1] - trace[2],
            1.0 - trace[0] + trace[1] - trace[2],
            1.0 - trace[0] - trace[1] + trace[2],
        ]
    )
    a, b, c = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    d, e, f = m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1]
    k = int(np.argmax(squares))
    rows = ((squares[0], a, b, c), (a, squares[1], d, e), (b, d, squares[2], f), (c, e, f, squares[3]))
    return np.array(rows[k]) / (2.0 * math.sqrt(squares[k]))


def _color(material: str) -> Color:
    r, g, b, _ = MATERIALS[material][0]
    return round(255 * r), round(255 * g), round(255 * b)


def _fin_shapes(fin: CaudalFin, first: int) -> list[Shape]:
    """The plate piece by piece, and two rods where it is open."""
    inner, found = seen_opening(fin), list[Shape]()
    for k, piece in enumerate(fin.pieces):
        boxes: list[Mesh] = []
        if piece.end > inner:
            boxes.append(_box(fin, max(inner, piece.begin) - piece.begin, piece.end - piece.begin, 0.0, 0.5))
        if piece.begin < inner:
            end = min(inner, piece.end) - piece.begin
            boxes += [_box(fin, 0.0, end, 0.4 * sign, 0.06) for sign in (-1.0, 1.0)]
        found.append(Shape(first + k, joined(*boxes), _color("fin")))
    return found


def _box(fin: CaudalFin, begin: float, end: float, up: float, half: float) -> Mesh:
    """From `begin` to `end` behind the frame; `up` and `half` as shares of the fin's height."""
    corner = np.array([[x, y, z] for x in (-end, -begin) for y in (-0.5, 0.5) for z in (-1.0, 1.0)])
    vertices = corner * (1.0, fin.thickness, half * fin.height) + (0.0, 0.0, up * fin.height)
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))]
    # Every face has corners of its own, so that edges stay sharp.
    return Mesh(vertices=vertices[np.array(faces).ravel()], faces=np.arange(3 * len(faces)).reshape(-1, 3))


def _moving(fin: CaudalFin | None) -> list[int]:
    """The pieces of a fin in front of which there is a joint or a hinge."""
    if fin is None:
        return []
    return [k for k in range(len(fin.pieces)) if k > 0 or fin.joint is not None]


def _fin_angles(fin: CaudalFin | None, sample: Log) -> list[float]:
    """The angle in front of every piece of the fin [rad]."""
    if fin is None:
        return []
    return [float(sample.get(f"signal_fin_angle_{k}", np.zeros(()))) for k in range(len(fin.pieces))]
