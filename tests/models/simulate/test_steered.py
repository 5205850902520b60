"""Controllers in lanes: `swim_many` with scenarios that are steered gives what `swim` gives, one by one."""

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest
from averaged_models import AVERAGED_MODEL

import laticauda as lc
from laticauda.control import (
    Circle,
    CurrentObserver,
    HeadingController,
    IntegralLineOfSight,
    LineOfSight,
    OffsetSteps,
    Path,
    PathFollowing,
    PathFrame,
    Polyline,
    Spline,
    StraightLine,
)
from laticauda.models.simulate import run_scenario, steered, swim_side_by_side
from laticauda.scenarios import VectorController
from laticauda.sensing import Altimeter, Compass
from laticauda.values import value_class

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
MODEL = AVERAGED_MODEL
CORNERS = ((0.0, 0.0), (0.3, 0.1), (0.6, -0.2), (1.5, 0.0))
BASE = lc.build_scenario("mamba", GAIT, 4.0)
FIGURES = ("forward_velocity", "mechanical_power", "mean_power", "cost_of_transport")


@value_class
class Sine(Path[None]):
    """A path of one's own, written for one robot: a line whose side changes."""

    height: float = 0.1

    def init(self):
        return None

    def locate(self, progress, position):
        x, y = float(position[0]), float(position[1])
        offset = self.height * math.sin(5.0 * x)
        return None, PathFrame(x, y - offset, 0.0, 0.0, math.inf)


PATHS = {
    "line": StraightLine(point=(0.1, 0.2), angle=0.3),
    "circle": Circle(center=(0.0, 1.0), radius=1.0, turns=-2.0),
    "legs": Polyline(waypoints=CORNERS, acceptance_distance=0.15),
    "spline": Spline(waypoints=CORNERS),
    "own": Sine(),
}
LAWS = {
    "line of sight": LineOfSight(look_ahead_distance=0.5),
    "integral": IntegralLineOfSight(look_ahead_distance=0.5, integral_gain=0.05),
}


def follower(**changes: Any) -> PathFollowing:
    fields = {
        "gait": GAIT,
        "path": StraightLine(),
        "guidance": LAWS["line of sight"],
        "heading": HeadingController(gain=0.4, max_offset=0.3),
    }
    return PathFollowing(**(fields | changes))


def scenarios_of(controllers, **settings: Any) -> list[lc.Scenario]:
    model = replace(BASE.model, **settings)
    return [
        replace(
            BASE,
            motion=controller,
            model=model,
            start=lc.Start(center_of_mass=(0.0, 0.2 * i - 0.3), heading=0.3 * i),
        )
        for i, controller in enumerate(controllers)
    ]


def check_equal(scenarios, within: float = 1e-12, **how: Any) -> None:
    swims = lc.swim_many(scenarios, feasibility=True, **how)
    for i, scenario in enumerate(scenarios):
        trial = lc.swim(scenario)
        alone = [*trial.center_of_mass[-1], trial.heading[-1]]
        alone += [getattr(trial, name) for name in FIGURES] + [trial.utilization]
        together = [*swims.center_of_mass[i], swims.heading[i]]
        together += [getattr(swims, name)[i] for name in FIGURES] + [swims.utilization[i]]
        np.testing.assert_allclose(together, alone, rtol=within, atol=within)
        assert (swims.succeeded[i], swims.status[i]) == (trial.succeeded, trial.status)


@pytest.mark.filterwarnings("ignore::laticauda.values.InfeasibleWarning")
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("path", PATHS)
def test_robots_that_follow_paths_side_by_side_swim_as_each_alone(path, law):
    controllers = [
        follower(path=PATHS[path], guidance=LAWS[law], heading_estimate=estimate)
        for estimate in ("raw", "cycle_mean", "raw")
    ]
    check_equal(scenarios_of(controllers), threads=1)


