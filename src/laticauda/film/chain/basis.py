"""Motion as numbers: splines of equal knots in time, and the harmonics of a gait.

A coordinate of the chain is q(t) = sum_k x_k b_k(t) + sum_h z_h g_h(t), with b_k splines of degree 5
and g_h cosine and sine of the harmonics of one frequency. The splines take what does not repeat.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.film.chain.scipy_parts import load_scipy

DEGREE = 5
"""Degree of the splines: their fourth derivative is continuous, the acceleration smooth."""
ROUGH_DERIVATIVE = 3
"""Derivative whose square the prior holds small."""
GAUSS_POINTS = 3
"""Points per interval that integrate the square of a third derivative, of degree 4, exactly."""


@dataclass(frozen=True, kw_only=True)
class SplineBasis:
    """Splines of degree 5 on equal intervals that cover a span of time."""

    begin: float
    """Begin of the span [s]."""
    step: float
    """Length of an interval [s]."""
    n_intervals: int
    """Number of intervals."""

    @property
    def size(self) -> int:
        """Number of splines."""
        return self.n_intervals + DEGREE

    @cached_property
    def knots(self) -> Float[np.ndarray, " n_knots"]:
        """Equal knots, `DEGREE` of them beyond each end [s]."""
        return self.begin + self.step * np.arange(-DEGREE, self.n_intervals + DEGREE + 1)

    def matrix(self, time: Float[np.ndarray, " n_times"], derivative: int = 0) -> Any:
        """Return the splines at given times as a sparse matrix of one row per time.

        Args:
            time: Times within the span [s].
            derivative: Order of the derivative in time.
        """
        knots = self.knots[derivative : len(self.knots) - derivative]
        end = self.begin + self.step * self.n_intervals
        inside = np.clip(time, self.begin, end)
        sparse = load_scipy("sparse")
        design_matrix = load_scipy("interpolate").BSpline.design_matrix
        matrix = design_matrix(inside, knots, DEGREE - derivative)
        # The derivative of a spline on equal knots has the differences of its coefficients.
        for order in range(derivative, 0, -1):
            n_columns = self.size - order + 1
            step_up = np.ones(n_columns - 1)
            differences = sparse.diags_array(
                [-step_up, step_up], offsets=[0, 1], shape=(n_columns - 1, n_columns)
            )
            matrix = matrix @ differences / self.step
        return sparse.csr_array(matrix)

    @cached_property
    def roughness(self) -> Any:
        """The matrix R of x^T R x, the integral of the squared third derivative, sparse."""
        sparse = load_scipy("sparse")
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        half_step = 0.5 * self.step
        middles = self.begin + self.step * (np.arange(self.n_intervals) + 0.5)
        time = middles[:, np.newaxis] + half_step * nodes
        third_derivative = self.matrix(time.ravel(), ROUGH_DERIVATIVE)
        durations = sparse.diags_array(np.tile(half_step * weights, self.n_intervals))
        return sparse.csr_array(third_derivative.T @ durations @ third_derivative)

    @cached_property
    def roughness_sizes(self) -> Float[np.ndarray, " n_splines"]:
        """Eigenvalues of the roughness; those of parabolas are 0."""
        sizes = np.linalg.eigvalsh(self.roughness.toarray())
        sizes[:ROUGH_DERIVATIVE] = 0.0
        return sizes

    @property
    def n_penalized(self) -> int:
        """Rank of the roughness: parabolas have none."""
        return self.size - ROUGH_DERIVATIVE


@dataclass(frozen=True, kw_only=True)
class Harmonics:
    """Cosine and sine of the first harmonics of a frequency, which may differ from draw to draw."""

    n_orders: int
    """Number of harmonics; 0: the motion is splines alone."""
    middle: float
    """Time at which all phases are 0: in the middle of the film, where frequency and phase part [s]."""
    frequency: float
    """First guess of the angular frequency [rad/s]."""
    frequency_deviation: float
    """Standard deviation of that guess [rad/s]."""

    @property
    def size(self) -> int:
        """Number of functions: two for each order."""
        return 2 * self.n_orders

    @property
    def orders(self) -> Float[np.ndarray, " n_functions"]:
        """Order of every function."""
        return np.repeat(np.arange(1.0, self.n_orders + 1.0), 2)

    def values(
        self, time: Float[np.ndarray, " n_times"], frequency: float, derivative: int = 0
    ) -> Float[np.ndarray, "n_times n_functions"]:
        """Return the functions, or their derivatives in time.

        Args:
            time: Times [s].
            frequency: Angular frequency of the first harmonic [rad/s].
            derivative: Order of the derivative.
        """
        rates = self.orders * frequency
        # A sine is a cosine a quarter later, and each derivative leads by a quarter.
        quarter = 0.5 * np.pi
        lag = np.tile([0.0, quarter], self.n_orders) - quarter * derivative
        phase = rates * (time[:, np.newaxis] - self.middle)
        return rates**derivative * np.cos(phase - lag)

    def slopes(
        self, time: Float[np.ndarray, " n_times"], frequency: float
    ) -> Float[np.ndarray, "n_times n_functions"]:
        """Return the derivatives of the functions by the frequency.

        Args:
            time: Times [s].
            frequency: Angular frequency of the first harmonic [rad/s].
        """
        since_middle = time[:, np.newaxis] - self.middle
        return self.values(time, frequency, 1) * since_middle / frequency
