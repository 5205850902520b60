"""Kinematics alone, as in the paper: one pose of the marker body and the joint angles give everything.

Nothing is filtered; without a frame the last result stands still. The filter is measured against this.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.angles import wrap_to_pi
from laticauda.estimation.samples import Estimate, JointSample, PoseSample, Sample, StateEstimator
from laticauda.kinematics import center_of_mass, heading, link_angles, module_poses, turn
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot

Vector = Float[np.ndarray, " _n"]


@dataclass(frozen=True, kw_only=True, eq=False)
class KinematicState:
    """The last samples of the joints, and what the frames of the last moments said."""

    joints: tuple[tuple[float, Vector], ...] = ()
    """Times [s] and angles [rad], oldest first."""
    frames: tuple[Estimate, ...] = ()
    """Oldest first; without velocities."""


@value
class KinematicEstimator(StateEstimator):
    """From the pose of the last module and the joint angles to center of mass and link angles.

    Joint angles are interpolated to the time of the frame. Velocities are differences over `span`. In space, height and
    pitch are known too: the whole rotation of the marker body is used, and the angles of all joints. The center of mass
    is then that of modules whose own are on their axes.
    """

    in_space: bool = option("whether it measures in three dimensions; else pitch joints are straight", default=False)
    span: float = quantity("s", "time over which velocities are taken", gt=0.0, default=0.1)

    @cached_property
    def _chain(self) -> Robot:
        return self.robot.planar()

    def init(self) -> KinematicState:
        """The state before the first sample."""
        return KinematicState()

    def step(self, state: KinematicState, sample: Sample) -> KinematicState:
        """The state after one more sample; frames from before the last one are left out.

        Args:
            state: As the last call returned it, or `init`.
            sample: What came in.

        Raises:
            ValueError: If the sample does not fit the robot.
        """
        if isinstance(sample, JointSample):
            angle = self._own(sample.angle)
            if not np.isfinite(angle).all() or (state.joints and sample.time <= state.joints[-1][0]):
                return state
            kept = [item for item in state.joints if item[0] > sample.time - 2.0 * self.span]
            return replace(state, joints=(*kept, (sample.time, angle)))
        if isinstance(sample, PoseSample) and not sample.is_lost and sample.rotation is not None and state.joints:
            return self._add_frame(state, sample)
        return state

    def _add_frame(self, state: KinematicState, frame: PoseSample) -> KinematicState:
        assert frame.rotation is not None  # the caller looked
        if state.frames and frame.time <= state.frames[-1].time:
            return state
        times = np.array([time for time, _ in state.joints])
        angles = np.stack([angle for _, angle in state.joints])
        joint = np.array([float(np.interp(frame.time, times, angles[:, i])) for i in range(angles.shape[1])])
        theta, place, pitch = self._seen(frame.position, frame.rotation, joint)
        if state.frames:
            before = state.frames[-1].heading
            now = float(heading(theta))
            theta = theta + (before + wrap_to_pi(now - before) - now)
        said = Estimate(
            time=frame.time,
            status="tracking",
            age=0.0,
            center_of_mass=place,
            center_of_mass_velocity=np.zeros_like(place),
            heading=float(heading(theta)),
            pitch=pitch,
            heading_rate=0.0,
            link_angle=theta,
            joint_angle=joint,
            joint_rate=np.zeros_like(joint),
        )
        kept = [old for old in state.frames if old.time >= frame.time - self.span - 1e-9]
        return replace(state, frames=(*kept, said))

    def _own(self, angle: Vector) -> Vector:
        """The joints that count, of all."""
        return angle[: self.robot.n_joints] if self.in_space else self.robot.yaw_joints("angle", angle)

    def _seen(self, position: Vector, rotation: np.ndarray, joint: Vector) -> tuple[Vector, Vector, float]:
        """Link angles [rad], center of mass [m] and mean pitch [rad], by the pose of the marker body."""
        if not self.in_space:
            link, offset = self.on_link
            theta = link_angles(joint, angle=self.mount.link_yaw(rotation), link=link)
            return theta, center_of_mass(self._chain, position[:2], theta, link=link, offset=offset), 0.0
        modules = module_poses(self.robot, np.zeros(3), np.eye(3), joint)  # in the axes of the tail module
        carrier = modules.rotation[self.mount.module]
        turned = rotation @ turn("yaw", -self.mount.angle) @ carrier.T
        marker = modules.position[self.mount.module] + carrier @ np.array((*self.mount.offset, 0.0)[:3])
        ahead = turned @ modules.rotation[:, :, 0].T
        theta: Vector = np.unwrap(np.arctan2(ahead[1], ahead[0]))
        pitch: Vector = -np.arctan2(ahead[2], np.hypot(ahead[0], ahead[1]))
        return theta, position - turned @ marker, float(pitch.mean())

    def estimate(self, state: KinematicState, time: float | None = None) -> Estimate | None:
        """What the last frame said; None before the first one.

        Args:
            state: The estimator's state.
            time: For when; None: for the last frame [s].
        """
        if not state.frames:
            return None
        first, last = state.frames[0], state.frames[-1]
        now = last.time if time is None else max(time, last.time)
        pace = 1.0 / (last.time - first.time) if last.time > first.time else 0.0
        return replace(
            last,
            time=now,
            status=self.status_at(now - last.time),
            age=now - last.time,
            center_of_mass_velocity=pace * (last.center_of_mass - first.center_of_mass),
            heading_rate=pace * (last.heading - first.heading),
            joint_rate=pace * (last.joint_angle - first.joint_angle),
        )
