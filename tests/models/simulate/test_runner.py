from dataclasses import dataclass, replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate import timeline
from laticauda.robot import load_robot, load_water
from laticauda.scenarios import Experiment

GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)


@dataclass(frozen=True)
class TurnAfter(lc.Controller):
    """Counts its control instants, and turns left after some of them."""

    gait: lc.Gait
    interval: float
    instants: int

    def init(self):
        return ()

    def step(self, state, observation):
        seen = (*state, observation.time)
        return seen, lc.Command(gait=self.gait, offset=0.1 if len(seen) > self.instants else 0.0)


def run(controller, **choices):
    return lc.run(
        lc.build_plant(load_robot("mamba"), load_water("paper-lateral")),
        controller,
        10.0,
        **choices,
    )


def test_a_controller_is_asked_at_every_control_instant():
    asked = []

    @dataclass(frozen=True)
    class Spy(TurnAfter):
        def step(self, state, observation):
            asked.append(observation.time)
            return super().step(state, observation)

    run(Spy(GAIT, 0.1, 1000))
    np.testing.assert_allclose(asked, np.arange(100) * 0.1, atol=1e-12)


def test_a_controller_that_never_changes_its_mind_is_the_open_loop():
    closed, free = run(TurnAfter(GAIT, 0.1, 1000)), run(lc.OpenLoop(command=lc.Command(gait=GAIT)))
    np.testing.assert_allclose(closed.time, free.time, atol=1e-12)
    np.testing.assert_allclose(closed.center_of_mass, free.center_of_mass, atol=1e-9)


def test_a_controller_can_steer():
    turned, straight = run(TurnAfter(GAIT, 0.1, 20)), run(TurnAfter(GAIT, 0.1, 1000))
    assert turned.heading[-1] > straight.heading[-1] + 0.3


@dataclass(frozen=True)
class Counting(TurnAfter):
    """Reports how often it was asked; too wide for a robot of two links."""

    def signals(self, state):
        return {"asked": float(len(state))}

    def check(self, robot):
        if robot.n_links < 3:
            raise ValueError("`robot` must have 3 links.")


def test_signals_are_held_from_one_control_instant_to_the_next():
    trial = run(Counting(GAIT, 0.5, 1000), sample_interval=0.1)
    expected = np.minimum(np.floor(trial.time / 0.5 + 1e-9) + 1, 20)
    np.testing.assert_array_equal(trial.signals["asked"], expected)
    assert run(Counting(GAIT, np.inf, 1000)).signals["asked"].tolist() == [1.0] * 201


def test_the_trial_keeps_its_controller():
    trial = run(Counting(GAIT, 5.0, 1000))
    assert trial.scenario.motion == Counting(GAIT, 5.0, 1000)
    assert run(TurnAfter(GAIT, 5.0, 1000)).signals == {}


def test_a_failed_run_keeps_its_signals():
    plant = lc.build_plant(load_robot("mamba"), load_water("paper-lateral"), joints="pd", dt=0.5)
    trial = lc.run(plant, Counting(GAIT, 1.0, 0), 10.0, sample_interval=0.5)
    assert not trial.succeeded
    assert trial.signals["asked"].size == trial.time.size


def test_a_controller_can_refuse_a_robot():
    plant = lc.build_plant(load_robot("mamba", n_links=2), load_water("paper-lateral"))
    with pytest.raises(ValueError, match="`robot` must have 3 links"):
        lc.run(plant, Counting(GAIT, 1.0, 0), 1.0)


def test_what_a_controller_commands_is_a_command():
    @dataclass(frozen=True)
    class Swapped(TurnAfter):
        def step(self, state, observation):
            return super().step(state, observation)[::-1]

    with pytest.raises(ValueError, match="`command` must be of class Command, got tuple"):
        run(Swapped(GAIT, 5.0, 0))


def test_progress_is_told_on_the_way_and_at_the_end(monkeypatch):
    monkeypatch.setattr(timeline, "LONGEST_SPAN", 50)
    told = []
    lc.swim(load_robot("mamba"), GAIT, duration=10.0, progress=told.append)
    assert told == pytest.approx([2.5, 5.0, 7.5, 10.0])


