"""Where every body of the 3D model is at any time of a trial, planar or spatial: between samples, smoothly."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.extras import load_mujoco
from laticauda.interfaces import ORIENTATION
from laticauda.kinematics import link_angles
from laticauda.robot import Robot
from laticauda.trial import Trial


@dataclass(frozen=True, kw_only=True, eq=False)
class Pose:
    """One instant."""

    center_of_mass: Float[np.ndarray, "3"]
    """[m]."""
    orientation: Float[np.ndarray, "4"]
    """Of module 0, a quaternion (w, x, y, z) [-]."""
    joint_angle: Float[np.ndarray, " n_joints"]
    """Of all joints of the robot, those that the planar model holds included [rad]."""
    fin_angle: Float[np.ndarray, " n_fin_joints"]
    """Of the joints of a fin that is driven or bends, from its root on; straight if the trial does not say [rad]."""


def pose(trial: Trial, time: float, height: float) -> Pose:
    """Where the robot is.

    Args:
        trial: Any trial.
        time: Within the trial's time [s].
        height: At which a planar robot swims [m].

    Raises:
        ValueError: If a measured trial does not say how the robot was bent.
    """
    trial.need("a picture of the robot", "joint_angle", "heading")
    before = int(np.clip(np.searchsorted(trial.time, time, side="right") - 1, 0, max(trial.time.size - 2, 0)))
    joint_angle = _between(trial, before, time, trial.joint_angle, trial.joint_rate)
    center = _between(trial, before, time, trial.center_of_mass, trial.center_of_mass_velocity)
    fin_angle = _between(trial, before, time, trial.fin_angle, trial.fin_rate)
    if center.size == 3:
        orientation = _orientation(trial, before, time)
        return Pose(center_of_mass=center, orientation=orientation, joint_angle=joint_angle, fin_angle=fin_angle)
    heading = float(_between(trial, before, time, trial.heading, trial.heading_rate))
    tail = float(link_angles(joint_angle, angle=heading)[0])
    return Pose(
        center_of_mass=np.array([*center, height]),
        orientation=_turned(tail),
        joint_angle=_all_joints(trial.robot, joint_angle),
        fin_angle=fin_angle,
    )


def put(model: Any, data: Any, robot: Robot, pose: Pose) -> None:
    """Move the bodies of `mjcf.spec(robot, ..., root="free")` there; velocities stay what they were."""
    mujoco = load_mujoco()
    data.qpos[:3], data.qpos[3:7] = 0.0, pose.orientation
    data.qpos[7 : 7 + robot.n_joints] = pose.joint_angle
    data.qpos[7 + robot.n_joints : 7 + robot.n_joints + pose.fin_angle.size] = pose.fin_angle
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    data.qpos[:3] = pose.center_of_mass - data.subtree_com[model.body("module_0").id]
    mujoco.mj_forward(model, data)


def _between(trial: Trial, before: int, time: float, values: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """The cubic through the values and rates of the two samples around a time."""
    if trial.time.size == 1:
        return np.asarray(values[0])
    start, stop = trial.time[before], trial.time[before + 1]
    h = stop - start
    s = float(np.clip((time - start) / h, 0.0, 1.0))
    rise, fall = s * s * (3.0 - 2.0 * s), s * (1.0 - s)
    tangents = h * fall * ((1.0 - s) * rates[before] - s * rates[before + 1])
    return np.asarray((1.0 - rise) * values[before] + rise * values[before + 1] + tangents)


def _orientation(trial: Trial, before: int, time: float) -> np.ndarray:
    """That of module 0: what the trial says, or else upright along its link angle."""
    after = min(before + 1, trial.time.size - 1)
    step = trial.time[after] - trial.time[before]
    s = (time - trial.time[before]) / step if step > 0.0 else 0.0
    if not all(name in trial.signals for name in ORIENTATION):
        return _turned(float((1.0 - s) * trial.link_angle[before, 0] + s * trial.link_angle[after, 0]))
    first, second = (np.array([trial.signals[name][k] for name in ORIENTATION]) for k in (before, after))
    mixed = (1.0 - s) * first + s * (second if first @ second >= 0.0 else -second)
    return mixed / np.linalg.norm(mixed)


def _turned(angle: float) -> np.ndarray:
    """A turn about the vertical axis."""
    return np.array([math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle)])


def _all_joints(robot: Robot, yaw: np.ndarray) -> np.ndarray:
    """The angles of all joints from those that the planar model has; it holds the others at 0."""
    full = np.zeros(robot.n_joints)
    full[[i for i, joint in enumerate(robot.joints) if joint.axis == "yaw"]] = yaw
    return full
