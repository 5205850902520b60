import numpy as np
import pytest
from identify.trials import DRAG, FRICTION, speeds

from laticauda.identify import Unknown, fit, posterior, profile

MEASURED = speeds(3, noise=0.002, duration=3.0)


@pytest.fixture(scope="module")
def found():
    return fit(MEASURED, parameters=[FRICTION], n_starts=1, threads=1)


def test_where_the_model_is_about_linear_the_profile_is_the_interval(found):
    ends = profile(found, FRICTION)
    low, high = found[FRICTION].interval
    assert ends.is_closed
    assert np.log((ends.low, ends.high)) == pytest.approx(np.log((low, high)), abs=0.05 * np.log(high / low))


def test_a_profile_does_not_close_where_nothing_is_seen():
    names = [Unknown(name=FRICTION, lower=0.1, upper=1.0), Unknown(name=DRAG, lower=0.8, upper=4.0)]
    blind = fit(speeds(3, duration=3.0, sigma=0.02), parameters=names, n_starts=1, threads=1)
    assert not blind[DRAG].is_identified
    assert not profile(blind, DRAG).is_closed
    with pytest.raises(ValueError, match="`name` must be one of"):
        profile(blind, "water.density")


def test_the_posterior_has_the_interval_too(found):
    sample = posterior(found, n_steps=24, n_walkers=8, seed=1)
    low, high = found[FRICTION].interval
    assert sample.values.shape == (12 * 8, 1)
    assert sample.interval(FRICTION) == pytest.approx((low, high), abs=0.4 * (high - low))
    assert np.median(sample.values) == pytest.approx(found[FRICTION].value, abs=0.25 * (high - low))
    assert 0.2 < sample.acceptance < 0.95
    one, other = (posterior(found, n_steps=3, n_walkers=4, seed=1).values for _ in range(2))
    np.testing.assert_array_equal(one, other)
