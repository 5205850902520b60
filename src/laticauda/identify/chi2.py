"""How large chi^2, the sum of the squared residuals, is if model and stated noise are right."""

from collections.abc import Mapping
from typing import NamedTuple

from laticauda.values import optional_import

UNUSUAL = 0.3
"""Probability that chi^2 is above its usual values [-]."""
RARE = 5e-4
"""Probability that chi^2 is below its range, and that it is above [-]."""


class Chi2Range(NamedTuple):
    """Range of chi^2 that the stated noise leaves only rarely."""

    low: float
    high: float


def independent_share(lags: Mapping[str, float]) -> float:
    """Return of how many independent numbers, as a share of all, chi^2 scatters like the sum.

    Args:
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
    """
    square = max(lags.values(), default=0.0) ** 2
    return (1.0 - square) / (1.0 + square)


def usual_chi2(degrees: float, lags: Mapping[str, float]) -> Chi2Range:
    """Return the range of chi^2 that the stated noise leaves only rarely.

    If neighboring samples share their noise, chi^2 scatters as for a fraction of the numbers.

    Args:
        degrees: Degrees of freedom [-].
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
    """
    return Chi2Range(
        low=chi2_at(RARE, degrees, lags),
        high=chi2_at(1.0 - RARE, degrees, lags),
    )


def chi2_at(probability: float, degrees: float, lags: Mapping[str, float]) -> float:
    """Return the chi^2 below which the stated noise leaves it with a probability.

    Args:
        probability: The probability, from 0 to 1 [-].
        degrees: Degrees of freedom [-].
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
    """
    special = optional_import("Identification", "scipy", "identify", "scipy.special")
    share = independent_share(lags)
    half_degrees = 0.5 * share * max(degrees, 1.0)
    # Chi^2 of n numbers is twice a gamma-distributed number of shape n/2.
    return 2.0 * float(special.gammaincinv(half_degrees, probability)) / share
