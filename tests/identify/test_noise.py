"""Noise that neighbors in time share: found in the residuals, and in the width of intervals."""

import numpy as np
import pytest
from identify.test_starts import FRICTION, SHORT, TRUE, named, tracked
from identify.trials import WATER, gaits
from scipy.linalg import toeplitz

import laticauda as lc
from laticauda.identify import Measurement, fit, profile_interval
from laticauda.identify.correlated_noise import noise_widening
from laticauda.identify.problem import make_problem

N = 40
RUN = lc.build_scenario(SHORT, gaits(1)[0], 8.0, environment=WATER)
TIME = np.linspace(0.0, 8.0, N)
ONE = Measurement(
    name="a",
    scenario=RUN,
    time=TIME,
    series={"center_of_mass": (np.zeros((N, 2)), 1.0), "heading": (np.zeros(N), 1.0)},
    free_start=False,
)
PROBLEM = make_problem([ONE], [FRICTION, "water.normal_drag", "water.added_mass"])
ROWS = np.stack([np.ones(3 * N), np.repeat(TIME, 3) / 8.0, np.sin(np.arange(3 * N) / 20.0)], axis=1)
INVERSE = np.linalg.inv(ROWS.T @ ROWS)


def correlated(lag, rng):
    """Noise of both series, the path's correlated and the heading's white."""
    noise = rng.standard_normal((N, 3))
    for k in range(1, N):
        noise[k, :2] = lag * noise[k - 1, :2] + np.sqrt(1.0 - lag**2) * noise[k, :2]
    return np.concatenate([noise[:, :2].ravel(), noise[:, 2]])


def test_intervals_from_correlated_residuals_hold_the_truth_as_often_as_they_say():
    rng = np.random.default_rng(3)
    hits, plain, seen = 0, 0, []
    for _ in range(100):
        noise = correlated(0.6, rng)
        errors = INVERSE @ ROWS.T @ noise
        wider, lags = noise_widening(PROBLEM, ROWS, noise - ROWS @ errors, None)
        seen.append(lags.get("center_of_mass", 0.0))
        one = 1.96 * np.sqrt(np.diag(INVERSE))
        hits += np.count_nonzero(np.abs(errors) < one * wider)
        plain += np.count_nonzero(np.abs(errors) < one)
    assert np.mean(seen) == pytest.approx(0.6, abs=0.05)
    assert plain / 300 < 0.85 < 0.90 < hits / 300 < 0.98


def test_the_widening_is_that_of_the_covariance_of_least_squares():
    noise = correlated(0.8, np.random.default_rng(5))
    off = noise - ROWS @ (INVERSE @ ROWS.T @ noise)
    wider, lags = noise_widening(PROBLEM, ROWS, off, None)
    between = np.eye(3 * N)
    between[: 2 * N, : 2 * N] = np.kron(toeplitz(lags["center_of_mass"] ** np.arange(N)), np.eye(2))
    assert set(lags) == {"center_of_mass"}
    covariance = INVERSE @ ROWS.T @ between @ ROWS @ INVERSE
    np.testing.assert_allclose(
        wider, np.fmax(np.sqrt(np.diag(covariance) / np.diag(INVERSE)), 1.0), rtol=1e-9
    )
    more = noise_widening(PROBLEM, ROWS, off, 3 * N - 3.0)[0]
    left = 3 * N - np.trace(INVERSE @ ROWS.T @ between @ ROWS)
    np.testing.assert_allclose(
        more[more > 1.0], (wider * np.sqrt((3 * N - 3) / left))[more > 1.0], rtol=1e-9
    )


def test_white_noise_is_hardly_ever_called_correlated_and_residuals_of_rounding_never():
    rng = np.random.default_rng(4)
    left = np.eye(3 * N) - ROWS @ INVERSE @ ROWS.T
    assert (
        sum(
            bool(noise_widening(PROBLEM, ROWS, left @ correlated(0.0, rng), None)[1])
            for _ in range(100)
        )
        <= 2
    )
    assert not noise_widening(PROBLEM, ROWS, 1e-6 * left @ correlated(0.9, rng), None)[1]


def test_correlated_residuals_are_said_and_widen_every_interval():
    white, found = (fit(tracked(lag=lag), parameters=[FRICTION], n_starts=1) for lag in (0.0, 0.95))
    assert not named(white, "correlated") and np.all(white.widening == 1.0)
    assert "(center_of_mass)" in named(found, "correlated residuals")[0] and not named(
        found, "chi^2"
    )
    assert found[FRICTION].sigma > 1.3 * white[FRICTION].sigma
    low, high = found[FRICTION].interval
    assert low < TRUE < high
    likely = profile_interval(found, FRICTION)
    assert np.log(likely[1] / likely[0]) == pytest.approx(np.log(high / low), rel=0.1)
