"""The delay of the loop: what a controller computes from what it sees acts later, in single runs and in batches."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.control import Following
from laticauda.models.planar.school import School

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
PAPER = Following().controller(GAIT)
START = lc.Start(center_of_mass=(0.0, 0.6), heading=0.1)
ROBOTS = ("mamba-fin", "mamba-modules")


@dataclass(frozen=True)
class Late(lc.Controller):
    """Hands a controller's commands on some control instants later: written by hand, for comparison."""

    inner: Any
    instants: int

    @property
    def gait(self):
        return self.inner.gait

    @property
    def interval(self):
        return self.inner.interval

    def init(self):
        return self.inner.init(), (lc.Command(gait=self.gait),) * self.instants

    def step(self, state, observation):
        inner, command = self.inner.step(state[0], observation)
        line = (*state[1], command)
        return (inner, line[1:]), line[0]

    def signals(self, state):
        return self.inner.signals(state[0])


@dataclass(frozen=True)
class Ramp(lc.Controller):
    """Asks for an offset that grows with every control instant."""

    gait: lc.Gait = GAIT
    interval: float = 0.2

    def init(self):
        return 0

    def step(self, state, observation):
        return state + 1, lc.Command(gait=self.gait, offset=0.02 * (state + 1))


def run(delay, controller=PAPER, duration=6.0, robot="mamba-fin", **choices):
    plant = lc.build_plant(
        lc.load_robot(robot), lc.load_water("paper-lateral"), loop_delay=delay, **choices
    )
    return lc.run(plant, controller, duration, start=START)


