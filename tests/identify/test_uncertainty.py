import numpy as np
import pytest
from identify.trials import DRAG, FRICTION, MASS, speeds

from laticauda.identify import Unknown, fit, posterior, profile

MEASURED = speeds(6, noise=0.002, duration=6.0)


@pytest.fixture(scope="module")
def found():
    return fit(MEASURED, parameters=[FRICTION], n_starts=1)


def test_where_the_model_is_about_linear_the_profile_is_the_interval(found):
    ends = profile(found, FRICTION)
    low, high = found[FRICTION].interval
    assert ends.is_closed
    assert np.log((ends.low, ends.high)) == pytest.approx(np.log((low, high)), abs=0.05 * np.log(high / low))


def test_a_profile_does_not_close_where_nothing_is_seen():
    names = [Unknown(name=name, lower=0.1, upper=5.0) for name in (FRICTION, DRAG, MASS)]
    blind = fit(speeds(4, duration=6.0, sigma=0.01), parameters=names, n_starts=1)
    assert not blind[DRAG].is_identified
    assert not profile(blind, DRAG).is_closed
    with pytest.raises(ValueError, match="`name` must be one of"):
        profile(blind, "water.density")


def test_the_posterior_has_the_interval_too(found):
    sample = posterior(found, n_steps=60, n_walkers=16, seed=1)
    low, high = found[FRICTION].interval
    assert sample.values.shape == (30 * 16, 1)
    assert sample.interval(FRICTION) == pytest.approx((low, high), abs=0.3 * (high - low))
    assert np.median(sample.values) == pytest.approx(found[FRICTION].value, abs=0.15 * (high - low))
    assert 0.2 < sample.acceptance < 0.95
    again = posterior(found, n_steps=60, n_walkers=16, seed=1)
    np.testing.assert_array_equal(again.values, sample.values)
