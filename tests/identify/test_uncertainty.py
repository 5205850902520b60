import numpy as np
import pytest
from identify.trials import DRAG, FRICTION, speeds

from laticauda.identify import Unknown, fit, profile_interval, sample_posterior
from laticauda.identify.posterior_sample import log_density

MEASURED = speeds(3, noise=0.002, duration=3.0)
SIGMA = 0.5  # of a meter [W]
OFFSET = speeds(
    3, noise=SIGMA, sigma=SIGMA, duration=1.0, figure="mean_power", tangential_friction=0.45
)


@pytest.fixture(scope="module")
def found():
    return fit(MEASURED, parameters=[FRICTION], n_starts=1, threads=1)


def test_where_the_model_is_about_linear_the_profile_is_the_interval(found):
    ends = profile_interval(found, FRICTION)
    low, high = found[FRICTION].interval
    assert None not in ends
    assert np.log(ends) == pytest.approx(np.log((low, high)), abs=0.05 * np.log(high / low))


def test_where_the_noise_is_estimated_the_profile_has_the_quantile_of_student_too():
    """Three numbers, one unknown: 4.3 standard deviations, where the normal distribution would have 2.0."""
    found = fit(
        OFFSET, parameters=["measured.power_offset"], n_starts=1, noise="estimated", threads=1
    )
    ends, estimate = (
        profile_interval(found, "measured.power_offset"),
        found["measured.power_offset"],
    )
    assert ends == pytest.approx(estimate.interval, rel=1e-3)
    assert ends[1] - ends[0] == pytest.approx(2 * 4.302653 * estimate.sigma, rel=2e-3)


def test_a_profile_does_not_close_where_nothing_is_seen():
    names = [Unknown(name=FRICTION, lower=0.1, upper=1.0), Unknown(name=DRAG, lower=0.8, upper=4.0)]
    blind = fit(speeds(3, duration=3.0, sigma=0.02), parameters=names, n_starts=1, threads=1)
    assert not blind[DRAG].is_identified
    blurred = profile_interval(blind, DRAG)
    assert None in blurred
    with pytest.raises(ValueError, match="`name` must be one of"):
        profile_interval(blind, "water.density")


def test_the_posterior_of_a_linear_model_with_normal_noise_is_the_normal_one():
    """What a meter adds is added to every figure alike: its posterior is known in closed form."""
    found = fit(OFFSET, parameters=["measured.power_offset"], n_starts=1, threads=1)
    mean, sd = found["measured.power_offset"].value, SIGMA / np.sqrt(3)
    assert found["measured.power_offset"].sigma == pytest.approx(sd, rel=1e-9)
    density = [log_density(found, np.array([mean + z * sd])) for z in (0.0, -1.0, 0.5, 2.0)]
    assert np.subtract(density[0], density[1:]) == pytest.approx([0.5, 0.125, 2.0], rel=1e-9)


def test_the_posterior_has_the_interval_too(found):
    sample = sample_posterior(found, n_steps=24, n_walkers=8, seed=1)
    low, high = found[FRICTION].interval
    assert sample.values.shape == (12 * 8, 1)
    assert sample.interval(FRICTION) == pytest.approx((low, high), abs=0.4 * (high - low))
    assert np.median(sample.values) == pytest.approx(found[FRICTION].value, abs=0.25 * (high - low))
    assert 0.2 < sample.acceptance < 0.95
    one, other = (sample_posterior(found, n_steps=3, n_walkers=4, seed=1).values for _ in range(2))
    np.testing.assert_array_equal(one, other)
