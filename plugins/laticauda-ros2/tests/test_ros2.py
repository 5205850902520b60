"""The drivers at a robot and cameras as ROS 2 has them, over the loopback interface alone."""

import itertools
import math
import os
import struct
import subprocess
import sys
from pathlib import Path
from threading import Event, Thread

import numpy as np
import pytest
from patience import complaints, running, until
from trials import run_trial

pytest.importorskip("cyclonedds", reason="the DDS library is not installed: pip install cyclonedds")

from cyclonedds.core import Policy, Qos

import laticauda as lc
from laticauda.tank import lab
from laticauda.tank.operate.drivers import Clock, DeviceFailed, contract, driver_named
from laticauda.tank.protocol import (
    EmergencyStop,
    Heartbeat,
    JointState,
    NodeCommand,
    NodeState,
    Order,
    encode_references,
)
from laticauda_ros2 import messages, node
from laticauda_ros2.emulator import TOPIC, Controllers, Poses, tank_behind_ros
from laticauda_ros2.mocap import NoPose, sample
from laticauda_ros2.node import Node

N = 8
DOMAIN = 20 + os.getpid() % 80  # whoever runs tests beside us
SPACES = (f"/tests_{os.getpid()}_{count}" for count in itertools.count())
JOINTS = ",".join(f"joint_{number}" for number in range(1, N + 1))
ENABLE = NodeCommand(order=Order.ENABLE)
LOOPBACK = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>60</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""


@pytest.fixture(autouse=True)
def alone_and_patient(monkeypatch):
    """Nothing leaves this computer, and a driver waits longer where other tests keep it busy."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    for module in ("bus", "mocap"):
        monkeypatch.setattr(f"laticauda_ros2.{module}.PATIENCE", 10.0)
    longer_times = {"HOLD_AFTER": 1.5, "LIMP_AFTER": 2.5, "SILENT": 3.0}
    for name, longer_time in longer_times.items():
        monkeypatch.setattr(f"laticauda_ros2.bus.{name}", longer_time)


@pytest.fixture
def space():
    """A namespace that is nobody else's."""
    return next(SPACES)


@pytest.fixture
def addresses_elsewhere(space):
    """The addresses of a robot and cameras in a program of their own."""
    command = [sys.executable, "-m", "laticauda_ros2.emulator", str(DOMAIN), space]
    folders = [str(Path(module.__file__).parents[1]) for module in (lc, node)]
    path = os.pathsep.join([*folders, os.environ.get("PYTHONPATH", "")])
    with running(command, env=os.environ | {"PYTHONPATH": path}, stdout=subprocess.PIPE) as program:
        bus, mocap, _ = program.stdout.readline().split(" | ")
        yield bus.removeprefix("bus "), mocap.removeprefix("mocap ")


@pytest.fixture
def robot(space):
    """A tank whose robot is behind ros2_control, with time going on."""
    tank = tank_behind_ros()
    controllers = Controllers(len(tank.nodes), DOMAIN, space)
    controllers.lab = lab.Lab(tank, bus=controllers, port=0)
    controllers.address = f"{space}/{JOINTS}:{DOMAIN}"
    with controllers.lab:
        yield controllers


@pytest.fixture
def cameras(space):
    """A publisher of poses; `pose_at(time)` is one of them."""

    class Cameras:
        topic = f"{space}/tail/pose"
        address = f"{topic}:{DOMAIN}"

        def pose_at(self, time, position=(1.0, 2.0, -0.1), quaternion=(0.5, 0.5, 0.5, 0.5)):
            pose = messages.Pose(messages.Point(*position), messages.Quaternion(*quaternion))
            return messages.PoseStamped(header=messages.stamped(time), pose=pose)

        def publish(self, pose):
            self.node.say(self.topic, pose)

    cameras = Cameras()
    cameras.node = Node(DOMAIN)
    cameras.node.write(cameras.topic, messages.PoseStamped)
    yield cameras
    cameras.node.close()


