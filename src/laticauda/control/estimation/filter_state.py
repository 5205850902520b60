"""State of the filter: errors of sensors and model, a Gaussian estimate, and the recent past.

Late samples take the filter back to that past; see `laticauda.control.estimation.filter`.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda.control.estimation import digital_twin, samples
from laticauda.values import quantity, value_class

# The filter runs hundreds of times per second: shapes are given in docstrings and not checked at
# run time.
Vector: TypeAlias = NDArray[np.float64]
Matrix: TypeAlias = NDArray[np.float64]


@value_class
class Noise:
    """Errors of sensors and model: standard deviations, and how fast unknown quantities wander."""

    position: float = quantity("m", "of the marker body, per axis", gt=0.0, default=0.001)
    yaw: float = quantity("rad", "of the marker body", gt=0.0, default=math.radians(0.1))
    joint: float = quantity(
        "rad", "of a joint's sensor, with residual backlash", gt=0.0, default=math.radians(0.3)
    )
    joint_acceleration: float = quantity(
        "rad/s^2/sqrt(Hz)", "drift of the rate from reference", gt=0.0, default=0.5
    )
    position_walk: float = quantity(
        "m/sqrt(s)", "how fast the center of mass drifts", ge=0.0, default=0.001
    )
    surge: float = quantity(
        "m/s/sqrt(s)", "how fast the speed through the water changes", ge=0.0, default=0.0067
    )
    sway: float = quantity(
        "m/s", "of the sideways speed, which fades within `sway_time`", ge=0.0, default=0.01
    )
    sway_time: float = quantity("s", "in which the sideways speed fades", gt=0.0, default=6.0)
    current: float = quantity(
        "m/s", "of the water's velocity, per axis, before any frame", gt=0.0, default=0.1
    )
    current_walk: float = quantity(
        "m/s/sqrt(s)", "how fast the water's velocity changes", ge=0.0, default=0.001
    )
    turning: float = quantity(
        "rad/s/sqrt(s)", "how fast the smooth heading's rate changes", ge=0.0, default=0.03
    )
    turn_gain: float = quantity(
        "1/s/sqrt(s)", "how fast turning per mean joint angle changes", ge=0.0, default=0.06
    )
    slip_gain: float = quantity(
        "m/s/sqrt(s)", "the same for the sideways speed", ge=0.0, default=0.015
    )
    heading_gain: float = quantity(
        "1/sqrt(s)", "how fast a mode's share in the heading changes", ge=0.0, default=0.15
    )
    across_gain: float = quantity(
        "m/sqrt(s)", "the same for its share in the place across", ge=0.0, default=0.005
    )
    heading_ripple: float = quantity(
        "rad/sqrt(s)", "of the heading's ripple; harmonic k: 1/k", ge=0.0, default=0.0033
    )
    position_ripple: float = quantity(
        "m/sqrt(s)", "the same for the center of mass", ge=0.0, default=0.006
    )

    @property
    def beside_twin(self) -> "Noise":
        """Noise of the same sensors, and of the part of the motion that a twin does not predict."""
        limited = {name: min(getattr(self, name), limit) for name, limit in BESIDE_TWIN.items()}
        return replace(self, **limited)


BESIDE_TWIN = {
    "turning": 0.012,
    "turn_gain": 0.03,
    "slip_gain": 0.01,
    "heading_gain": 0.05,
    "across_gain": 0.002,
    "heading_ripple": 0.003,
    "position_ripple": 0.0025,
}
"""Limits on how fast the motion that a twin does not explain changes, in the units of `Noise`.

