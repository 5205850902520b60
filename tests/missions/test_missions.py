"""Missions: the table, what is believed, and a whole inspection with docking, by sensors alone."""

import math
from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import campaign_scripts
import numpy as np
import pytest

import laticauda as lc
from laticauda.missions import (
    Avoidance,
    BatteryLow,
    Echo,
    Estimate,
    FollowWall,
    Helm,
    Mission,
    Phase,
    Rest,
    Search,
    SensorSilent,
    Steering,
    SwimRoute,
    SwimStraight,
    Transition,
    load_mission,
    run_campaign,
    run_mission,
    run_missions,
    summarize_campaign,
)
from laticauda.missions.behaviours.routes import RouteState
from laticauda.missions.campaign import wilson_interval
from laticauda.missions.campaign_table import read_rows
from laticauda.missions.posture import bend_of_head, find_posture
from laticauda.robot import kinematics
from laticauda.sensing import SensorFault

ROOT = Path(__file__).parent.parent.parent
GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=210, phase_shift_deg=40)
OUT = Phase(name="out", behaviour=SwimStraight(distance=1.0), done="rest")
REST = Phase(name="rest", behaviour=Rest())
SQUARE_OF_POINTS = ((2.0, -6.0), (2.0, -4.0), (0.0, -4.0), (0.0, -8.0))


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


def test_gaps_of_the_gyro_do_not_turn_what_is_believed(inspection):
    mission = Mission(
        gait=GAIT,
        phases=(
            Phase(name="circle", behaviour=SwimRoute(points=SQUARE_OF_POINTS), done="rest"),
            REST,
        ),
        navigation=replace(inspection.motion.navigation, start=(0.0, -6.0)),
    )
    sensors = [
        replace(sensor, dropout=0.2)
        for sensor in inspection.model.sensors
        if sensor.name != "beacon"
    ]
    scenario = replace(
        inspection,
        motion=mission,
        start=lc.Start(center_of_mass=(0.0, -6.0)),
        model=replace(inspection.model, sensors=tuple(sensors)),
        duration=50.0,
    )
    (result,) = run_missions([with_fault(scenario, "compass", begin=2.0, end=60.0)])
    (change,) = result.changes
    assert change.reason == "done"
    at_the_end = np.searchsorted(result.trial.time, change.time)
    middle = result.trial.center_of_mass[at_the_end]
    assert math.dist(middle, SQUARE_OF_POINTS[-1]) < 2.0


def estimate_with(*echoes):
    """What a robot believes that lies at the origin, in still water, and sees these echoes."""
    return Estimate(
        time=10.0,
        position=(0.0, 0.0),
        position_std=0.1,
        velocity=(0.2, 0.0),
        velocity_now=(0.2, 0.0),
        heading=0.0,
        heading_now=0.0,
        bow=(0.8, 0.0),
        current=(0.0, 0.0),
        head_position=(0.8, 0.0),
        head_heading=0.0,
        echoes=echoes,
        last_echo=None,
        sightings=(),
        battery=None,
        silence={},
    )


def test_a_wall_near_home_is_not_the_one_to_follow():
    echo_of_dock = Echo(bearing=0.5, distance=1.0, x=1.6, y=0.5)
    echo_of_pen = Echo(bearing=-0.5, distance=3.0, x=3.4, y=-1.4)
    estimate = estimate_with(echo_of_dock, echo_of_pen)
    for radius, is_seen in ((0.0, "dock"), (3.0, "pen")):
        follow = FollowWall(home_radius=radius)
        state, _ = follow.steer(follow.begin(estimate), estimate)
        assert (state.direction > 0.0) == (is_seen == "dock")


def test_what_is_near_home_is_not_what_is_searched():
    search = Search(points=((9.0, 0.0),), within=2.5, home_radius=3.0)
    echo_of_dock = Echo(bearing=0.0, distance=1.0, x=2.9, y=0.0)
    estimate = estimate_with(echo_of_dock)
    state = RouteState(leg=0, begin=(0.0, 0.0))
    assert search.outcome(state, estimate) is None
    assert replace(search, home=(6.0, 0.0)).outcome(state, estimate) == "done"


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


def estimate_of(position=(0.0, 0.0), heading=0.0, sightings=(), echoes=(), battery=None):
    return Estimate(
        time=0.0,
        position=position,
        position_std=0.1,
        velocity=(0.0, 0.0),
        velocity_now=(0.0, 0.0),
        heading=heading,
        heading_now=heading,
        bow=position,
        current=(0.0, 0.0),
        head_position=position,
        head_heading=heading,
        echoes=echoes,
        last_echo=None,
        sightings=sightings,
        battery=battery,
        silence={},
    )


