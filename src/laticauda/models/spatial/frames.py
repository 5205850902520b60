"""The links of a robot as frames, as in ROS: their names in the URDF and their poses.

The frames form the same tree as the links of the URDF, with `module_0` in the world;
`spatial.bodies` defines their origins. Viewers draw the robot from the URDF and the poses.
"""

from typing import NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.models.spatial.bodies import Body, Three, ballast_of, build_bodies
from laticauda.models.spatial.mounts import Quaternion, build_mounts
from laticauda.models.spatial.urdf import build_urdf
from laticauda.robot import Module, Robot
from laticauda.scenarios import Model
from laticauda.values import from_quaternion

UNTURNED = (1.0, 0.0, 0.0, 0.0)
"""Orientation of a frame whose axes are those of its parent [-]."""
WORLD = "world"
"""Parent of the tail module's frame."""

Positions: TypeAlias = Float[np.ndarray, "n_samples 3"]
Orientations: TypeAlias = Float[np.ndarray, "n_samples 4"]
Angles: TypeAlias = Float[np.ndarray, "n_samples _n_joints"]


class FixedFrame(NamedTuple):
    """A frame that is fixed to its parent."""

    parent: str
    """Name of the parent's frame."""
    position: Three
    """Position in the parent's frame [m]."""
    orientation: Quaternion
    """Orientation in the parent's frame, as a quaternion (w, x, y, z) [-]."""


class MovingFrame(NamedTuple):
    """A frame that moves in its parent's frame, at a number of samples."""

    parent: str
    """Name of the parent's frame."""
    position: Positions
    """Positions in the parent's frame [m]."""
    orientation: Orientations
    """Orientations in the parent's frame, as quaternions (w, x, y, z) [-]."""


class _Poses(NamedTuple):
    """Poses of one body in the axes of the tail module, from its origin."""

    rotation: Float[np.ndarray, "3 3 n_samples"]
    """Rotation from the body's axes [-]."""
    position: Float[np.ndarray, "3 n_samples"]
    """Origin of the body's frame [m]."""


class Frames:
    """The frames of one robot.

    Args:
        robot: The robot with all of its modules, not reduced to the plane.
        model: Model of the robot, if known; it determines the depth of the modules' ballast.
    """

    def __init__(self, robot: Robot, model: Model | None = None) -> None:
        self.robot = robot
        self.description = build_urdf(robot)
        """Text of the robot's URDF."""
        self.fixed: dict[str, FixedFrame] = {}
        """Frames that are fixed to their parent: a fin without a joint, thrusters, pectoral fins."""
        self._ballast = ballast_of(robot, model)
        self._bodies = build_bodies(robot)
        for body in self._bodies:
            if body.parent and body.joint is None:
                self.fixed[body.name] = FixedFrame(body.parent, body.position, UNTURNED)
        for mount in build_mounts(robot):
            self.fixed[mount.name] = FixedFrame(mount.body, mount.position, mount.orientation)

    def compute_moving_frames(
        self,
        center_of_mass: Float[np.ndarray, "n_samples n_axes"],
        orientation: Orientations,
        joint_angle: Angles,
        fin_angle: Angles,
    ) -> dict[str, MovingFrame]:
        """Return all other frames at the given samples.

        Args:
            center_of_mass: Center of mass of the robot with its fin; a planar one is at the height
                0 [m].
            orientation: Orientation of the tail module, as a quaternion [-].
            joint_angle: Angles of all joints, or of the yaw joints only if the others are straight
                [rad].
            fin_angle: Angles of the fin's joints, starting at its root [rad].
        """
        n_samples = len(center_of_mass)
        turns = self._turns_of_bodies(n_samples, joint_angle, fin_angle)
        poses = {"": self._poses_of_tail(orientation)}
        moment = np.zeros((3, n_samples))
        mass = 0.0
        moving_frames: dict[str, MovingFrame] = {}
        for body in self._bodies:
            turn = turns[body.name]
            poses[body.name] = _move_to_child(poses[body.parent], body, turn)
            moment += body.mass * self._center_of_body(body, poses[body.name])
            mass += body.mass
            if body.joint is not None:
                offsets = np.tile(np.array(body.position), (n_samples, 1))
                moving_frames[body.name] = MovingFrame(body.parent, offsets, turn)
        center = np.zeros((3, n_samples))
        center[: center_of_mass.shape[1]] = center_of_mass.T
        tail = MovingFrame(WORLD, (center - moment / mass).T, orientation)
        return {"module_0": tail, **moving_frames}

    def _poses_of_tail(self, orientation: Orientations) -> _Poses:
        """Return the poses of the tail module at the origin."""
        return _Poses(
            rotation=from_quaternion(*orientation.T), position=np.zeros((3, len(orientation)))
        )

    def _center_of_body(self, body: Body, poses: _Poses) -> np.ndarray:
        """Return the center of mass of a body at all samples [m]."""
        depth = self._ballast if isinstance(body.part, Module) else 0.0
        ahead = poses.rotation[:, 0]
        up = poses.rotation[:, 2]
        return poses.position + body.center * ahead - depth * up

    def _turns_of_bodies(
        self, n_samples: int, joint_angle: Angles, fin_angle: Angles
    ) -> dict[str, Orientations]:
        """Return the orientation of every body in its parent's frame."""
        angles = np.hstack((joint_angle, fin_angle)).T
        names = self._names_of_joints(n_angles=joint_angle.shape[1])
        angle_of_joint = dict(zip(names, angles, strict=True))
        straight = np.zeros(n_samples)
        turns: dict[str, Orientations] = {}
        for body in self._bodies:
            half_angle = 0.5 * angle_of_joint.get(body.joint_name, straight)
            sin = np.sin(half_angle)
            x, y, z = body.axis
            turns[body.name] = np.stack((np.cos(half_angle), x * sin, y * sin, z * sin), axis=1)
        return turns

    def _names_of_joints(self, n_angles: int) -> list[str]:
        """Return the names of the joints whose angles are known: all of the body or its yaw joints, and the fin's."""
        names: list[str] = []
        for i, joint in enumerate(self.robot.joints):
            if n_angles == self.robot.n_joints or joint.axis == "yaw":
                names.append(f"joint_{i}")
        for k in self.robot.fin_joints:
            if k == 0:
                names.append("fin_joint")
            else:
                names.append(f"fin_hinge_{k}")
        return names


def _move_to_child(parent: _Poses, body: Body, turn: Orientations) -> _Poses:
    """Return the poses of a body from those of its parent."""
    offset = np.einsum("ijn,j->in", parent.rotation, np.array(body.position))
    rotation = np.einsum("ijn,jkn->ikn", parent.rotation, from_quaternion(*turn.T))
    return _Poses(rotation=rotation, position=parent.position + offset)
