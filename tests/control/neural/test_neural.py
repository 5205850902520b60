"""Gaits by neurons: alone they tend to their gait; cut apart, they swim only by what they feel."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.neural import Feedback, HalfCenters, PhaseOscillators
from laticauda.models.simulate.numbers import list_parameters

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)


def lags(trial):
    """Phase from joint to joint of the references, over the second half [deg]."""
    half = len(trial.time) // 2
    wave = trial.joint_angle_ref[half:]
    spectrum = np.fft.rfft((wave - wave.mean(axis=0)) * np.hanning(len(wave))[:, None], axis=0)
    main = np.argmax(np.abs(spectrum[:, 0]))
    phases = np.unwrap(np.angle(spectrum[main]))
    return np.degrees(np.diff(phases))


def test_without_feedback_oscillators_swim_the_gait_that_they_tend_to():
    neural = lc.swim("mamba", PhaseOscillators(gait=GAIT, seed=3), 40.0, joints="servo")
    gait = lc.swim("mamba", GAIT, 40.0, joints="servo")
    assert lags(neural) == pytest.approx(np.full(7, 40.0), abs=1.0)
    assert neural.forward_velocity == pytest.approx(gait.forward_velocity, rel=0.03)


@pytest.mark.parametrize("phase_shift_deg", [20.0, 55.0])
def test_the_lag_is_as_commanded(phase_shift_deg):
    gait = lc.lateral_undulation(
        amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=phase_shift_deg
    )
    oscillators = PhaseOscillators(gait=gait, seed=1)
    trial = lc.swim("mamba", oscillators, 30.0, joints="servo")
    phases = np.array([trial.signals[f"phase_{i}"][-1] for i in range(8)])
    difference = np.degrees(np.diff(phases)) - phase_shift_deg
    assert (difference + 180.0) % 360.0 - 180.0 == pytest.approx(np.zeros(7), abs=1.0)


def test_half_centers_make_a_wave_that_runs_to_the_tail_with_the_frequency_of_the_gait():
    trial = lc.swim("mamba", HalfCenters(gait=GAIT), 40.0, joints="servo")
    assert np.all((lags(trial) > 15.0) & (lags(trial) < 40.0))
    half = len(trial.time) // 2
    wave = trial.joint_angle_ref[half:, 4]
    rises = np.flatnonzero((wave[:-1] <= 0.0) & (wave[1:] > 0.0))
    period = np.mean(np.diff(trial.time[half:][rises]))
    assert period == pytest.approx(2.0 * math.pi / GAIT.frequency, rel=0.03)
    assert np.abs(wave).max() == pytest.approx(math.radians(30.0), rel=0.1)
    assert trial.forward_velocity > 0.06


def test_path_following_steers_a_network():
    following = lc.PathFollowing(
        gait=GAIT,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=1.6),
        heading=lc.HeadingController(gain=0.3, max_offset_deg=20),
        heading_estimate="cycle_mean",
    )
    network = PhaseOscillators(gait=GAIT, steering=following)
    start = lc.Start(center_of_mass=(0.0, 0.8))
    trial = lc.swim("mamba", network, 60.0, joints="servo", start=start)
    assert abs(np.mean(trial.center_of_mass[-200:, 1])) < 0.15
    alone = lc.swim("mamba", PhaseOscillators(gait=GAIT), 60.0, joints="servo", start=start)
    assert abs(np.mean(alone.center_of_mass[-200:, 1])) > 0.3


def test_a_network_is_stored_with_its_trial_and_swims_again(tmp_path):
    network = PhaseOscillators(gait=GAIT, feedback=Feedback(stretch=1.0), cuts=(2,), seed=1)
    trial = lc.swim("mamba", network, 3.0, joints="servo")
    trial.save(tmp_path / "trial.nc")
    again = lc.swim(lc.load_trial(tmp_path / "trial.nc").scenario)
    assert np.array_equal(again.joint_angle, trial.joint_angle)


def test_numbers_of_a_network_can_be_swept():
    scenario = lc.build_scenario("mamba", PhaseOscillators(gait=GAIT), 3.0, joints="servo")
    names = list_parameters(scenario)
    assert {"controller.coupling", "controller.feedback.pressure"} <= set(names)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cuts": (8,)}, r"`cuts` must be joints from 0 to 6, got 8"),
        ({"coupling": -1.0}, r"`coupling` must be between 0 and 50 1/s, got -1"),
        ({"seed": -1}, r"`seed` must be a whole number >= 0, got -1"),
    ],
)
def test_what_no_network_can_have_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        lc.swim("mamba", PhaseOscillators(gait=GAIT, **change), 1.0, joints="servo")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"steering": GAIT}, "`steering` must be of class Controller, got Gait."),
        ({"steering": PhaseOscillators(gait=GAIT)}, "`steering` must be a controller that commands a gait"),
        ({"gait": lc.recorded_gait(lc.load_joint_angles("amphibot-1"))}, "`gait` must be a wave, with"),
        ({"interval": 1e-9}, "`interval` must be between 0.0001 and 1 s, got 1e-09."),
        ({"interval": 100.0}, "`interval` must be between 0.0001 and 1 s, got 100.0."),
    ],
)  # fmt: skip
def test_what_cannot_steer_or_pace_a_network_is_refused(changes, message):
    with pytest.raises(ValueError, match="must be") as refusal:
        PhaseOscillators(**({"gait": GAIT} | changes))
    assert message in str(refusal.value)


def test_a_robot_with_pitch_joints_is_refused_by_its_name():
    robot = lc.load_robot("mamba-modules")
    message = (
        r"`robot` must have yaw joints only .*, got `mamba-modules` with pitch joints; in the plane"
    )
    with pytest.raises(ValueError, match=message):
        PhaseOscillators(gait=GAIT).check(robot)
    PhaseOscillators(gait=GAIT).check(robot.planar())


def test_a_robot_without_joints_is_refused():
    with pytest.raises(ValueError, match="`robot` must have joints to be moved by neurons, got"):
        lc.swim(lc.load_robot("chain", n_links=1), PhaseOscillators(gait=GAIT), 1.0, joints="pd")


def test_prescribed_joints_are_refused():
    with pytest.raises(ValueError, match="`references` must be None for prescribed joints"):
        lc.swim("mamba", PhaseOscillators(gait=GAIT), 1.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"coupling": 1e9}, "`coupling` must be between 0 and 50 1/s, got 1000000000.0."),
        ({"amplitude_rate": 401.0}, "`amplitude_rate` must be between 0 and 400 1/s, got 401.0."),
    ],
)
def test_networks_faster_than_their_steps_are_refused(changes, message):
    with pytest.raises(ValueError, match="must be") as refusal:
        PhaseOscillators(gait=GAIT, **changes)
    assert message in str(refusal.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gait": replace(GAIT, frequency=0.0)}, "got 0 to 0."),
        ({"toward_tail": 100.0}, "natural frequencies > 0 and <= 1.36 rad/s, .* got 2.27 to 2.27"),
        ({"inhibition": 1e3}, "<= 0.141 rad/s, which steps of 0.01 s follow .*, got 2.27 to 2.27"),
        ({"fatigue": 1e6}, "<= 0.0996 rad/s"),
        ({"seed": 0, "spread": 3.0}, "got -[0-9.]+ to"),
    ],
)  # fmt: skip
def test_half_centers_faster_than_their_steps_or_backward_are_refused(changes, message):
    network = HalfCenters(**({"gait": GAIT} | changes))
    with pytest.raises(ValueError, match=f"`gait` must have neurons with .*{message}"):
        lc.swim("mamba", network, 1.0, joints="servo")


def test_feedback_stronger_than_the_steps_can_follow_ends_in_one_sentence():
    network = PhaseOscillators(gait=GAIT, feedback=Feedback(stretch=1e6))
    with pytest.raises(
        ValueError,
        match=r"`feedback` must pull phases by at most 200 1/s, .* got gains that pull by",
    ):
        lc.swim("mamba", network, 2.0, joints="servo")


def test_the_strongest_coupling_still_settles_at_the_lag_of_the_gait():
    network = PhaseOscillators(gait=GAIT, coupling=50.0, seed=1)
    trial = lc.swim("mamba", network, 6.0, joints="servo")
    phases = np.array([trial.signals[f"phase_{i}"][-1] for i in range(8)])
    lags = np.angle(np.exp(1j * np.diff(phases)))
    assert np.degrees(lags) == pytest.approx(math.degrees(GAIT.phase_shift), abs=1.0)
