"""Noise that is correlated between neighboring samples.

It is caused by calibration errors, waves or errors of the model.

If the correlation C of the noise n falls by the factor r from sample to sample, C_ij = r^|i - j|, a
fit leaves the residuals e = n - J F^-1 J^T n, and the covariance of its estimates is F^-1 (J^T C J)
F^-1 (the sandwich) instead of F^-1. A fit absorbs part of the noise, so its residuals look less
correlated than the noise is. Therefore r is chosen such that random noise, after the same fit, has
the lag-1 correlation of the residuals.

Such noise is made of white noise w: every sample keeps the share r of the one before it, and gets
sqrt(1 - r^2) w of new noise, so that its variance remains 1. The first sample is all new. This is a
linear filter, n = L w, so that C = L L^T, and J^T C J = H^T H with H = L^T J: the same filter, run
backward over the columns of J. No matrix of the size of C is ever formed.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.identify.information import invert_information
from laticauda.identify.problem import Problem
from laticauda.values import optional_import

_SURE = 3.1
"""White noise is this many standard deviations off in 1 of 1000 cases [-]."""
_ROUNDING = 1e-3
"""Residuals smaller than this fraction of the stated noise do not come from a measurement [-]."""
_N_DRAWS = 50
"""Samples of random noise from which its correlation after a fit is computed."""
_N_ROUNDS = 12
"""Corrections of r."""
_LARGEST_LAG = 0.98
"""Largest r that is assumed [-]."""

Chains = Mapping[str, list[np.ndarray]]
"""By kind of series: for every measured series, a chain, where its samples stand in the data.

