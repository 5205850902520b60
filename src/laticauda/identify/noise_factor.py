"""The ratio of the residuals to the stated noise, as reported and as applied.

Both are sqrt(sum of r^2 / degrees of freedom), r in standard deviations of the stated noise. They
count the degrees of freedom differently if some unknowns have priors:

    reported   an unknown with a prior counts as not fitted: n_data - (n_unknowns - n_priors)
    applied    an unknown counts by the share of it that the data determine, the rest being
               determined by its prior: n_data - trace((F_data + F_priors)^-1 F_data)

The reported one needs no fit, and is the same however the fit was done. The applied one widens
priors and data alike during a fit with estimated noise. Without priors, both are the same.
"""

import math

import numpy as np

from laticauda.identify.local_search import LocalSearch
from laticauda.identify.problem import Problem


def reported_degrees_of_freedom(problem: Problem) -> float:
    """Return the number of measured numbers minus the number of unknowns without a prior [-]."""
    return float(problem.observed.size - max(len(problem.unknowns) - problem.n_priors, 0))


def reported_noise_factor(chi2: float, degrees: float) -> float:
    """Return the factor that a fit reports; nan without degrees of freedom [-].

    Args:
        chi2: Sum of squared residuals of the data, in units of the stated noise [-].
        degrees: Degrees of freedom, as reported [-].
    """
    if degrees <= 0.0:
        return math.nan
    return math.sqrt(chi2 / degrees)


def applied_noise_factor(problem: Problem, search: LocalSearch, residuals: np.ndarray) -> float:
    """Return the factor to apply to the stated noise in the next search [-].

    Args:
        problem: Measurements and unknowns.
        search: Search that ended where the residuals were computed.
        residuals: Residuals of the data there, in units of the stated noise.
    """
    of_data = problem.information(search.jacobian)
    of_data_and_priors = search.jacobian.T @ search.jacobian
    n_fitted = float(np.trace(np.linalg.pinv(of_data_and_priors) @ of_data))
    return math.sqrt(float(np.sum(residuals**2)) / (problem.observed.size - n_fitted))