@pytest.fixture
def mocap(cameras):
    """The driver, which has heard a first pose of 1000.0 s."""
    end = Event()

    def repeat():
        while not end.wait(0.01):
            cameras.publish(cameras.pose_at(1000.0))

    thread = Thread(target=repeat)
    thread.start()
    try:
        driver = driver_named("mocap", "ros2", cameras.address)(cameras.address, Clock(), "tail")
    finally:
        end.set()
        thread.join()
    with driver:
        yield driver


def open_driver(robot):
    driver_class = driver_named("bus", "ros2", robot.address)
    return driver_class(robot.address, Clock())


def reports_once(driver, condition, kind=Heartbeat, messages=()) -> dict:
    """The last heartbeats or joint states of all joints, once a condition on them holds."""
    reports: dict = {}

    def do_they_meet_it() -> bool:
        heard, _ = contract.listen(driver, driver._clock, 0.1, messages=messages)
        for item in heard:
            if isinstance(item.value, kind):
                reports[item.value.node] = item.value
        return len(reports) == N and condition(reports)

    until(do_they_meet_it)
    return reports


def is_any_motor_on(robot) -> bool:
    return robot.lab.call(lambda tank: any(module.is_on for module in tank.nodes))


# ---- poses ---------------------------------------------------------------------------------------


def test_a_message_says_where_the_body_is(cameras):
    quaternion = (0.0, 0.0, 1.001 * math.sin(0.2), 1.001 * math.cos(0.2))
    pose = sample(cameras.pose_at(1_700_000_000.125, quaternion=quaternion))
    assert pose.time == 1_700_000_000.125
    assert pose.position == pytest.approx([1.0, 2.0, -0.1])
    c, s = math.cos(0.4), math.sin(0.4)
    assert pose.rotation == pytest.approx(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    unseen = cameras.pose_at(1.0, position=(math.nan, 0.0, 0.0), quaternion=(0.0,) * 4)
    assert sample(unseen).is_lost


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"time": 0.0}, "its stamp must be a time, got 0 s and 0 ns"),
        ({"time": -1.0}, "its stamp must be a time, got -1 s"),
        ({"time": 1.0, "position": (math.inf, 0.0, 0.0)}, "its position must be finite"),
        ({"time": 1.0, "quaternion": (0.0,) * 4}, "its quaternion have length 1, got .* and 0"),
        (
            {"time": 1.0, "quaternion": (math.nan,) * 4},
            "its quaternion have length 1, got .* and nan",
        ),
    ],
)
def test_a_message_that_makes_no_sense_is_refused_with_a_reason(cameras, fields, reason):
    with pytest.raises(NoPose, match=reason):
        sample(cameras.pose_at(**fields))


def test_nonsense_is_told_and_what_is_late_is_lost(mocap, cameras, monkeypatch):
    times = []

    def has_come(time) -> bool:
        times.extend(pose.time for _, pose in mocap.receive())
        return time in times

    cameras.publish(cameras.pose_at(1001.0))
    until(lambda: has_come(1001.0))
    cameras.publish(cameras.pose_at(1000.9))
    cameras.publish(cameras.pose_at(1002.0))
    until(lambda: has_come(1002.0))
    cameras.publish(cameras.pose_at(1003.0, quaternion=(1.0,) * 4))
    until(lambda: mocap.trouble)
    assert (
        "invalid message: its position must be finite and its quaternion have length 1"
        in mocap.trouble
    )
    cameras.publish(cameras.pose_at(1004.0))
    until(lambda: has_come(1004.0))
    assert not mocap.trouble
    with monkeypatch.context() as patch:
        patch.setattr(
            messages.PoseStamped, "deserialize", lambda data: struct.unpack("<d", b"short")
        )
        cameras.publish(cameras.pose_at(1005.0))
        until(lambda: "invalid message: its bytes are not those of its type" in mocap.trouble)
    cameras.publish(cameras.pose_at(10.0))  # its clock began anew
    until(lambda: has_come(10.0))
    assert times == [1000.0, 1001.0, 1002.0, 1004.0, 10.0]


