"""The door of filterpy: predict and correct one Gaussian estimate, as functions of values."""

# pyright: reportMissingImports=false, reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from laticauda.errors import MissingExtra

try:
    from filterpy import kalman
except ImportError as error:
    raise MissingExtra("State estimation", "filterpy", "hardware") from error

_kalman: Any = kalman  # its annotations are guesses


@dataclass(frozen=True, kw_only=True, eq=False)
class Gaussian:
    """What is known of a vector: its mean and covariance, in the units of its parts."""

    mean: NDArray[np.float64]
    """Expected value."""
    covariance: NDArray[np.float64]
    """Symmetric, positive semi-definite."""


def predicted(
    mean: NDArray[np.float64],
    covariance: NDArray[np.float64],
    transition: NDArray[np.float64],
    noise: NDArray[np.float64],
) -> Gaussian:
    """A step of time: the covariance becomes F P F' + Q.

    Args:
        mean: After the step; a nonlinear model has computed it.
        covariance: P, before the step.
        transition: F, derivative of the step with respect to what is estimated.
        noise: Q, covariance of what the model does not know.
    """
    # filterpy propagates the mean with F too; the model's own, nonlinear one takes its place.
    _, spread = _kalman.predict(mean, covariance, transition, noise)
    return Gaussian(mean=mean, covariance=_symmetric(spread))


def corrected(
    known: Gaussian,
    residual: NDArray[np.float64],
    sensitivity: NDArray[np.float64],
    noise: NDArray[np.float64],
) -> Gaussian:
    """A measurement taken in, in Joseph's form of the covariance.

    Args:
        known: Before it.
        residual: Measured minus expected; angles wrapped.
        sensitivity: H, derivative of the measurement with respect to what is estimated.
        noise: R, covariance of the measurement.
    """
    mean, spread = _kalman.update(known.mean, known.covariance, residual + sensitivity @ known.mean, noise, sensitivity)
    return Gaussian(mean=mean, covariance=_symmetric(spread))


def squared_distance(
    known: Gaussian,
    residual: NDArray[np.float64],
    sensitivity: NDArray[np.float64],
    noise: NDArray[np.float64],
) -> float:
    """How far off a measurement is, squared, in units of its expected spread (chi-squared, m degrees) [-]."""
    spread = sensitivity @ known.covariance @ sensitivity.T + noise
    return float(residual @ np.linalg.solve(spread, residual))


def _symmetric(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    return 0.5 * (matrix + matrix.T)
