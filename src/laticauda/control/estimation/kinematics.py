"""Kinematics only, as in the paper: a pose of the marker body and the joint angles say everything.

Nothing is filtered; without a frame, the last result is held. This is the baseline for the filter.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.control.estimation.samples import (
    Estimate,
    JointSample,
    PoseSample,
    Sample,
    StateEstimator,
)
from laticauda.robot import Robot, center_of_mass, heading, link_angles, module_poses, turn
from laticauda.values import option, quantity, value_class, wrap_to_pi

Vector = Float[np.ndarray, " _n"]
Matrix = Float[np.ndarray, "_m _n"]

_TIME_ROUNDING = 1e-9
"""Smaller than the time between any two frames [s]."""


class JointRecord(NamedTuple):
    """Joints at one time, of those that the estimator uses."""

    time: float
    """Time of the sample [s]."""
    angle: Vector
    """Angles [rad]."""
    rate: Vector
    """Rates, 0 where they are unknown [rad/s]."""


class Pose(NamedTuple):
    """Pose of the whole robot, as it follows from one frame."""

    link_angle: Vector
    """theta of every link [rad]."""
    center_of_mass: Vector
    """p, two or three coordinates [m]."""
    pitch: float
    """Mean pitch of the links; 0 in the plane [rad]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class KinematicState:
    """Most recent joint samples, and the estimates from the most recent frames."""

    joints: tuple[JointRecord, ...] = ()
    """Joint samples, oldest first."""
    frames: tuple[Estimate, ...] = ()
    """Estimates from frames, oldest first; without velocities."""


