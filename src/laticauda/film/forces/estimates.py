"""Figures of many draws with median, interval, and the shares of where the interval comes from."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.film.forces.assumptions import AssumptionDraws
from laticauda.values import add_up

CONFIDENCE = 0.95
"""Probability of an interval."""
SOURCES = ("film", "water", "body")
"""Where an interval comes from."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A figure with its interval."""

    title: str
    """What it is, a few words."""
    unit: str
    """Its unit; empty for a pure number."""
    median: float
    """Median of the draws."""
    low: float
    """Lower end of the 95 % interval."""
    high: float
    """Upper end."""
    shares: Mapping[str, float]
    """Shares of its variance from `film`, `water` and `body`."""

    def holds(self, value: float) -> bool:
        """Return whether a value lies in the interval.

        Args:
            value: The value.
        """
        return bool(self.low <= value <= self.high)


def estimate(
    title: str, unit: str, values: Float[np.ndarray, " n_draws"], assumed: AssumptionDraws
) -> Estimate:
    """Return a figure with its interval and shares.

    The shares are those of a linear regression on the numbers of water and body that were drawn, less
    what as many numbers without any effect would explain; the rest is the film's.

    Args:
        title: What it is.
        unit: Its unit.
        values: Its value in every draw; draws without one, nan, are left out.
        assumed: What was drawn of water and body.
    """
    is_finite = np.isfinite(values)
    if np.count_nonzero(is_finite) < 2:
        unknown = {source: np.nan for source in SOURCES}
        return Estimate(
            title=title, unit=unit, median=np.nan, low=np.nan, high=np.nan, shares=unknown
        )
    # The usual quantile of few draws lies inside the interval; this one is right on average.
    probabilities = [0.5 - 0.5 * CONFIDENCE, 0.5, 0.5 + 0.5 * CONFIDENCE]
    low, median, high = np.quantile(values[is_finite], probabilities, method="weibull")
    shares = _share_variance(
        values[is_finite],
        water=assumed.water_numbers[is_finite],
        body=assumed.body_numbers[is_finite],
    )
    return Estimate(
        title=title,
        unit=unit,
        median=float(median),
        low=float(low),
        high=float(high),
        shares=shares,
    )


def _share_variance(
    values: Float[np.ndarray, " n"],
    water: Float[np.ndarray, "n n_water"],
    body: Float[np.ndarray, "n n_body"],
) -> dict[str, float]:
    """Return the shares of the variance that are linear in the numbers of water and body; the rest is the film's."""
    centered = values - np.mean(values)
    if _sum_of_squares(centered) == 0.0:
        return {"film": 1.0, "water": 0.0, "body": 0.0}
    numbers: np.ndarray = np.column_stack((water, body))
    numbers = numbers - np.mean(numbers, axis=0)
    inverse: np.ndarray = np.linalg.pinv(numbers)
    slopes: np.ndarray = inverse @ centered
    n_water = water.shape[1]
    n_body = body.shape[1]
    of_water: np.ndarray = numbers[:, :n_water] @ slopes[:n_water]
    of_body: np.ndarray = numbers[:, n_water:] @ slopes[n_water:]
    remainder: np.ndarray = centered - of_water - of_body
    n_free = len(values) - 1
    n_left = max(n_free - n_water - n_body, 1)
    # A number without any effect explains this much on average.
    by_chance = _sum_of_squares(remainder) / n_left
    sizes = {
        "water": max(_sum_of_squares(of_water) - n_water * by_chance, 0.0),
        "body": max(_sum_of_squares(of_body) - n_body * by_chance, 0.0),
        "film": by_chance * n_free,
    }
    total = add_up(sizes.values())
    return {source: sizes[source] / total for source in SOURCES}


def _sum_of_squares(values: Float[np.ndarray, " n"]) -> float:
    return float(np.sum(values**2))
