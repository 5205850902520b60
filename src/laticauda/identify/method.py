"""Settings of a fit, and the losses among which it can choose.

The losses are those that SciPy's search knows by name. Another one is an entry of `LOSSES`.

A loss is applied to the residuals of the data alone: it is the noise of measured numbers that has
outliers. A prior is the normal distribution that the user states, and its residual counts by its
square, however strongly the data contradict it. If the noise is estimated, a residual of the data
counts as an outlier by the estimated noise, which outliers make larger (`noise_factor`).

A robust loss is taken as what it is: another probability of the noise, exp(-rho(r^2)/2), with long
tails. The covariance of a fit is therefore the inverse of the curvature of half the cost, which is
where its profiles and its posterior have their width too. In linear fits of 10 and 40 numbers with
a share of 0 or 0.1 of outliers, such intervals of 95 % contained the truth in 92 to 100 % of the
cases; those of the sandwich estimate, which trusts the scatter of these few residuals instead,
in 60 to 94 %.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from laticauda.identify.identifiability import LIMIT
from laticauda.values import check_one_among, option, optional_import, quantity, value_class

Loss = Callable[[np.ndarray], np.ndarray]
"""Function of squared residuals: rho, of which a search minimizes the sum, and its first two derivatives."""


def _linear(squares: np.ndarray) -> np.ndarray:
    return np.array([squares, np.ones_like(squares), np.zeros_like(squares)])


def _soft_l1(squares: np.ndarray) -> np.ndarray:
    root = np.sqrt(1.0 + squares)
    return np.array([2.0 * (root - 1.0), 1.0 / root, -0.5 / root**3])


def _huber(squares: np.ndarray) -> np.ndarray:
    root = np.sqrt(np.maximum(squares, 1.0))  # 1 where the loss is linear in the square
    is_outlier = squares > 1.0
    return np.array(
        [
            np.where(is_outlier, 2.0 * root - 1.0, squares),
            1.0 / root,
            np.where(is_outlier, -0.5 / root**3, 0.0),
        ]
    )


def _cauchy(squares: np.ndarray) -> np.ndarray:
    slope = 1.0 / (1.0 + squares)
    return np.array([np.log1p(squares), slope, -(slope**2)])


def _arctan(squares: np.ndarray) -> np.ndarray:
    slope = 1.0 / (1.0 + squares**2)
    return np.array([np.arctan(squares), slope, -2.0 * squares * slope**2])


LOSSES: dict[str, Loss] = {
    "linear": _linear,
    "soft_l1": _soft_l1,
    "huber": _huber,
    "cauchy": _cauchy,
    "arctan": _arctan,
}
"""Losses by name, as `scipy.optimize.least_squares` defines them."""
NOISE = ("known", "estimated")
"""Whether the stated noise is trusted, or a common factor on it is estimated from the residuals."""


@value_class
class Method:
    """Settings of a fit."""

    noise: str = option(
        "known, or estimated: the same times a common factor",
        default="known",
        check=check_one_among(*NOISE),
    )
    loss: str = option(
        "Loss of the residuals; all but linear weigh outliers less",
        default="linear",
        check=check_one_among(*LOSSES),
    )
    n_starts: int = quantity("", "Largest number of starts", default=8, ge=1)
    seed: int = quantity("", "Seed of the random starts", default=0, ge=0)
    confidence: float = quantity("", "Confidence of the intervals", default=0.95, ge=0.5, le=0.9999)
    limit: float = quantity(
        "", "Relative deviation above which an unknown is not identified", default=LIMIT, gt=0.0
    )

    @property
    def estimates_noise(self) -> bool:
        """Whether a common factor on the stated noise is estimated."""
        return self.noise == "estimated"

    def quantile(self, degrees: float) -> float:
        """Return the half-width of an interval in standard deviations.

        It is that of Student's t, or of the normal distribution if the noise is known.

        Args:
            degrees: Degrees of freedom.

        Raises:
            MissingExtra: If scipy is not installed.
        """
        special = optional_import("Identification", "scipy", "identify", "scipy.special")
        probability = 0.5 * (1.0 + self.confidence)
        if not self.estimates_noise or np.isinf(degrees):
            return float(special.ndtri(probability))
        return float(special.stdtrit(degrees, probability))


def cost_of(residuals: np.ndarray, loss: str, *, n_priors: int) -> float:
    """Compute what a search minimizes: the sum of rho(r^2) of the data, and of r^2 of the priors.

    Args:
        residuals: Residuals r, in standard deviations; those of the priors come last.
        loss: Name of the loss, whose function is rho.
        n_priors: Number of residuals of priors.
    """
    squares = residuals**2
    values, _, _ = _loss_of_data(squares, loss=loss, n_priors=n_priors)
    return float(np.sum(values))


def loss_for_search(loss: str, n_priors: int) -> str | Loss:
    """Return the loss in the form that SciPy's search takes: by name, unless there are priors.

    Args:
        loss: Name of the loss of the data.
        n_priors: Number of residuals of priors, which come last.
    """
    if loss == "linear" or n_priors == 0:
        return loss
    return partial(_loss_of_data, loss=loss, n_priors=n_priors)


def _loss_of_data(squares: np.ndarray, *, loss: str, n_priors: int) -> np.ndarray:
    """Return a loss of the data, and squares of the priors, with the first two derivatives."""
    n_data = squares.size - n_priors
    of_data = LOSSES[loss](squares[:n_data])
    of_priors = _linear(squares[n_data:])
    return np.concatenate([of_data, of_priors], axis=1)