def test_a_course_passes_what_was_seen_at_the_stated_distance():
    avoidance = Avoidance(clearance=1.0, horizon=5.0)
    estimate = estimate_of(sightings=((2.0, 0.1),))
    course = avoidance.free_course(0.0, estimate)
    assert course < 0.0  # to the right of a point ahead on the left
    passed_at = abs(2.0 * math.sin(course) - 0.1 * math.cos(course))
    assert passed_at == pytest.approx(1.0, abs=0.01)
    assert avoidance.free_course(math.pi, estimate) == math.pi
    assert avoidance.free_course(0.0, estimate_of(sightings=((9.0, 0.1),))) == 0.0


def test_a_turn_does_not_sweep_across_a_net_beside_the_robot():
    avoidance = Avoidance(clearance=1.0, turning_room=2.0)
    beside = estimate_of(sightings=((0.0, 1.5),))
    steering = avoidance.correct(Steering(course=math.radians(170.0)), beside)
    assert steering.offset == -math.inf
    free = avoidance.correct(Steering(course=math.radians(-170.0)), beside)
    assert free.course == math.radians(-170.0)


def test_the_battery_must_hold_for_the_way_home():
    low = BatteryLow(share=0.2, share_per_meter=0.01, home=(0.0, 0.0))
    assert low.is_met(estimate_of(position=(20.0, 0.0), battery=0.39))
    assert not low.is_met(estimate_of(position=(20.0, 0.0), battery=0.41))
    assert not low.is_met(estimate_of(position=(20.0, 0.0)))


def test_a_mission_goes_home_before_the_battery_is_empty(inspection):
    sensors = [
        replace(sensor, capacity=1.0) if sensor.name == "battery" else sensor
        for sensor in inspection.model.sensors
    ]
    model = replace(inspection.model, sensors=tuple(sensors))
    (result,) = run_missions([replace(inspection, model=model, duration=40.0)])
    reasons = {change.after: change.reason for change in result.changes}
    assert reasons["return"] == "battery below 20 % and the way home"


def test_with_any_sensor_failing_once_the_robot_docked_without_contact():
    rows = read_rows(campaign_scripts.campaign("missions").STORED)
    along_the_net = [row for row in rows if 30.0 < row.fault_begin < 90.0]
    failed = Counter((row.failing, row.fault) for row in along_the_net)
    sensors = ("sonar", "compass", "inertial", "velocity", "water_velocity", "beacon")
    assert set(failed) == {(name, kind) for name in sensors for kind in ("silent", "frozen")}
    assert min(failed.values()) >= 8
    for row in along_the_net:
        assert row.is_docked
        assert row.clearance > 0.0
        assert row.share_seen > 0.9


@pytest.mark.slow
def test_with_a_sensor_failing_once_the_robot_docks_without_contact(inspection):
    across = replace(inspection.environment, current=(0.0, 0.08))
    failing = (("sonar", "frozen"), ("compass", "silent"), ("velocity", "frozen"))
    scenarios = [
        with_fault(replace(inspection, environment=across), name, kind, begin=80.0, end=110.0)
        for name, kind in failing
    ]
    for result in run_missions(scenarios):
        assert result.is_docked
        assert result.clearance > 0.0
        assert result.share_seen > 0.9


@pytest.mark.slow
def test_the_stored_campaign_holds_what_the_page_says_and_repeats_a_row(inspection, tmp_path):
    campaign = campaign_scripts.campaign("missions")
    rows = read_rows(campaign.STORED)
    summary = summarize_campaign(rows)
    assert summary.share_low >= 0.93
    assert summary.n_contacts == 0
    page = (ROOT / "docs/how-to/missions.md").read_text(encoding="utf-8")
    assert f"{summary.n_docked} of {summary.n_runs}" in page
    (again,) = run_campaign(inspection, campaign.CONDITIONS, [rows[0].seed], tmp_path / "row.csv")
    assert again.is_docked == rows[0].is_docked
    assert again.duration == pytest.approx(rows[0].duration, abs=2.0)


def test_intervals_of_wilson_are_those_of_tables():
    low, high = wilson_interval(950, 1000)
    assert (round(low, 4), round(high, 4)) == (0.9347, 0.9619)


@pytest.mark.parametrize("kind", ["silent", "frozen"])
def test_what_a_silent_or_frozen_sonar_passes_by_is_not_seen(inspection, kind):
    straight = Mission(
        gait=GAIT,
        phases=(replace(OUT, behaviour=SwimStraight(distance=50.0)), REST),
        navigation=inspection.motion.navigation,
    )
    start = lc.Start(center_of_mass=(5.0, -3.0))
    scenario = replace(inspection, motion=straight, start=start, duration=15.0)
    failing = with_fault(scenario, "sonar", kind, begin=0.5, end=60.0)
    well, failed = run_missions([scenario, failing])
    # Its first ping was before the fault.
    assert failed.share_seen < well.share_seen - 0.05
