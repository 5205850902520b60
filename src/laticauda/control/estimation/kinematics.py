"""Kinematics only, as in the paper: one pose of the marker body and the joint angles determine everything.

Nothing is filtered; without a frame, the last result is held. This is the baseline for the filter.
"""

from dataclasses import dataclass, replace
from functools import cached_property

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


@dataclass(frozen=True, kw_only=True, eq=False)
class KinematicState:
    """Most recent joint samples, and the estimates from the most recent frames."""

    joints: tuple[tuple[float, Vector, Vector], ...] = ()
    """Times [s], angles [rad] and rates [rad/s], 0 where they are unknown, oldest first."""
    frames: tuple[Estimate, ...] = ()
    """Estimates from frames, oldest first; without velocities."""


@value_class
class KinematicEstimator(StateEstimator):
    """Estimator of center of mass and link angles from the pose of the marked module and the joint angles.

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
            angle = self._own(sample.angle)
            if not np.isfinite(angle).all() or (
                state.joints and sample.time <= state.joints[-1][0]
            ):
                return state
            rate = (
                np.zeros_like(angle)
                if sample.rate is None
                else np.nan_to_num(self._own(sample.rate))
            )
            kept = [item for item in state.joints if item[0] > sample.time - 2.0 * self.span]
            return replace(state, joints=(*kept, (sample.time, angle, rate)))
        if (
            isinstance(sample, PoseSample)
            and not sample.is_lost
            and sample.rotation is not None
            and state.joints
        ):
            return self._add_frame(state, sample)
        return state

    def _add_frame(self, state: KinematicState, frame: PoseSample) -> KinematicState:
        assert frame.rotation is not None  # checked by the caller
        if state.frames and frame.time <= state.frames[-1].time:
            return state
        times = np.array([time for time, *_ in state.joints])
        angles = np.stack([angle for _, angle, _ in state.joints])
        joint = np.array(
            [float(np.interp(frame.time, times, angles[:, i])) for i in range(angles.shape[1])]
        )
        joint += min(max(frame.time - float(times[-1]), 0.0), self.span) * state.joints[-1][2]
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
        """Select the joints that are used."""
        return (
            angle[: self.robot.n_joints] if self.in_space else self.robot.yaw_joints("angle", angle)
        )

    def _seen(
        self, position: Vector, rotation: np.ndarray, joint: Vector
    ) -> tuple[Vector, Vector, float]:
        """Return link angles [rad], center of mass [m] and mean pitch [rad] from the pose of the marker body."""
        if not self.in_space:
            link, offset = self.on_link
            theta = link_angles(joint, angle=self.mount.link_yaw(rotation), link=link)
            return (
                theta,
                center_of_mass(self._chain, position[:2], theta, link=link, offset=offset),
                0.0,
            )
        modules = module_poses(
            self.robot, np.zeros(3), np.eye(3), joint
        )  # in the axes of the tail module
        carrier = modules.rotation[self.mount.module]
        turned = rotation @ turn("yaw", -self.mount.angle) @ carrier.T
        marker = modules.position[self.mount.module] + carrier @ np.array(
            (*self.mount.offset, 0.0)[:3]
        )
        ahead = turned @ modules.rotation[:, :, 0].T
        theta: Vector = np.unwrap(np.arctan2(ahead[1], ahead[0]))
        pitch: Vector = -np.arctan2(ahead[2], np.hypot(ahead[0], ahead[1]))
        return theta, position - turned @ marker, float(pitch.mean())

    def estimate(self, state: KinematicState, time: float | None = None) -> Estimate | None:
        """Return the estimate from the last frame; None before the first one.

        Args:
            state: State of the estimator.
            time: Requested time; None for that of the last frame [s].
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
