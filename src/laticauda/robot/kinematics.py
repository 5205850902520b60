"""Positions of all parts of a planar robot from its center of mass and link angles, and the inverse from one marker.

Every point of the robot is the center of mass plus a fixed combination of the links' directions:

    r = p + sum_i b_i t_i,                t_i = (cos theta_i, sin theta_i)

so a robot is described by a few rows of levers b [m]. The pieces of a fin count as links here,
behind the tail link; if `fin_angle` is omitted, the fin is straight. Links are numbered from the
tail, phi_i = theta_{i+1} - theta_i; angles are counter-clockwise from the world x axis. All arrays
may have any number of leading axes (time first). The robot is used unchanged: reduce one with pitch
joints by `robot.planar()`. nan is passed through: a lost marker gives an unknown pose, at that
sample only.

The module also computes the poses of modules in space from center of mass, tail module orientation
and joint angles.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot
from laticauda.values import (
    BadArgument,
    as_floats,
    check_choice,
    check_instance,
    check_whole_number,
    explain,
    from_quaternion,
    show_value,
    to_quaternion,
)

__all__ = [
    "ModulePoses",
    "Posture",
    "center_of_mass",
    "from_quaternion",
    "heading",
    "joint_angles",
    "levers",
]
__all__ += ["link_angles", "module_poses", "to_quaternion", "turn"]

AXES = ("yaw", "pitch", "roll")
"""Axes about which something turns, of a robot or of a part of it."""
Angles = Float[np.ndarray, "*batch n_links"]
FinAngles = Float[np.ndarray, "*batch n_fin_joints"]
Vectors = Float[np.ndarray, "*batch 2"]
Points = Float[np.ndarray, "*batch n_points 2"]
Levers = Float[np.ndarray, "n_points n_pieces_and_links"]


def heading(link_angle: Angles) -> Float[np.ndarray, "*batch"]:
    """Return the mean of the body's link angles [rad], equation (6) of the paper; the fin does not count.

    Args:
        link_angle: theta [rad].

    Raises:
        ValueError: If there are no links.
    """
    if np.shape(link_angle)[-1:] in ((), (0,)):
        raise BadArgument(
            "link_angle", f"must have a column per link, got {show_value(link_angle)}"
        )
    return np.asarray(np.mean(link_angle, axis=-1))


def joint_angles(link_angle: Angles) -> Float[np.ndarray, "*batch n_joints"]:
    """Compute joint angles phi_i = theta_{i+1} - theta_i [rad], tail first; or rates from rates.

    Args:
        link_angle: theta [rad], or theta' [rad/s].
    """
    return np.diff(link_angle, axis=-1)


def link_angles(
    joint_angle: Float[np.ndarray, "*batch n_joints"],
    *,
    angle: Float[np.ndarray, "*batch"] | float,
    link: int | None = None,
) -> Angles:
    """Compute the angles of all links from the joint angles and one more angle; or rates from rates.

    Args:
        joint_angle: phi [rad], or phi' [rad/s].
        angle: Angle of `link`, or the heading (6) if `link` is None [rad]; its rate [rad/s] if
            rates are given.
        link: Link whose angle is given, 0 = tail; None means the mean of all links.

    Returns:
        theta [rad], not wrapped, or theta' [rad/s]. `joint_angles` recovers `joint_angle` from it.

    Raises:
        ValueError: If the robot has no such link.

    Example:
        >>> link_angles(np.array([0.25, 0.5]), angle=1.0, link=0)
        array([1.  , 1.25, 1.75])
    """
    joint_angle = np.asarray(joint_angle, dtype=np.float64)
    start = np.zeros((*joint_angle.shape[:-1], 1))
    from_tail = np.concatenate((start, np.cumsum(joint_angle, axis=-1)), axis=-1)
    if link is None:
        known = heading(from_tail)
    else:
        known = from_tail[..., check_whole_number("link", link, 0, from_tail.shape[-1] - 1)]
    return from_tail + (np.asarray(angle) - known)[..., np.newaxis]


@dataclass(frozen=True, eq=False)
class Posture:
    """Positions of the parts of a robot, at one or many moments; all points are in world axes [m].

    Raises:
        ValueError: If an array does not fit the robot.

    Example:
        >>> from laticauda.robot import load_robot
        >>> Posture(load_robot("mamba"), np.zeros(2), np.zeros(9)).link_ends[[0, -1]].round(2).tolist()
        [[-0.81, 0.0], [0.81, 0.0]]
    """

    robot: Robot
    """The robot."""
    center_of_mass: Vectors
    """p of the whole robot, including its fin, world axes [m]."""
    link_angle: Angles
    """theta of the body's links [rad]."""
    fin_angle: FinAngles | None = None
    """Angles of the joints of a flexible or driven fin, from its root on [rad]."""

    def __post_init__(self) -> None:
        """Reject anything that is not a robot, and arrays that do not fit it."""
        check_instance("robot", self.robot, Robot)
        object.__setattr__(
            self, "center_of_mass", _columns("center_of_mass", self.center_of_mass, 2, "x and y")
        )
        object.__setattr__(
            self, "link_angle", _columns("link_angle", self.link_angle, self.robot.n_links)
        )

    @property
    def link_centers(self) -> Points:
        """Middle of each body link's length; the link's own center of mass may be off it."""
        return self._at(levers(self.robot).center)

    @property
    def link_ends(self) -> Points:
        """Tail end, every joint and head end of the body: the posture as one line of n_links + 1 points."""
        return self._at(levers(self.robot).end)

    @property
    def fin_line(self) -> Points:
        """The fin as a line: trailing edge, hinges, root. Without a fin, both ends are the tail end."""
        return self._at(levers(self.robot).fin)

    @property
    def trailing_edge(self) -> Vectors:
        """Trailing edge of the fin; without a fin, the tail end. A rigid fin extends the tail link backward."""
        return self.fin_line[..., 0, :]

    def _at(self, lever: Levers) -> Points:
        angle = _with_fin(self.robot, self.link_angle, self.fin_angle)
        return self.center_of_mass[..., np.newaxis, :] + _offsets(lever, angle)


