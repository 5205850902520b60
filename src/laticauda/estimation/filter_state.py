"""What the filter knows: how much sensors and model are off, a Gaussian estimate, and the past it may go back to."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda.estimation import digital_twin, samples
from laticauda.files import read_toml
from laticauda.quantities import quantity, value

# The filter runs hundreds of times a second: shapes are in the docstrings, and are not checked at run time.
Vector: TypeAlias = NDArray[np.float64]
Matrix: TypeAlias = NDArray[np.float64]


@value
class Noise:
    """How much the sensors and the model are off: standard deviations, and how fast what is not known wanders."""

    position: float = quantity("m", "of the marker body, per axis", gt=0.0, default=0.001)
    yaw: float = quantity("rad", "of the marker body", gt=0.0, default=math.radians(0.1))
    joint: float = quantity("rad", "of a joint's sensor, with rests of its backlash", gt=0.0, default=math.radians(0.3))
    joint_acceleration: float = quantity("rad/s^2/sqrt(Hz)", "straying of rate from reference", gt=0.0, default=0.5)
    position_walk: float = quantity("m/sqrt(s)", "how fast the center of mass strays", ge=0.0, default=0.001)
    surge: float = quantity("m/s/sqrt(s)", "how fast the speed through the water changes", ge=0.0, default=0.0067)
    sway: float = quantity("m/s", "of the sideways speed, which fades within `sway_time`", ge=0.0, default=0.01)
    sway_time: float = quantity("s", "in which the sideways speed fades", gt=0.0, default=6.0)
    current: float = quantity("m/s", "of the water's velocity, per axis, before any frame", gt=0.0, default=0.1)
    current_walk: float = quantity("m/s/sqrt(s)", "how fast the water's velocity changes", ge=0.0, default=0.001)
    turning: float = quantity("rad/s/sqrt(s)", "how fast the smooth heading's rate changes", ge=0.0, default=0.03)
    turn_gain: float = quantity("1/s/sqrt(s)", "how fast turning per mean joint angle changes", ge=0.0, default=0.06)
    slip_gain: float = quantity("m/s/sqrt(s)", "the same for the sideways speed", ge=0.0, default=0.015)
    heading_gain: float = quantity("1/sqrt(s)", "how fast a mode's share in the heading changes", ge=0.0, default=0.15)
    across_gain: float = quantity("m/sqrt(s)", "the same for its share in the place across", ge=0.0, default=0.005)
    heading_ripple: float = quantity("rad/sqrt(s)", "of the heading's ripple; harmonic k: 1/k", ge=0.0, default=0.0033)
    position_ripple: float = quantity("m/sqrt(s)", "the same for the center of mass", ge=0.0, default=0.006)

    @property
    def beside_twin(self) -> "Noise":
        """The same sensors, and of the motion what a twin does not foresee."""
        return replace(self, **{name: min(getattr(self, name), limit) for name, limit in BESIDE_TWIN.items()})


BESIDE_TWIN: dict[str, float] = read_toml(Path(__file__).with_name("beside_twin.toml"))
"""How fast changes what a twin leaves to explain of the motion."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Gaussian:
    """What is known of a vector: its mean and covariance, in the units of its parts."""

    mean: Vector
    """Expected value."""
    covariance: Matrix
    """Symmetric, positive semi-definite."""

    def predict(self, mean: Vector, transition: Matrix, noise: Matrix) -> "Gaussian":
        """A step of time: the covariance becomes F P F' + Q.

        Args:
            mean: After the step; a nonlinear model has computed it.
            transition: F, derivative of the step with respect to what is estimated.
            noise: Q, covariance of what the model does not know.
        """
        return Gaussian(mean=mean, covariance=_symmetric(transition @ self.covariance @ transition.T + noise))

    def update(self, residual: Vector, sensitivity: Matrix, noise: Matrix) -> "Gaussian":
        """A measurement taken in, in Joseph's form of the covariance.

        Args:
            residual: Measured minus expected; angles wrapped.
            sensitivity: H, derivative of the measurement with respect to what is estimated.
            noise: R, covariance of the measurement.
        """
        # H x is added and taken off again, as in recordings that are replayed to the bit.
        linear = sensitivity @ self.mean
        spread = sensitivity @ self.covariance @ sensitivity.T + noise
        gain = self.covariance @ sensitivity.T @ np.linalg.inv(spread)
        rest = np.eye(self.mean.size) - gain @ sensitivity
        covariance = rest @ self.covariance @ rest.T + gain @ noise @ gain.T
        mean = self.mean + gain @ ((residual + linear) - linear)
        return Gaussian(mean=mean, covariance=_symmetric(covariance))

    def restarted(self, at: np.ndarray, mean: Vector | float, variance: Vector | float) -> "Gaussian":
        """The same, with some entries as if they were known by themselves alone.

        Args:
            at: Which entries.
            mean: Of them.
            variance: Of them.
        """
        means, covariance = self.mean.copy(), self.covariance.copy()
        means[at] = mean
        covariance[at, :] = covariance[:, at] = 0.0
        covariance[at, at] = variance
        return Gaussian(mean=means, covariance=covariance)

    def squared_distance(self, residual: Vector, sensitivity: Matrix, noise: Matrix) -> float:
        """How far off a measurement is, squared, in units of its expected spread (chi-squared, m degrees) [-].

        Args:
            residual: Measured minus expected; angles wrapped.
            sensitivity: H, derivative of the measurement with respect to what is estimated.
            noise: R, covariance of the measurement.
        """
        spread = sensitivity @ self.covariance @ sensitivity.T + noise
        return float(residual @ np.linalg.solve(spread, residual))


