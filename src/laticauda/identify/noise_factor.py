"""The noise factor: how many times the stated noise the residuals are.

It is sqrt(sum of r^2 / degrees of freedom), r in standard deviations of the stated noise, and the
degrees of freedom are the number of measured numbers minus that of the unknowns fitted to them. How
an unknown with a prior counts depends on what the factor is for (`Method.noise`):

    known       The factor only describes the residuals; nothing is multiplied by it. An unknown
                with a prior counts as not fitted: n_data - (n_unknowns - n_priors).
    estimated   The noise that a fit applies is the factor times the stated noise. An unknown
                counts by the share of it that the data determine, the rest being determined by its
                prior: n_data - trace((F_data + F_priors)^-1 F_data). A prior that says nothing
                then changes nothing, and a direction that nothing determines does not count.

Also with a robust loss, all residuals count by their squares, outliers too. The factor is then that
of the noise with its outliers: in fits of one number to 40, of which four are off by 10 standard
deviations, it is 3.3 on average, and intervals are 2.3 to 2.8 times as wide as with the noise
known. They err on the safe side; who knows the noise of the good numbers should state it.

There is one factor in a fit: with estimated noise, the one reported is the one that search,
covariance, profiles and posterior apply, and Student's t has the same degrees of freedom.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify.identifiability import compute_spectrum
from laticauda.identify.method import Method
from laticauda.identify.problem import Problem

_NO_DEGREES = 1e-9
"""Degrees of freedom below this are rounding errors [-]."""


class NoiseFactor(NamedTuple):
    """Ratio of the residuals to the stated noise."""

    factor: float
    """The ratio; nan without degrees of freedom [-]."""
    degrees: float
    """Degrees of freedom from which it is computed [-]."""

    @property
    def is_usable(self) -> bool:
        """Whether noise can be stated by it: there are degrees of freedom, and residuals."""
        return self.degrees > 0.0 and self.factor > 0.0


def measure_noise_factor(
    problem: Problem,
    method: Method,
    jacobian: Float[np.ndarray, "n_residuals n_unknowns"],
    residuals: Float[np.ndarray, " n_data"],
) -> NoiseFactor:
    """Compute the noise factor at the end of a search.

    Args:
        problem: Measurements and unknowns.
        method: Decides how unknowns with a prior count.
        jacobian: Jacobian of all residuals there, those of the priors last, in the noise that the
            search applied.
        residuals: Residuals of the data there, in units of the stated noise.
    """
    if method.estimates_noise:
        n_fitted = _number_determined_by_data(problem, jacobian)
    else:
        n_fitted = float(len(problem.unknowns) - problem.n_priors)
    degrees = problem.observed.size - n_fitted
    if degrees < _NO_DEGREES:
        return NoiseFactor(factor=math.nan, degrees=0.0)
    chi2 = float(np.sum(residuals**2))
    return NoiseFactor(factor=math.sqrt(chi2 / degrees), degrees=degrees)


def _number_determined_by_data(problem: Problem, jacobian: np.ndarray) -> float:
    """Return how many unknowns the data determine, each counted by the share that is not a prior's.

    Without priors, it is the number of directions that the data see at all.
    """
    scaled = jacobian * problem.sizes
    eigenvalues, vectors = compute_spectrum(scaled.T @ scaled)
    is_seen = eigenvalues > 0.0
    if problem.n_priors == 0:
        return float(np.count_nonzero(is_seen))
    of_data = vectors.T @ problem.information(scaled) @ vectors
    shares = np.diag(of_data)[is_seen] / eigenvalues[is_seen]
    return float(np.sum(shares))