def test_a_run_in_chunks_is_the_same_run(monkeypatch):
    whole = lc.swim(load_robot("mamba"), GAIT, duration=10.0)
    monkeypatch.setattr(timeline, "LONGEST_SPAN", 50)
    chunks = lc.swim(load_robot("mamba"), GAIT, duration=10.0)
    np.testing.assert_array_equal(chunks.center_of_mass, whole.center_of_mass)


@pytest.mark.parametrize(("interval", "instants"), [(5.0, [0.0, 5.0]), (np.inf, [0.0])])
def test_nobody_decides_at_the_seams_of_a_run_in_chunks(monkeypatch, interval, instants):
    whole = run(Counting(GAIT, interval, 1))
    monkeypatch.setattr(timeline, "LONGEST_SPAN", 50)
    asked = []

    @dataclass(frozen=True)
    class Spy(Counting):
        def step(self, state, observation):
            asked.append(observation.time)
            return super().step(state, observation)

    trial = run(Spy(GAIT, interval, 1))
    assert asked == pytest.approx(instants)
    np.testing.assert_array_equal(trial.signals["asked"], whole.signals["asked"])
    np.testing.assert_array_equal(trial.center_of_mass, whole.center_of_mass)


def test_a_run_in_chunks_may_only_end_at_a_control_instant(monkeypatch):
    monkeypatch.setattr(timeline, "LONGEST_SPAN", 50)
    assert run(TurnAfter(GAIT, np.inf, 1000), until=lambda seen: True).time[-1] == 10.0
    cut = run(TurnAfter(GAIT, 5.0, 1000), until=lambda seen: True)
    assert cut.scenario.duration == cut.time[-1] == 5.0


@pytest.mark.parametrize("delay", [1.2, 3.2])
def test_a_late_command_acts_once_in_a_run_in_chunks(monkeypatch, delay):
    plant = lc.build_plant(load_robot("mamba"), load_water("paper-lateral"), loop_delay=delay)
    whole = lc.run(plant, TurnAfter(GAIT, 5.0, 1), 15.0)
    monkeypatch.setattr(timeline, "LONGEST_SPAN", 50)
    chunks = lc.run(plant, TurnAfter(GAIT, 5.0, 1), 15.0)
    np.testing.assert_allclose(chunks.time, whole.time, atol=1e-12)
    np.testing.assert_allclose(chunks.center_of_mass, whole.center_of_mass, atol=1e-12)


def test_a_trial_without_a_gait_needs_a_controller_to_go_on():
    trial = lc.swim(load_robot("mamba"), GAIT, duration=1.0)
    unknown = Experiment(robot=trial.robot, environment=trial.environment)
    trial = replace(trial, scenario=unknown)
    with pytest.raises(
        ValueError, match="`controller` must be given to continue a trial that has no gait"
    ):
        lc.resume(lc.build_plant(load_robot("mamba"), trial.environment), trial, 1.0)
    with pytest.raises(ValueError, match="`trial` must be of class Trial, got str"):
        lc.resume(lc.build_plant(load_robot("mamba"), trial.environment), "run.nc", 1.0)


def test_a_run_is_over_where_until_says_so():
    whole = run(TurnAfter(GAIT, 0.1, 1000))
    cut = run(TurnAfter(GAIT, 0.1, 1000), until=lambda seen: seen.center_of_mass[0] >= 0.5)
    assert cut.succeeded
    assert cut.center_of_mass[-1, 0] >= 0.5 > cut.center_of_mass[-3, 0]
    np.testing.assert_array_equal(cut.center_of_mass, whole.center_of_mass[: cut.time.size])


def test_until_is_not_asked_before_the_robot_has_swum():
    cut = run(TurnAfter(GAIT, 0.1, 1000), until=lambda seen: True)
    assert cut.duration == pytest.approx(0.1)


def test_a_plant_is_made_of_names_as_a_swim_is():
    named = lc.build_plant("mamba", "paper-lateral")
    assert (named.robot, named.environment) == (
        lc.load_robot("mamba"),
        lc.load_water("paper-lateral"),
    )
    assert isinstance(lc.build_plant("mamba", environment="coulomb").environment, lc.Ground)
    assert lc.build_plant("mamba").environment == lc.load_water("paper-lateral")
    amphibot = lc.load_robot("amphibot")
    assert lc.build_plant(amphibot).environment == lc.load_water("textbook", amphibot)
    with pytest.raises(ValueError, match="`environment` must be of class Water or Ground, got int"):
        lc.build_plant("mamba", 3)  # type: ignore[arg-type]
