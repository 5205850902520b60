"""Filter: from joint samples and motion-capture frames to a smooth estimate.

Samples may have gaps, noise and outliers.
It is an extended Kalman filter with `MotionModel` and, optionally, a digital twin. Its state is a
value; samples may arrive late and out of order by up to `horizon`: the filter then goes back,
inserts the sample where it belongs, and repeats everything after it.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple, cast

import numpy as np

from laticauda.control.estimation.digital_twin import check_plant, start_twin, step_twin
from laticauda.control.estimation.filter_state import (
    EstimatorState,
    FilterState,
    Gaussian,
    Matrix,
    Noise,
    PastStep,
    Vector,
)
from laticauda.control.estimation.motion_model import MotionModel
from laticauda.control.estimation.samples import (
    Estimate,
    JointSample,
    PoseSample,
    ReferenceSample,
    Sample,
    StateEstimator,
)
from laticauda.control.estimation.servo_lag import smooth_reference, turn_by_speed_control
from laticauda.control.estimation.state_vector import JOINTS, VX, VY, H, R, S, U, X, Y
from laticauda.models.dynamics import Plant
from laticauda.motion.joints import SpeedServo
from laticauda.robot import Water, kinematics
from laticauda.values import BadArgument, option, quantity, value_class, wrap_to_pi

PLAY_TORQUE = 0.3
"""Approximate torque at which a gear touches on one side [N m]."""
LONGEST_STEP = 0.05
"""Longest prediction step over a gap [s]."""
FAULTY_POSE_VARIANCE = 1.0
"""Variance added to position [m^2], heading [rad^2] and its rate if the filter must be wrong."""
FAULTY_SPEED_VARIANCE = 0.1
"""Variance added to both speeds through the water then [m^2/s^2]."""
FAULTY_JOINT_RATE_VARIANCE = 1.0
"""Variance of the rate of a joint with which the filter is restarted [rad^2/s^2]."""


class _Measurement(NamedTuple):
    """What a frame says of the marker body."""

    values: Vector
    """x and y [m], and the yaw of the link [rad] if the frame has a rotation."""
    covariance: Matrix
    """Covariance of their noise."""


class _PredictionCache:
    """Last prediction: the next samples often come where an estimate was requested."""

    before: FilterState | None = None
    """State that was predicted from."""
    after: FilterState | None = None
    """State that was predicted."""
    time: float = math.nan
    """Time that was predicted to [s]."""


@value_class
class Estimator(StateEstimator):
    """Extended Kalman filter that estimates the motion of a robot; the fields are its settings.

    With a `plant`, a simulated robot whose joints are driven by the `pd` or `servo` law, a digital
    twin runs alongside and predicts the motion; without it, the filter has no model of the water.
    With `swim_speed`, a current along the course can be distinguished from the robot's own speed;
    see `MotionModel`. `backlash` is removed if the modules report torques: the sensor is on the
    motor's side, which leads by half the backlash wherever the motor pulls.
    """

    noise: Noise = option("noise of the sensors and of the model", default_factory=Noise)
    swim_speed: float | None = quantity(
        "m/s", "speed through the water under the gait, if known", default=None
    )
    swim_speed_std: float = quantity("m/s", "its standard deviation", gt=0.0, default=0.01)
    plant: Plant[Any] | None = option("the digital twin", default=None)
    coupling: float = quantity(
        "", "k of the twin's joints, phi_ref + k (phi - phi_twin)", ge=0.0, default=1.0
    )
    backlash: float = quantity(
        "rad", "total play between a joint and its sensor", ge=0.0, default=0.0
    )
    gate: float = quantity(
        "", "standard deviations beyond which a measurement is rejected", gt=0.0, default=5.0
    )
    largest_residual: float = quantity(
        "m", "of the markers of an accepted frame", gt=0.0, default=0.005
    )
    patience: int = quantity(
        "", "frames rejected in a row after which the filter must be wrong", ge=1, default=10
    )
    joint_patience: int = quantity(
        "", "the same for a joint: stalled servos break away", ge=1, default=3
    )
    horizon: float = quantity("s", "how late a sample may come", ge=0.0, default=0.1)

    def __post_init__(self) -> None:
        """Reject a plant that cannot serve as the robot's twin."""
        super().__post_init__()
        check_plant(self.plant, self.robot)
        if self.plant is None:
            return
        if self.swim_speed is not None:
            rule = "must be None with a `plant`, which determines it"
            raise BadArgument("swim_speed", f"{rule}, got {self.swim_speed}")
        water = self.plant.environment
        if isinstance(water, Water) and water.flow is not None:
            # The filter handles a flow.
            still_plant = replace(self.plant, environment=water.still)
            object.__setattr__(self, "plant", still_plant)

    @cached_property
    def model(self) -> MotionModel:
        """Motion model given by the settings."""
        return MotionModel(
            robot=self.robot,
            mount=self.mount,
            noise=self.noise,
            swim_speed=self.swim_speed,
            swim_speed_std=self.swim_speed_std,
        )

    @cached_property
    def twin_model(self) -> MotionModel:
        """Motion model used with a twin."""
        return MotionModel(
            robot=self.robot, mount=self.mount, noise=self.noise.beside_twin, has_twin=True
        )

    def init(self, time: float = -math.inf) -> EstimatorState:
        """Return the state before the first sample.

        The first call with a plant compiles it, which may take seconds.

        Args:
            time: Samples before this time are ignored [s].
        """
        zeros = np.zeros(self.model.n_joints)
        if self.plant is not None:
            twin = start_twin(self.plant, zeros)
            step_twin(self.plant, twin, reference=zeros, joint_angle=None, coupling=0.0, dt=0.01)
        first = FilterState(
            time=time,
            reference=zeros,
            lagged=zeros,
            lagged_rate=zeros,
            n_joint_rejected=zeros.astype(np.int64),
        )
        return EstimatorState(history=(PastStep(sample=None, state=first),))

    def step(self, state: EstimatorState, sample: Sample) -> EstimatorState:
        """Return the state after one more sample; samples may come in any order.

        Args:
            state: State returned by the last call or by `init`.
            sample: New sample.

        Raises:
            ValueError: If the sample does not fit the robot.
        """
        return self.steps(state, (sample,))

    def steps(self, state: EstimatorState, samples: Sequence[Sample]) -> EstimatorState:
        """Return the state after several samples that arrived at once.

        The filter goes back only once for all of them.

        Args:
            state: State returned by the last call or by `init`.
            samples: New samples in order of arrival.

        Raises:
            ValueError: If a sample does not fit the robot.
        """
        in_time = self._select_in_time(state, samples)
        n_late = state.n_late + len(samples) - len(in_time)
        if not in_time:
            return replace(state, n_late=n_late)
        history = list(state.history)
        repeated = _go_back(history, min(sample.time for sample in in_time))
        n_outliers = state.n_outliers
        for sample in sorted((*repeated, *in_time), key=_time_of):
            before = history[-1].state
            after = self._process(before, sample)
            history.append(PastStep(sample, after))
            is_new = not any(sample is earlier for earlier in repeated)
            if is_new and after.n_rejected > before.n_rejected:
                n_outliers += 1
        after_all = replace(state, history=tuple(history), n_outliers=n_outliers, n_late=n_late)
        return after_all.within(self.horizon)

    def _select_in_time(self, state: EstimatorState, samples: Sequence[Sample]) -> list[Sample]:
        """Return the samples that are not too late for the filter to go back to them."""
        first_time = state.history[0].state.time
        latest_time = state.latest.time
        in_time = list[Sample]()
        for sample in samples:
            if sample.time >= max(first_time, latest_time - self.horizon):
                in_time.append(sample)
            latest_time = max(latest_time, sample.time)
        return in_time

    def estimate(self, state: EstimatorState, time: float | None = None) -> Estimate | None:
        """Return the estimate, predicted from the last sample on.

        It is None before the first frame and joint sample.

        Args:
            state: State of the filter.
            time: Requested time; None for that of the last sample [s].
        """
        now = state.latest
        if now.posterior is None:
            return None
        if time is not None and time > now.time:
            now = self._predict(now, time)
        posterior = now.posterior
        assert posterior is not None  # a prediction keeps it
        mean = posterior.mean
        model = self._model_of(now)
        center_of_mass, heading, derivative = model.pose(mean, now.lagged)
        velocity, heading_rate = model.rates(
            mean, now.lagged, now.lagged_rate, now.frequency, now.twin
        )
        joint = now.lagged + mean[JOINTS::2]
        pose_covariance = derivative @ posterior.covariance @ derivative.T
        current_covariance = posterior.covariance[VX : VY + 1, VX : VY + 1]
        age = now.time - now.frame_time
        return Estimate(
            time=now.time,
            status=self.status_at(age),
            age=age,
            center_of_mass=center_of_mass,
            center_of_mass_velocity=velocity,
            heading=heading,
            heading_rate=heading_rate,
            link_angle=heading + model.spread @ joint,
            joint_angle=joint,
            joint_rate=now.lagged_rate + mean[JOINTS + 1 :: 2],
            center_of_mass_std=math.sqrt(0.5 * (pose_covariance[0, 0] + pose_covariance[1, 1])),
            heading_std=math.sqrt(pose_covariance[2, 2]),
            current=mean[[VX, VY]],
            current_std=math.sqrt(_larger_eigenvalue(current_covariance)),
        )

    # ---- prediction ------------------------------------------------------------------------------

    def _process(self, state: FilterState, sample: Sample) -> FilterState:
        """Return the filter after a sample that is not older than it."""
        state = self._predict(state, sample.time)
        if isinstance(sample, ReferenceSample):
            return self._apply_references(state, sample)
        if isinstance(sample, JointSample):
            return self._apply_joints(state, self._remove_play(sample))
        return self._apply_frame(state, sample)

    @cached_property
    def _last_prediction(self) -> _PredictionCache:
        return _PredictionCache()

    def _predict(self, state: FilterState, time: float) -> FilterState:
        """Return the filter at a later time, without further samples."""
        last = self._last_prediction
        if last.before is state and last.time == time and last.after is not None:
            return last.after
        after = self._advance(state, time)
        last.before = state
        last.time = time
        last.after = after
        return after

    def _advance(self, state: FilterState, time: float) -> FilterState:
        """Advance references, twin and estimate to a later time."""
        dt = time - state.time
        if dt == 0.0 or not math.isfinite(dt):
            return replace(state, time=time)
        lagged, lagged_rate = self._follow_references(state, dt)
        if state.posterior is not None or state.twin is not None:
            n_steps = max(1, math.ceil(dt / LONGEST_STEP))
            for _ in range(n_steps):
                state = self._advance_substep(state, lagged, dt / n_steps)
        return replace(state, time=time, lagged=lagged, lagged_rate=lagged_rate)

    def _follow_references(self, state: FilterState, dt: float) -> tuple[Vector, Vector]:
        """Return the lagged references after a step, and their rates; a twin's law says how joints lag."""
        law = None
        if self.plant is not None:
            law = self.plant.settings.joints
        if isinstance(law, SpeedServo):
            return turn_by_speed_control(state.lagged, state.reference, law, dt)
        return smooth_reference(
            state.lagged, state.lagged_rate, state.reference, self.model.reference_bandwidth, dt
        )

    def _advance_substep(self, state: FilterState, lagged: Vector, dt: float) -> FilterState:
        """Advance twin and estimate by one step; the lagged references are those at its end."""
        if state.twin is not None and self.plant is not None:
            state = self._advance_twin(self.plant, state, lagged, dt)
        if state.posterior is None:
            return state
        step = self._model_of(state).step(
            state.posterior.mean, lagged, state.frequency, dt, state.twin
        )
        posterior = state.posterior.predict(step.mean, step.transition, step.noise)
        return replace(state, posterior=posterior)

    def _advance_twin(
        self, plant: Plant[Any], state: FilterState, lagged: Vector, dt: float
    ) -> FilterState:
        """Advance the twin; if it must be abandoned, the model without a twin takes over."""
        assert state.twin is not None
        posterior = state.posterior
        joint_angle: Vector | None = None
        if posterior is not None:
            joint_angle = lagged + posterior.mean[JOINTS::2]
        twin = step_twin(
            plant,
            state.twin,
            reference=state.reference,
            joint_angle=joint_angle,
            coupling=self.coupling,
            dt=dt,
            fin=state.fin_reference,
        )
        if twin is None and posterior is not None:
            posterior = self.model.reset_motion(posterior)
        return replace(state, twin=twin, twin_failed=twin is None, posterior=posterior)

    def _model_of(self, state: FilterState) -> MotionModel:
        if state.twin is None:
            return self.model
        return self.twin_model

    # ---- references ------------------------------------------------------------------------------

    def _apply_references(self, state: FilterState, sample: ReferenceSample) -> FilterState:
        """Apply new references; the first ones start the twin."""
        reference = self.robot.yaw_joints("angle", sample.angle)
        if state.twin is None and self.plant is not None and not state.twin_failed:
            state = self._start_twin(self.plant, state, reference)
        fin_reference = tuple(sample.angle[self.robot.n_joints :].tolist())
        return replace(
            state,
            reference=reference,
            fin_reference=fin_reference,
            frequency=sample.frequency,
        )

    def _start_twin(self, plant: Plant[Any], state: FilterState, reference: Vector) -> FilterState:
        """Start the twin, whose model takes over."""
        posterior = state.posterior
        if posterior is not None:
            posterior = self.twin_model.reset_motion(posterior)
        return replace(state, twin=start_twin(plant, reference), posterior=posterior)

    # ---- joints ----------------------------------------------------------------------------------

    def _remove_play(self, sample: JointSample) -> Vector:
        """Return the joint angles, from the sensors and the side on which the gears touch [rad]."""
        angle = self.robot.yaw_joints("angle", sample.angle)
        if self.backlash == 0.0 or sample.torque is None:
            return angle
        torque = np.nan_to_num(self.robot.yaw_joints("torque", sample.torque))
        return angle - 0.5 * self.backlash * np.tanh(torque / PLAY_TORQUE)

    def _apply_joints(self, state: FilterState, angle: Vector) -> FilterState:
        """Correct the filter by joint angles, nan where a module did not answer.

        An angle far off is rejected; one that stays far off is accepted, and the filter restarted
        with it.
        """
        is_reported = np.isfinite(angle)
        if state.posterior is None:
            return _remember_joints(state, angle)
        posterior = state.posterior
        variance = self.noise.joint**2
        entries = JOINTS + 2 * np.arange(angle.size)
        residual = angle - state.lagged - posterior.mean[entries]
        spread = np.sqrt(posterior.covariance[entries, entries] + variance)
        is_rejected = is_reported & (np.abs(residual) > self.gate * spread)
        n_rejected = np.where(is_reported, 0, state.n_joint_rejected)
        n_rejected = np.where(is_rejected, state.n_joint_rejected + 1, n_rejected)
        is_insisting = n_rejected >= self.joint_patience
        if is_insisting.any():
            insisting = entries[is_insisting]
            measured = posterior.mean[insisting] + residual[is_insisting]
            posterior = posterior.reset_entries(insisting, measured, variance)
            posterior = posterior.reset_entries(insisting + 1, 0.0, FAULTY_JOINT_RATE_VARIANCE)
        is_used = is_reported & ~is_rejected
        if is_used.any():
            sensitivity = np.eye(posterior.mean.size)[entries[is_used]]
            noise = variance * np.eye(sensitivity.shape[0])
            posterior = posterior.update(residual[is_used], sensitivity, noise)
        n_rejected = np.where(is_insisting, 0, n_rejected)
        return replace(state, posterior=posterior, n_joint_rejected=n_rejected)

    # ---- frames ----------------------------------------------------------------------------------

    def _apply_frame(self, state: FilterState, frame: PoseSample) -> FilterState:
        """Correct the filter by a frame, or reject it if it is far off.

        If too many were rejected in a row, the filter must be wrong: it opens up and accepts.
        """
        if frame.is_lost:
            return state
        if frame.residual > self.largest_residual:
            return replace(state, n_rejected=state.n_rejected + 1)
        if state.posterior is None:
            return self._initialize(state, frame)
        posterior = state.posterior
        expected, sensitivity = self.model.marker(posterior.mean, state.lagged)
        measurement = self._measure(frame)
        n = measurement.values.size
        sensitivity = sensitivity[:n]
        residual = measurement.values - expected[:n]
        if n == 3:
            residual[2] = wrap_to_pi(float(residual[2]))
        # The mean and the spread of chi-squared are n and sqrt(2 n).
        limit = n + self.gate * math.sqrt(2.0 * n)
        distance = posterior.squared_distance(residual, sensitivity, measurement.covariance)
        if distance > limit:
            if state.n_rejected + 1 < self.patience:
                return replace(state, n_rejected=state.n_rejected + 1)
            posterior = _open_up(posterior)
        posterior = posterior.update(residual, sensitivity, measurement.covariance)
        return replace(state, posterior=posterior, frame_time=state.time, n_rejected=0)

    def _measure(self, frame: PoseSample) -> _Measurement:
        """Return what a frame says of the marker body; without a rotation, only its position."""
        variances = [self.noise.position**2, self.noise.position**2, self.noise.yaw**2]
        if frame.rotation is None or not np.isfinite(frame.rotation).all():
            return _Measurement(frame.position[:2].copy(), np.diag(variances[:2]))
        yaw = self.mount.link_yaw(frame.rotation)
        values = np.array([frame.position[0], frame.position[1], yaw])
        return _Measurement(values, np.diag(variances))

    def _initialize(self, state: FilterState, frame: PoseSample) -> FilterState:
        """Initialize the filter with the first frame and the joint angles before it."""
        measured = self._measure(frame).values
        if state.joint_angle is None or measured.size < 3:
            return state
        link, offset = self.on_link
        theta = kinematics.link_angles(state.joint_angle, angle=float(measured[2]), link=link)
        posterior = self._model_of(state).initial(
            center_of_mass=kinematics.center_of_mass(
                self.model.chain, measured[:2], theta, link=link, offset=offset
            ),
            heading=float(kinematics.heading(theta)),
            deviation=state.joint_angle - state.lagged,
            deviation_rate=-state.lagged_rate,
        )
        return replace(state, posterior=posterior, frame_time=state.time, joint_angle=None)


