"""The door of filterpy: predict and correct one Gaussian estimate, as functions of values."""

# pyright: reportMissingImports=false, reportUnknownMemberType=false, reportUnknownVariableType=false

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.errors import MissingExtra

try:
    from filterpy import kalman as _kalman
except ImportError as error:
    raise MissingExtra("State estimation", "filterpy", "hardware") from error


@dataclass(frozen=True, kw_only=True, eq=False)
class Gaussian:
    """What is known of a vector: its mean and covariance, in the units of its parts."""

    mean: Float[np.ndarray, " n"]
    """Expected value."""
    covariance: Float[np.ndarray, "n n"]
    """Symmetric, positive semi-definite."""


def predicted(
    mean: Float[np.ndarray, " n"],
    covariance: Float[np.ndarray, "n n"],
    transition: Float[np.ndarray, "n n"],
    noise: Float[np.ndarray, "n n"],
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
    residual: Float[np.ndarray, " m"],
    sensitivity: Float[np.ndarray, "m n"],
    noise: Float[np.ndarray, "m m"],
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
    residual: Float[np.ndarray, " m"],
    sensitivity: Float[np.ndarray, "m n"],
    noise: Float[np.ndarray, "m m"],
) -> float:
    """How far off a measurement is, squared, in units of its expected spread (chi-squared, m degrees) [-]."""
    spread = sensitivity @ known.covariance @ sensitivity.T + noise
    return float(residual @ np.linalg.solve(spread, residual))


def _symmetric(matrix: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    return 0.5 * (matrix + matrix.T)
