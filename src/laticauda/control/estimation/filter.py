"""Filter from joint samples and motion-capture frames, with gaps, noise and outliers, to a smooth estimate.

It is an extended Kalman filter with `MotionModel` and, optionally, a digital twin. Its state is a
value; samples may arrive late and out of order by up to `horizon`: the filter then goes back,
inserts the sample where it belongs, and repeats everything after it.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, cast

import numpy as np

from laticauda.control.estimation.digital_twin import check_plant, start_twin, step_twin
from laticauda.control.estimation.filter_state import (
    EstimatorState,
    FilterState,
    Gaussian,
    Matrix,
    Noise,
    Vector,
)
from laticauda.control.estimation.motion_model import JOINTS, VX, VY, H, MotionModel, R, S, U, X, Y
from laticauda.control.estimation.samples import (
    Estimate,
    JointSample,
    PoseSample,
    ReferenceSample,
    Sample,
    StateEstimator,
)
from laticauda.models.dynamics import Plant
from laticauda.motion.gaits import filter_step
from laticauda.robot import Water, center_of_mass, heading, link_angles
from laticauda.values import BadArgument, option, quantity, value_class, wrap_to_pi

PLAY_TORQUE = 0.3  # approximate torque at which a gear touches on one side [N m]
LONGEST_STEP = 0.05  # longest prediction step over a gap [s]


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
        if (
            self.plant is not None
            and isinstance(water := self.plant.environment, Water)
            and water.flow is not None
        ):
            object.__setattr__(
                self, "plant", replace(self.plant, environment=water.still)
            )  # the filter handles a flow
        if self.plant is not None and self.swim_speed is not None:
            raise BadArgument(
                "swim_speed",
                f"must be None with a `plant`, which determines it, got {self.swim_speed}",
            )

    @cached_property
    def model(self) -> MotionModel:
        """Motion model given by the settings."""
        speed: dict[str, Any] = {
            "swim_speed": self.swim_speed,
            "swim_speed_std": self.swim_speed_std,
        }
        return MotionModel(robot=self.robot, mount=self.mount, noise=self.noise, **speed)

    @cached_property
    def twin_model(self) -> MotionModel:
        """Motion model used with a twin."""
        return MotionModel(
            robot=self.robot, mount=self.mount, noise=self.noise.beside_twin, has_twin=True
        )

    def init(self, time: float = -math.inf) -> EstimatorState:
        """Return the state before the first sample. The first call with a plant compiles it, which may take seconds.

        Args:
            time: Samples before this time are ignored [s].
        """
        still = np.zeros(self.model.n_joints)
        if self.plant is not None:
            step_twin(self.plant, start_twin(self.plant, still), still, None, 0.0, 0.01)
        none = still.astype(np.int64)
        first = FilterState(
            time=time, reference=still, lagged=still, lagged_rate=still, n_joint_rejected=none
        )
        return EstimatorState(history=((None, first),))

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
        """Return the state after several samples that arrived at once; the filter goes back only once for all of them.

        Args:
            state: State returned by the last call or by `init`.
            samples: New samples in order of arrival.

        Raises:
            ValueError: If a sample does not fit the robot.
        """
        history, new = list(state.history), list[Sample]()
        latest = state.latest.time
        for sample in samples:
            if sample.time >= max(history[0][1].time, latest - self.horizon):
                new.append(sample)
            latest = max(latest, sample.time)
        n_late = state.n_late + len(samples) - len(new)
        if not new:
            return replace(state, n_late=n_late)
        later, begin = list[Sample](), min(sample.time for sample in new)
        while len(history) > 1 and history[-1][1].time > begin:
            later.append(cast(Sample, history.pop()[0]))  # only the first has none
        rejected = 0
        for item in sorted((*reversed(later), *new), key=lambda sample: sample.time):
            before = history[-1][1]
            after = self._after(before, item)
            history.append((item, after))
            rejected += after.n_rejected > before.n_rejected and not any(
                item is old for old in later
            )
        after = replace(
            state, history=tuple(history), n_outliers=state.n_outliers + rejected, n_late=n_late
        )
        return after.within(self.horizon)

    def estimate(self, state: EstimatorState, time: float | None = None) -> Estimate | None:
        """Return the estimate, predicted from the last sample on; None before the first frame and joint sample.

        Args:
            state: State of the filter.
            time: Requested time; None for that of the last sample [s].
        """
        now = state.latest
        if now.posterior is None:
            return None
        if time is not None and time > now.time:
            now = self._predicted(now, time)
        posterior, model = now.posterior, self._model_of(now)
        assert posterior is not None  # a prediction keeps it
        mean = posterior.mean
        place, theta, rows = model.pose(mean, now.lagged)
        velocity, turning = model.rates(mean, now.lagged, now.lagged_rate, now.frequency, now.twin)
        joint = now.lagged + mean[JOINTS::2]
        spread = rows @ posterior.covariance @ rows.T
        age = now.time - now.frame_time
        return Estimate(
            time=now.time,
            status=self.status_at(age),
            age=age,
            center_of_mass=place,
            center_of_mass_velocity=velocity,
            heading=theta,
            heading_rate=turning,
            link_angle=theta + model.spread @ joint,
            joint_angle=joint,
            joint_rate=now.lagged_rate + mean[JOINTS + 1 :: 2],
            center_of_mass_std=math.sqrt(0.5 * (spread[0, 0] + spread[1, 1])),
            heading_std=math.sqrt(spread[2, 2]),
            current=mean[[VX, VY]],
            current_std=math.sqrt(
                _larger_eigenvalue(posterior.covariance[VX : VY + 1, VX : VY + 1])
            ),
        )

    # ---- inside ----------------------------------------------------------------------------------

    def _after(self, state: FilterState, sample: Sample) -> FilterState:
        state = self._predicted(state, sample.time)
        if isinstance(sample, ReferenceSample):
            return self._with_references(state, sample)
        if isinstance(sample, JointSample):
            return self._with_joints(state, self._without_play(sample))
        return self._with_frame(state, sample)

    def _predicted(self, state: FilterState, time: float) -> FilterState:
        """Return the filter at a later time, without further samples.

        The last prediction is kept: the next samples often come where an estimate was requested.
        """
        kept: Any = self.__dict__.get("_kept", (None, math.nan, None))
        if kept[0] is not state or kept[1] != time:
            kept = self.__dict__["_kept"] = state, time, self._advanced(state, time)
        return kept[2]

    def _advanced(self, state: FilterState, time: float) -> FilterState:
        dt = time - state.time
        if dt == 0.0 or not math.isfinite(dt):
            return replace(state, time=time)
        width = self.model.reference_bandwidth
        decay, lag = (
            math.exp(-width * dt),
            cast(Any, filter_step),
        )  # its formula also holds for arrays
        lagged, rate, _ = lag(state.lagged, state.lagged_rate, state.reference, width, decay, dt)
        runs = state.posterior is not None or state.twin is not None
        n_steps = max(1, math.ceil(dt / LONGEST_STEP)) if runs else 0
        for _ in range(n_steps):
            state = self._substep(state, lagged, dt / n_steps)
        return replace(state, time=time, lagged=lagged, lagged_rate=rate)

    def _substep(self, state: FilterState, lagged: Vector, dt: float) -> FilterState:
        """Advance twin and robot by one step; the joints' lagged references are already those at its end."""
        posterior = state.posterior
        if state.twin is not None and self.plant is not None:
            joint = None if posterior is None else lagged + posterior.mean[JOINTS::2]
            twin = step_twin(
                self.plant,
                state.twin,
                state.reference,
                joint,
                self.coupling,
                dt,
                fin=state.fin_reference,
            )
            if twin is None and posterior is not None:
                posterior = self.model.reopened(posterior)
            state = replace(state, twin=twin, twin_failed=twin is None)
        if posterior is not None:
            mean, f, q = self._model_of(state).step(
                posterior.mean, lagged, state.frequency, dt, state.twin
            )
            posterior = posterior.predict(mean, f, q)
        return replace(state, posterior=posterior)

    def _model_of(self, state: FilterState) -> MotionModel:
        return self.model if state.twin is None else self.twin_model

    def _with_references(self, state: FilterState, sample: ReferenceSample) -> FilterState:
        """Apply new references; the first ones start the twin."""
        reference, twin, posterior = (
            self.robot.yaw_joints("angle", sample.angle),
            state.twin,
            state.posterior,
        )
        if twin is None and self.plant is not None and not state.twin_failed:
            twin = start_twin(self.plant, reference)
            posterior = None if posterior is None else self.twin_model.reopened(posterior)
        fin = tuple(sample.angle[self.robot.n_joints :].tolist())
        state = replace(state, reference=reference, fin_reference=fin, frequency=sample.frequency)
        return replace(state, twin=twin, posterior=posterior)

    def _without_play(self, sample: JointSample) -> Vector:
        """Return the joint angles, from the sensors and the side on which the gears touch."""
        angle = self.robot.yaw_joints("angle", sample.angle)
        if self.backlash == 0.0 or sample.torque is None:
            return angle
        pull = np.nan_to_num(self.robot.yaw_joints("torque", sample.torque))
        return angle - 0.5 * self.backlash * np.tanh(pull / PLAY_TORQUE)

    def _with_joints(self, state: FilterState, angle: Vector) -> FilterState:
        reported = np.isfinite(angle)
        if state.posterior is None:
            before = np.zeros_like(angle) if state.joint_angle is None else state.joint_angle
            return (
                replace(state, joint_angle=np.where(reported, angle, before))
                if reported.any()
                else state
            )
        posterior = state.posterior
        places = JOINTS + 2 * np.arange(angle.size)
        residual = angle - state.lagged - posterior.mean[places]
        spread = np.sqrt(posterior.covariance[places, places] + self.noise.joint**2)
        rejected = reported & (np.abs(residual) > self.gate * spread)
        n_rejected = np.where(
            rejected, state.n_joint_rejected + 1, np.where(reported, 0, state.n_joint_rejected)
        )
        insists = n_rejected >= self.joint_patience
        if insists.any():  # accept these and restart the filter with them
            at = places[insists]
            posterior = posterior.restarted(
                at, posterior.mean[at] + residual[insists], self.noise.joint**2
            )
            posterior = posterior.restarted(at + 1, 0.0, 1.0)
        use = reported & ~rejected
        if use.any():
            rows = np.eye(posterior.mean.size)[places[use]]
            posterior = posterior.update(
                residual[use], rows, self.noise.joint**2 * np.eye(rows.shape[0])
            )
        return replace(
            state, posterior=posterior, n_joint_rejected=np.where(insists, 0, n_rejected)
        )

    def _with_frame(self, state: FilterState, frame: PoseSample) -> FilterState:
        if frame.is_lost:
            return state
        if frame.residual > self.largest_residual:
            return replace(state, n_rejected=state.n_rejected + 1)
        if state.posterior is None:
            return self._initialized(state, frame)
        posterior = state.posterior
        expected, rows = self.model.marker(posterior.mean, state.lagged)
        measured, noise = self._measurement(frame)
        n = measured.size
        residual, rows = measured - expected[:n], rows[:n]
        if n == 3:
            residual[2] = wrap_to_pi(float(residual[2]))
        gate = n + self.gate * math.sqrt(
            2.0 * n
        )  # mean and spread of chi-squared are n and sqrt(2 n)
        if posterior.squared_distance(residual, rows, noise) > gate:
            if state.n_rejected + 1 < self.patience:
                return replace(state, n_rejected=state.n_rejected + 1)
            posterior = _inflated(posterior)
        posterior = posterior.update(residual, rows, noise)
        return replace(state, posterior=posterior, frame_time=state.time, n_rejected=0)

    def _measurement(self, frame: PoseSample) -> tuple[Vector, Matrix]:
        variance = [self.noise.position**2, self.noise.position**2, self.noise.yaw**2]
        if frame.rotation is None or not np.isfinite(frame.rotation).all():
            return frame.position[:2].copy(), np.diag(variance[:2])
        yaw = self.mount.link_yaw(frame.rotation)
        return np.array([frame.position[0], frame.position[1], yaw]), np.diag(variance)

    def _initialized(self, state: FilterState, frame: PoseSample) -> FilterState:
        """Initialize the filter with the pose from the first frame and the joint angles before it."""
        measured, _ = self._measurement(frame)
        if state.joint_angle is None or measured.size < 3:
            return state
        link, offset = self.on_link
        theta = link_angles(state.joint_angle, angle=float(measured[2]), link=link)
        place = center_of_mass(self.model.chain, measured[:2], theta, link=link, offset=offset)
        posterior = self._model_of(state).initial(
            place, float(heading(theta)), state.joint_angle - state.lagged, -state.lagged_rate
        )
        return replace(state, posterior=posterior, frame_time=state.time, joint_angle=None)


def _larger_eigenvalue(matrix: Matrix) -> float:
    """Return the larger eigenvalue of a symmetric 2 x 2 matrix."""
    a, b, d = float(matrix[0, 0]), float(matrix[0, 1]), float(matrix[1, 1])
    return 0.5 * (a + d) + math.hypot(0.5 * (a - d), b)


def _inflated(posterior: Gaussian) -> Gaussian:
    """Increase the uncertainty of pose and speeds, for a filter that no longer fits any frame."""
    covariance = posterior.covariance.copy()
    for at, variance in ((X, 1.0), (Y, 1.0), (H, 1.0), (U, 0.1), (S, 0.1), (R, 1.0)):
        covariance[at, at] += variance
    return Gaussian(mean=posterior.mean, covariance=covariance)
