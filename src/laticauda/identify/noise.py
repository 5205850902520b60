"""Noise that is correlated between neighboring samples, caused by calibration errors, waves or model error.

If the correlation C of the noise n falls by the factor r from sample to sample, C_ij = r^|i - j|, a
fit leaves the residuals e = n - J F^-1 J^T n, and the covariance of its estimates is F^-1 (J^T C J)
F^-1 (the sandwich) instead of F^-1. A fit absorbs part of the noise, so its residuals look less
correlated than the noise is. Therefore r is chosen such that random noise, after the same fit, has
the lag-1 correlation of the residuals.
"""

from collections.abc import Callable, Mapping

import numpy as np
from jaxtyping import Float

from laticauda.identify.problem import Problem
from laticauda.values.optional import optional_import

_SURE = 3.1  # standard deviations; white noise is this far off in 1 of 1000 cases
_ROUNDING = 1e-3  # of the stated noise: smaller residuals do not come from a measurement
_DRAWS, _ROUNDS = 50, 12
_MOST = 0.98

Chains = Mapping[str, list[np.ndarray]]
"""For each kind of series, the indices of the data of every such series, time first."""


def noise_widening(
    problem: Problem,
    jacobian: Float[np.ndarray, "n_residuals n_unknowns"],
    off: Float[np.ndarray, " n_data"],
    degrees: float | None,
) -> tuple[Float[np.ndarray, " n_unknowns"], dict[str, float]]:
    """Compute the factor (at least 1) by which correlated noise widens the intervals, and r for each kind of series.

    Args:
        problem: Measurements and unknowns.
        jacobian: Jacobian of the residuals, those of the priors last.
        off: The residuals of the data.
        degrees: Degrees of freedom, if the residuals estimated the noise: less of correlated noise
            remains in them.
    """
    data, priors = np.split(jacobian * problem.sizes, [off.size])
    inverse = np.linalg.pinv(data.T @ data + priors.T @ priors, rcond=1e-13, hermitian=True)
    chains = _chains(problem, off)
    lags = _lags(chains, off, lambda noise: noise - data @ (inverse @ (data.T @ noise)))
    half = data.copy()
    for kind, lag in lags.items():
        for chain in chains[kind]:
            half[chain] = _scales(chain, lag) * _summed(data[chain][::-1], lag)[::-1]
    shared = half.T @ half
    if degrees is not None and lags:
        shared *= degrees / max(off.size - float(np.trace(inverse @ shared)), 1.0)
    variance = np.diag(inverse @ (shared + priors.T @ priors) @ inverse)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.fmax(np.sqrt(variance / np.diag(inverse)), 1.0) if lags else np.ones(
            len(inverse)
        ), lags


def _lags(
    chains: Chains, off: np.ndarray, left_of: Callable[[np.ndarray], np.ndarray]
) -> dict[str, float]:
    """Estimate r for the kinds of series with correlated residuals; `left_of` returns what a fit leaves of noise."""
    white = np.random.default_rng(0).standard_normal((off.size, _DRAWS))

    def missing(lags: Mapping[str, float]) -> dict[str, float]:
        noise = white.copy()
        for kind, lag in lags.items():
            for chain in chains[kind]:
                noise[chain] = _summed(_scales(chain, lag) * white[chain], lag)
        left = left_of(noise)
        return {
            kind: _lag(off[:, np.newaxis], mine) - _lag(left, mine) for kind, mine in chains.items()
        }

    sizes = {kind: sum(chain.size for chain in mine) for kind, mine in chains.items()}
    found = {kind: 0.0 for kind, more in missing({}).items() if more * np.sqrt(sizes[kind]) > _SURE}
    for _ in range(_ROUNDS if found else 0):
        more = missing(found)
        found = {kind: float(np.clip(lag + more[kind], 0.0, _MOST)) for kind, lag in found.items()}
    return found


def _chains(problem: Problem, off: np.ndarray) -> Chains:
    found: dict[str, list[np.ndarray]] = {}
    for one in problem.places:
        time = problem.measurements[one.owner].time
        if one.is_series and time is not None and time.size > 1 and np.std(off[one.at]) > _ROUNDING:
            found.setdefault(one.what, []).append(
                np.arange(off.size)[one.at].reshape(time.size, -1)
            )
    return found


def _lag(residuals: np.ndarray, chains: list[np.ndarray]) -> float:
    """Compute the lag-1 correlation."""
    beside = sum(float(np.sum(residuals[chain[1:]] * residuals[chain[:-1]])) for chain in chains)
    return beside / sum(float(np.sum(residuals[chain] ** 2)) for chain in chains)


def _scales(chain: np.ndarray, lag: float) -> np.ndarray:
    """Return the scale of the new noise in every sample: 1 for the first."""
    return np.where(np.arange(len(chain)) > 0, np.sqrt(1.0 - lag**2), 1.0)[
        :, np.newaxis, np.newaxis
    ]


def _summed(rows: np.ndarray, lag: float) -> np.ndarray:
    """Add to every sample what is left of those before it."""
    signal = optional_import("Identification", "scipy", "identify", "scipy.signal")
    return signal.lfilter([1.0], [1.0, -lag], rows, axis=0)
