"""What the filter knows: a Gaussian estimate, and the past that a late sample may take it back to."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda.estimation.digital_twin import TwinState
from laticauda.estimation.samples import Sample

# The filter runs hundreds of times a second: shapes are in the docstrings, and are not checked at run time.
Vector: TypeAlias = NDArray[np.float64]
Matrix: TypeAlias = NDArray[np.float64]


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
        linear = (
            sensitivity @ self.mean
        )  # H x; added and taken off again, as in recordings that are replayed to the bit
        spread = sensitivity @ self.covariance @ sensitivity.T + noise
        gain = self.covariance @ sensitivity.T @ np.linalg.inv(spread)
        rest = np.eye(self.mean.size) - gain @ sensitivity
        covariance = rest @ self.covariance @ rest.T + gain @ noise @ gain.T
        mean = self.mean + gain @ ((residual + linear) - linear)
        return Gaussian(mean=mean, covariance=_symmetric(covariance))

    def squared_distance(self, residual: Vector, sensitivity: Matrix, noise: Matrix) -> float:
        """How far off a measurement is, squared, in units of its expected spread (chi-squared, m degrees) [-].

        Args:
            residual: As in `update`, and so are the others.
            sensitivity: H.
            noise: R.
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
    twin: TwinState | None = None
    """The digital twin; None without one."""
    twin_failed: bool = False
    """Whether the twin had to be given up [-]."""


History: TypeAlias = tuple[tuple[Sample | None, FilterState], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class EstimatorState:
    """The estimator's state: the filter now, and the last few samples with the filter after each."""

    history: History
    """Oldest first; the first one has no sample."""
    n_outliers: int = 0
    """Frames that were not accepted so far [-]."""
    n_late: int = 0
    """Samples that came too late and were left out so far [-]."""

    @property
    def latest(self) -> FilterState:
        """After the last sample."""
        return self.history[-1][1]


def initial_state(n_joints: int, time: float) -> FilterState:
    """The filter before the first sample.

    Args:
        n_joints: Of the planar robot [-].
        time: From when on [s].
    """
    still = np.zeros(n_joints)
    rejected = np.zeros(n_joints, dtype=np.int64)
    return FilterState(time=time, reference=still, lagged=still, lagged_rate=still, n_joint_rejected=rejected)


def within_horizon(history: Sequence[tuple[Sample | None, FilterState]], horizon: float) -> History:
    """The end of a history that a late sample may still go back to.

    Args:
        history: Oldest first.
        horizon: How late a sample may come [s].
    """
    oldest = history[-1][1].time - horizon
    keep = 0
    while keep + 1 < len(history) and history[keep + 1][1].time <= oldest:
        keep += 1
    return ((None, history[keep][1]), *history[keep + 1 :])


def _symmetric(matrix: Matrix) -> Matrix:
    return 0.5 * (matrix + matrix.T)