They were chosen on runs of their own, with the right plant and with a wrong one; see
docs/theory/estimation.md.
"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Gaussian:
    """Gaussian estimate of a vector: mean and covariance, in the units of its components."""

    mean: Vector
    """Expected value."""
    covariance: Matrix
    """Covariance; symmetric, positive semi-definite."""

    def predict(self, mean: Vector, transition: Matrix, noise: Matrix) -> "Gaussian":
        """Apply a time step: the covariance becomes F P F' + Q.

        Args:
            mean: Mean after the step, computed by a nonlinear model.
            transition: F, derivative of the step with respect to the estimated vector.
            noise: Q, covariance of the process noise.
        """
        covariance = transition @ self.covariance @ transition.T + noise
        return Gaussian(mean=mean, covariance=_symmetrize(covariance))

    def update(self, residual: Vector, sensitivity: Matrix, noise: Matrix) -> "Gaussian":
        """Apply a measurement, with the Joseph form of the covariance.

        Args:
            residual: Measured minus expected; angles wrapped.
            sensitivity: H, derivative of the measurement with respect to the estimated vector.
            noise: R, covariance of the measurement.
        """
        # H x is added and subtracted again, as in recordings that are replayed bit for bit.
        linear = sensitivity @ self.mean
        spread = sensitivity @ self.covariance @ sensitivity.T + noise
        gain = self.covariance @ sensitivity.T @ np.linalg.inv(spread)
        remainder = np.eye(self.mean.size) - gain @ sensitivity
        covariance = remainder @ self.covariance @ remainder.T + gain @ noise @ gain.T
        mean = self.mean + gain @ ((residual + linear) - linear)
        return Gaussian(mean=mean, covariance=_symmetrize(covariance))

    def reset_entries(
        self, entries: np.ndarray, mean: Vector | float, variance: Vector | float
    ) -> "Gaussian":
        """Return the same Gaussian with some entries reset and uncorrelated with all others.

        Args:
            entries: Indices of the entries.
            mean: Their mean.
            variance: Their variance.
        """
        whole_mean = self.mean.copy()
        whole_mean[entries] = mean
        covariance = self.covariance.copy()
        covariance[entries, :] = 0.0
        covariance[:, entries] = 0.0
        covariance[entries, entries] = variance
        return Gaussian(mean=whole_mean, covariance=covariance)

    def squared_distance(self, residual: Vector, sensitivity: Matrix, noise: Matrix) -> float:
        """Return the squared distance of a measurement in units of its expected spread [-].

        It is distributed as chi-squared, with as many degrees of freedom as the measurement has
        numbers.

        Args:
            residual: Measured minus expected; angles wrapped.
            sensitivity: H, derivative of the measurement with respect to the estimated vector.
            noise: R, covariance of the measurement.
        """
        spread = sensitivity @ self.covariance @ sensitivity.T + noise
        return float(residual @ np.linalg.solve(spread, residual))


@dataclass(frozen=True, kw_only=True, eq=False)
class FilterState:
    """State of the filter right after one sample."""

    time: float
    """Time [s]."""
    reference: Vector
    """phi_ref in force [rad]."""
    fin_reference: tuple[float, ...] = ()
    """phi_ref in force of a driven fin, which the twin needs; empty without a fin [rad]."""
    lagged: Vector
    """phi_ref after the filter that models the joints' lag [rad]."""
    lagged_rate: Vector
    """Rate of `lagged` [rad/s]."""
    n_joint_rejected: np.ndarray
    """Number of consecutive rejected samples, per joint [-]."""
    posterior: Gaussian | None = None
    """Estimated quantities; None before the first frame."""
    frequency: float = 0.0
    """Frequency of the gait [rad/s]."""
    joint_angle: Vector | None = None
    """Last joint angles before the first frame [rad]."""
    frame_time: float = -math.inf
    """Time of the last accepted frame; -inf before the first [s]."""
    n_rejected: int = 0
    """Number of consecutive rejected frames [-]."""
    twin: digital_twin.TwinState | None = None
    """Digital twin; None without one."""
    twin_failed: bool = False
    """Whether the twin had to be abandoned [-]."""


class PastStep(NamedTuple):
    """A sample, and the filter right after it."""

    sample: samples.Sample | None
    """The sample; None if it is so old that the filter never returns to before it."""
    state: FilterState
    """State of the filter after it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EstimatorState:
    """State of the estimator: the current filter, and its last few steps."""

    history: tuple[PastStep, ...]
    """Last steps, oldest first; only the first has no sample."""
    n_outliers: int = 0
    """Number of frames rejected so far [-]."""
    n_late: int = 0
    """Number of samples so far that arrived too late and were left out [-]."""

    @property
    def latest(self) -> FilterState:
        """Filter after the last sample."""
        return self.history[-1].state

    def within(self, horizon: float) -> "EstimatorState":
        """Return the state without the history that samples within a horizon cannot reach.

        Args:
            horizon: Largest delay of a sample [s].
        """
        oldest_time = self.latest.time - horizon
        steps = self.history
        first = 0
        while first + 1 < len(steps) and steps[first + 1].state.time <= oldest_time:
            first += 1
        start = PastStep(sample=None, state=steps[first].state)
        return replace(self, history=(start, *steps[first + 1 :]))


def _symmetrize(matrix: Matrix) -> Matrix:
    return 0.5 * (matrix + matrix.T)
