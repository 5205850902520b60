"""Thrusters and fins take time, have a dead band and a limit: their laws, and the same from outside."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.dynamics.effector_dynamics import EffectorDynamics
from laticauda.models.simulate import build_plant, swim_together
from laticauda.robot import PectoralFin, Thruster
from laticauda.scenarios import Command, Start

GAIT = lc.lateral_undulation(amplitude_deg=0, frequency_deg_s=60, phase_shift_deg=40)
RISE = 0.6
"""Rise time of the thruster [s]."""
THRUSTER = Thruster(link=4, thrust=0.0, max_thrust=2.0, rise_time=RISE, dead_band=0.2)
FIN = PectoralFin(
    link=6, area=0.01, lift_slope=3.0, stall_angle=0.4, max_deflection=0.5, rise_time=0.3
)


def build(model="planar", thrusters=(THRUSTER,), fins=(), dt=None):
    robot = replace(lc.load_robot("mamba"), thrusters=thrusters, pectoral_fins=fins)
    scenario = lc.Scenario(
        robot=robot,
        environment=lc.load_water("paper-lateral"),
        motion=GAIT,
        duration=1.0,
        model=lc.Planar(dt=dt) if model == "planar" else lc.Spatial(dt=dt),
    )
    return build_plant(scenario)


def step_response(plant, told, duration=3.0, sample_interval=0.05):
    """Return the log after a step of the thrust from 0."""
    still = Command(gait=GAIT, thrusts=(0.0,))
    state = plant.step(plant.init(Start(), still), still, 0.1)
    return plant.march(state, Command(gait=GAIT, thrusts=(told,)), duration, sample_interval).log


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_step_of_thrust_takes_the_rise_time_from_a_tenth_to_nine_tenths(model):
    log = step_response(build(model), told=1.5)
    thrust = log.signals["thrust_0"]
    time = log.time - log.time[0]
    expected = 1.5 * (1.0 - np.exp(-time * math.log(9.0) / RISE))
    assert thrust == pytest.approx(expected, abs=1e-5)
    begin, end = np.interp([0.15, 1.35], thrust, time)
    assert end - begin == pytest.approx(RISE, rel=0.01)


def test_the_impulse_of_a_rising_thrust_is_that_of_its_law():
    # A robot that is pushed by nothing else and hardly dragged at first moves as its law says.
    water = replace(lc.load_water("paper-lateral"), tangential_friction=0.0)
    plant = replace(build(dt=0.005), environment=water)
    log = step_response(plant, told=1.5, duration=1.0)
    time = log.time - log.time[0]
    lag = RISE / math.log(9.0)
    impulse = 1.5 * (time - lag * (1.0 - np.exp(-time / lag)))
    mass = sum(module.mass for module in plant.robot.modules)
    assert mass * log.center_of_mass_velocity[:, 0] == pytest.approx(impulse, abs=2e-3)


@pytest.mark.parametrize(
    ("told", "done"),
    [(0.19, 0.0), (-0.19, 0.0), (0.2, 0.2), (-0.3, -0.3), (5.0, 2.0), (-5.0, -2.0)],
)
def test_small_thrust_is_none_and_large_thrust_is_the_limit(told, done):
    quick = replace(THRUSTER, rise_time=0.0)
    for thruster in (THRUSTER, quick):
        log = step_response(build(thrusters=(thruster,)), told=told)
        assert log.signals["thrust_0"][-1] == pytest.approx(done, abs=1e-4)


def test_a_servo_stops_within_its_dead_band_and_ignores_small_changes():
    fin = replace(FIN, dead_band=0.05)
    robot = replace(lc.load_robot("mamba"), pectoral_fins=(fin,))
    dynamics = EffectorDynamics(robot)
    course = dynamics.move(np.array([0.0]), np.array([0.3]), 10.0)
    assert course.end == pytest.approx(0.25)
    # It creeps to there on an exponential, the mean of which is known.
    lag = 0.3 / math.log(9.0)
    moving = lag * math.log(0.3 / 0.05)
    behind = (lag * (0.3 - 0.05) + 0.05 * (10.0 - moving)) / 10.0
    assert course.mean == pytest.approx(0.3 - behind)
    assert dynamics.are_settled(course.end, np.array([0.28]))
    assert dynamics.move(course.end, np.array([0.28]), 1.0).end == pytest.approx(course.end)
    assert dynamics.move(course.end, np.array([0.1]), 10.0).end == pytest.approx(0.15)


def test_pieces_of_a_course_make_up_the_whole():
    dynamics = EffectorDynamics(
        replace(lc.load_robot("mamba"), thrusters=(THRUSTER,), pectoral_fins=(FIN,))
    )
    begin, target = np.array([0.0, 0.4]), np.array([1.0, -0.2])
    whole = dynamics.move(begin, target, 0.7)
    first = dynamics.move(begin, target, 0.2)
    second = dynamics.move(first.end, target, 0.5)
    assert second.end == pytest.approx(whole.end)
    assert 0.2 * first.mean + 0.5 * second.mean == pytest.approx(0.7 * whole.mean)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_stepping_from_outside_gives_the_same_as_one_march(model):
    plant = build(model, fins=(FIN,), dt=0.01)
    still = Command(gait=GAIT, thrusts=(0.0,), deflections=(0.0,))
    told = Command(gait=GAIT, thrusts=(1.0,), deflections=(0.3,))
    start = plant.step(plant.init(Start(velocity=0.2), still), still, 0.1)
    whole = plant.march(start, told, 1.0, 0.1)
    state = start
    for _ in range(10):
        state = plant.step(state, told, 0.1)
        state = plant.unpack(plant.pack(state))
    assert state.effectors == pytest.approx(whole.state.effectors, abs=1e-12)
    assert state.values == pytest.approx(whole.state.values, abs=1e-9)


def test_a_run_begins_with_what_its_first_command_says():
    plant = build()
    told = Command(gait=GAIT, thrusts=(1.5,))
    log = plant.march(plant.init(Start(), told), told, 0.5, 0.1).log
    assert log.signals["thrust_0"] == pytest.approx(1.5)


def test_effectors_without_dynamics_keep_their_bits():
    old = replace(THRUSTER, rise_time=0.0, dead_band=0.0)
    plant = build(thrusters=(old,))
    assert not plant.effector_dynamics.has_memory
    assert "effectors" not in plant.pack(plant.init(Start(), Command(gait=GAIT)))


def test_loads_are_logged_through_a_rise():
    plant = build()
    still = Command(gait=GAIT, thrusts=(0.0,))
    state = plant.step(plant.init(Start(), still), still, 0.1)
    told = Command(gait=GAIT, thrusts=(1.0,))
    march = plant.march(state, told, 0.4, 0.1, link_forces=True)
    pushed = march.log.link_force["effector"][:, 4, 0]
    assert pushed.shape == march.log.time.shape
    assert np.all(np.diff(pushed) > 0.0)
    loads = plant.observe_under(march.state, told).loads
    assert loads.joint_torque.shape == (plant.robot.n_joints,)


def test_a_stored_run_goes_on_from_what_its_effectors_did():
    plant = build()
    still = Command(gait=GAIT, thrusts=(0.0,))
    state = plant.step(plant.init(Start(), still), still, 0.1)
    stored = plant.pack(plant.step(state, Command(gait=GAIT, thrusts=(1.0,)), 0.1))
    assert 0.1 < float(stored["effectors"][0]) < 0.9
    with pytest.raises(
        ValueError, match=r"must have one number per driven effector, 1 in all, got 2"
    ):
        plant.unpack({**stored, "effectors": np.zeros(2)})


def test_robots_in_one_scene_must_have_quick_effectors():
    robot = replace(lc.load_robot("mamba"), thrusters=(THRUSTER,))
    scenario = lc.Scenario(
        robot=robot,
        environment=lc.load_water("paper-lateral"),
        motion=GAIT,
        duration=0.1,
        model=lc.Spatial(scene="open"),
    )
    with pytest.raises(ValueError, match=r"must have no driven effector with a rise time"):
        swim_together([scenario, scenario])
