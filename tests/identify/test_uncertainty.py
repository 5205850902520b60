from dataclasses import replace

import numpy as np
import pytest
from identify.trials import DRAG, FRICTION, WATER, speeds

from laticauda.identify import (
    Unknown,
    fit,
    local_search,
    profile_interval,
    profiles,
    sample_posterior,
)
from laticauda.identify.method import LOSSES
from laticauda.identify.model import predict
from laticauda.identify.posterior_sample import log_density
from laticauda.identify.profiles import sum_of_squares
from laticauda.values import SimulationFailed

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


def offset_with(prior, **settings):
    unknown = Unknown(name="measured.power_offset", prior=prior, size=10.0)
    return fit(OFFSET, parameters=[unknown], n_starts=1, threads=1, noise="estimated", **settings)


def test_a_prior_that_says_nothing_changes_neither_the_estimated_noise_nor_an_interval():
    """An unknown with such a prior is fitted to the data, and counts so."""
    without, found = offset_with(None), offset_with((0.0, 1e6))
    assert found.degrees_of_freedom == pytest.approx(without.degrees_of_freedom, rel=1e-6)
    assert without.degrees_of_freedom == 2
    assert found.noise_factor == pytest.approx(without.noise_factor, rel=1e-6)
    names = ["measured.power_offset"]
    assert found[names[0]].interval == pytest.approx(without[names[0]].interval, rel=1e-5)
    ends = [profile_interval(one, names[0]) for one in (without, found)]
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)


def test_profiles_apply_the_noise_factor_that_is_reported():
    """A prior as strong as the data: of the three degrees of freedom, half a one is fitted."""
    alone = offset_with(None)["measured.power_offset"]
    found = offset_with((alone.value + alone.sigma, alone.sigma))
    estimate = found["measured.power_offset"]
    assert 2.0 < found.degrees_of_freedom < 3.0
    assert found.used_noise_factor == pytest.approx(found.noise_factor, rel=1e-5)
    ends = profile_interval(found, "measured.power_offset")
    assert ends == pytest.approx(estimate.interval, rel=1e-3)


def test_a_robust_loss_tells_outliers_by_the_estimated_noise_and_not_by_the_stated_one():
    measured = speeds(9, noise=SIGMA, sigma=SIGMA, duration=1.0, figure="mean_power")
    value, sigma = measured[0].figures["mean_power"]
    measured[0] = replace(measured[0], figures={"mean_power": (value + 8.0 * SIGMA, sigma)})
    settings = {"loss": "huber", "noise": "estimated", "n_starts": 1, "threads": 1}
    found = []
    for share in (1.0, 0.1):
        stated = []
        for one in measured:
            value, sigma = one.figures["mean_power"]
            stated.append(replace(one, figures={"mean_power": (value, share * sigma)}))
        found.append(fit(stated, parameters=["measured.power_offset"], **settings))
    plain, less = (one["measured.power_offset"] for one in found)
    assert less.value == pytest.approx(plain.value, rel=1e-4)
    assert less.interval == pytest.approx(plain.interval, rel=1e-4)
    ends = profile_interval(found[0], "measured.power_offset")
    assert ends == pytest.approx(plain.interval, abs=0.2 * plain.sigma)


def test_a_robust_loss_leaves_a_prior_its_weight_however_far_it_is_from_the_data():
    """All data are within their noise, where a huber loss is that of squares; the prior is not."""
    friction = WATER.tangential_friction
    exact = speeds(8, sigma=SIGMA, duration=1.0, figure="mean_power", tangential_friction=friction)
    prior = Unknown(name="measured.power_offset", prior=(3.0 * SIGMA, SIGMA), size=10.0)
    found = [
        fit(exact, parameters=[prior], n_starts=1, threads=1, rivals=False, loss=loss)
        for loss in ("linear", "huber")
    ]
    plain, robust = (one["measured.power_offset"] for one in found)
    best = found[0], found[0].x
    assert robust.value == pytest.approx(plain.value, rel=1e-6)
    assert plain.value == pytest.approx(3.0 * SIGMA / 9.0, rel=1e-3)
    assert robust.interval == pytest.approx(plain.interval, rel=1e-6)
    assert sum_of_squares(found[1], found[1].x) == pytest.approx(sum_of_squares(*best), rel=1e-6)


@pytest.mark.parametrize("loss", LOSSES)
def test_the_derivatives_of_a_loss_are_those_of_its_values(loss):
    squares = np.array([0.01, 0.5, 0.99, 1.01, 3.0, 40.0])
    step = 1e-5
    values, slopes, bends = LOSSES[loss](squares)
    after, slopes_after, _ = LOSSES[loss](squares + step)
    before, slopes_before, _ = LOSSES[loss](squares - step)
    np.testing.assert_allclose(slopes, (after - before) / (2.0 * step), atol=1e-8)
    np.testing.assert_allclose(bends, (slopes_after - slopes_before) / (2.0 * step), atol=1e-8)
    assert np.all(values <= squares)


