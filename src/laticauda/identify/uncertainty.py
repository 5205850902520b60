"""Uncertainty beyond the covariance: intervals from profile likelihoods, and a sample of the posterior."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.identify.fitting import all_residuals, cost_of, minimize
from laticauda.identify.result import Fit
from laticauda.models.simulate.runner import Progress, silent
from laticauda.values.checks import check_choice, check_whole_number
from laticauda.values.optional import optional_import

_CLOSE = 1e-3  # relative accuracy of the distance to an end
_FAR = 1e3  # sizes, beyond which no end is searched for, and standard deviations
_FIRST = 0.5  # first step along a direction without curvature, in sizes


Ends = tuple[float | None, float | None]
"""Ends of an interval; None: every value up to the end of its range describes the data as well."""


def profile_interval(found: Fit, name: str) -> Ends:
    """Return the interval of one unknown in which the sum of squares is less than q^2 above its minimum.

    q is the quantile used for the fit's own intervals. Where the model is far from linear within
    the uncertainty, the coverage of this interval is more accurate than that of the interval from
    the covariance. It costs about ten searches, because all other unknowns are refitted at its
    ends.

    Args:
        found: The fit.
        name: Name of the unknown.

    Raises:
        ValueError: If there is no such unknown.
    """
    names = found.problem.names
    k = names.index(check_choice("name", name, names))
    return _end(found, k, -1.0), _end(found, k, 1.0)


def _end(found: Fit, k: int, sign: float) -> float | None:
    """Find one end of the interval: where the square root of the rise in the sum of squares equals the quantile."""
    optimize = optional_import("Identification", "scipy", "identify", "scipy.optimize")
    x, unknown, factor = found.x, found.problem.unknowns[k], found.used_noise_factor
    quantile = found.method.quantile(found.degrees_of_freedom) * float(found.widening[k])
    free, at = np.array([j for j in range(x.size) if j != k], dtype=int), x
    least = _cost(found, x)

    def missing(step: float) -> float:
        nonlocal at
        at = np.where(np.arange(x.size) == k, x + sign * step, at)
        if free.size:
            at = minimize(found.problem, at, loss=found.method.loss, factor=factor, free=free).end
        cost = _cost(found, at)
        return (
            min(math.sqrt(max(cost - least, 0.0)), _FAR) if math.isfinite(cost) else _FAR
        ) - quantile

    deviation, most = math.sqrt(found.covariance[k, k]), abs(unknown.ends[sign > 0.0] - x[k])
    step = (
        quantile * deviation
        if math.isfinite(deviation) and deviation > 0.0
        else _FIRST * unknown.size
    )
    limit = min(most, _FAR * unknown.size)
    while missing(step := min(step, limit)) < 0.0:
        if step >= limit:
            return None
        step *= 2.0
    return unknown.value(
        x[k] + sign * optimize.brentq(missing, 0.0, step, rtol=_CLOSE, xtol=_CLOSE * step)
    )


def _cost(found: Fit, x: np.ndarray) -> float:
    """Compute the sum of squares of data and priors."""
    residuals = all_residuals(found.problem, found.problem.values_of(x), found.used_noise_factor)
    n_data = found.problem.observed.size
    return cost_of(residuals[:n_data], found.method.loss) + cost_of(
        residuals[n_data:], found.method.loss
    )


def log_density(found: Fit, x: Float[np.ndarray, " n_unknowns"]) -> float:
    """Return the log posterior density up to a constant; -inf where a measurement cannot be simulated.

    Args:
        found: The fit.
        x: Coordinates of the unknowns.
    """
    cost = _cost(found, x)
    return -0.5 * cost if math.isfinite(cost) else -math.inf


@dataclass(frozen=True, kw_only=True, eq=False)
class Posterior:
    """Samples of the posterior of the unknowns, given data, priors and ranges."""

    names: tuple[str, ...]
    """Names of the unknowns."""
    values: Float[np.ndarray, "n_samples n_unknowns"]
    """Values of the unknowns, one row per sample, in their units."""
    acceptance: float
    """Fraction of proposals that were accepted; between 0.2 and 0.5 is good [-]."""

    def interval(self, name: str, confidence: float = 0.95) -> tuple[float, float]:
        """Return the interval that holds the central fraction `confidence` of an unknown's samples.

        Args:
            name: Name of the unknown.
            confidence: Fraction of the samples [-].
        """
        column = self.values[:, self.names.index(check_choice("name", name, self.names))]
        low, high = np.quantile(column, [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
        return float(low), float(high)


def sample_posterior(
    found: Fit,
    *,
    n_steps: int = 500,
    n_walkers: int | None = None,
    seed: int = 0,
    progress: Progress = silent,
) -> Posterior:
    """Sample the posterior with an ensemble of walkers (emcee), started around the fit.

    An unknown without a prior is assumed uniformly distributed over its range, in its logarithm on
    a log scale. The first half of the steps is discarded. Each step of each walker simulates all
    measurements once.

    Args:
        found: The fit.
        n_steps: Number of steps of each walker.
        n_walkers: Number of walkers; None: four per unknown, at least 8.
        seed: Seed of all random numbers.
        progress: Called periodically with the finished fraction.

    Raises:
        ValueError: If an argument is out of its range.
        MissingExtra: If emcee is not installed.

    References:
        D. Foreman-Mackey et al., emcee: The MCMC Hammer, PASP 125 (2013) 306-312.
    """
    check_whole_number("n_steps", n_steps, 2)
    problem, n = found.problem, len(found.estimates)
    walkers = (
        max(4 * n, 8)
        if n_walkers is None
        else check_whole_number("n_walkers", n_walkers, 2 * n + 2)
    )
    lower, upper = np.array([unknown.ends for unknown in problem.unknowns]).T

    def log_probability(points: np.ndarray) -> np.ndarray:
        inside = np.all((points > lower) & (points < upper), axis=1)
        return np.array(
            [
                log_density(found, x) if fits else -math.inf
                for x, fits in zip(points, inside, strict=True)
            ]
        )

    rng = np.random.default_rng(seed)
    sizes = problem.sizes
    spread = np.minimum(np.sqrt(np.diag(found.covariance)), 0.3 * sizes)
    begin = found.x + 0.5 * np.where(spread > 0.0, spread, 1e-3 * sizes) * rng.standard_normal(
        (walkers, n)
    )
    margin = 1e-9 * sizes
    begin = np.clip(begin, lower + margin, upper - margin)
    emcee = optional_import("Identification", "emcee", "identify")
    sampler = emcee.EnsembleSampler(walkers, n, log_probability, vectorize=True)
    sampler.random_state = np.random.RandomState(seed).get_state()
    for step, _ in enumerate(
        sampler.sample(begin, iterations=n_steps, skip_initial_state_check=True)
    ):
        progress((step + 1) / n_steps)
    chain: np.ndarray = np.asarray(sampler.get_chain())
    kept = chain[n_steps // 2 :].reshape(-1, n)
    return Posterior(
        names=problem.names,
        values=np.array([problem.values_of(x) for x in kept]),
        acceptance=float(sampler.acceptance_fraction.mean()),
    )