@pytest.mark.filterwarnings("ignore::laticauda.values.InfeasibleWarning")
@pytest.mark.parametrize("differs", ["speed_std", "model"])
def test_robots_that_observe_the_current_side_by_side_swim_as_each_alone(differs):
    water = replace(BASE.environment, current=(0.02, 0.05))
    controllers = [
        follower(
            gait=replace(GAIT, frequency=2.0 + 0.1 * i, offset=0.01 * i),
            observer=CurrentObserver(model=MODEL, speed_std=0.01),
            max_crab_angle=0.3 + 0.2 * i,
        )
        for i in range(3)
    ]
    other: Any = {"speed_std": 0.02, "model": replace(MODEL, bend=1.3)}[differs]
    observer = replace(controllers[1].observer, **{differs: other})
    controllers[1] = replace(controllers[1], observer=observer)
    scenarios = [replace(one, environment=water) for one in scenarios_of(controllers)]
    check_equal(scenarios, threads=1)


@pytest.mark.filterwarnings("ignore::laticauda.values.InfeasibleWarning")
@pytest.mark.parametrize("joints", ["pd", "servo"])
@pytest.mark.parametrize(("delay", "interval"), [(0.0, 0.2), (0.13, 0.2), (0.04, 0.03)])
def test_driven_joints_and_late_commands_are_those_of_single_runs(joints, delay, interval):
    controllers = [follower(interval=interval), follower(interval=interval, gait=GAIT)]
    law = lc.JointLaw.of(joints)
    check_equal(scenarios_of(controllers, joints=law, dt=None, loop_delay=delay))


def test_gaits_waters_and_robots_may_differ_among_those_that_are_steered():
    gaits = [replace(GAIT, amplitude=0.3 + 0.02 * i) for i in range(9)]
    scenarios = scenarios_of([follower(gait=gait) for gait in gaits])
    water = lc.load_water("paper-eel")
    scenarios[3] = replace(scenarios[3], environment=replace(water, current=(0.02, 0.01)))
    scenarios[5] = replace(scenarios[5], robot=lc.load_robot("mamba-fin"))
    scenarios[7] = replace(scenarios[7], motion=GAIT)
    check_equal(scenarios, threads=2)


@dataclass(frozen=True)
class Homing(lc.Controller[int]):
    """A controller of one's own, written for one robot."""

    gait: lc.Gait = GAIT
    gain: float = 0.2
    interval: float = 0.1

    def init(self):
        return 0

    def step(self, state, observation):
        offset = -self.gain * math.tanh(observation.center_of_mass[1] + observation.joint_rate[0])
        return state + 1, lc.Command(gait=self.gait, offset=offset)


class ForArrays(Homing):
    """The same, written for arrays."""

    @classmethod
    def vectorize(cls, controllers):
        return Homings(np.array([controller.gain for controller in controllers]))


class Homings(VectorController):
    """Steers many robots as `Homing` does."""

    def __init__(self, gain):
        self.gain = gain

    def step(self, observations):
        distance = observations.center_of_mass[:, 1] + observations.joint_rate[:, 0]
        return {"offset": -self.gain * np.tanh(distance)}


@pytest.mark.parametrize("kind", [Homing, ForArrays])
def test_a_controller_of_ones_own_steers_many_whether_written_for_arrays_or_not(kind, monkeypatch):
    if kind is ForArrays:
        monkeypatch.setattr("laticauda.scenarios.vector_control.OneByOne", None)
    check_equal(scenarios_of([kind(gain=0.1), kind(gain=0.3)]))


def test_a_subclass_that_decides_otherwise_is_not_steered_by_the_arrays_of_its_base():
    class Reversed(ForArrays):
        def step(self, state, observation):
            state, command = super().step(state, observation)
            return state, replace(command, offset=-command.offset)

    check_equal(scenarios_of([Reversed(gain=0.1), Reversed(gain=0.3)]))


def test_arrays_that_do_not_fit_the_robots_are_named():
    class Wrong(ForArrays):
        """Commands what no array can."""

        decisions: ClassVar = {"offset": np.zeros(3)}

        @classmethod
        def vectorize(cls, controllers):
            steering = Homings(np.zeros(2))
            steering.step = lambda observations: cls.decisions
            return steering

    scenarios = scenarios_of([Wrong(), Wrong()])
    with pytest.raises(
        ValueError,
        match=r"`decisions\['offset'\]` must hold one number for each of the 2 robots, got the shape \(3,\)",
    ):
        lc.swim_many(scenarios)
    Wrong.decisions = {"references": np.zeros(8)}
    rule = r"`decisions\['references'\]` must hold a row of angles for each of the 2 robots, got the shape \(8,\)"
    with pytest.raises(ValueError, match=rule):
        lc.swim_many(scenarios)
    Wrong.decisions = {"references": np.full((2, 8), np.nan)}
    with pytest.raises(ValueError, match=r"`decisions\['references'\]` must be finite \[rad\]"):
        lc.swim_many(scenarios)
    Wrong.decisions = {"references": np.zeros((2, 8)), "offset": np.zeros(2)}
    with pytest.raises(
        ValueError, match="`decisions` must hold `references` alone, also got offset"
    ):
        lc.swim_many(scenarios)
    Wrong.decisions = {"references": np.zeros((2, 8))}
    with pytest.raises(ValueError, match="`references` must be None for prescribed joints"):
        lc.swim_many(scenarios)
    Wrong.decisions = {"speed": np.zeros(2)}
    with pytest.raises(ValueError, match=r"`decisions` must be one of `amplitude`.*, got 'speed'"):
        lc.swim_many(scenarios)