@value_class
class KinematicEstimator(StateEstimator):
    """Estimator of center of mass and link angles from one module's pose and the joint angles.

    Joint angles are interpolated to the time of the frame; after the last ones, which are as old as
    a tick, they go on at the joints' rates, for at most `span`. Velocities are differences over
    `span`. In space, height and pitch are also known: the whole rotation of the marker body and the
    angles of all joints are used. The center of mass is then computed for modules whose own centers
    of mass are on their axes.
    """

    in_space: bool = option(
        "whether to estimate in three dimensions; else pitch joints are straight", default=False
    )
    span: float = quantity("s", "time over which velocities are averaged", gt=0.0, default=0.1)

    @cached_property
    def _chain(self) -> Robot:
        """Planar reduction of the robot."""
        return self.robot.planar()

    def init(self) -> KinematicState:
        """Return the state before the first sample."""
        return KinematicState()

    def step(self, state: KinematicState, sample: Sample) -> KinematicState:
        """Return the state after one more sample; frames older than the last one are ignored.

        Args:
            state: State returned by the last call or by `init`.
            sample: New sample.

        Raises:
            ValueError: If the sample does not fit the robot.
        """
        if isinstance(sample, JointSample):
            return self._add_joints(state, sample)
        if isinstance(sample, PoseSample):
            return self._add_frame(state, sample)
        return state

    def _add_joints(self, state: KinematicState, sample: JointSample) -> KinematicState:
        """Remember a joint sample, if it is complete and newer than the last."""
        angle = self._select_joints(sample.angle)
        if not np.isfinite(angle).all():
            return state
        if state.joints and sample.time <= state.joints[-1].time:
            return state
        rate = np.zeros_like(angle)
        if sample.rate is not None:
            rate = np.nan_to_num(self._select_joints(sample.rate))
        oldest = sample.time - 2.0 * self.span
        recent = [record for record in state.joints if record.time > oldest]
        return replace(state, joints=(*recent, JointRecord(sample.time, angle, rate)))

    def _add_frame(self, state: KinematicState, frame: PoseSample) -> KinematicState:
        """Estimate from a frame, unless it says too little or is not newer than the last one."""
        if frame.is_lost or frame.rotation is None or not state.joints:
            return state
        if state.frames and frame.time <= state.frames[-1].time:
            return state
        joint = self._joints_at(state, frame.time)
        pose = self._pose_of_robot(frame.position, frame.rotation, joint)
        link_angle = pose.link_angle
        if state.frames:
            last_heading = state.frames[-1].heading
            new_heading = float(heading(link_angle))
            nearest_heading = last_heading + wrap_to_pi(new_heading - last_heading)
            link_angle = link_angle + (nearest_heading - new_heading)
        estimate = Estimate(
            time=frame.time,
            status="tracking",
            age=0.0,
            center_of_mass=pose.center_of_mass,
            center_of_mass_velocity=np.zeros_like(pose.center_of_mass),
            heading=float(heading(link_angle)),
            pitch=pose.pitch,
            heading_rate=0.0,
            link_angle=link_angle,
            joint_angle=joint,
            joint_rate=np.zeros_like(joint),
        )
        oldest = frame.time - self.span - _TIME_ROUNDING
        recent = [earlier for earlier in state.frames if earlier.time >= oldest]
        return replace(state, frames=(*recent, estimate))

    def _joints_at(self, state: KinematicState, time: float) -> Vector:
        """Return the joint angles at a time, interpolated or carried on at the last rates [rad]."""
        times = np.array([record.time for record in state.joints])
        angles = np.stack([record.angle for record in state.joints])
        n_joints = angles.shape[1]
        joint = np.array([float(np.interp(time, times, angles[:, i])) for i in range(n_joints)])
        time_since_last = max(time - float(times[-1]), 0.0)
        joint += min(time_since_last, self.span) * state.joints[-1].rate
        return joint

    def _select_joints(self, angle: Vector) -> Vector:
        """Select the joints that are used."""
        if self.in_space:
            return angle[: self.robot.n_joints]
        return self.robot.yaw_joints("angle", angle)

    def _pose_of_robot(self, position: Vector, rotation: Matrix, joint: Vector) -> Pose:
        """Return the pose of the robot that follows from that of the marker body."""
        if self.in_space:
            return self._pose_in_space(position, rotation, joint)
        link, offset = self.on_link
        theta = link_angles(joint, angle=self.mount.link_yaw(rotation), link=link)
        place = center_of_mass(self._chain, position[:2], theta, link=link, offset=offset)
        return Pose(link_angle=theta, center_of_mass=place, pitch=0.0)

    def _pose_in_space(self, position: Vector, rotation: Matrix, joint: Vector) -> Pose:
        """Return the pose in three dimensions: in the axes of the tail, then in the world's."""
        modules = module_poses(self.robot, np.zeros(3), np.eye(3), joint)
        carrier = modules.rotation[self.mount.module]
        offset = np.array((*self.mount.offset, 0.0)[:3])
        marker = modules.position[self.mount.module] + carrier @ offset
        to_world = rotation @ turn("yaw", -self.mount.angle) @ carrier.T
        ahead = to_world @ modules.rotation[:, :, 0].T
        theta: Vector = np.unwrap(np.arctan2(ahead[1], ahead[0]))
        pitch: Vector = -np.arctan2(ahead[2], np.hypot(ahead[0], ahead[1]))
        return Pose(
            link_angle=theta,
            center_of_mass=position - to_world @ marker,
            pitch=float(pitch.mean()),
        )

    def estimate(self, state: KinematicState, time: float | None = None) -> Estimate | None:
        """Return the estimate from the last frame; None before the first one.

        Args:
            state: State of the estimator.
            time: Requested time; None for that of the last frame [s].
        """
        if not state.frames:
            return None
        first = state.frames[0]
        last = state.frames[-1]
        if time is None:
            time = last.time
        time = max(time, last.time)
        age = time - last.time
        per_span = 0.0
        if last.time > first.time:
            per_span = 1.0 / (last.time - first.time)
        return replace(
            last,
            time=time,
            status=self.status_at(age),
            age=age,
            center_of_mass_velocity=per_span * (last.center_of_mass - first.center_of_mass),
            heading_rate=per_span * (last.heading - first.heading),
            joint_rate=per_span * (last.joint_angle - first.joint_angle),
        )
