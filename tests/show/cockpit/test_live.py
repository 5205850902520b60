import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import StraightLine
from laticauda.motion.gaits import EelLike
from laticauda.motion.joints.laws import PD
from laticauda.paper.measured import read_efficiency_trials
from laticauda.scenarios import Experiment
from laticauda.show.cockpit import Live, read_figures
from laticauda.show.cockpit.buffer import RingBuffer
from laticauda.show.cockpit.changes import adapt_scenario, change_fin, find_measured
from laticauda.show.cockpit.live import MOST_TICKS
from laticauda.show.cockpit.simulation import TICK
from laticauda.trials.logs import load_trial

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)


@pytest.fixture
def live():
    return Live(lc.build_scenario("mamba", GAIT))


def swum(live, duration):
    for _ in range(round(duration / 0.05)):
        live.advance(0.05)
    return live


def test_the_live_robot_swims_as_swim_says(live):
    swum(live, 30.0)
    trial = lc.swim(live.scenario.robot, GAIT, 30.0, environment=live.scenario.environment)
    assert read_figures(live)["time"] == pytest.approx(30.0)
    assert read_figures(live)["forward_velocity"] == pytest.approx(trial.forward_velocity, rel=1e-6)
    assert read_figures(live)["mean_power"] == pytest.approx(trial.mean_power, rel=1e-4)
    assert read_figures(live)["cost_of_transport"] == pytest.approx(
        trial.cost_of_transport, rel=1e-4
    )


def test_time_goes_as_fast_as_asked_for(live):
    live.speed = 4.0
    for _ in range(10):
        live.advance(0.05)
    assert live.simulation.time == pytest.approx(2.0)


def test_time_that_was_not_used_up_is_kept(live):
    for _ in range(100):
        live.advance(0.4 * TICK)
    assert live.simulation.ticks == 40


def test_a_paused_world_stands_still(live):
    live.paused = True
    before = live.latest()
    assert live.advance(1.0) == 0
    np.testing.assert_array_equal(live.latest().joint_angle, before.joint_angle)


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
    np.testing.assert_allclose(live.latest().joint_angle, before.joint_angle, atol=1e-9)
    live.advance(TICK)
    assert np.abs(live.latest().joint_angle - before.joint_angle).max() < 0.1


def test_another_kind_of_gait_is_taken_up_once_the_joints_are_straight(live):
    swum(live, 5.0)
    live.alter(gait=replace(GAIT, envelope=EelLike()))
    angles = []
    for _ in range(160):
        live.advance(TICK)
        angles.append(live.latest().joint_angle)
    steps = np.abs(np.diff(angles, axis=0)).max(axis=1)
    assert steps.max() < 0.12  # [rad], in 25 ms: what the old gait does anyway
    assert live.simulation.envelope_gait.kind == "eel_like"
    assert np.abs(angles[-40:]).max(axis=0)[0] > 2.0 * np.abs(angles[-40:]).max(axis=0)[-1]


@pytest.mark.parametrize(
    "change",
    [
        {"joints": "pd"},
        {"joints": "servo"},
        {"current": (0.1, -0.05)},
        {"robot": change_fin(lc.load_robot("mamba"), True, None)},
        {"robot": change_fin(lc.load_robot("mamba"), True, 0.2)},
        {"robot": lc.load_robot("mamba-modules")},
        {"robot": lc.load_robot("chain")},
    ],
)
def test_another_body_goes_on_at_the_same_place_and_heading(live, change):
    swum(live, 5.0)
    before = live.latest()
    live.alter(**change)
    after = live.latest()
    np.testing.assert_allclose(after.center_of_mass, before.center_of_mass, atol=1e-12)
    assert after.heading == pytest.approx(before.heading, abs=1e-12)
    swum(live, 1.0)
    assert live.simulation.failure is None


def test_the_spatial_model_takes_over_where_the_planar_one_was(live):
    pytest.importorskip("mujoco")
    swum(live, 5.0)
    before = live.latest()
    live.alter(model="spatial")
    np.testing.assert_allclose(live.latest().center_of_mass[:2], before.center_of_mass, atol=1e-9)
    assert live.latest().heading == pytest.approx(before.heading, abs=1e-9)
    swum(live, 1.0)
    live.alter(model="planar")
    assert live.simulation.failure is None


def test_a_current_carries_the_robot(live):
    live.alter(gait=replace(GAIT, amplitude=0.0), current=(0.2, 0.0))
    swum(live, 20.0)
    assert live.latest().center_of_mass_velocity[0] == pytest.approx(0.2, rel=0.15)


def test_following_a_path_brings_the_error_down(live):
    swum(live, 2.0)
    live.alter(path=StraightLine(point=(0.0, -0.6)))
    first = abs(read_figures(live)["cross_track_error"])
    swum(live, 40.0)
    assert first > 0.4
    assert abs(read_figures(live)["cross_track_error"]) < 0.15


def test_what_does_not_go_together_is_refused_and_nothing_changes(live):
    swum(live, 1.0)
    live.alter(path=StraightLine())
    before = live.simulation
    with pytest.raises(ValueError, match=r"`max_offset` must be <= 0\.0708 rad"):
        live.alter(gait=replace(GAIT, amplitude=1.5))
    with pytest.raises(ValueError, match="`joints` must be one of"):
        live.alter(joints="loose")
    with pytest.raises(ValueError, match=r"`flexural_rigidity` must be > 0 N m\^2, got -1"):
        change_fin(live.scenario.robot, True, -1.0)
    assert live.simulation is before