A chain is an array of indices, time first; noise is correlated along it, and never between two.
"""


class Widening(NamedTuple):
    """How correlated noise widens the intervals of a fit."""

    factors: Float[np.ndarray, " n_unknowns"]
    """Factor on the interval of each unknown, at least 1 [-]."""
    lags: dict[str, float]
    """r for each kind of series whose residuals are correlated [-]."""


def noise_widening(
    problem: Problem,
    jacobian: Float[np.ndarray, "n_residuals n_unknowns"],
    residuals: Float[np.ndarray, " n_data"],
    degrees: float | None,
) -> Widening:
    """Compute by which factors correlated noise widens the intervals, and r by kind of series.

    Args:
        problem: Measurements and unknowns.
        jacobian: Jacobian of the residuals, those of the priors last.
        residuals: The residuals of the data.
        degrees: Degrees of freedom, if the residuals estimated the noise; None if it is known.
    """
    data_rows, prior_rows = np.split(jacobian * problem.sizes, [residuals.size])
    prior_information = prior_rows.T @ prior_rows
    covariance = invert_information(data_rows.T @ data_rows + prior_information)

    def remove_fitted(noise: np.ndarray) -> np.ndarray:
        return noise - data_rows @ (covariance @ (data_rows.T @ noise))

    chains = _chains(problem, residuals)
    lags = _estimate_lags(chains, residuals, remove_fitted)
    if not lags:
        return Widening(factors=np.ones(len(covariance)), lags=lags)
    filtered = data_rows.copy()  # H of the docstring of the module
    for kind, lag in lags.items():
        for chain in chains[kind]:
            backward = _add_what_remains(data_rows[chain][::-1], lag)[::-1]
            filtered[chain] = _scales_of_new_noise(chain, lag) * backward
    correlated_information = filtered.T @ filtered  # J^T C J
    if degrees is not None:
        correlated_information *= _correction_of_estimated_noise(
            covariance, correlated_information, residuals.size, degrees
        )
    # What is known from priors has its own uncertainty, which no correlation of the noise changes.
    sandwich = covariance @ (correlated_information + prior_information) @ covariance
    variances = np.diag(covariance)
    factors = np.ones(len(covariance))
    is_determined = variances > 0.0  # the pseudoinverse leaves 0 for what nothing determines
    ratios = np.diag(sandwich)[is_determined] / variances[is_determined]
    factors[is_determined] = np.fmax(np.sqrt(ratios), 1.0)
    return Widening(factors=factors, lags=lags)


def _correction_of_estimated_noise(
    covariance: np.ndarray, correlated_information: np.ndarray, n_data: int, degrees: float
) -> float:
    """Return by what to multiply the variance of a noise that the residuals estimated.

    That estimate divided their sum of squares by the degrees of freedom, which is what a fit leaves
    of white noise. Of correlated noise, a fit absorbs trace(F^-1 J^T C J), which is more, so that
    the residuals are smaller than the noise by more than the degrees of freedom tell.
    """
    n_absorbed = float(np.trace(covariance @ correlated_information))
    n_left = max(n_data - n_absorbed, 1.0)
    return degrees / n_left


def _estimate_lags(
    chains: Chains, residuals: np.ndarray, remove_fitted: Callable[[np.ndarray], np.ndarray]
) -> dict[str, float]:
    """Estimate r for the kinds of series with correlated residuals.

    Args:
        chains: The series.
        residuals: The residuals of the data.
        remove_fitted: Returns what a fit leaves of noise.
    """
    white = np.random.default_rng(0).standard_normal((residuals.size, _N_DRAWS))

    def missing_correlation(lags: Mapping[str, float]) -> dict[str, float]:
        """Return by how much the residuals are more correlated than noise with these r."""
        noise = white.copy()
        for kind, lag in lags.items():
            for chain in chains[kind]:
                new_noise = _scales_of_new_noise(chain, lag) * white[chain]
                noise[chain] = _add_what_remains(new_noise, lag)
        remaining = remove_fitted(noise)
        missing: dict[str, float] = {}
        for kind, own_chains in chains.items():
            observed = _lag_1_correlation(residuals[:, np.newaxis], own_chains)
            missing[kind] = observed - _lag_1_correlation(remaining, own_chains)
        return missing

    lags: dict[str, float] = {}
    for kind, missing in missing_correlation({}).items():
        n_samples = sum(chain.size for chain in chains[kind])
        if missing * np.sqrt(n_samples) > _SURE:
            lags[kind] = 0.0
    if not lags:
        return lags
    for _ in range(_N_ROUNDS):
        missing_by_kind = missing_correlation(lags)
        lags = {
            kind: float(np.clip(lag + missing_by_kind[kind], 0.0, _LARGEST_LAG))
            for kind, lag in lags.items()
        }
    return lags


def _chains(problem: Problem, residuals: np.ndarray) -> Chains:
    """Return the series with more than one sample whose residuals are not just rounding errors."""
    chains: dict[str, list[np.ndarray]] = {}
    indices = np.arange(residuals.size)
    for block in problem.data_blocks:
        time = problem.measurements[block.owner].time
        if not block.is_series or time is None or time.size <= 1:
            continue
        if np.std(residuals[block.numbers]) > _ROUNDING:
            chain = indices[block.numbers].reshape(time.size, -1)
            chains.setdefault(block.name, []).append(chain)
    return chains


def _lag_1_correlation(residuals: np.ndarray, chains: list[np.ndarray]) -> float:
    """Compute the correlation of neighboring samples."""
    products = 0.0
    squares = 0.0
    for chain in chains:
        products += float(np.sum(residuals[chain[1:]] * residuals[chain[:-1]]))
        squares += float(np.sum(residuals[chain] ** 2))
    return products / squares


def _scales_of_new_noise(chain: np.ndarray, lag: float) -> np.ndarray:
    """Return the scale of what is new in the noise of every sample: all of it in the first."""
    scales = np.full(len(chain), np.sqrt(1.0 - lag**2))
    scales[0] = 1.0
    return scales[:, np.newaxis, np.newaxis]


def _add_what_remains(samples: np.ndarray, lag: float) -> np.ndarray:
    """Add to every sample the share of the sum before it that remains: y_i = x_i + r y_(i-1)."""
    signal = optional_import("Identification", "scipy", "identify", "scipy.signal")
    return signal.lfilter([1.0], [1.0, -lag], samples, axis=0)
