"""The filter's state: what is known of a vector, beside the textbook, and the past that it keeps."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from laticauda.control.estimation import EstimatorState, FilterState, JointSample, Noise
from laticauda.control.estimation.filter_state import Gaussian, PastStep

CHANCE = np.random.default_rng(7)
ROOT = CHANCE.normal(size=(5, 5))
KNOWN = Gaussian(mean=CHANCE.normal(size=5), covariance=ROOT @ ROOT.T)


def test_noise_is_what_the_campaign_of_the_estimator_chose():
    usual = {
        "position": 0.001,
        "yaw": math.radians(0.1),
        "joint": math.radians(0.3),
        "joint_acceleration": 0.5,
        "position_walk": 0.001,
        "surge": 0.0067,
        "sway": 0.01,
        "sway_time": 6.0,
        "current": 0.1,
        "current_walk": 0.001,
        "turning": 0.03,
        "turn_gain": 0.06,
        "slip_gain": 0.015,
        "heading_gain": 0.15,
        "across_gain": 0.005,
        "heading_ripple": 0.0033,
        "position_ripple": 0.006,
    }
    assert {one.name: getattr(Noise(), one.name) for one in fields(Noise)} == usual
    beside = {
        "turning": 0.012,
        "turn_gain": 0.03,
        "slip_gain": 0.01,
        "heading_gain": 0.05,
        "across_gain": 0.002,
        "heading_ripple": 0.003,
        "position_ripple": 0.0025,
    }
    assert Noise().beside_twin == Noise(**(usual | beside))
    assert Noise(turning=0.001).beside_twin.turning == 0.001  # never more than without


@pytest.mark.parametrize(
    "name",
    [
        "position",
        "yaw",
        "joint",
        "joint_acceleration",
        "sway_time",
        "current",
        "surge",
        "sway",
        "turning",
    ],
)
def test_a_sensor_is_never_exact_and_no_density_is_negative(name):
    strict = name in ("position", "yaw", "joint", "joint_acceleration", "sway_time", "current")
    with pytest.raises(ValueError, match=rf"`{name}` must be {'> 0' if strict else '>= 0'} "):
        Noise(**{name: 0.0 if strict else -1e-9})
    if not strict:
        assert getattr(Noise(**{name: 0.0}), name) == 0.0


@pytest.mark.parametrize(
    "name",
    ["position_walk", "current_walk", "turn_gain", "slip_gain", "heading_gain", "across_gain", "heading_ripple",
     "position_ripple"],
)  # fmt: skip
def test_what_does_not_wander_has_the_density_zero(name):
    assert getattr(Noise(**{name: 0.0}), name) == 0.0
    with pytest.raises(ValueError, match=rf"`{name}` must be >= 0 "):
        Noise(**{name: -1e-9})


def test_a_step_of_time_is_f_p_ft_plus_q_and_stays_symmetric():
    transition, noise = CHANCE.normal(size=(5, 5)), np.diag(np.arange(1.0, 6.0))
    mean = CHANCE.normal(size=5)
    after = KNOWN.predict(mean, transition, noise)
    np.testing.assert_allclose(
        after.covariance, transition @ KNOWN.covariance @ transition.T + noise, rtol=1e-12
    )
    assert np.array_equal(after.covariance, after.covariance.T)
    assert after.mean is mean


def test_a_measurement_gives_what_is_known_given_it():
    """The conditional distribution of a joint Gaussian, by its precision."""
    sensitivity, noise = CHANCE.normal(size=(2, 5)), np.array([[0.5, 0.1], [0.1, 0.3]])
    residual = np.array([0.4, -0.7])
    after = KNOWN.update(residual, sensitivity, noise)
    precision = np.linalg.inv(KNOWN.covariance) + sensitivity.T @ np.linalg.inv(noise) @ sensitivity
    np.testing.assert_allclose(after.covariance, np.linalg.inv(precision), rtol=1e-6, atol=1e-9)
    gain = np.linalg.inv(precision) @ sensitivity.T @ np.linalg.inv(noise)
    np.testing.assert_allclose(after.mean, KNOWN.mean + gain @ residual, rtol=1e-6)
    assert np.array_equal(after.covariance, after.covariance.T)
    spread = sensitivity @ KNOWN.covariance @ sensitivity.T + noise
    distance = KNOWN.squared_distance(residual, sensitivity, noise)
    assert distance == pytest.approx(residual @ np.linalg.inv(spread) @ residual)


def test_what_is_restarted_is_known_by_itself_alone_and_the_rest_is_as_it_was():
    after = KNOWN.reset_entries(np.array([1, 3]), np.array([8.0, 9.0]), 0.25)
    assert after.mean.tolist() == [KNOWN.mean[0], 8.0, KNOWN.mean[2], 9.0, KNOWN.mean[4]]
    assert after.covariance[[1, 3]].tolist() == [
        [0.0, 0.25, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.25, 0.0],
    ]
    assert not after.covariance[np.ix_([0, 2, 4], [1, 3])].any()
    kept = np.ix_([0, 2, 4], [0, 2, 4])
    assert np.array_equal(after.covariance[kept], KNOWN.covariance[kept])
    assert not np.array_equal(KNOWN.mean, after.mean)  # the one before is not changed


def at(time: float) -> FilterState:
    zeros = np.zeros(1)
    return FilterState(
        time=time, reference=zeros, lagged=zeros, lagged_rate=zeros, n_joint_rejected=zeros
    )


def test_before_anything_a_filter_has_no_pose_no_gait_and_no_twin():
    first = at(0.0)
    assert (first.posterior, first.joint_angle, first.twin, first.twin_failed) == (
        None,
        None,
        None,
        False,
    )
    assert (first.frequency, first.n_rejected, first.fin_reference, first.frame_time) == (
        0.0,
        0,
        (),
        -math.inf,
    )
    state = EstimatorState(history=(PastStep(None, first),))
    assert (state.n_outliers, state.n_late) == (0, 0)


@pytest.mark.parametrize(
    ("horizon", "kept"),
    [
        (0.0, [4.0]),
        (0.5, [3.0, 4.0]),
        (1.0, [3.0, 4.0]),
        (1.5, [2.0, 3.0, 4.0]),
        (9.0, [1.0, 2.0, 3.0, 4.0]),
    ],
)
def test_of_the_past_is_kept_what_a_late_sample_may_go_back_to(horizon, kept):
    samples = [
        PastStep(JointSample(time=time, angle=np.zeros(1)), at(time))
        for time in (1.0, 2.0, 3.0, 4.0)
    ]
    state = replace(
        EstimatorState(history=(PastStep(None, samples[0].state), *samples[1:])),
        n_late=3,
        n_outliers=2,
    )
    after = state.within(horizon)
    assert [one.time for _, one in after.history] == kept
    assert after.history[0][0] is None and all(
        sample is not None for sample, _ in after.history[1:]
    )
    assert after.latest is state.latest and (after.n_late, after.n_outliers) == (3, 2)
