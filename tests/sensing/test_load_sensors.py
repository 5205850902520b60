"""Strain gauges and pressure sensors: what they tell is what joints and links bear, with the errors that they state."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.sensing import PressureSensor, SensorFault, StrainGauge
from laticauda.values import DIRECTIONS

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
EXACT_GAUGE = StrainGauge(
    joints=(0, 5), force_noise=0.0, moment_noise=0.0, force_zero_error=0.0, moment_zero_error=0.0
)
EXACT_SKIN = PressureSensor(links=(0, 3, 8), noise=0.0, zero_error=0.0)


class Straight(lc.Controller):
    """Swims straight, and decides often."""

    gait = GAIT

    def __init__(self, interval=0.05):
        self.interval = interval

    def init(self):
        return None

    def step(self, state, observation):
        return None, lc.Command(gait=GAIT)


def swim(*sensors, duration=2.0, interval=0.05, **changes):
    scenario = lc.build_scenario(
        "mamba", Straight(interval), duration, sensors=sensors, sample_interval=interval, **changes
    )
    return lc.swim(scenario, link_forces=True)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_exact_sensors_tell_what_the_log_has(model):
    trial = swim(EXACT_GAUGE, EXACT_SKIN, model=model)
    for joint in (0, 5):
        for k, direction in enumerate(DIRECTIONS):
            for kind in ("force", "moment"):
                told = trial.signals[f"load_{kind}_{direction}_{joint}"]
                logged = getattr(trial, f"joint_{kind}")[:, joint, k]
                np.testing.assert_allclose(told[1:-1], logged[1:-1], atol=1e-5)
    for link in (0, 3, 8):
        told = trial.signals[f"pressure_difference_{link}"]
        np.testing.assert_allclose(told[1:-1], trial.pressure_difference[1:-1, link], atol=1e-3)


def test_gauges_have_the_noise_and_the_zero_that_they_state():
    errors = {"force_noise": 0.3, "moment_noise": 0.02}
    zeros = {"force_zero_error": 2.0, "moment_zero_error": 0.5}
    everywhere = replace(EXACT_GAUGE, joints=tuple(range(8)))
    true = swim(everywhere, duration=20.0).signals
    noisy = swim(replace(everywhere, seed=3, **errors, **zeros), duration=20.0).signals
    for kind in ("force", "moment"):
        names = [name for name in true if name.startswith(f"load_{kind}")]
        assert len(names) == 24
        error = np.array([noisy[name] - true[name] for name in names])
        zero = error.mean(axis=1)
        largest = zeros[f"{kind}_zero_error"]
        assert 0.8 * largest < np.abs(zero).max() < 1.1 * largest
        assert error.std(axis=1) == pytest.approx(errors[f"{kind}_noise"], rel=0.15)


def test_the_zero_of_a_gauge_is_the_same_in_every_run_of_a_seed():
    gauge = replace(EXACT_GAUGE, force_zero_error=1.0, seed=7)
    first, again = swim(gauge).signals, swim(gauge).signals
    other = swim(replace(gauge, seed=8)).signals
    name = "load_force_up_5"  # nothing acts upward in the plane
    assert np.array_equal(first[name], again[name])
    assert np.unique(first[name]).size == 1
    assert abs(first[name][0] - other[name][0]) > 0.01


def test_sensors_show_no_more_than_their_largest_value():
    gauge = replace(EXACT_GAUGE, force_limit=1.0, moment_limit=0.1)
    trial = swim(gauge, replace(EXACT_SKIN, limit=20.0))
    assert np.abs(trial.joint_force[:, 5]).max() > 2.0
    assert np.abs(trial.signals["load_force_left_5"]).max() == 1.0
    assert np.abs(trial.signals["load_moment_up_5"]).max() == 0.1
    assert np.abs(trial.signals["pressure_difference_8"]).max() == 20.0


def test_rate_latency_and_faults_are_those_of_any_sensor():
    silent = SensorFault(begin=0.5, end=1.0)
    trial = swim(replace(EXACT_GAUGE, rate=10.0, latency=0.1, faults=(silent,)), interval=0.05)
    told = trial.signals["load_moment_up_5"]
    assert np.isnan(told[:2]).all()
    truth = trial.joint_moment[:, 5, 2]
    np.testing.assert_allclose(told[8:10], truth[6], atol=1e-6)
    np.testing.assert_allclose(told[12:22], truth[8], atol=1e-6)


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        (
            StrainGauge(joints=(0, 8)),
            "`sensors.load.joints` must be joints of the robot, 0 to 7, got 8",
        ),
        (
            PressureSensor(links=(9,)),
            "`sensors.pressure.links` must be links of the robot, 0 to 8, got 9",
        ),
    ],
)
def test_a_place_that_the_robot_does_not_have_is_refused(sensor, message):
    with pytest.raises(ValueError, match=message):
        swim(sensor)


def test_a_scenario_with_these_sensors_is_stored_and_swum_again(tmp_path):
    controller = lc.PathFollowing(
        gait=GAIT,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=0.5),
        heading=lc.HeadingController(gain=0.4, max_offset_deg=20),
    )
    sensors = (StrainGauge(joints=(2,)), PressureSensor(links=(0, 1)))
    trial = lc.swim("mamba", controller, 2.0, sensors=sensors)
    trial.save(tmp_path / "run.nc")
    stored = lc.load_trial(tmp_path / "run.nc")
    assert stored.scenario.model.sensors == sensors
    again = lc.swim(stored.scenario)
    for name, values in trial.signals.items():
        assert np.array_equal(values, again.signals[name], equal_nan=True), name