class PointMotion(NamedTuple):
    """Position and velocity of a point in the plane."""

    position: Vectors
    """World axes [m]."""
    velocity: Vectors
    """World axes [m/s]."""


def move_head(
    robot: Robot,
    *,
    center_of_mass: Vectors,
    velocity: Vectors,
    link_angle: Angles,
    link_rate: Angles,
    fin_angle: FinAngles | None = None,
    fin_rate: FinAngles | None = None,
) -> PointMotion:
    """Compute where the tip of the head is, and how it moves.

    Args:
        robot: The robot.
        center_of_mass: p of the whole robot, world axes [m].
        velocity: p', world axes [m/s].
        link_angle: theta [rad].
        link_rate: theta' [rad/s].
        fin_angle: Angles of the joints of a flexible or driven fin, from its root on [rad].
        fin_rate: Their rates [rad/s].
    """
    angle = _with_fin(robot, link_angle, fin_angle)
    rate = _with_fin(robot, link_rate, fin_rate)
    lever = levers(robot).end[-1]
    cos = np.cos(angle)
    sin = np.sin(angle)
    offset = np.stack((cos @ lever, sin @ lever), axis=-1)
    speed = np.stack(((-sin * rate) @ lever, (cos * rate) @ lever), axis=-1)
    return PointMotion(position=center_of_mass + offset, velocity=velocity + speed)


def center_of_mass(
    robot: Robot,
    position: Vectors,
    link_angle: Angles,
    *,
    link: int = 0,
    offset: tuple[float, float] = (0.0, 0.0),
    fin_angle: FinAngles | None = None,
) -> Vectors:
    """Compute the center of mass of the whole robot, including its fin, from one marker and the link angles.

    Motion capture tracks one link and the joints report their angles; `link_angles` turns these
    into link angles.

    Args:
        robot: The robot.
        position: Position of the marker [m], world axes.
        link_angle: theta [rad].
        link: The link that carries the marker, 0 = tail.
        offset: Position of the marker relative to the middle of the link: toward the head, to the
            left [m].
        fin_angle: Angles of the joints of a flexible or driven fin, from its root on [rad].

    Returns:
        p [m], world axes. Its `link_centers` equal `position` if `offset` is zero.

    Raises:
        ValueError: If an array does not fit the robot, or the robot has no such link.
    """
    row = levers(robot).center[[check_whole_number("link", link, 0, robot.n_links - 1)]]
    position = _columns("position", position, 2, "x and y")
    link_angle = _columns("link_angle", link_angle, robot.n_links)
    angles = _with_fin(robot, link_angle, fin_angle)
    return position - _rotated(offset, link_angle[..., link]) - _offsets(row, angles)[..., 0, :]


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotLevers:
    """Rows b for the points of one robot, relative to its center of mass; the fin's pieces come first."""

    center: Float[np.ndarray, "n_links n_pieces_and_links"]
    """Middles of the links [m]."""
    end: Float[np.ndarray, "n_ends n_pieces_and_links"]
    """Tail end, joints, head end [m]."""
    fin: Float[np.ndarray, "n_points n_pieces_and_links"]
    """Trailing edge, hinges, root [m]."""


@lru_cache(maxsize=64)
def levers(robot: Robot) -> RobotLevers:
    """Return the levers of a robot's points, from which pages draw it.

    Args:
        robot: The robot.
    """
    check_instance("robot", robot, Robot)
    # First relative to the tail end, then shifted by the center of mass, which is such a row
    # itself.
    pieces = robot.caudal_fin.pieces[::-1] if robot.caudal_fin is not None else ()
    length = np.array(
        [*(piece.length for piece in pieces), *(module.length for module in robot.modules)]
    )
    mass = np.array([*(piece.mass for piece in pieces), *(module.mass for module in robot.modules)])
    off_middle = np.array([*(0.0 for _ in pieces), *(module.center for module in robot.modules)])
    n, f = len(length), len(pieces)

    end = np.tril(np.ones((n + 1, n)), k=-1) * length
    end -= end[f]
    center = 0.5 * (end[:-1] + end[1:])
    to_center = mass @ (center + np.diag(off_middle)) / np.sum(mass)
    fin = end[: f + 1] if pieces else end[[0, 0]]
    return RobotLevers(center=center[f:] - to_center, end=end[f:] - to_center, fin=fin - to_center)