def _time_of(sample: Sample) -> float:
    return sample.time


def _go_back(history: list[PastStep], time: float) -> list[Sample]:
    """Take the steps after a time off the history, and return their samples, oldest first."""
    samples = list[Sample]()
    while len(history) > 1 and history[-1].state.time > time:
        sample = history.pop().sample
        samples.append(cast(Sample, sample))  # only the first step has none
    samples.reverse()
    return samples


def _remember_joints(state: FilterState, angle: Vector) -> FilterState:
    """Remember joint angles for the first frame; nan leaves a joint as it was."""
    is_reported = np.isfinite(angle)
    if not is_reported.any():
        return state
    last_angle = state.joint_angle
    if last_angle is None:
        last_angle = np.zeros_like(angle)
    return replace(state, joint_angle=np.where(is_reported, angle, last_angle))


def _larger_eigenvalue(matrix: Matrix) -> float:
    """Return the larger eigenvalue of a symmetric 2 x 2 matrix."""
    a = float(matrix[0, 0])
    b = float(matrix[0, 1])
    d = float(matrix[1, 1])
    return 0.5 * (a + d) + math.hypot(0.5 * (a - d), b)


def _open_up(posterior: Gaussian) -> Gaussian:
    """Increase the uncertainty of pose and speeds, for a filter that no longer fits any frame."""
    covariance = posterior.covariance.copy()
    for entry in (X, Y, H, R):
        covariance[entry, entry] += FAULTY_POSE_VARIANCE
    for entry in (U, S):
        covariance[entry, entry] += FAULTY_SPEED_VARIANCE
    return Gaussian(mean=posterior.mean, covariance=covariance)