def test_the_run_since_the_last_change_is_saved_whole(live, tmp_path):
    swum(live, 3.0)
    live.alter(current=(0.05, 0.0))
    with pytest.raises(ValueError, match="no run to save yet"):
        live.trial()
    swum(live, 4.0)
    trial = live.trial()
    assert trial.duration == pytest.approx(4.0, abs=0.051)
    assert trial.environment.current == (0.05, 0.0)
    assert trial.forward_velocity == pytest.approx(read_figures(live)["forward_velocity"])
    trial.save(tmp_path / "run.nc")
    assert load_trial(tmp_path / "run.nc").equals(trial)


@pytest.mark.parametrize(
    "change", [{}, {"path": StraightLine(point=(0.0, -0.6))}, {"joints": "servo"}]
)
def test_a_run_in_which_nothing_was_changed_can_be_run_again(live, change, tmp_path):
    live.alter(**change)  # before anything has happened, which is no change
    for _ in range(203):
        live.advance(TICK)
    live.trial().save(tmp_path / "run.nc")
    trial = load_trial(tmp_path / "run.nc")
    again = lc.swim(trial.scenario)
    assert trial.time.size == again.time.size >= 204
    for name, values in again.series().items():
        np.testing.assert_allclose(
            trial.series()[name], values, rtol=1e-12, atol=1e-12, err_msg=name
        )
    live.alter(current=(0.1, 0.0))
    live.advance(1.0)
    assert isinstance(live.trial().scenario, Experiment)


def test_a_run_that_began_before_what_is_kept_of_it_cannot_be_run_again(live):
    live._record = RingBuffer(10)
    swum(live, 1.0)
    assert live.trial().time.size == 11
    assert isinstance(live.trial().scenario, Experiment)


def test_reset_begins_anew_with_the_present_scenario(live):
    swum(live, 3.0)
    live.alter(joints="pd")
    live.reset()
    assert live.simulation.time == 0.0
    assert live.scenario.model.joints == PD()
    np.testing.assert_array_equal(live.latest().center_of_mass, (0.0, 0.0))
    assert live.plots() == {}


def test_link_forces_come_on_request(live):
    live.advance(0.05)
    assert live.latest().link_force is None
    live.link_forces = True
    live.advance(0.05)
    assert live.latest().link_force["drag"].shape == (9, 2)


def test_the_paper_stands_beside_its_own_trials_only(live):
    assert find_measured(live.scenario).forward_velocity == 0.1514
    assert find_measured(
        adapt_scenario(live.scenario, robot=change_fin(live.scenario.robot, True, None))
    ).has_fin
    for change in (
        {"current": (0.1, 0.0)},
        {"path": StraightLine()},
        {"gait": replace(GAIT, amplitude=0.51)},
        {"robot": change_fin(live.scenario.robot, True, 0.2)},
        {"robot": lc.load_robot("mamba-thruster")},
    ):
        assert find_measured(adapt_scenario(live.scenario, **change)) is None


@pytest.mark.parametrize("case", read_efficiency_trials())
def test_every_trial_of_the_paper_is_known_when_its_sliders_are_set(case):
    robot = lc.load_robot("mamba-fin" if case.has_fin else "mamba")
    shown = {
        name: round(math.degrees(getattr(case.gait, name)), 9)
        for name in ("amplitude", "frequency", "phase_shift")
    }
    gait = replace(case.gait, **{name: math.radians(value) for name, value in shown.items()})
    assert find_measured(lc.build_scenario(robot, gait)) == case
    assert find_measured(lc.build_scenario(robot, replace(gait, offset=0.1))) is None
    assert find_measured(adapt_scenario(lc.build_scenario(robot, gait), current=(0.1, 0.0))) is None


def test_what_is_plotted_step_by_step_ends_with_the_newest_sample(live):
    for n_ticks in (1, 6, 9):
        live.advance(n_ticks * TICK)
        whole, stepped = live.plots(), live.plots(step=4)
        assert whole["time"][-1] == pytest.approx(live.simulation.time)
        for name, column in whole.items():
            np.testing.assert_array_equal(stepped[name], column[::-4][::-1])


def test_no_more_is_kept_than_there_is_room_for_and_that_is_the_newest():
    ring = RingBuffer(3)
    for k in range(11):
        ring.append({"time": float(k), "place": np.array([k, -k])})
        expected = list(range(max(k - 2, 0), k + 1))
        assert ring.last()["time"].tolist() == expected
        assert ring.last()["place"][:, 0].tolist() == expected
        assert ring.last(2)["time"].tolist() == expected[::-2][::-1]
    ring.clear()
    assert ring.last() == {}


def test_the_paper_s_water_goes_along_with_the_kind_of_gait_and_another_stays():
    eel = replace(GAIT, envelope=EelLike())
    drifting = adapt_scenario(lc.build_scenario("mamba", GAIT), current=(0.1, 0.0))
    assert adapt_scenario(drifting, gait=eel).environment == replace(
        lc.load_water("paper-eel"), current=(0.1, 0.0)
    )
    own = replace(lc.load_water("paper-lateral"), normal_drag=1.4)
    assert (
        adapt_scenario(lc.build_scenario("mamba", GAIT, environment=own), gait=eel).environment
        == own
    )


def test_what_a_page_cannot_show_is_refused():
    with pytest.raises(ValueError, match="`environment` must be of class Water"):
        Live(lc.build_scenario("mamba", GAIT, environment=lc.load_ground("coulomb")))
    with pytest.raises(ValueError, match="`motion` must be of class Gait or PathFollowing"):
        Live(lc.build_scenario("mamba", lc.OpenLoop(command=lc.Command(gait=GAIT))))