@dataclass(frozen=True, kw_only=True, eq=False)
class FilterState:
    """The filter right after one sample."""

    time: float
    """[s]."""
    reference: Vector
    """phi_ref in force [rad]."""
    fin_reference: tuple[float, ...] = ()
    """The same of a driven fin, which the twin needs; empty without [rad]."""
    lagged: Vector
    """phi_ref after the filter that stands for the joints' lag [rad]."""
    lagged_rate: Vector
    """Its rate [rad/s]."""
    n_joint_rejected: np.ndarray
    """Samples in a row that were rejected, per joint [-]."""
    posterior: Gaussian | None = None
    """What is estimated; None before the first frame."""
    frequency: float = 0.0
    """Of the gait [rad/s]."""
    joint_angle: Vector | None = None
    """The last joint angles, before the first frame [rad]."""
    frame_time: float = -math.inf
    """When the last frame that was accepted was taken; -inf before [s]."""
    n_rejected: int = 0
    """Frames in a row that were rejected [-]."""
    twin: digital_twin.TwinState | None = None
    """The digital twin; None without one."""
    twin_failed: bool = False
    """Whether the twin had to be given up [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EstimatorState:
    """The estimator's state: the filter now, and the last few samples with the filter after each."""

    history: tuple[tuple[samples.Sample | None, FilterState], ...]
    """Oldest first; the first one has no sample."""
    n_outliers: int = 0
    """Frames that were not accepted so far [-]."""
    n_late: int = 0
    """Samples that came too late and were left out so far [-]."""

    @property
    def latest(self) -> FilterState:
        """After the last sample."""
        return self.history[-1][1]

    def within(self, horizon: float) -> "EstimatorState":
        """The same without what no sample may go back to that comes late by at most `horizon` [s].

        Args:
            horizon: How late a sample may come [s].
        """
        past, keep = self.history, 0
        while keep + 1 < len(past) and past[keep + 1][1].time <= self.latest.time - horizon:
            keep += 1
        return replace(self, history=((None, past[keep][1]), *past[keep + 1 :]))


def _symmetric(matrix: Matrix) -> Matrix:
    return 0.5 * (matrix + matrix.T)
