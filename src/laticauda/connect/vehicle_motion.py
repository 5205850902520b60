"""A swimmer seen as one body, for programs that know vehicles: its place, attitude, and inertial measurements.

World axes are x forward, y left, z up, body axes forward, left, up.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.robot import ModulePoses, Posture, from_quaternion, module_poses, turn
from laticauda.scenarios import ORIENTATION, Scenario, Spatial
from laticauda.values import Log

Vector = Float[np.ndarray, " 3"]
Rotation = Float[np.ndarray, "3 3"]

FELT_AT_REST = np.array([0.0, 0.0, 9.80665])
"""What an accelerometer at rest measures: upward, against gravity, world axes [m/s^2]."""
SMALLEST_SINE = 1e-12
"""Sine of an angle below which a rotation's angle is its sine."""


@dataclass(frozen=True, kw_only=True)
class VehicleMotion:
    """Where the robot is as one body, and how it moves, at one instant."""

    time: float
    """[s]."""
    position: Vector
    """World axes, z counted from the surface [m]."""
    rotation: Rotation
    """Body axes as columns, in world axes [-]."""
    velocity: Vector
    """World axes [m/s]."""
    tail_end: Vector
    """Tail end of the tail module, where models of the robot have their root, world axes [m]."""
    tail_rotation: Rotation
    """Axes of the tail module as columns, in world axes [-]."""


@dataclass(frozen=True, kw_only=True)
class Inertial:
    """What gyroscopes and accelerometers measure, as means over a step.

    Summed up over steps, they give the attitude and the velocity again.
    """

    angular_velocity: Vector
    """Body axes [rad/s]."""
    specific_force: Vector
    """Acceleration with gravity's reaction, body axes [m/s^2]."""


class MotionTracker:
    """Finds the motion of the body as a whole, or of its head.

    Args:
        scenario: The scenario, with robot and model as they are simulated.
        of_head: Whether it is that of the head.
    """

    def __init__(self, scenario: Scenario, *, of_head: bool) -> None:
        self._robot = scenario.robot
        self._of_head = of_head
        self._ballast_depth = 0.0
        self._surface = np.zeros(3)
        model = scenario.model
        if isinstance(model, Spatial):
            # Only a robot that its weight can move has ballast.
            if model.gravity and model.root == "free":
                self._ballast_depth = model.ballast_depth
            if model.scene is not None:
                self._surface = np.array([0.0, 0.0, model.scene.level])

    def motion(self, log: Log, index: int, before: VehicleMotion | None = None) -> VehicleMotion:
        """Return the motion at a sample of a log.

        Args:
            log: The log.
            index: Index of the sample.
            before: Motion earlier, from which follows the velocity of the head; None: that of the
                center of mass stands for it.
        """
        time = float(log.time[index])
        poses = self._poses(log, index)
        velocity = _in_space(log.center_of_mass_velocity[index])
        if self._of_head:
            position = poses.position[-1] - self._surface
            rotation = poses.rotation[-1]
            if before is not None:
                moved = position - before.position
                velocity = moved / (time - before.time)
        else:
            center_of_mass = _in_space(log.center_of_mass[index])
            position = center_of_mass - self._surface
            rotation = mean_rotation(poses.rotation)
        tail_rotation = poses.rotation[0]
        half_length = self._robot.modules[0].half_length
        to_tail_end = -half_length * tail_rotation[:, 0]
        tail_end = poses.position[0] + to_tail_end - self._surface
        return VehicleMotion(
            time=time,
            position=position,
            rotation=rotation,
            velocity=velocity,
            tail_end=tail_end,
            tail_rotation=tail_rotation,
        )

    def _poses(self, log: Log, index: int) -> ModulePoses:
        """Return the poses of all modules at a sample of a log."""
        if ORIENTATION[0] in log.signals:
            quaternion = [float(log.signals[name][index]) for name in ORIENTATION]
            tail_rotation = from_quaternion(*quaternion)
            return module_poses(
                self._robot,
                log.center_of_mass[index],
                tail_rotation,
                log.joint_angle[index],
                ballast_depth=self._ballast_depth,
            )
        link_angle = log.link_angle[index]
        posture = Posture(self._robot, log.center_of_mass[index], link_angle)
        centers = posture.link_centers
        heights = np.zeros(len(centers))
        rotations = [turn("yaw", angle) for angle in link_angle.tolist()]
        return ModulePoses(
            position=np.column_stack((centers, heights)),
            rotation=np.stack(rotations),
        )


def measure_inertial(before: VehicleMotion, now: VehicleMotion) -> Inertial:
    """Return what an inertial unit measures over a step.

    Args:
        before: Motion at the begin of the step.
        now: Motion at its end.
    """
    duration = now.time - before.time
    turned = before.rotation.T @ now.rotation
    acceleration = (now.velocity - before.velocity) / duration
    felt = acceleration + FELT_AT_REST
    return Inertial(
        angular_velocity=rotation_vector(turned) / duration,
        specific_force=now.rotation.T @ felt,
    )


def mean_rotation(rotations: Float[np.ndarray, "n 3 3"]) -> Rotation:
    """Return the axes of a bent body as a whole: forward as its modules on average, up as nearly as possible.

    Args:
        rotations: Axes of the modules (forward, left, up) as columns.
    """
    forward, _, up = rotations.sum(axis=0).T
    forward = _normalized(forward)
    along = up @ forward
    up = _normalized(up - along * forward)
    left = np.cross(up, forward)
    return np.stack((forward, left, up), axis=1)


def _normalized(vector: Vector) -> Vector:
    """Return the unit vector in the same direction."""
    length = np.linalg.norm(vector)
    return vector / length


def rotation_vector(rotation: Rotation) -> Vector:
    """Return axis times angle of a rotation by less than half a turn [rad].

    Args:
        rotation: The rotation.
    """
    x = rotation[2, 1] - rotation[1, 2]
    y = rotation[0, 2] - rotation[2, 0]
    z = rotation[1, 0] - rotation[0, 1]
    sines = 0.5 * np.array([x, y, z])
    sine = math.sqrt(float(sines @ sines))
    if sine < SMALLEST_SINE:
        return sines
    cosine = 0.5 * (float(np.trace(rotation)) - 1.0)
    angle = math.atan2(sine, cosine)
    return sines * (angle / sine)


def _in_space(vector: np.ndarray) -> Vector:
    """Return a vector of the plane or of space with three components."""
    in_space = np.zeros(3)
    in_space[: len(vector)] = vector
    return in_space
