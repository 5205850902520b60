"""Missions: a depth that is held by the pitch joints, and conditions by which a robot tells that it is in a dock."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

import laticauda as lc
from laticauda.missions import (
    Captured,
    DepthKeeping,
    Mission,
    Navigation,
    Phase,
    Rest,
    SwimStraight,
    Touched,
    Transition,
    load_mission,
    read_changes,
)
from laticauda.scenarios import save_scenario
from laticauda.sensing import ContactSensor, DepthGauge, Wall

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=210, phase_shift_deg=40)
REST = Phase(name="rest", behaviour=Rest())
AHEAD = SwimStraight(distance=50.0)


def until(condition):
    """A mission that swims straight on until a condition is met."""
    out = Phase(name="out", behaviour=AHEAD, transitions=(Transition(when=condition, to="rest"),))
    return Mission(gait=GAIT, phases=(out, REST))


# ---- depth ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("rise_rate", [0.0, 0.01])
def test_a_depth_is_reached_and_held_though_the_robot_is_lighter_than_water(rise_rate):
    keeping = DepthKeeping()
    state, depth, pitch, deepest = None, 0.5, 0.0, 0.0
    for instant in range(1000):
        state = keeping.step(state, 1.0, SimpleNamespace(time=0.1 * instant, depth=depth))
        pitch += 0.1 * (1.2 * state.offset - 0.1 * pitch)
        depth += 0.1 * (0.2 * math.sin(pitch) - rise_rate)
        deepest = max(deepest, depth)
    assert depth == pytest.approx(1.0, abs=0.05)
    assert deepest < 1.1


def test_without_a_depth_gauge_the_pitch_joints_stay():
    keeping = DepthKeeping()
    assert keeping.step(None, 1.0, SimpleNamespace(time=0.0, depth=None)) is None


@pytest.mark.parametrize(("depth", "sign"), [(1.0, 1.0), (0.0, -1.0)])
def test_in_space_the_pitch_joints_bend_to_the_depth_of_the_phase(depth, sign):
    pytest.importorskip("mujoco")
    robot = lc.load_robot("mamba-modules")
    yaw = tuple(i for i, joint in enumerate(robot.joints) if joint.axis == "yaw")
    mission = Mission(
        gait=replace(GAIT, amplitude=0.2, frequency=2.0),
        phases=(Phase(name="dive", behaviour=AHEAD, depth=depth),),
        navigation=Navigation(yaw_joints=yaw),
    )
    model = lc.Spatial(sensors=(DepthGauge(),))
    start = lc.Start(depth=0.5)
    trial = lc.swim(lc.build_scenario(robot, mission, 0.6, model=model, start=start))
    assert sign * trial.signals["pitch_offset"][-1] > 0.05
    assert sign * trial.joint_angle[-1, 1] > 0.0


def test_a_robot_without_pitch_joints_cannot_hold_a_depth():
    mission = Mission(gait=GAIT, phases=(Phase(name="dive", behaviour=AHEAD, depth=1.0),))
    message = (
        "`robot` must have pitch joints to hold the depth of the phase `dive`, got `mamba-fin`"
    )
    with pytest.raises(ValueError, match=message):
        lc.swim(lc.build_scenario("mamba-fin", mission, 1.0))


# ---- capture -------------------------------------------------------------------------------------


def estimate(distance=0.2, heading=0.0, silence=0.5, force=None):
    return SimpleNamespace(
        beacon_distance=distance,
        heading=heading,
        silence={"beacon": silence},
        contact_force=force,
    )


@pytest.mark.parametrize(
    ("seen", "is_captured"),
    [
        (estimate(), True),
        (estimate(heading=2.0 * math.pi - 0.3), True),
        (estimate(distance=0.5), False),
        (estimate(distance=None), False),
        (estimate(heading=math.pi), False),
        (estimate(silence=3.0), False),
    ],
)
def test_a_robot_is_captured_by_what_beacon_and_heading_tell(seen, is_captured):
    assert Captured().is_met(seen) is is_captured


def test_the_phase_ends_where_the_beacon_is(tmp_path):
    inspection = load_mission("net-inspection")
    scenario = replace(
        inspection,
        motion=replace(until(Captured(radius=0.4)), navigation=inspection.motion.navigation),
        model=replace(inspection.model, places=()),
        start=lc.Start(center_of_mass=(-1.5, 0.0)),
        duration=12.0,
    )
    save_scenario(scenario, tmp_path / "mission.toml")
    scenario = load_mission(tmp_path / "mission.toml")
    trial = lc.swim(scenario)
    (change,) = read_changes(trial)
    assert (change.after, change.reason) == ("rest", "beacon within 0.4 m")
    tip = trial.center_of_mass[trial.time >= change.time][0] + (0.81, 0.0)
    assert math.hypot(*tip) < 0.6


def test_a_robot_tells_that_it_touches_something():
    pytest.importorskip("mujoco")
    wall = Wall(name="wall", begin=(0.95, -2.0), end=(0.95, 2.0))
    model = lc.Spatial(sensors=(ContactSensor(noise=0.0),), places=(wall,))
    trial = lc.swim(lc.build_scenario("mamba", until(Touched(force=0.3)), 4.0, model=model))
    (change,) = read_changes(trial)
    assert change.reason == "touched by 0.3 N"
