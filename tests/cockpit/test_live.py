import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cockpit import Live, Setting
from laticauda.cockpit.live import MOST_TICKS
from laticauda.cockpit.settings import with_fin
from laticauda.cockpit.world import TICK
from laticauda.control import StraightLine
from laticauda.logs import load_trial
from laticauda.paper.measured import efficiency_trials

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)


@pytest.fixture
def live():
    return Live(Setting(robot=lc.load_robot("mamba"), gait=GAIT))


def swum(live, duration):
    for _ in range(round(duration / 0.05)):
        live.advance(0.05)
    return live


def test_the_live_robot_swims_as_swim_says(live):
    swum(live, 30.0)
    trial = lc.swim(live.setting.robot, GAIT, 30.0, environment=live.setting.environment)
    assert live.numbers().time == pytest.approx(30.0)
    assert live.numbers().forward_velocity == pytest.approx(trial.forward_velocity, rel=1e-6)
    assert live.numbers().mean_power == pytest.approx(trial.mean_power, rel=1e-4)
    assert live.numbers().cost_of_transport == pytest.approx(trial.cost_of_transport, rel=1e-4)


def test_time_goes_as_fast_as_asked_for(live):
    live.speed = 4.0
    for _ in range(10):
        live.advance(0.05)
    assert live.world.time == pytest.approx(2.0)


def test_time_that_was_not_used_up_is_kept(live):
    for _ in range(100):
        live.advance(0.4 * TICK)
    assert live.world.ticks == 40


def test_a_paused_world_stands_still(live):
    live.paused = True
    before = live.latest()
    assert live.advance(1.0) == 0
    np.testing.assert_array_equal(live.latest()["joint_angle"], before["joint_angle"])


def test_a_clock_that_stood_still_is_not_caught_up_with(live):
    assert live.advance(100.0) == MOST_TICKS
    assert live.lag == pytest.approx(100.0 - MOST_TICKS * TICK)


@pytest.mark.parametrize("speed", [0.0, 9.0, math.nan])
def test_a_speed_of_time_out_of_range_is_refused(live, speed):
    with pytest.raises(ValueError, match="`speed` must be"):
        live.speed = speed


def test_another_gait_is_taken_up_without_a_jump(live):
    swum(live, 5.0)
    before = live.latest()
    live.alter(gait=replace(GAIT, amplitude=0.8, frequency=1.0, phase_shift=0.3, offset=0.1))
    np.testing.assert_allclose(live.latest()["joint_angle"], before["joint_angle"], atol=1e-9)
    live.advance(TICK)
    assert np.abs(live.latest()["joint_angle"] - before["joint_angle"]).max() < 0.1


def test_another_kind_of_gait_is_taken_up_once_the_joints_are_straight(live):
    swum(live, 5.0)
    live.alter(gait=replace(GAIT, kind="eel_like"))
    angles = []
    for _ in range(160):
        live.advance(TICK)
        angles.append(live.latest()["joint_angle"])
    steps = np.abs(np.diff(angles, axis=0)).max(axis=1)
    assert steps.max() < 0.12  # [rad], in 25 ms: what the old gait does anyway
    assert live.world.shape.kind == "eel_like"
    assert np.abs(angles[-40:]).max(axis=0)[0] > 2.0 * np.abs(angles[-40:]).max(axis=0)[-1]


@pytest.mark.parametrize(
    "change",
    [
        {"joints": "pd"},
        {"joints": "servo"},
        {"current": (0.1, -0.05)},
        {"robot": with_fin(lc.load_robot("mamba"), True, None)},
        {"robot": with_fin(lc.load_robot("mamba"), True, 0.2)},
        {"robot": lc.load_robot("mamba-modules")},
        {"robot": lc.load_robot("chain")},
    ],
)
def test_another_body_goes_on_at_the_same_place_and_heading(live, change):
    swum(live, 5.0)
    before = live.latest()
    live.alter(**change)
    after = live.latest()
    np.testing.assert_allclose(after["center_of_mass"], before["center_of_mass"], atol=1e-12)
    assert after["heading"] == pytest.approx(before["heading"], abs=1e-12)
    swum(live, 1.0)
    assert live.world.failure is None


