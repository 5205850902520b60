"""Operations whose controller steers by the robot's own sensors: in a tank without wires, and on wires."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from lab_parts import EXACT

import laticauda as lc
from laticauda.control import Following
from laticauda.missions import load_mission
from laticauda.scenarios import Planar
from laticauda.sensing import AcousticPosition, Compass
from laticauda.tank.lab import Lab, Tank, VirtualRobot
from laticauda.tank.operate import Decision, Event, read_operation, rerun_controller
from laticauda.tank.operate.drivers import Clock
from laticauda.tank.operate.recording.entries import SensorSample
from laticauda.tank.operate.session import operate
from laticauda.tank.operate.settings import (
    Calibration,
    CaptureVolume,
    Connection,
    Limits,
    Operation,
)
from laticauda.tank.protocol import bus_address

GAIT = lc.lateral_undulation(
    amplitude=math.radians(20), frequency=math.radians(90), phase_shift=math.radians(40)
)
SENSORS = (Compass(rate=50.0, bias=0.3), AcousticPosition(beacon=(3.0, 4.0, 0.0)))
PATIENT = Limits(
    straighten_time=1.0,
    max_lateness=2.0,
    joint_timeout=3.0,
    heartbeat_timeout=3.0,
    mocap_timeout=5.0,
)


@dataclass(frozen=True)
class ByCompass(lc.Controller):
    """Holds the course of the compass, and counts what the beacon told."""

    gait: lc.Gait = GAIT
    interval: float = 0.2

    def init(self):
        return None

    def step(self, state, observation):
        compass, beacon = observation.readings["compass"], observation.readings["beacon"]
        before = state or State({"n_fixes": 0.0, "course": 0.0, "age": 0.0})
        course = compass.values[0] if math.isfinite(compass.values[0]) else 0.0
        signals = {
            "n_fixes": before.signals["n_fixes"] + beacon.is_new,
            "course": course,
            "age": observation.time - compass.time,
        }
        return State(signals), lc.Command(gait=self.gait, offset=0.2 * course)


@dataclass(frozen=True)
class State:
    signals: dict[str, float]


def operation(**changes) -> Operation:
    usual = Operation(
        name="sensed",
        gait=GAIT,
        steering=ByCompass(),
        duration=4.0,
        rate=50.0,
        countdown=0.1,
        tank=CaptureVolume(volume_x=(-1.0, 11.0)),
        calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5),
        limits=PATIENT,
    )
    return replace(usual, **changes)


def tank(settings=EXACT, sensors=SENSORS) -> Tank:
    robot, water = lc.load_robot("mamba"), lc.load_water("paper-lateral")
    model = Planar(joints=lc.Servo(), sensors=sensors)
    return Tank(VirtualRobot(robot, lc.build_plant(robot, water, model=model)), settings)


@pytest.fixture(scope="module")
def sensed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sensed")
    return operate(operation(), folder, tank=tank()), folder / "sensed.mcap"


def test_a_controller_finds_what_the_sensors_of_the_tank_measured(sensed):
    result, _ = sensed
    assert result.accepted, result.reason
    signals = result.trial.signals
    in_run = result.trial.time > 0.5
    # In the plane the head swings about the heading, and the compass is wrong by 0.3 rad.
    head = result.trial.link_angle[in_run, -1]
    assert signals["compass_heading"][in_run] == pytest.approx(head + 0.3, abs=0.12)
    assert np.all(signals["age"] < 0.05)
    # One fix per second of the run, and the last one of the time before it.
    assert signals["n_fixes"][-1] in (4.0, 5.0)


def test_the_recording_decides_the_same_again_to_the_last_bit(sensed):
    _, path = sensed
    rerun = rerun_controller(read_operation(path))
    assert len(rerun.recorded) == 20
    assert rerun.n_different == 0


def test_who_steers_is_said_once(tmp_path):
    with pytest.raises(ValueError, match="`steering` must not be given with `following`"):
        operation(following=Following())
    other = replace(GAIT, amplitude=0.1)
    assert operation(gait=other).gait == GAIT


@pytest.fixture(scope="module")
def mission():
    """The mission of the tank, cut down to its first and its last phase."""
    steering = load_mission("tank-inspection").motion
    leave, *_, rest = steering.phases
    short = replace(leave, behaviour=replace(leave.behaviour, distance=0.2), done="rest")
    return replace(steering, phases=(replace(short, late="rest"), rest), always=())


def mission_tank() -> Tank:
    scenario = load_mission("tank-inspection")
    plant = lc.build_plant(scenario)
    nodes = replace(EXACT.nodes, hold_after=3.0, limp_after=4.0)
    world = VirtualRobot(scenario.robot, plant, scenario.start)
    return Tank(world, replace(EXACT, nodes=nodes))


def on_mission(mission, **changes) -> Operation:
    return operation(robot="mamba-fin", parameters="mamba-identified", steering=mission, **changes)


def test_a_mission_goes_through_its_phases_under_the_supervisor(mission, tmp_path: Path):
    tank = mission_tank()
    result = operate(on_mission(mission, duration=6.0), tmp_path, tank=tank)
    assert result.stopped is False
    assert not any(node.is_on for node in tank.nodes)
    log = read_operation(tmp_path / "sensed.mcap")
    (end,) = [event for event in log.of(Event) if event.kind == "stop"]
    assert end.message == "The run reached its end."
    decisions = log.of_run(Decision)
    phases = [decision.signals["mission_phase"] for decision in decisions]
    assert (phases[0], phases[-1]) == (0.0, 1.0)
    changed_at = decisions[phases.index(1.0)].time - log.span[0]
    assert 1.0 < changed_at < 5.0
    # The wall is 4.2 m to the right.
    pings = [sample for sample in log.of(SensorSample) if sample.sensor == "sonar"]
    echoes = [np.nanmin(ping.values) for ping in pings if ping.has_values]
    assert np.median(echoes) == pytest.approx(4.2, abs=0.3)


def test_over_wires_a_mission_is_told_the_same(mission, tmp_path: Path):
    lab = Lab(mission_tank(), bus=bus_address("virtual:sensed"), port=0, sensors_port=0, speed=0.5)
    with lab as addresses:
        connection = Connection(
            bus_address="virtual:sensed",
            mocap_address=f"{addresses.mocap_host}:{addresses.mocap_port}",
            sensors_address=f"127.0.0.1:{addresses.sensors_port}",
        )
        what = on_mission(mission, duration=2.0, rate=20.0, connection=connection)
        operate(what, tmp_path, clock=Clock(speed=0.5))
        # Also if this computer was too busy for it: then the supervisor has ended the run.
        assert not any(node.is_on for node in lab.tank.nodes)
    log = read_operation(tmp_path / "sensed.mcap")
    samples = log.of(SensorSample)
    names = set(lab.tank.body.sensor_columns)
    assert {sample.sensor for sample in samples if not sample.has_values} == names
    inertial = [sample for sample in samples if sample.sensor == "inertial" and sample.has_values]
    assert len(inertial) > 100
    assert all(before.time < after.time for before, after in pairwise(inertial))
    decisions = log.of(Decision)
    assert decisions[0].signals["mission_phase"] == 0.0
    assert decisions[0].signals["believed_std"] > 0.0
