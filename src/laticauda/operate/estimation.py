"""The filter: from joint samples and motion-capture frames, with gaps, noise and outliers, to a smooth estimate.

An extended Kalman filter over `laticauda.operate.motion`, with a digital twin beside it if there is one. Its state is a
value; samples may come late and out of order by up to `horizon`: then the filter goes back, takes the sample in where
it belongs, and repeats what came after it.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from laticauda.angles import wrap_to_pi
from laticauda.errors import not_negative, positive, whole
from laticauda.gaits.reference import filter_step
from laticauda.interfaces import Plant
from laticauda.kinematics import center_of_mass, heading, link_angles
from laticauda.operate import filtering
from laticauda.operate.belief import Belief, EstimatorState, nothing_seen, remembered
from laticauda.operate.estimate import Estimate, Mount, status_at
from laticauda.operate.filtering import Gaussian
from laticauda.operate.motion import JOINTS, VX, VY, H, MotionModel, R, S, U, X, Y
from laticauda.operate.noise import Noise, beside_twin
from laticauda.operate.samples import JointSample, PoseSample, ReferenceSample, Sample, yaw_joints
from laticauda.operate.twin import PlantRecord, check_plant, stepped
from laticauda.operate.twin import start as twin_start
from laticauda.robot import Robot

Vector: TypeAlias = NDArray[np.float64]

PLAY_TORQUE = 0.3  # that has a gear touch on one side, about [N m]
LONGEST_STEP = 0.05  # of the prediction over a gap [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimator:
    """The filter's settings.

    Raises:
        ValueError: If a field is out of its range.
    """

    robot: Robot
    """What swims; its planar reduction counts, pitch joints are straight."""
    mount: Mount = field(default_factory=Mount)
    """Where the marker body sits."""
    noise: Noise = field(default_factory=Noise)
    """How much sensors and model are off."""
    swim_speed: float | None = None
    """Speed through the water under the gait, if it is known; see `MotionModel` [m/s]."""
    swim_speed_std: float = 0.01
    """How well it is known [m/s]."""
    plant: Plant[Any] | PlantRecord | None = None
    """A simulated robot, its joints driven by the `pd` or `servo` law, that runs along as a digital twin and foresees
    the motion; None: the filter knows no water. A recording holds only its record."""
    coupling: float = 1.0
    """How strongly the twin's joints are pulled to the measured ones: phi_ref + coupling (phi - phi_twin) [-]."""
    backlash: float = 0.0
    """Play between a joint and its sensor, in all; taken off where the modules report torques. The sensor is on the
    motor's side, which leads by half the play wherever the motor pulls [rad]."""
    gate: float = 5.0
    """A measurement is not believed beyond so many standard deviations [-]."""
    largest_residual: float = 0.005
    """Nor is a frame whose markers fit the body worse than that [m]."""
    patience: int = 10
    """After so many unbelieved frames, or samples of a joint, in a row it is the filter that must be wrong [-]."""
    horizon: float = 0.1
    """How late a sample may come [s]."""
    bridging_after: float = 0.05
    """Without a frame for longer, the status is `bridging` [s]."""
    lost_after: float = 1.5
    """Without a frame for longer, the status is `lost` [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        for name in ("gate", "largest_residual", "bridging_after", "lost_after"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        object.__setattr__(self, "horizon", not_negative("horizon", self.horizon, "s"))
        object.__setattr__(self, "backlash", not_negative("backlash", self.backlash, "rad"))
        object.__setattr__(self, "coupling", not_negative("coupling", self.coupling))
        object.__setattr__(self, "patience", whole("patience", self.patience, 1))
        check_plant(self.plant, self.robot)
        if self.plant is not None and self.swim_speed is not None:
            raise ValueError(f"`swim_speed` must be None beside a `plant`, which knows it, got {self.swim_speed}.")
        _ = self.model

    @cached_property
    def model(self) -> MotionModel:
        """The motion model that follows from the settings."""
        return MotionModel(
            robot=self.robot,
            mount=self.mount,
            noise=self.noise,
            swim_speed=self.swim_speed,
            swim_speed_std=self.swim_speed_std,
        )

    @cached_property
    def twin_model(self) -> MotionModel:
        """The same beside a twin."""
        return MotionModel(robot=self.robot, mount=self.mount, noise=beside_twin(self.noise), has_twin=True)

    def init(self, time: float = -math.inf) -> EstimatorState:
        """Nothing seen yet. The first call with a plant has it compiled, which may take seconds.

        Args:
            time: Samples from before it are left out [s].

        Raises:
            ValueError: If the plant is only the record of one.
        """
        if isinstance(self.plant, PlantRecord):
            raise ValueError("`plant` must be made from its record first (`laticauda.plant`), got a record.")
        if self.plant is not None:
            still = np.zeros(self.model.n_joints)
            stepped(self._plant, twin_start(self._plant, still), still, None, 0.0, 0.01)
        return EstimatorState(history=((None, nothing_seen(self.model.n_joints, time)),))

    def step(self, state: EstimatorState, sample: Sample) -> EstimatorState:
        """The state after one more sample, in whatever order samples come.

        Args:
            state: As the last call returned it, or `init`.
            sample: What came in.

        Raises:
            ValueError: If the sample does not fit the robot.
        """
        later: list[Sample] = []
        history = list(state.history)
        while history[-1][1].time > sample.time:
            old, _ = history.pop()
            if old is None or not history:  # from before anything that is remembered
                return replace(state, n_late=state.n_late + 1)
            later.append(old)
        refused = 0
        for item in (sample, *reversed(later)):
            before = history[-1][1]
            belief = self._after(before, item)
            history.append((item, belief))
            refused += item is sample and belief.n_refused > before.n_refused
        return EstimatorState(
            history=remembered(history, self.horizon), n_outliers=state.n_outliers + refused, n_late=state.n_late
        )

    def estimate(self, state: EstimatorState, time: float | None = None) -> Estimate | None:
        """Where the robot is, by the model from the last sample on; None before the first frame and joint sample.

        Args:
            state: The filter's state.
            time: For when; None: for the last sample [s].
        """
        belief = state.belief
        if belief.known is None:
            return None
        if time is not None and time > belief.time:
            belief = self._moved(belief, time)
        known, model = belief.known, self._model_of(belief)
        assert known is not None
        mean = known.mean
        place, theta, rows = model.pose(mean, belief.smooth)
        velocity, turning = model.rates(mean, belief.smooth, belief.smooth_rate, belief.frequency, belief.twin)
        joint = belief.smooth + mean[JOINTS::2]
        spread = rows @ known.covariance @ rows.T
        water = known.covariance[VX : VY + 1, VX : VY + 1]
        age = belief.time - belief.seen
        return Estimate(
            time=belief.time,
            status=status_at(age, self.bridging_after, self.lost_after),
            age=age,
            center_of_mass=place,
            center_of_mass_velocity=velocity,
            heading=theta,
            heading_rate=turning,
            link_angle=theta + model.spread @ joint,
            joint_angle=joint,
            joint_rate=belief.smooth_rate + mean[JOINTS + 1 :: 2],
            center_of_mass_std=math.sqrt(0.5 * (spread[0, 0] + spread[1, 1])),
            heading_std=math.sqrt(spread[2, 2]),
            current=mean[[VX, VY]],
            current_std=math.sqrt(_larger_eigenvalue(water)),
        )

    # ---- inside ----------------------------------------------------------------------------------------------------

    def _after(self, belief: Belief, sample: Sample) -> Belief:
        belief = self._moved(belief, sample.time)
        if isinstance(sample, ReferenceSample):
            return self._with_references(belief, sample)
        if isinstance(sample, JointSample):
            return self._with_joints(belief, self._without_play(sample))
        return self._with_frame(belief, sample)

    def _moved(self, belief: Belief, time: float) -> Belief:
        """What is believed at a later time, without having seen more."""
        dt = time - belief.time
        if dt == 0.0:
            return belief
        if not math.isfinite(dt):
            return replace(belief, time=time)
        width = self.model.reference_bandwidth
        # The filter's formula holds for arrays too.
        moved: Any = filter_step
        smooth, rate, _ = moved(belief.smooth, belief.smooth_rate, belief.asked, width, math.exp(-width * dt), dt)
        n_steps = max(1, math.ceil(dt / LONGEST_STEP)) if belief.known is not None or belief.twin is not None else 0
        for _ in range(n_steps):
            belief = self._moved_on(belief, smooth, dt / n_steps)
        return replace(belief, time=time, smooth=smooth, smooth_rate=rate)

    def _moved_on(self, belief: Belief, smooth: Vector, dt: float) -> Belief:
        """Twin and robot after one step; the joints' smoothed references are already those at its end."""
        known, twin, moved = belief.known, belief.twin, None
        if twin is not None:
            joint = None if known is None else smooth + known.mean[JOINTS::2]
            then = stepped(self._plant, twin, belief.asked, joint, self.coupling, dt)
            if then is None:
                belief = replace(belief, twin=None, twin_failed=True)
                known = None if known is None else self.model.anew(known)
            else:
                twin, moved = then
                belief = replace(belief, twin=twin)
        if known is not None:
            mean, f, q = self._model_of(belief).step(known.mean, smooth, belief.frequency, dt, moved)
            known = filtering.predicted(mean, known.covariance, f, q)
        return replace(belief, known=known)

    @property
    def _plant(self) -> Plant[Any]:
        # `init` has refused a mere record; to ask here again would cost as much as the step.
        return cast("Plant[Any]", self.plant)

    def _model_of(self, belief: Belief) -> MotionModel:
        return self.model if belief.twin is None else self.twin_model

    def _with_references(self, belief: Belief, sample: ReferenceSample) -> Belief:
        """What the joints are asked for; the first ones start the twin."""
        asked, twin, known = self._yaw("angle", sample.angle), belief.twin, belief.known
        if twin is None and self.plant is not None and not belief.twin_failed:
            twin = twin_start(self._plant, asked)
            known = None if known is None else self.twin_model.anew(known)
        return replace(belief, asked=asked, frequency=sample.frequency, twin=twin, known=known)

    def _without_play(self, sample: JointSample) -> Vector:
        """The joint angles, from the sensors and the side on which the gears touch."""
        angle = self._yaw("angle", sample.angle)
        if self.backlash == 0.0 or sample.torque is None:
            return angle
        pull = np.nan_to_num(self._yaw("torque", sample.torque))
        return angle - 0.5 * self.backlash * np.tanh(pull / PLAY_TORQUE)

    def _with_joints(self, belief: Belief, angle: Vector) -> Belief:
        told = np.isfinite(angle)
        if belief.known is None:
            before = np.zeros_like(angle) if belief.joint is None else belief.joint
            return replace(belief, joint=np.where(told, angle, before)) if told.any() else belief
        known = belief.known
        places = JOINTS + 2 * np.arange(angle.size)
        residual = angle - belief.smooth - known.mean[places]
        spread = np.sqrt(known.covariance[places, places] + self.noise.joint**2)
        stray = told & (np.abs(residual) > self.gate * spread)
        n_stray = np.where(stray, belief.n_stray + 1, np.where(told, 0, belief.n_stray))
        known = self._anew(known, places[n_stray >= self.patience], residual[n_stray >= self.patience])
        use = told & ~stray
        if use.any():
            rows = np.zeros((int(use.sum()), known.mean.size))
            rows[np.arange(rows.shape[0]), places[use]] = 1.0
            noise = self.noise.joint**2 * np.eye(rows.shape[0])
            known = filtering.corrected(known, residual[use], rows, noise)
        return replace(belief, known=known, n_stray=np.where(n_stray >= self.patience, 0, n_stray))

    def _anew(self, known: Gaussian, places: np.ndarray, shift: Vector) -> Gaussian:
        """Joints that insist on another angle are believed: the filter starts anew with them."""
        if not places.size:
            return known
        mean, covariance = known.mean.copy(), known.covariance.copy()
        mean[places] += shift
        mean[places + 1] = 0.0
        for at, variance in ((places, self.noise.joint**2), (places + 1, 1.0)):
            covariance[at, :] = covariance[:, at] = 0.0
            covariance[at, at] = variance
        return Gaussian(mean=mean, covariance=covariance)

    def _with_frame(self, belief: Belief, frame: PoseSample) -> Belief:
        if frame.is_lost:
            return belief
        if frame.residual > self.largest_residual:
            return replace(belief, n_refused=belief.n_refused + 1)
        if belief.known is None:
            return self._first(belief, frame)
        known, model = belief.known, self.model
        expected, rows = model.marker(known.mean, belief.smooth)
        measured, noise = self._measured(frame)
        n = measured.size
        residual, rows = measured - expected[:n], rows[:n]
        if n == 3:
            residual[2] = wrap_to_pi(float(residual[2]))
        if filtering.squared_distance(known, residual, rows, noise) > self._limit(n):
            if belief.n_refused + 1 < self.patience:
                return replace(belief, n_refused=belief.n_refused + 1)
            known = _widened(known)
        known = filtering.corrected(known, residual, rows, noise)
        return replace(belief, known=known, seen=belief.time, n_refused=0)

    def _limit(self, n: int) -> float:
        """The gate on a squared distance of n numbers: mean and spread of chi-squared are n and sqrt(2 n)."""
        return n + self.gate * math.sqrt(2.0 * n)

    def _measured(self, frame: PoseSample) -> tuple[Vector, NDArray[np.float64]]:
        variance = [self.noise.position**2, self.noise.position**2, self.noise.yaw**2]
        if frame.rotation is None or not np.isfinite(frame.rotation).all():
            return frame.position[:2].copy(), np.diag(variance[:2])
        yaw = self.mount.link_yaw(frame.rotation)
        return np.array([frame.position[0], frame.position[1], yaw]), np.diag(variance)

    def _first(self, belief: Belief, frame: PoseSample) -> Belief:
        """The first frame, with the joint angles before it, gives a pose to start from."""
        measured, _ = self._measured(frame)
        if belief.joint is None or measured.size < 3:
            return belief
        link, offset = self.mount.on_link(self.robot)
        theta = link_angles(belief.joint, angle=float(measured[2]), link=link)
        place = center_of_mass(self.model.chain, measured[:2], theta, link=link, offset=offset)
        known = self._model_of(belief).start(
            place, float(heading(theta)), belief.joint - belief.smooth, -belief.smooth_rate
        )
        return replace(belief, known=known, seen=belief.time, joint=None)

    def _yaw(self, name: str, angle: Vector) -> Vector:
        """Of the joints that turn in the plane, whichever of both was given."""
        return yaw_joints(self.robot, name, angle)


def _larger_eigenvalue(matrix: NDArray[np.float64]) -> float:
    """Of a symmetric 2 x 2 matrix."""
    a, b, d = float(matrix[0, 0]), float(matrix[0, 1]), float(matrix[1, 1])
    return 0.5 * (a + d) + math.hypot(0.5 * (a - d), b)


def _widened(known: Gaussian) -> Gaussian:
    """The same, with pose and speeds open again: for a filter that no frame fits any more."""
    covariance = known.covariance.copy()
    for at, variance in ((X, 1.0), (Y, 1.0), (H, 1.0), (U, 0.1), (S, 0.1), (R, 1.0)):
        covariance[at, at] += variance
    return Gaussian(mean=known.mean, covariance=covariance)
