"""What data tell about unknowns, as a matrix, and its inverse: their covariance."""

import numpy as np
from jaxtyping import Float

_SMALLEST_STRENGTH = 1e-13
"""Eigenvalues of the information below this share of the largest are rounding errors [-]."""


def invert_information(
    information: Float[np.ndarray, "n_unknowns n_unknowns"],
) -> Float[np.ndarray, "n_unknowns n_unknowns"]:
    """Return the covariance of unknowns; what is not seen at all has none here.

    Args:
        information: The sum of J^T J over all residuals, with unknowns in units in which they are
            of the same order, so that rounding errors are told from what is seen.
    """
    return np.linalg.pinv(information, rcond=_SMALLEST_STRENGTH, hermitian=True)
