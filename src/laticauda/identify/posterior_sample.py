"""A sample of the posterior of the unknowns, drawn by an ensemble of walkers."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.identify.profiles import sum_of_squares
from laticauda.identify.result import Fit
from laticauda.models.simulate import Progress, silent
from laticauda.values import check_choice, check_whole_number, optional_import

_WIDEST_START = 0.3
"""Largest spread of the starts, along unknowns that are not identified, in large changes [-]."""
_NARROWEST_START = 1e-3
"""Spread of the starts along an unknown without any uncertainty, in large changes [-]."""
LARGEST_SEED = 2**32 - 1
"""Largest seed that emcee's generator takes."""
_MARGIN = 1e-9
"""Distance of the starts from the ends of the range, as a fraction of a large change [-]."""


def log_density(fit: Fit, x: Float[np.ndarray, " n_unknowns"]) -> float:
    """Return the log posterior density up to a constant; -inf where nothing can be simulated.

    Args:
        fit: The fit.
        x: Coordinates of the unknowns.
    """
    cost = sum_of_squares(fit, x)
    if not math.isfinite(cost):
        return -math.inf
    return -0.5 * cost


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
        column = self.names.index(check_choice("name", name, self.names))
        ends = [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence]
        low, high = np.quantile(self.values[:, column], ends)
        return float(low), float(high)


def sample_posterior(
    fit: Fit,
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
        fit: The fit.
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
    check_whole_number("seed", seed, 0, LARGEST_SEED)
    problem = fit.problem
    n_unknowns = len(fit.estimates)
    if n_walkers is None:
        n_walkers = max(4 * n_unknowns, 8)
    else:
        check_whole_number("n_walkers", n_walkers, 2 * n_unknowns + 2)
    lower, upper = np.array([unknown.ends for unknown in problem.unknowns]).T

    def log_probability(points: np.ndarray) -> np.ndarray:
        log_densities = np.full(len(points), -math.inf)
        is_inside = np.all((points > lower) & (points < upper), axis=1)
        for row in np.flatnonzero(is_inside):
            log_densities[row] = log_density(fit, points[row])
        return log_densities

    starts = _starts_of_walkers(fit, n_walkers, seed)
    margin = _MARGIN * problem.sizes
    starts = np.clip(starts, lower + margin, upper - margin)
    emcee = optional_import("Identification", "emcee", "identify")
    sampler = emcee.EnsembleSampler(n_walkers, n_unknowns, log_probability, vectorize=True)
    sampler.random_state = np.random.RandomState(seed).get_state()
    steps = sampler.sample(starts, iterations=n_steps, skip_initial_state_check=True)
    for n_done, _ in enumerate(steps, start=1):
        progress(n_done / n_steps)
    chain: np.ndarray = np.asarray(sampler.get_chain())
    samples = chain[n_steps // 2 :].reshape(-1, n_unknowns)
    return Posterior(
        names=problem.names,
        values=np.array([problem.values_of(x) for x in samples]),
        acceptance=float(sampler.acceptance_fraction.mean()),
    )


def _starts_of_walkers(fit: Fit, n_walkers: int, seed: int) -> np.ndarray:
    """Return random coordinates around the fit, half as scattered as its uncertainty."""
    sizes = fit.problem.sizes
    rng = np.random.default_rng(seed)
    deviation = np.minimum(np.sqrt(np.diag(fit.covariance)), _WIDEST_START * sizes)
    spread = np.where(deviation > 0.0, deviation, _NARROWEST_START * sizes)
    return fit.x + 0.5 * spread * rng.standard_normal((n_walkers, sizes.size))
