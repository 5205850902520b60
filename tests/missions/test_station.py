"""Station keeping by what sensors tell: by swimming against the flow, and by thrusters."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.missions import Hover, KeepStation, Phase, load_mission
from laticauda.robot import Thruster

CURRENT = 0.066
"""0.3 of the top speed of the gait [m/s]."""
SIDE = 0.5 * math.pi
HOVER = Hover(position=(0.0, 0.0), directions=(0.0, SIDE, SIDE), places=(0.0, -0.36, 0.36))
THRUSTERS = (
    Thruster(link=4, thrust=0.0, max_thrust=2.0),
    Thruster(link=2, thrust=0.0, max_thrust=2.0, angle=SIDE),
    Thruster(link=6, thrust=0.0, max_thrust=2.0, angle=SIDE),
)


@pytest.fixture(scope="module")
def base():
    """The preset's robot and sensors, in open water."""
    inspection = load_mission("net-inspection")
    sensors = tuple(sensor for sensor in inspection.model.sensors if sensor.name != "sonar")
    model = replace(inspection.model, places=(), sensors=sensors)
    start = replace(inspection.start, center_of_mass=(-0.5, 0.3))
    return replace(inspection, model=model, start=start, duration=100.0)


def stay(base, behaviour, current, thrusters=()):
    phase = Phase(name="stay", behaviour=behaviour, avoids=False)
    mission = replace(base.motion, phases=(phase,), always=())
    return replace(
        base,
        motion=mission,
        environment=replace(base.environment, current=current),
        robot=replace(base.robot, thrusters=thrusters),
    )


def rms_distance(trial, after):
    late = trial.time > after
    return math.sqrt(np.mean(np.sum(trial.center_of_mass[late] ** 2, axis=1)))


def test_a_swimmer_keeps_its_station_in_a_current_by_swimming_at_its_speed(base):
    trial = lc.swim(stay(base, KeepStation(position=(0.0, 0.0)), (CURRENT, 0.0)))
    assert rms_distance(trial, after=60.0) < 0.12
    # It faces the current.
    assert abs(math.remainder(trial.heading[-1] - math.pi, 2.0 * math.pi)) < 0.3


def test_a_swimmer_finds_by_itself_how_fast_it_swims(base):
    wrong = KeepStation(position=(0.0, 0.0), swim_speed=0.6)
    trial = lc.swim(stay(base, wrong, (0.0, CURRENT)))
    assert rms_distance(trial, after=70.0) < 0.15


def test_a_swimmer_rests_near_its_station_in_still_water(base):
    behaviour = KeepStation(position=(0.0, 0.0))
    near = stay(base, behaviour, (0.0, 0.0))
    trial = lc.swim(
        replace(near, duration=10.0, start=replace(near.start, center_of_mass=(0.2, 0.1)))
    )
    assert rms_distance(trial, after=0.0) < behaviour.radius
    assert np.abs(trial.joint_angle[-1]).max() < 1e-3


def test_thrusters_hold_a_robot_against_a_current(base):
    trial = lc.swim(stay(base, HOVER, (CURRENT, 0.0), THRUSTERS))
    assert rms_distance(trial, after=60.0) < 0.12
    pushes = trial.signals["thrust_0"][-50:].mean()
    assert 0.1 < pushes < 2.0


def test_a_phase_of_station_keeping_ends_after_its_duration(base):
    for behaviour in (KeepStation(position=(0.0, 0.0), duration=3.0), replace(HOVER, duration=3.0)):
        scenario = stay(base, behaviour, (0.0, 0.0), THRUSTERS)
        first = replace(scenario.motion.phases[0], done="again")
        again = replace(first, name="again", done=None)
        mission = replace(scenario.motion, phases=(first, again))
        trial = lc.swim(replace(scenario, motion=mission, duration=5.0))
        phase = trial.signals["mission_phase"]
        assert phase[trial.time < 2.9].max() == 0.0
        assert phase[trial.time > 3.5].min() == 1.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"places": (0.0,)},
            r"`places` must have one entry per thruster, as the 3 `directions`, got 1",
        ),
        (
            {"places": (0.0, 0.3, 0.3)},
            r"`directions` must be of thrusters that can push ahead and aside, and turn the robot",
        ),
    ],
)
def test_hovering_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        replace(HOVER, **changes)