@dataclass(frozen=True)
class Feeling(lc.Controller[int]):
    """References for the joints, which depend on what the body feels; every third instant, the gait swims."""

    gait: lc.Gait = GAIT
    gain: float = 0.1
    interval: float = 0.1

    def init(self):
        return 0

    def step(self, state, observation):
        if state % 3 == 2:
            return state + 1, lc.Command(gait=self.gait, offset=self.gain)
        references = angles_of(observation, self.gain)
        return state + 1, lc.Command(gait=self.gait, references=tuple(references.tolist()))


def angles_of(observation, gain):
    loads = observation.loads
    wave = 0.3 * np.sin(np.multiply.outer(observation.time, np.ones(8)) + 0.7 * np.arange(8))
    felt = 0.01 * loads.pressure_difference[..., 1:] - observation.joint_angle
    felt = felt + 0.01 * (loads.joint_force[..., 1] + loads.joint_moment[..., 2])
    felt = felt + 0.01 * (
        loads.joint_torque + loads.water_force[..., 1:, 0] - loads.fin_force[..., :1]
    )
    return wave + gain * felt


class FeelingForArrays(Feeling):
    """The same, written for arrays."""

    @classmethod
    def vectorize(cls, controllers):
        return Feelings(np.array([[controller.gain] for controller in controllers]))


class Feelings(VectorController):
    """Moves the joints of many robots as `Feeling` does."""

    def __init__(self, gain):
        self.gain = gain
        self.n_instants = 0

    def step(self, observations):
        self.n_instants += 1
        if self.n_instants % 3 == 0:
            return {"offset": self.gain[:, 0]}
        return {"references": angles_of(observations, self.gain)}


@pytest.mark.parametrize("robot", ["mamba", "mamba-fin"])
@pytest.mark.parametrize("kind", [Feeling, FeelingForArrays])
def test_references_for_the_joints_of_many_robots_move_each_as_alone(kind, robot, monkeypatch):
    if kind is FeelingForArrays:
        monkeypatch.setattr("laticauda.scenarios.vector_control.OneByOne", None)
    controllers = [kind(gain=0.05 * i) for i in range(3)]
    scenarios = scenarios_of(controllers, joints=lc.JointLaw.of("servo"), dt=None, loop_delay=0.03)
    robots = [replace(one, robot=lc.load_robot(robot), duration=2.0) for one in scenarios]
    check_equal(robots, threads=1)


@dataclass(frozen=True)
class Replaying(lc.Controller[int]):
    """Swims another recording at every instant, which lanes cannot do."""

    gait: lc.Gait = GAIT
    interval: float = 1.0

    def init(self):
        return 0

    def step(self, state, observation):
        times = np.linspace(0.0, 4.0, 9)
        angles = np.tile(0.1 * np.sin(times + state), (8, 1))
        recorded = lc.recorded_gait(lc.JointAngles(time=times, angle=angles))
        return state + 1, lc.Command(gait=recorded)


def test_commands_that_lanes_cannot_take_are_run_one_by_one():
    check_equal(scenarios_of([Replaying(), Replaying()]))