def test_the_spatial_model_takes_over_where_the_planar_one_was(live):
    pytest.importorskip("mujoco")
    swum(live, 5.0)
    before = live.latest()
    live.alter(model="spatial")
    np.testing.assert_allclose(live.latest()["center_of_mass"][:2], before["center_of_mass"], atol=1e-9)
    assert live.latest()["heading"] == pytest.approx(before["heading"], abs=1e-9)
    swum(live, 1.0)
    live.alter(model="planar")
    assert live.world.failure is None


def test_a_current_carries_the_robot(live):
    live.alter(gait=replace(GAIT, amplitude=0.0), current=(0.2, 0.0))
    swum(live, 20.0)
    assert live.latest()["center_of_mass_velocity"][0] == pytest.approx(0.2, rel=0.15)


def test_following_a_path_brings_the_error_down(live):
    swum(live, 2.0)
    live.alter(path=StraightLine(point=(0.0, -0.6)))
    first = abs(live.numbers().cross_track_error)
    swum(live, 40.0)
    assert first > 0.4
    assert abs(live.numbers().cross_track_error) < 0.15


def test_what_does_not_go_together_is_refused_and_nothing_changes(live):
    swum(live, 1.0)
    live.alter(path=StraightLine())
    before = live.world
    with pytest.raises(ValueError, match=r"`max_offset` must be <= 0\.0708 rad"):
        live.alter(gait=replace(GAIT, amplitude=1.5))
    with pytest.raises(ValueError, match="`joints` must be one of"):
        live.alter(joints="loose")
    with pytest.raises(ValueError, match=r"`flexural_rigidity` must be > 0 N m\^2, got -1"):
        with_fin(live.setting.robot, True, -1.0)
    assert live.world is before


def test_the_run_since_the_last_change_is_saved_whole(live, tmp_path):
    swum(live, 3.0)
    live.alter(current=(0.05, 0.0))
    with pytest.raises(ValueError, match="no run to save yet"):
        live.trial()
    swum(live, 4.0)
    trial = live.trial()
    assert trial.duration == pytest.approx(4.0, abs=0.051)
    assert trial.environment.current == (0.05, 0.0)
    assert trial.forward_velocity == pytest.approx(live.numbers().forward_velocity)
    trial.save(tmp_path / "run.nc")
    assert load_trial(tmp_path / "run.nc").equals(trial)


def test_reset_begins_anew_with_the_present_setting(live):
    swum(live, 3.0)
    live.alter(joints="pd")
    live.reset()
    assert live.world.time == 0.0
    assert live.setting.joints == "pd"
    np.testing.assert_array_equal(live.latest()["center_of_mass"], (0.0, 0.0))
    assert live.plots() == {}


def test_link_forces_come_on_request(live):
    live.advance(0.05)
    assert not [name for name in live.latest() if name.startswith("force_")]
    live.link_forces = True
    live.advance(0.05)
    assert live.latest()["force_drag"].shape == (9, 2)


def test_the_paper_stands_beside_its_own_settings_only(live):
    assert live.setting.measured().forward_velocity == 0.1514
    assert replace(live.setting, robot=with_fin(live.setting.robot, True, None)).measured().has_fin
    for change in (
        {"current": (0.1, 0.0)},
        {"path": StraightLine()},
        {"gait": replace(GAIT, amplitude=0.51)},
        {"robot": with_fin(live.setting.robot, True, 0.2)},
        {"robot": lc.load_robot("mamba-thruster")},
    ):
        assert replace(live.setting, **change).measured() is None


@pytest.mark.parametrize("case", efficiency_trials())
def test_every_trial_of_the_paper_is_known_when_its_sliders_are_set(case):
    robot = lc.load_robot("mamba-fin" if case.has_fin else "mamba")
    shown = {
        name: round(math.degrees(getattr(case.gait, name)), 9) for name in ("amplitude", "frequency", "phase_shift")
    }
    gait = replace(case.gait, **{name: math.radians(value) for name, value in shown.items()})
    assert Setting(robot=robot, gait=gait).measured() == case
    assert Setting(robot=robot, gait=replace(gait, offset=0.1)).measured() is None
    assert Setting(robot=robot, gait=gait, current=(0.1, 0.0)).measured() is None
