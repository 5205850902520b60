"""Where every module is in space: from the center of mass, the tail module's orientation and the joint angles."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot


@dataclass(frozen=True, kw_only=True, eq=False)
class ModulePoses:
    """All modules at one instant, world axes, tail first."""

    position: Float[np.ndarray, "n_modules 3"]
    """Middles of the modules [m]."""
    rotation: Float[np.ndarray, "n_modules 3 3"]
    """Their axes (forward, left, up) as columns [-]."""


def module_poses(
    robot: Robot,
    center_of_mass: Float[np.ndarray, " 3"],
    rotation: Float[np.ndarray, "3 3"],
    joint_angle: Float[np.ndarray, " n_joints"],
    *,
    ballast_depth: float = 0.0,
) -> ModulePoses:
    """Where every module is.

    Args:
        robot: With all of its modules, not reduced to the plane.
        center_of_mass: Of the robot [m].
        rotation: Of the tail module: its axes as columns [-].
        joint_angle: phi of all joints, yaw and pitch; positive yaw bends to the left, positive pitch down [rad].
        ballast_depth: How far the modules' centers of mass lie below their axes [m].
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


def turned_about_vertical(angle: float) -> Float[np.ndarray, "3 3"]:
    """The rotation of a level body that points at `angle` from the world x axis [rad]."""
    return turn("yaw", angle)


def turn(axis: str, angle: float) -> Float[np.ndarray, "3 3"]:
    """The rotation by `angle` [rad] about an `axis`: `yaw` to the left, `pitch` down, `roll` left side up."""
    c, s = np.cos(angle), np.sin(angle)
    if axis == "yaw":
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if axis == "pitch":
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