@pytest.mark.filterwarnings("ignore::laticauda.values.ImplausibleWarning")
def test_a_steered_run_that_diverges_does_not_disturb_the_others():
    model = {"joints": lc.JointLaw.of("pd"), "dt": 0.05, "offset_bandwidth": 5.0}
    scenarios = scenarios_of([follower()] * 3, **model)
    wild = replace(GAIT, amplitude=1.0, frequency=30.0)
    wild_follower = follower(gait=wild, heading=HeadingController(gain=0.4, max_offset=0.01))
    scenarios[1] = replace(scenarios[1], motion=wild_follower)
    swims = lc.swim_many(scenarios)
    trials = [lc.swim(scenario) for scenario in scenarios]
    assert [trial.succeeded for trial in trials] == [True, False, True]
    assert swims.status == tuple(trial.status for trial in trials)
    assert swims.center_of_mass[2].tolist() == pytest.approx(trials[2].center_of_mass[-1].tolist())


def test_a_controller_that_asks_too_much_of_its_robot_is_named_by_its_place():
    scenarios = scenarios_of([follower(), follower()])
    much = HeadingController(gain=0.4, max_offset=3.0)
    scenarios[1] = replace(scenarios[1], motion=follower(heading=much))
    with pytest.raises(ValueError, match=r"`scenarios\[1\]\.motion\.max_offset` must be <= "):
        lc.swim_many(scenarios)


def test_offsets_held_one_after_the_other_are_run_side_by_side():
    scenarios = scenarios_of([OffsetSteps(gait=GAIT, interval=1.0)] * 2)
    check_equal(scenarios)


def test_progress_of_steered_and_unsteered_runs_adds_up(monkeypatch):
    monkeypatch.setattr(steered, "SMALLEST_FLEET", 8)
    shares: list[float] = []
    scenarios = scenarios_of([follower()] * 10 + [GAIT] * 10)
    lc.swim_many(scenarios, threads=2, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)


@pytest.mark.filterwarnings("ignore::laticauda.values.InfeasibleWarning")
def test_trials_side_by_side_are_those_of_single_runs_and_end_where_they_arrive():
    laws = [
        follower(),
        follower(interval=0.2),
        OffsetSteps(gait=GAIT, interval=0.5),
        GAIT,
        FeelingForArrays(),
    ]
    scenarios = scenarios_of(laws, joints=lc.JointLaw.of("pd"), dt=None, loop_delay=0.07)
    scenarios[0] = replace(scenarios[0], robot=lc.load_robot("mamba-fin"))
    with_sensors = replace(scenarios[1].model, sensors=(Compass(), Altimeter()))
    scenarios[1] = replace(scenarios[1], model=with_sensors)
    ends = np.array([0.02, 0.05, 9.0, 9.0, 9.0])

    def has_arrived(observations, index):
        return observations.center_of_mass[:, 0] >= ends[index]

    trials = swim_side_by_side(scenarios, has_arrived)
    for scenario, trial, end in zip(scenarios, trials, ends, strict=True):
        plant = lc.build_plant(scenario)
        alone = run_scenario(
            scenario, plant, until=lambda seen, end=end: seen.center_of_mass[0] >= end
        )
        assert trial.duration == alone.duration
        assert trial.scenario == alone.scenario
        assert trial.signals.keys() == alone.signals.keys()
        for name in ("time", "heading", "joint_torque", "joint_angle_ref", "center_of_mass"):
            values, expected = getattr(trial, name), getattr(alone, name)
            np.testing.assert_allclose(values, expected, rtol=1e-10, atol=1e-10, err_msg=name)
        for name, expected in alone.signals.items():
            np.testing.assert_allclose(trial.signals[name], expected, atol=1e-12, err_msg=name)
        (state,) = trial.state.values()
        np.testing.assert_allclose(state, *alone.state.values(), rtol=1e-10, atol=1e-10)
    assert trials[0].duration < 4.0
    assert trials[3].duration == 4.0


@pytest.mark.filterwarnings("ignore::laticauda.values.ImplausibleWarning")
def test_trials_that_no_fleet_holds_are_run_alone():
    held = scenarios_of([Replaying(), Replaying()])
    wild = replace(GAIT, amplitude=1.0, frequency=30.0)
    gentle = HeadingController(gain=0.4, max_offset=0.01)
    wild_follower = follower(gait=wild, heading=gentle)
    diverging = scenarios_of([wild_follower], joints=lc.JointLaw.of("pd"), dt=0.05)
    for scenario, trial in zip(
        [*held, *diverging], swim_side_by_side([*held, *diverging]), strict=True
    ):
        assert trial.equals(lc.swim(scenario))
    assert not trial.succeeded