@pytest.mark.parametrize("loss", ["linear", "soft_l1", "huber", "cauchy", "arctan"])
def test_the_covariance_is_the_inverse_curvature_of_what_is_minimized(loss):
    """Also of a robust loss, of which the rows of the Jacobian have the curvature.

    The residuals are small: none is an outlier, of which the curvature would be negative and is 0.
    """
    measured = []
    for one in OFFSET:
        value, sigma = one.figures["mean_power"]
        measured.append(replace(one, figures={"mean_power": (value, 4.0 * sigma)}))
    found = fit(measured, parameters=["measured.power_offset"], n_starts=1, threads=1, loss=loss)
    step = 0.01 * SIGMA
    before, least, after = (
        sum_of_squares(found, found.x + change) for change in (-step, 0.0, step)
    )
    curvature_of_half = 0.5 * (before - 2.0 * least + after) / step**2
    assert found.covariance[0, 0] == pytest.approx(1.0 / curvature_of_half, rel=1e-3)


def test_a_profile_does_not_close_where_nothing_is_seen():
    names = [Unknown(name=FRICTION, lower=0.1, upper=1.0), Unknown(name=DRAG, lower=0.8, upper=4.0)]
    blind = fit(speeds(3, duration=3.0, sigma=0.02), parameters=names, n_starts=1, threads=1)
    assert not blind[DRAG].is_identified
    blurred = profile_interval(blind, DRAG)
    assert None in blurred
    with pytest.raises(ValueError, match="`name` must be one of"):
        profile_interval(blind, "water.density")


@pytest.fixture
def two_offsets():
    """A fit of an offset that data determine, and of one that only its prior determines."""
    unknowns = [
        Unknown(name="measured.power_offset", size=10.0),
        Unknown(name="measured.heading_offset", prior=(0.0, 1.0)),
    ]
    return fit(OFFSET, parameters=unknowns, n_starts=1, threads=1)


def test_a_profile_ends_where_nothing_can_be_simulated(two_offsets, monkeypatch):
    low, high = two_offsets["measured.power_offset"].interval
    middle = two_offsets["measured.power_offset"].value
    limit = 0.5 * (middle + high)

    def predict_up_to_limit(problem, values):
        predicted = predict(problem, values)
        if values[0] > limit:
            unknown = np.full(predicted.values.size, np.nan)
            return replace(predicted, values=unknown, failures={"trial 0": "diverged at 0.1 s"})
        return predicted

    monkeypatch.setattr(local_search, "predict", predict_up_to_limit)
    ends = profile_interval(two_offsets, "measured.power_offset")
    assert ends == pytest.approx((low, limit), abs=2e-3 * (high - low))
    with pytest.raises(SimulationFailed, match="where a search begins: `trial 0`: diverged"):
        local_search.minimize(two_offsets.problem, np.array([2.0 * high, 0.0]), loss="linear")


def test_a_profile_has_ends_even_if_a_refit_comes_to_another_minimum_than_before(
    two_offsets, monkeypatch
):
    """The first step is half as long as the interval; its first refit fails, later ones do not."""
    cautious = replace(two_offsets, covariance=0.25 * two_offsets.covariance)
    n_searches = 0

    def minimize_badly_at_first(*args, **settings):
        nonlocal n_searches
        n_searches += 1
        search = local_search.minimize(*args, **settings)
        if n_searches > 1:
            return search
        return replace(search, end=search.end + np.array([0.0, 50.0]))

    monkeypatch.setattr(profiles, "minimize", minimize_badly_at_first)
    low, high = profile_interval(cautious, "measured.power_offset")
    assert low < two_offsets["measured.power_offset"].value < high


def test_refits_leave_the_end_of_a_range_at_which_the_fit_ended():
    """Less friction can be made up for by the drag of a tether, of which the fit found none."""
    measured = speeds(8, noise=0.002, duration=3.0)
    alone = fit(measured, parameters=[FRICTION], n_starts=1, threads=1)
    pulled = fit(measured, parameters=[FRICTION, "robot.tether.drag"], n_starts=1, threads=1)
    assert pulled["robot.tether.drag"].value == pytest.approx(0.0, abs=1e-9)
    low_alone, _ = profile_interval(alone, FRICTION)
    low, _ = profile_interval(pulled, FRICTION)
    assert low < 0.98 * low_alone


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