def same(one, other):
    for name in ("time", "center_of_mass", "heading", "joint_angle", "joint_torque", "work"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    for name in one.signals:
        np.testing.assert_array_equal(one.signals[name], other.signals[name])


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("instants", [0, 1, 9])
def test_a_delay_of_whole_control_intervals_is_a_controller_that_hands_its_commands_on_later(
    robot, instants
):
    same(run(instants * PAPER.interval, robot=robot), run(0.0, Late(PAPER, instants), robot=robot))


def test_the_model_in_space_has_the_same_delay():
    pytest.importorskip("mujoco")
    how = {"model": "spatial", "root": "planar", "duration": 2.0}
    same(run(0.1, **how), run(0.0, Late(PAPER, 2), **how))


@settings(max_examples=10)
@given(delay=st.floats(0.0, 0.7))
def test_any_delay_begins_to_act_when_it_is_over(delay):
    trial = run(delay, Ramp(), 2.0, joints="servo", offset_bandwidth=1e6)
    straight = run(0.0, lc.OpenLoop(command=lc.Command(gait=GAIT)), 2.0, joints="servo")
    bent = np.abs(trial.joint_angle_ref - straight.joint_angle_ref)
    np.testing.assert_allclose(trial.time, np.linspace(0.0, 2.0, 41), atol=1e-9)
    told = np.floor((trial.time - delay) / 0.2 + 1e-6) + 1.0
    at_turn = np.abs((trial.time - delay) / 0.2 - np.rint((trial.time - delay) / 0.2)) < 0.05
    expected = 0.02 * np.clip(told, 0.0, 10.0)
    np.testing.assert_allclose(bent.max(axis=1)[~at_turn], expected[~at_turn], atol=1e-9)


@pytest.mark.parametrize("delay", [0.07, 0.2, 0.33])
def test_finer_samples_see_the_same_run(delay):
    plant = lc.build_plant(
        lc.load_robot("mamba"), lc.load_water("paper-lateral"), loop_delay=delay, dt=0.01
    )
    coarse, fine = (
        lc.run(plant, PAPER, 4.0, start=START, sample_interval=one) for one in (0.05, 0.01)
    )
    np.testing.assert_allclose(fine.center_of_mass[::5], coarse.center_of_mass, atol=1e-6)
    assert fine.signals["offset"].size == fine.time.size == 401


@pytest.mark.parametrize("delay", [0.0, 0.2, 0.5, 0.73])
@pytest.mark.parametrize("n", [1, 3])
def test_a_robot_of_a_school_does_what_it_does_alone(delay, n):
    plant = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"), loop_delay=delay)
    school = School(plant, lc.Command(gait=GAIT), n, 0.2)
    where, heading = np.tile(START.center_of_mass, (n, 1)), np.full(n, START.heading)

    def begin():
        school.place(np.arange(n), center_of_mass=where, heading=heading, current=np.zeros((n, 2)))

    def swim():
        for i in range(10):
            school.tell({"offset": np.full(n, 0.02 * (i + 1))})
            school.march()
        return [school.observe(lane).center_of_mass for lane in range(n)]

    alone = lc.run(plant, Ramp(), 2.0, start=START, sample_interval=0.2).center_of_mass[-1]
    begin()
    for found in swim():
        np.testing.assert_allclose(
            found, alone, rtol=0.0, atol=0.0 if delay in (0.0, 0.2) else 1e-7
        )
    # Steps are cut where a command arrives; a run alone has none to cut before the first one does.
    begin()  # what is on its way belongs to the episode before
    np.testing.assert_allclose(swim()[0], alone, rtol=0.0, atol=1e-7)


def test_what_looks_at_nothing_is_not_late_and_a_batch_is_that_of_single_runs():
    late, soon = (
        lc.build_scenario("mamba", replace(GAIT, offset=0.1), 3.0, loop_delay=delay)
        for delay in (0.4, 0.0)
    )
    same(lc.swim(late), lc.swim(soon))
    together, alone = lc.swim_many([late]).forward_velocity[0], lc.swim(soon).forward_velocity
    assert together == pytest.approx(alone, rel=1e-12)  # lanes round otherwise


def test_a_run_whose_commands_are_on_their_way_does_not_go_on():
    plant = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"), loop_delay=0.3)
    followed, swum = (
        lc.run(plant, PAPER, 1.0),
        lc.run(plant, lc.OpenLoop(command=lc.Command(gait=GAIT)), 1.0),
    )
    for trial, controller in ((followed, None), (followed, PAPER), (swum, PAPER)):
        with pytest.raises(
            ValueError,
            match=r"`loop_delay` must be 0 to continue from the end of a trial.* got 0\.3",
        ):
            lc.resume(plant, trial, 1.0, controller=controller)
    assert lc.resume(plant, swum, 1.0).succeeded


def test_a_trial_says_its_delay_and_can_be_run_again(tmp_path):
    scenario = lc.build_scenario("mamba", PAPER, 2.0, loop_delay=0.12, start=START)
    trial = lc.swim(scenario)
    trial.save(tmp_path / "late.nc")
    kept = lc.load_trial(tmp_path / "late.nc")
    assert kept.settings["loop_delay"] == 0.12
    same(lc.swim(kept.scenario), trial)


def test_without_a_filter_the_reference_jumps_and_a_servo_follows():
    trial = run(0.0, Ramp(interval=1.0), 3.0, joints="servo", offset_bandwidth=1e6, ramp=0.0)
    assert trial.succeeded
    filtered = run(0.0, Ramp(interval=1.0), 3.0, joints="servo", offset_bandwidth=1e4, ramp=0.0)
    np.testing.assert_allclose(trial.center_of_mass, filtered.center_of_mass, atol=1e-5)


@pytest.mark.parametrize("joints", ["prescribed", "pd"])
def test_joints_that_look_at_the_references_rate_need_the_filter(joints):
    message = r"`offset_bandwidth` must be < 1e\+06 1/s, unless the joint law takes references that jump.*got 1e\+06"
    with pytest.raises(ValueError, match=message):
        lc.Planar(joints=lc.PD() if joints == "pd" else lc.Prescribed(), offset_bandwidth=1e6)
    assert lc.Planar(joints=lc.SpeedServo(), offset_bandwidth=1e6).offset_bandwidth == 1e6


def test_a_negative_delay_is_refused():
    with pytest.raises(ValueError, match=r"`loop_delay` must be >= 0 s, got -0\.1"):
        lc.Planar(loop_delay=-0.1)
