"""Missions: the table, what is believed, and a whole inspection with docking, by sensors alone."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import laticauda as lc
from laticauda.missions import (
    Helm,
    Mission,
    Phase,
    Rest,
    SensorSilent,
    Steering,
    SwimStraight,
    Transition,
    load_mission,
    run_mission,
    run_missions,
)
from laticauda.missions.posture import bend_of_head, find_posture
from laticauda.robot import kinematics
from laticauda.sensing import SensorFault

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=210, phase_shift_deg=40)
OUT = Phase(name="out", behaviour=SwimStraight(distance=1.0), done="rest")
REST = Phase(name="rest", behaviour=Rest())


@pytest.fixture(scope="module")
def inspection():
    return load_mission("net-inspection")


@pytest.fixture(scope="module")
def inspected(inspection):
    """The mission in a current of half of the top speed, across the dock."""
    across = replace(inspection.environment, current=(0.0, 0.11))
    return run_mission(replace(inspection, environment=across))


def with_fault(scenario, name, kind="silent", begin=60.0, end=90.0):
    fault = SensorFault(begin=begin, end=end, kind=kind)
    sensors = [
        replace(sensor, faults=(fault,)) if sensor.name == name else sensor
        for sensor in scenario.model.sensors
    ]
    return replace(scenario, model=replace(scenario.model, sensors=tuple(sensors)))


def test_a_robot_inspects_a_net_and_docks_in_a_current_of_half_its_speed(inspected):
    assert inspected.is_docked
    assert inspected.clearance > 0.3
    assert inspected.share_seen > 0.95
    assert inspected.largest_error < 0.5
    assert [change.after for change in inspected.changes] == ["search", "follow", "return", "dock"]


def test_the_log_says_when_and_why_the_phase_changed(inspected):
    first = inspected.changes[0]
    assert (first.before, first.after, first.reason) == ("undock", "search", "done")
    assert 5.0 < first.time < 30.0
    phase = inspected.trial.signals["mission_phase"]
    assert phase[inspected.trial.time < first.time].max() == 0.0
    assert phase[-1] == 5.0


def test_the_current_is_believed_as_it_is(inspected):
    assert inspected.trial.signals["believed_current_y"][-1] == pytest.approx(0.11, abs=0.01)
    assert inspected.trial.signals["believed_current_x"][-1] == pytest.approx(0.0, abs=0.01)


def test_a_mission_sees_readings_and_joints_only(inspection):
    class Watched(lc.Controller):
        """Hands a mission nothing else."""

        gait = inspection.motion.gait
        interval = inspection.motion.interval

        def init(self):
            return inspection.motion.init()

        def step(self, state, observation):
            told = SimpleNamespace(
                time=observation.time,
                joint_angle=observation.joint_angle,
                joint_rate=observation.joint_rate,
                readings=observation.readings,
            )
            return inspection.motion.step(state, told)

    short = replace(inspection, duration=5.0)
    seen = lc.swim(replace(short, motion=Watched()))
    usual = lc.swim(short)
    assert np.array_equal(seen.center_of_mass, usual.center_of_mass)


def test_a_stored_mission_runs_again_the_same(inspection, tmp_path):
    trial = lc.swim(replace(inspection, duration=4.0))
    trial.save(tmp_path / "mission.nc")
    stored = lc.load_trial(tmp_path / "mission.nc")
    assert stored.scenario == trial.scenario
    assert np.array_equal(lc.swim(stored.scenario).center_of_mass, trial.center_of_mass)


def test_the_posture_follows_from_the_joints():
    robot = lc.load_robot("mamba")
    joint_angle = [0.3, -0.2, 0.1, 0.4, -0.3, 0.2, 0.1, -0.1]
    posture = find_posture(
        body_length=robot.length,
        head_heading=0.7,
        head_rate=0.0,
        joint_angle=joint_angle,
        joint_rate=[0.0] * 8,
    )
    links = kinematics.link_angles(np.array(joint_angle), angle=0.7, link=8)
    true = kinematics.Posture(robot, np.zeros(2), links)
    assert (posture.head_x, posture.head_y) == pytest.approx(true.link_ends[-1], abs=1e-9)
    assert posture.heading == pytest.approx(np.mean(links))
    assert bend_of_head(joint_angle) == pytest.approx(0.7 - np.mean(links))


def test_the_helm_points_upstream():
    estimate = SimpleNamespace(heading=0.0, current=(0.0, 0.1))
    helm = Helm(swim_speed=0.2)
    assert helm.crab_angle(0.0, (0.0, 0.1)) == pytest.approx(-math.radians(30.0))
    assert helm.offset_of(Steering(course=0.0), estimate) < 0.0
    assert helm.offset_of(Steering(heading=0.0), estimate) == 0.0


@pytest.mark.parametrize("kind", ["silent", "frozen"])
def test_a_sensor_that_repeats_itself_is_as_good_as_silent(inspection, kind):
    lost = Transition(when=SensorSilent(sensor="compass", longer_than=3.0), to="rest")
    mission = Mission(
        gait=GAIT,
        phases=(replace(OUT, transitions=(lost,), behaviour=SwimStraight(distance=50.0)), REST),
        navigation=inspection.motion.navigation,
    )
    scenario = replace(inspection, motion=mission, duration=12.0)
    (result,) = run_missions([with_fault(scenario, "compass", kind, begin=4.0, end=20.0)])
    (change,) = result.changes
    assert change.reason == "compass silent for 3 s"
    assert change.time == pytest.approx(7.0, abs=0.5)


def test_tables_that_lead_nowhere_are_refused():
    with pytest.raises(
        ValueError, match=r"must lead to one of `out`, `rest`, got 'home' after `out`"
    ):
        Mission(gait=GAIT, phases=(replace(OUT, done="home"), REST))
    with pytest.raises(ValueError, match="must have different names, got `rest` twice"):
        Mission(gait=GAIT, phases=(OUT, REST, REST))


def test_beams_must_be_those_of_the_sonar(inspection):
    navigation = replace(inspection.motion.navigation, beams=(0.0,))
    wrong = replace(inspection, motion=replace(inspection.motion, navigation=navigation))
    with pytest.raises(ValueError, match="must have the beams of the sonar, 21 of them, got 1"):
        lc.swim(replace(wrong, duration=1.0))
