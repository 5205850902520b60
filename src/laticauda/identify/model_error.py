"""What a model leaves out: how far it was off in measurements that a fit did not see, beyond their noise.

A number that is left out is off by the error of the model, by the noise of its measurement, by the
numbers that the fit held fixed, as far as it cannot make up for them, and by what the other
measurements leave open. With V the variance of the first three together, n numbers that are off by
e_i, and the leverage h_i of each,

    s^2 = mean of (1 - h_i) e_i^2          is an estimate of V,
    nu  = sum of (1 - h_i)                 are its degrees of freedom.

V is at least the variance sigma^2 that noise and numbers held fixed explain. With nothing else known
of its size (a density of 1/V above sigma^2), its mean is

    E[V] = nu s^2 / (nu - 2) * P(nu - 2, c) / P(nu, c),   c = nu s^2 / sigma^2,

where P(nu, c) is the probability that chi^2 with nu degrees of freedom is below c. The model's own
variance is E[V] - sigma^2. It is never 0: few measurements that agree do not prove a model right.

All errors are those of logarithms, and so relative to the value.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.values import optional_import

_FEWEST_DEGREES = 2.0
"""Up to so many degrees of freedom, the mean of the variance is infinite [-]."""
_FEWEST_GROUPS = 2
"""Number of groups from which on leaving one out says something."""

Numbers = Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True)
class ModelError:
    """How far a model was off in what it did not see, relative to the measured value."""

    off: float
    """Root mean square of the errors of what was left out [-]."""
    explained: float
    """Part that noise and numbers held fixed explain, root mean square: it is taken off [-]."""
    degrees: float
    """Degrees of freedom from which it is estimated [-]."""
    size: float | None
    """Standard deviation of what the model leaves out; None: too few measurements to tell [-]."""


def measure_model_error(off: Numbers, leverage: Numbers, explained: Numbers) -> ModelError:
    """Estimate what a model leaves out, from numbers that were left out one at a time.

    Args:
        off: Error of each number when it was left out, predicted minus measured, relative [-].
        leverage: Share of each number in its own fitted value [-].
        explained: Standard deviation of the residual of each number by noise, as far as it is
            known, and by numbers held fixed, relative [-].
    """
    remaining = 1.0 - leverage
    total_variance = float(np.mean(remaining * off**2))
    degrees = float(np.sum(remaining))
    explained_variance = float(np.mean(explained**2))
    variance = _variance_beyond(explained_variance, total_variance, degrees)
    size: float | None = None
    if variance is not None:
        size = math.sqrt(variance)
    return ModelError(
        off=math.sqrt(float(np.mean(off**2))),
        explained=math.sqrt(explained_variance),
        degrees=degrees,
        size=size,
    )


def _variance_beyond(explained: float, total: float, degrees: float) -> float | None:
    """Return the expected variance of the model's own error; None: it cannot be told.

    Args:
        explained: Variance that is explained otherwise.
        total: Estimate of the whole variance.
        degrees: Degrees of freedom of the estimate.
    """
    special = optional_import("Identification", "scipy", "identify", "scipy.special")
    if degrees <= _FEWEST_DEGREES:
        return None
    expected = degrees * total / (degrees - 2.0)
    if explained == 0.0:
        return expected
    largest = degrees * total / explained
    below = float(special.chdtr(degrees, largest))
    if below < math.sqrt(np.finfo(float).tiny):  # far less scatter than explained: the limit
        return 2.0 * explained / (degrees - 2.0)
    expected *= float(special.chdtr(degrees - 2.0, largest)) / below
    return max(expected - explained, 0.0)


def measure_error_of_groups(off: Numbers, explained: Numbers, n_groups: int) -> ModelError | None:
    """Estimate what a model leaves out, from whole groups that were left out one at a time.

    The numbers of a group are off together. With fewer than four groups, the mean of the variance
    is not defined, and the estimate itself stands for it.

    Args:
        off: Error of each number when its group was left out, relative [-].
        explained: Standard deviation of the residual of each number by noise, as far as it is
            known, and by numbers held fixed, relative [-].
        n_groups: Number of groups.
    """
    if n_groups < _FEWEST_GROUPS or not np.all(np.isfinite(off)):
        return None
    total_variance = float(np.mean(off**2))
    explained_variance = float(np.mean(explained**2))
    degrees = n_groups - 1.0
    variance = _variance_beyond(explained_variance, total_variance, degrees)
    if variance is None:
        variance = max(total_variance - explained_variance, 0.0)
    return ModelError(
        off=math.sqrt(total_variance),
        explained=math.sqrt(explained_variance),
        degrees=degrees,
        size=math.sqrt(variance),
    )