def _with_fin(robot: Robot, link_angle: Angles, fin_angle: FinAngles | None) -> np.ndarray:
    """Return the angles (or rates) of the fin's pieces, trailing edge first, and of the links."""
    fin, joints, tail = robot.caudal_fin, robot.fin_joints, link_angle[..., :1]
    if fin is None:
        return link_angle
    if fin_angle is None or not joints:
        return np.concatenate((np.repeat(tail, len(fin.pieces), axis=-1), link_angle), axis=-1)
    bends = _columns("fin_angle", fin_angle, len(joints), "one per joint of the robot's fin")
    pieces = tail - np.cumsum(bends, axis=-1)
    pieces = pieces if 0 in joints else np.concatenate((tail, pieces), axis=-1)
    return np.concatenate((pieces[..., ::-1], link_angle), axis=-1)


def _offsets(lever: Levers, angle: np.ndarray) -> Points:
    """Compute sum_i b_i t_i of every point [m]."""
    return np.stack((np.cos(angle) @ lever.T, np.sin(angle) @ lever.T), axis=-1)


# A wrong last axis would broadcast silently to a wrong result, so every public entry point makes
# this check.


def _columns(
    name: str,
    values: Float[np.ndarray, "*batch columns"],
    n: int,
    what: str = "one per link of the robot",
) -> Float[np.ndarray, "*batch columns"]:
    array = as_floats(name, values)
    if array.ndim == 0 or array.shape[-1] != n:
        raise BadArgument(name, f"must have {n} columns, {what}, got shape {array.shape}")
    return array


def _rotated(vector: tuple[float, float], angle: Float[np.ndarray, "*batch"]) -> Vectors:
    """Transform `vector` from link axes to world axes."""
    along, across = vector
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack((cos * along - sin * across, sin * along + cos * across), axis=-1)


# ---- modules in space ----------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True, eq=False)
class ModulePoses:
    """Poses of all modules at one instant, world axes, tail first."""

    position: Float[np.ndarray, "n_modules 3"]
    """Middles of the modules [m]."""
    rotation: Float[np.ndarray, "n_modules 3 3"]
    """Axes of the modules (forward, left, up) as columns [-]."""


def module_poses(
    robot: Robot,
    center_of_mass: Float[np.ndarray, " 3"],
    rotation: Float[np.ndarray, "3 3"],
    joint_angle: Float[np.ndarray, " n_joints"],
    *,
    ballast_depth: float = 0.0,
) -> ModulePoses:
    """Compute the pose of every module.

    Args:
        robot: The robot with all of its modules, not reduced to the plane.
        center_of_mass: Center of mass of the robot [m].
        rotation: Orientation of the tail module: its axes as columns [-].
        joint_angle: phi of all joints, yaw and pitch; positive yaw bends to the left, positive
            pitch down [rad].
        ballast_depth: Distance of the modules' centers of mass below their axes [m].
    """
    n = robot.n_links
    turned = np.empty((n, 3, 3))
    turned[0] = rotation
    for i, (joint, angle) in enumerate(zip(robot.joints, joint_angle.tolist(), strict=True)):
        turned[i + 1] = turned[i] @ turn(joint.axis, angle)
    along = turned[:, :, 0]
    half = np.array([module.half_length for module in robot.modules])[:, np.newaxis]
    middle = np.zeros((n, 3))
    middle[1:] = np.cumsum(half[:-1] * along[:-1] + half[1:] * along[1:], axis=0)
    mass = np.array([module.mass for module in robot.modules])
    center = np.array([module.center for module in robot.modules])[:, np.newaxis]
    moment = mass @ (middle + center * along - ballast_depth * turned[:, :, 2])
    total = float(mass.sum())
    if robot.caudal_fin is not None:
        behind = -half[0] - 0.5 * robot.caudal_fin.length
        moment = moment + robot.caudal_fin.mass * behind * along[0]
        total += robot.caudal_fin.mass
    return ModulePoses(position=middle + (center_of_mass - moment / total), rotation=turned)


def turn(axis: str, angle: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation by `angle` [rad] about an `axis`: `yaw` to the left, `pitch` down, `roll` left side up.

    Args:
        axis: yaw, pitch or roll.
        angle: Angle of the rotation [rad].

    Raises:
        ValueError: If there is no such axis.
    """
    check_choice("axis", axis, AXES)
    c, s = np.cos(angle), np.sin(angle)
    if axis == "yaw":
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if axis == "pitch":
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


explain(globals())
