"""The wake of a trial's robot: its numbers are the robot's, in Python and in files."""

import re
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import Posture
from laticauda.trials import WakeOfTrial, measure_wake, metrics
from laticauda.trials.wake import tail_height

GAIT = lc.Gait(amplitude_deg=30, frequency_deg_s=120, phase_shift_deg=40)


@pytest.fixture(scope="module")
def leader():
    return lc.swim("mamba", GAIT, 30.0, parameters="mamba-identified")


@pytest.fixture(scope="module")
def leader_file(leader, tmp_path_factory):
    path = tmp_path_factory.mktemp("leader") / "leader.nc"
    leader.save(path)
    return path


def test_the_numbers_of_a_wake_are_those_of_the_run(leader):
    wake = measure_wake(leader)
    assert wake.speed == pytest.approx(leader.steady_velocity, rel=2e-3)
    assert wake.period == pytest.approx(leader.period)
    assert wake.direction == pytest.approx(leader.course, abs=0.01)
    assert wake.width / (wake.period * wake.speed) == pytest.approx(
        leader.strouhal_number, rel=0.02
    )


def test_a_wake_carries_the_drag_of_the_straight_robot_or_the_thrust_that_is_stated(leader):
    wake = measure_wake(leader)
    force_per_flux = leader.environment.density * tail_height(leader.chain)
    drag = metrics.towing_drag(leader.chain, leader.environment, wake.speed)
    assert wake.momentum_flux * force_per_flux == pytest.approx(drag, rel=1e-9)
    pushed = measure_wake(leader, thrust=3.0 * drag, span=2.0 * tail_height(leader.chain))
    assert pushed.momentum_flux == pytest.approx(1.5 * wake.momentum_flux, rel=1e-9)


def test_the_tail_of_the_wake_beats_as_that_of_the_robot_did(leader):
    wake = measure_wake(leader)
    posture = Posture(
        leader.chain, leader.center_of_mass, leader.link_angle, fin_angle=leader.fin_angle
    )
    is_last = leader.time > leader.time[-1] - wake.period
    t = leader.time[is_last] - leader.time[-1]
    heading = np.array([np.cos(wake.direction), np.sin(wake.direction)])
    to_the_left = np.array([-heading[1], heading[0]])
    beat = 0.5 * wake.width * np.sin(2.0 * np.pi * t / wake.period + wake.phase)
    place = np.array([wake.x, wake.y]) + wake.speed * t[:, np.newaxis] * heading
    place += beat[:, np.newaxis] * to_the_left
    missed = np.linalg.norm(posture.trailing_edge[is_last] - place, axis=1)
    assert np.max(missed) < 0.15 * wake.width


def test_in_a_current_the_robot_leaves_the_same_wake_and_the_water_carries_it(leader):
    water = replace(leader.environment, current=(0.05, 0.0))
    carried = lc.swim(replace(leader.scenario, environment=water, start=lc.Start(velocity=0.05)))
    wake, still = measure_wake(carried), measure_wake(leader)
    assert wake.mean == (0.05, 0.0, 0.0)
    assert wake.circulation == pytest.approx(still.circulation, rel=0.02)


def test_a_wake_in_a_file_is_a_trial_and_changes_of_place_and_phase(leader, leader_file, tmp_path):
    (tmp_path / "behind.toml").write_text(
        f'kind = "wake-of-trial"\nsource = "{leader_file}"\nx = 1.5\ny = 0.2\nphase_deg = 90\n',
        encoding="utf-8",
    )
    flow = lc.load_current(tmp_path / "behind.toml")
    assert isinstance(flow, WakeOfTrial)
    expected = replace(measure_wake(leader), x=1.5, y=0.2, phase=0.5 * np.pi)
    assert flow.wake == expected
    assert flow.motion(0.5, 0.1, 0.0, 2.0) == expected.motion(0.5, 0.1, 0.0, 2.0)


def test_a_run_in_the_wake_of_a_file_keeps_it_and_a_changed_file_is_refused(leader_file, tmp_path):
    flow = WakeOfTrial(source=str(leader_file), x=1.5)
    scenario = lc.build_scenario("mamba", GAIT, 1.0, current=flow)
    lc.save_scenario(scenario, tmp_path / "follower.toml")
    kept = lc.load_scenario(tmp_path / "follower.toml").environment.current
    assert kept == flow
    assert re.fullmatch("[0-9a-f]{16}", kept.digest)
    with pytest.raises(ValueError, match=r"`digest` must match .* which has changed since, got 12"):
        replace(flow, digest="12")


def test_a_leader_that_turns_or_swims_in_waves_is_refused(leader):
    curved = lc.swim("mamba", replace(GAIT, offset=0.1), 30.0, environment=leader.environment)
    with pytest.raises(
        ValueError, match=r"`trial` must be straight for a wake: within 20 deg in 8 cycles, got \d+"
    ):
        measure_wake(curved)
    swell = replace(leader.environment, current=lc.load_current("swell"))
    scenario = replace(leader.scenario, environment=swell)
    with pytest.raises(
        ValueError, match="`environment` must be still or uniform water for a wake, got another one"
    ):
        measure_wake(replace(leader, scenario=scenario))


@pytest.mark.parametrize("gait", [replace(GAIT, amplitude=0.0), replace(GAIT, phase_shift=0.0)])
def test_a_leader_that_stays_where_it_is_leaves_no_wake(leader, gait):
    staying = lc.swim("mamba", gait, 20.0, environment=leader.environment)
    with pytest.raises(
        ValueError, match=r"`trial` must advance for a wake: by [\d.]+ m in a cycle, got [\d.e-]+ m"
    ):
        measure_wake(staying)


def test_a_file_whose_robot_left_no_wake_is_named(tmp_path):
    path = tmp_path / "short.nc"
    lc.swim("mamba", GAIT, 5.0).save(path)
    with pytest.raises(
        ValueError, match=r"short.nc: its robot left no wake: `time` must span at least 13 s"
    ):
        _ = WakeOfTrial(source=str(path)).wake