@pytest.mark.parametrize(
    ("reliability", "durability"),
    [
        (Policy.Reliability.BestEffort, Policy.Durability.Volatile),
        (Policy.Reliability.Reliable(10**8), Policy.Durability.TransientLocal),
    ],
)
def test_any_publisher_is_heard(cameras, monkeypatch, reliability, durability):
    cameras.node.close()
    quality = Qos(reliability, durability, Policy.History.KeepLast(1))
    monkeypatch.setattr(node, "SAYS", quality)
    cameras.node = Node(DOMAIN)
    cameras.node.write(cameras.topic, messages.PoseStamped)
    listener = Node(DOMAIN)
    listener.read(cameras.topic, messages.PoseStamped)

    def is_heard() -> bool:
        cameras.publish(cameras.pose_at(1.0))
        return bool(list(listener.taken(cameras.topic)))

    until(is_heard)
    listener.close()


def test_poses_that_do_not_come_are_refused_with_what_to_check(cameras, monkeypatch):
    monkeypatch.setattr("laticauda_ros2.mocap.PATIENCE", 0.2)
    with pytest.raises(
        DeviceFailed,
        match=f"No PoseStamped arrives on /nothing. Check its domain, here {DOMAIN}, and",
    ):
        monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
        driver_named("mocap", "ros2", "/nothing")("/nothing", Clock())
    with pytest.raises(
        DeviceFailed, match="do not name their body: leave `mocap_body` empty, or use a"
    ):
        driver_named("mocap", "ros2", cameras.address)(cameras.address, Clock(), "fish")
    reasons = {
        "tail": "must be TOPIC or TOPIC:DOMAIN, such as /tail/pose:0, got 'tail'",
        "/a b:1": "must be TOPIC or TOPIC:DOMAIN",
        "/tail:233": "must have a domain from 0 to 232, got '233'",
        "/tail:": "must have a domain from 0 to 232, got ''",
    }
    for address, reason in reasons.items():
        with pytest.raises(ValueError, match=f"`mocap_address` {reason}"):
            driver_named("mocap", "ros2", address)


# ---- joints --------------------------------------------------------------------------------------


def test_both_drivers_keep_the_contract_with_a_robot_in_another_program(
    addresses_elsewhere, monkeypatch
):
    bus, mocap = addresses_elsewhere
    # That an address of nothing is refused is tested below, with less patience.
    assert complaints(monkeypatch, "bus", bus, duration=0.5, moves=True) == ()
    assert complaints(monkeypatch, "mocap", mocap, duration=0.5) == ()


def test_joints_go_where_references_say_and_are_limp_after_close(robot):
    # Each its own, and their order is not that of the message.
    goals = [0.02 * number for number in range(1, N + 1)]
    with open_driver(robot) as driver:

        def are_there(_) -> bool:
            truth = robot.lab.call(lambda tank: tank.truth.joint_angle)
            return bool(max(abs(truth - goals)) < 0.015)

        reports_once(driver, are_there, messages=(ENABLE, *encode_references(goals)))
        states = reports_once(driver, lambda _: True, JointState, messages=encode_references(goals))
        angles = [states[number].angle for number in range(1, N + 1)]
        assert angles == pytest.approx(goals, abs=0.03)
    until(lambda: not is_any_motor_on(robot))


def test_an_emergency_stop_switches_all_motors_off_until_it_is_cleared(robot):
    straight = encode_references([0.0] * N)
    with open_driver(robot) as driver:
        reports_once(driver, lambda reports: reports[1].state.is_on, messages=(ENABLE, *straight))
        heartbeats = reports_once(
            driver,
            lambda reports: reports[N].state == NodeState.FAULT,
            messages=(EmergencyStop(), ENABLE, *straight),
        )
        assert all(heartbeat.emergency_stopped for heartbeat in heartbeats.values())
        until(lambda: not is_any_motor_on(robot))
        reports_once(
            driver,
            lambda reports: reports[N].state == NodeState.READY,
            messages=(NodeCommand(order=Order.CLEAR),),
        )


def test_rates_and_torques_may_be_missing(robot):
    robot.tells = ()
    with open_driver(robot) as driver:
        reports_once(
            driver,
            lambda reports: reports[1].state.is_on,
            messages=(ENABLE, *encode_references([0.5] * N)),
        )
        states = reports_once(
            driver,
            lambda reports: reports[1].rate > 0.05,
            JointState,
            messages=encode_references([0.5] * N),
        )
        assert states[1].torque == 0.0


