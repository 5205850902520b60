"""What the sensors of the autopilot read, from the log of the last step."""

from dataclasses import dataclass

import numpy as np

from laticauda.models.spatial.settings import used_ballast_depth
from laticauda.robot import from_quaternion, module_poses, turn
from laticauda.robot.kinematics import ModulePoses, Posture
from laticauda.scenarios import ORIENTATION, Scenario, Spatial
from laticauda.values import Log
from laticauda_ardupilot.attitude import (
    Rotation,
    Vector,
    euler_angles,
    flip_rotation,
    flip_vector,
    mean_rotation,
    quaternion_of,
    rotation_vector,
)
from laticauda_ardupilot.packets import SensorReading

GRAVITY = np.array([0.0, 0.0, 9.80665])
"""North, east, down [m/s^2]."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Where the robot is for the autopilot, at one instant."""

    time: float
    """[s]."""
    position: Vector
    """North, east, and down from the surface [m]."""
    rotation: Rotation
    """From body axes (forward, right, down) to earth axes (north, east, down) [-]."""
    velocity: Vector
    """North, east, down [m/s]."""


class MotionSensor:
    """Finds position, attitude and velocity of the robot as a whole, or of its head.

    Args:
        scenario: The scenario, with robot and model as they are simulated.
        of_head: Whether it sits in the head.
    """

    def __init__(self, scenario: Scenario, *, of_head: bool) -> None:
        self._robot = scenario.robot
        self._of_head = of_head
        self._ballast_depth = 0.0
        self._surface = 0.0
        model = scenario.model
        if isinstance(model, Spatial):
            self._ballast_depth = used_ballast_depth(model)
            if model.scene is not None:
                self._surface = model.scene.level

    def motion(self, log: Log, index: int, before: Motion | None = None) -> Motion:
        """Return the motion at a sample of a log.

        Args:
            log: The log.
            index: Index of the sample.
            before: Motion one step earlier, from whose place follows the velocity of the head; None:
                that of the center of mass stands for it.
        """
        time = float(log.time[index])
        poses = self._poses(log, index)
        velocity = flip_vector(_in_space(log.center_of_mass_velocity[index]))
        if not self._of_head:
            center_of_mass = _in_space(log.center_of_mass[index])
            return Motion(
                time=time,
                position=self._below_surface(center_of_mass),
                rotation=flip_rotation(mean_rotation(poses.rotation)),
                velocity=velocity,
            )
        position = self._below_surface(poses.position[-1])
        if before is not None:
            velocity = (position - before.position) / (time - before.time)
        return Motion(
            time=time,
            position=position,
            rotation=flip_rotation(poses.rotation[-1]),
            velocity=velocity,
        )

    def _below_surface(self, position: Vector) -> Vector:
        """Return a place in the autopilot's axes, from the surface [m]."""
        return flip_vector(position - np.array([0.0, 0.0, self._surface]))

    def _poses(self, log: Log, index: int) -> ModulePoses:
        """Return the poses of all modules at a sample of a log."""
        if "orientation_w" in log.signals:
            quaternion = [float(log.signals[name][index]) for name in ORIENTATION]
            return module_poses(
                self._robot,
                log.center_of_mass[index],
                from_quaternion(*quaternion),
                log.joint_angle[index],
                ballast_depth=self._ballast_depth,
            )
        link_angle = log.link_angle[index]
        posture = Posture(self._robot, log.center_of_mass[index], link_angle)
        centers = posture.link_centers
        return ModulePoses(
            position=np.column_stack((centers, np.zeros(len(centers)))),
            rotation=np.stack([turn("yaw", angle) for angle in link_angle.tolist()]),
        )


def _in_space(vector: np.ndarray) -> Vector:
    """Return a vector of the plane or of space with three components."""
    return np.append(vector, np.zeros(3 - len(vector)))


def read_motion(before: Motion, now: Motion) -> SensorReading:
    """Return what gyroscopes, accelerometers, position and attitude read at the end of a step.

    Angular velocity and specific force are means over the step: summed up, they give the attitude and
    the velocity again.

    Args:
        before: Motion at the begin of the step.
        now: Motion at its end.
    """
    duration = now.time - before.time
    turned = before.rotation.T @ now.rotation
    acceleration = (now.velocity - before.velocity) / duration
    return SensorReading(
        time=now.time,
        gyro=rotation_vector(turned) / duration,
        acceleration=now.rotation.T @ (acceleration - GRAVITY),
        position=now.position,
        velocity=now.velocity,
        attitude=euler_angles(now.rotation),
        quaternion=quaternion_of(now.rotation),
    )