def test_a_zero_that_is_set_counts_both_ways(robot):
    with open_driver(robot) as driver:
        driver.send((NodeCommand(order=Order.SET_ZERO, node=2, angle=0.1),))
        states = reports_once(driver, lambda reports: reports[2].angle > 0.07, JointState)
        assert states[2].angle == pytest.approx(0.1, abs=0.03)
        assert states[1].angle == pytest.approx(0.0, abs=0.03)
        reports_once(
            driver,
            lambda reports: reports[2].state.is_on,
            messages=(ENABLE, *encode_references([0.0] * N)),
        )

        def is_there(_) -> bool:
            truth = robot.lab.call(lambda tank: tank.truth.joint_angle)
            return bool(abs(truth[1] + 0.1) < 0.03 and abs(truth[0]) < 0.03)

        reports_once(driver, is_there, messages=encode_references([0.0] * N))


def test_a_robot_that_leaves_is_noticed(robot):
    with open_driver(robot) as driver:
        robot.lab.close()
        until(lambda: f"{robot._goals} and {robot._motors} any longer" in driver.bus_off)

        def is_silent() -> bool:
            heard, _ = contract.listen(driver, driver._clock, 0.5)
            return not heard

        until(is_silent)


def test_messages_of_other_shapes_are_lost(robot):
    with open_driver(robot) as driver:
        publisher = Node(DOMAIN)
        publisher.write(robot._states, messages.JointState)
        until(lambda: publisher.is_heard(robot._states))
        for names, angles in (
            (["joint_1"], [1.0, 2.0]),
            (["joint_1"], [math.nan]),
            (["wheel"], [3.0]),
            ([], [1.0]),
        ):
            message = messages.JointState(
                messages.stamped(1.0), name=names, position=angles, velocity=[], effort=[]
            )
            publisher.say(robot._states, message)
        assert publisher.has_arrived(robot._states, 10.0)
        heard, _ = contract.listen(driver, driver._clock, 0.3)
        publisher.close()
        states = [item.value for item in heard if isinstance(item.value, JointState)]
        assert max(abs(state.angle) for state in states) < 0.1


def test_a_robot_that_is_not_there_is_refused_with_what_to_check(space, monkeypatch):
    monkeypatch.setattr("laticauda_ros2.bus.PATIENCE", 0.3)
    address = f"{space}/a,b:{DOMAIN}"
    message = (
        rf"No node subscribes to {space}/forward_position_controller/commands in domain {DOMAIN}:"
    )
    with pytest.raises(DeviceFailed, match=rf"{message} .* \(for {address}\)"):
        driver_named("bus", "ros2", address)(address, Clock())
    robot = Controllers(2, DOMAIN, space)
    with (
        robot,
        pytest.raises(
            DeviceFailed, match=f"No position of a, b arrives on {space}/joint_states in domain"
        ),
    ):
        driver_named("bus", "ros2", address)(address, Clock())
    for address in ("a,,b", "a,a", "sp ace/a,b", ",".join(f"j{number}" for number in range(20))):
        with pytest.raises(
            ValueError,
            match=r"`bus_address` must be JOINT,JOINT,\.\.\. with up to 19 names, tail first",
        ):
            driver_named("bus", "ros2", address)


def test_a_whole_trial_runs_over_both(space, tmp_path: Path):
    tank = tank_behind_ros()
    topic = f"{space}/{lab.BODY.replace('-', '_')}/pose"
    virtual_lab = lab.Lab(tank, bus=Controllers(len(tank.nodes), DOMAIN, space))
    virtual_lab.server = Poses(DOMAIN, topic)
    result = run_trial(
        virtual_lab, tmp_path, bus=f"ros2@{space}/{JOINTS}:{DOMAIN}", mocap=f"ros2@{topic}:{DOMAIN}"
    )
    assert result.accepted, result.reason
    trial = lc.load_trial(tmp_path / "whole.nc")
    assert trial.forward_velocity > 0.0
    assert math.radians(10) < abs(trial.joint_angle).max() < math.radians(40)
    assert TOPIC in topic
