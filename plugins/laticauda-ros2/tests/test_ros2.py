"""The drivers at a robot and cameras as ROS 2 has them, over the loopback interface alone."""

import itertools
import math
import os
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from patience import complaints, running, until
from trials import swum

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
ON = NodeCommand(order=Order.ENABLE)
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
    for name, longer in {"HOLD_AFTER": 1.5, "LIMP_AFTER": 2.5, "SILENT": 3.0}.items():
        monkeypatch.setattr(f"laticauda_ros2.bus.{name}", longer)


@pytest.fixture
def space():
    """A namespace that is nobody else's."""
    return next(SPACES)


@pytest.fixture
def elsewhere(space):
    """A robot and cameras in a program of their own: the addresses of both."""
    argv = [sys.executable, "-m", "laticauda_ros2.emulator", str(DOMAIN), space]
    places = [str(Path(module.__file__).parents[1]) for module in (lc, node)]
    env = os.environ | {"PYTHONPATH": os.pathsep.join([*places, os.environ.get("PYTHONPATH", "")])}
    with running(argv, env=env, stdout=subprocess.PIPE) as program:
        yield [part.split()[1] for part in program.stdout.readline().split(" | ")[:2]]


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
    """A publisher of poses, 100 a second; `at(time)` is one of them."""

    class Cameras:
        topic, address = f"{space}/tail/pose", f"{space}/tail/pose:{DOMAIN}"

        def at(self, time, place=(1.0, 2.0, -0.1), turned=(0.5, 0.5, 0.5, 0.5)):
            pose = messages.Pose(messages.Point(*place), messages.Quaternion(*turned))
            return messages.PoseStamped(header=messages.stamped(time), pose=pose)

        def say(self, *poses):
            for pose in poses:
                self.node.say(self.topic, pose)

    found = Cameras()
    found.node = Node(DOMAIN)
    found.node.write(found.topic, messages.PoseStamped)
    yield found
    found.node.close()


@pytest.fixture
def sees(cameras):
    """The driver, which has heard a first pose of 1000.0 s."""
    from threading import Event, Thread

    end = Event()

    def repeat():
        while not end.wait(0.01):
            cameras.say(cameras.at(1000.0))

    thread = Thread(target=repeat)
    thread.start()
    try:
        driver = driver_named("mocap", "ros2", cameras.address)(cameras.address, Clock(), "tail")
    finally:
        end.set()
        thread.join()
    with driver:
        yield driver


def opened(robot, clock=None):
    return driver_named("bus", "ros2", robot.address)(robot.address, clock or Clock())


def told(driver, wanted, kind=Heartbeat, **how) -> dict:
    """The last heartbeats or joint states of all joints, once they are as wanted."""
    last: dict = {}

    def are_as_wanted() -> bool:
        found, _ = contract.listen(driver, driver._clock, 0.1, **how)
        last.update({one.value.node: one.value for one in found if isinstance(one.value, kind)})
        return len(last) == N and wanted(last)

    until(are_as_wanted)
    return last


# ---- poses ---------------------------------------------------------------------------------------


def test_a_message_says_where_the_body_is(cameras):
    pose = sample(
        cameras.at(
            1_700_000_000.125, turned=(0.0, 0.0, 1.001 * math.sin(0.2), 1.001 * math.cos(0.2))
        )
    )
    assert pose.time == 1_700_000_000.125
    assert pose.position == pytest.approx([1.0, 2.0, -0.1])
    c, s = math.cos(0.4), math.sin(0.4)
    assert pose.rotation == pytest.approx(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    assert sample(cameras.at(1.0, place=(math.nan, 0.0, 0.0), turned=(0.0,) * 4)).is_lost


@pytest.mark.parametrize(
    ("what", "why"),
    [
        ({"time": 0.0}, "its stamp must be a time, got 0 s and 0 ns"),
        ({"time": -1.0}, "its stamp must be a time, got -1 s"),
        ({"time": 1.0, "place": (math.inf, 0.0, 0.0)}, "its position must be finite"),
        ({"time": 1.0, "turned": (0.0,) * 4}, "its quaternion have length 1, got .* and 0"),
        ({"time": 1.0, "turned": (math.nan,) * 4}, "its quaternion have length 1, got .* and nan"),
    ],
)
def test_a_message_that_makes_no_sense_is_refused_with_a_reason(cameras, what, why):
    with pytest.raises(NoPose, match=why):
        sample(cameras.at(**what))


def test_nonsense_is_told_and_what_is_late_is_lost(sees, cameras, monkeypatch):
    found = []

    def has_come(time) -> bool:
        found.extend(pose.time for _, pose in sees.receive())
        return time in found

    for when in (1001.0, 1000.9, 1002.0):
        cameras.say(cameras.at(when))
        until(lambda when=when: has_come(when) or when == 1000.9)
    cameras.say(cameras.at(1003.0, turned=(1.0,) * 4))
    until(lambda: sees.trouble)
    assert (
        "invalid message: its position must be finite and its quaternion have length 1"
        in sees.trouble
    )
    cameras.say(cameras.at(1004.0))
    until(lambda: has_come(1004.0))
    assert not sees.trouble
    with monkeypatch.context() as patch:
        patch.setattr(
            messages.PoseStamped, "deserialize", lambda data: struct.unpack("<d", b"short")
        )
        cameras.say(cameras.at(1005.0))
        until(lambda: "invalid message: its bytes are not those of its type" in sees.trouble)
    cameras.say(cameras.at(10.0))  # its clock began anew
    until(lambda: has_come(10.0))
    assert found == [1000.0, 1001.0, 1002.0, 1004.0, 10.0]


@pytest.mark.parametrize(
    "quality", [Policy.Reliability.BestEffort, Policy.Reliability.Reliable(10**8)]
)
def test_any_publisher_is_heard(cameras, monkeypatch, quality):
    cameras.node.close()
    durable = (
        Policy.Durability.TransientLocal
        if quality != Policy.Reliability.BestEffort
        else Policy.Durability.Volatile
    )
    monkeypatch.setattr(node, "SAYS", Qos(quality, durable, Policy.History.KeepLast(1)))
    cameras.node = Node(DOMAIN)
    cameras.node.write(cameras.topic, messages.PoseStamped)
    heard = Node(DOMAIN)
    heard.read(cameras.topic, messages.PoseStamped)
    until(lambda: cameras.say(cameras.at(1.0)) or list(heard.taken(cameras.topic)))
    heard.close()


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
    for address, why in {
        "tail": "must be TOPIC or TOPIC:DOMAIN, such as /tail/pose:0, got 'tail'",
        "/a b:1": "must be TOPIC or TOPIC:DOMAIN",
        "/tail:233": "must have a domain from 0 to 232, got '233'",
        "/tail:": "must have a domain from 0 to 232, got ''",
    }.items():
        with pytest.raises(ValueError, match=f"`mocap_address` {why}"):
            driver_named("mocap", "ros2", address)


# ---- joints --------------------------------------------------------------------------------------


def test_both_drivers_keep_the_contract_with_a_robot_in_another_program(elsewhere, monkeypatch):
    bus, mocap = elsewhere
    # That an address of nothing is refused is tested below, with less patience.
    assert complaints(monkeypatch, "bus", bus, duration=0.5, moves=True) == ()
    assert complaints(monkeypatch, "mocap", mocap, duration=0.5) == ()


def test_joints_go_where_references_say_and_are_limp_after_close(robot):
    goals = [
        0.02 * number for number in range(1, N + 1)
    ]  # each its own, and their order is not that of the message
    with opened(robot) as driver:

        def are_there(_) -> bool:
            truth = robot.lab.call(lambda tank: tank.truth.joint_angle)
            return bool(max(abs(truth - goals)) < 0.015)

        told(driver, are_there, messages=(ON, *encode_references(goals)))
        angles = told(driver, lambda _: True, JointState, messages=encode_references(goals))
        assert [angles[number].angle for number in range(1, N + 1)] == pytest.approx(
            goals, abs=0.03
        )
    until(lambda: not robot.lab.call(lambda tank: any(one.is_on for one in tank.nodes)))


def test_an_emergency_stop_switches_all_motors_off_until_it_is_cleared(robot):
    held = encode_references([0.0] * N)
    with opened(robot) as driver:
        told(driver, lambda last: last[1].state.is_on, messages=(ON, *held))
        found = told(
            driver,
            lambda last: last[N].state == NodeState.FAULT,
            messages=(EmergencyStop(), ON, *held),
        )
        assert all(one.emergency_stopped for one in found.values())
        until(lambda: not robot.lab.call(lambda tank: any(one.is_on for one in tank.nodes)))
        told(
            driver,
            lambda last: last[N].state == NodeState.READY,
            messages=(NodeCommand(order=Order.CLEAR),),
        )


def test_rates_and_torques_may_be_missing(robot):
    robot.tells = ()
    with opened(robot) as driver:
        told(driver, lambda last: last[1].state.is_on, messages=(ON, *encode_references([0.5] * N)))
        first = told(
            driver,
            lambda last: last[1].rate > 0.05,
            JointState,
            messages=encode_references([0.5] * N),
        )
        assert first[1].torque == 0.0


def test_a_zero_that_is_set_counts_both_ways(robot):
    with opened(robot) as driver:
        driver.send((NodeCommand(order=Order.SET_ZERO, node=2, angle=0.1),))
        found = told(driver, lambda last: last[2].angle > 0.07, JointState)
        assert found[2].angle == pytest.approx(0.1, abs=0.03)
        assert found[1].angle == pytest.approx(0.0, abs=0.03)
        told(driver, lambda last: last[2].state.is_on, messages=(ON, *encode_references([0.0] * N)))

        def is_there(_) -> bool:
            truth = robot.lab.call(lambda tank: tank.truth.joint_angle)
            return bool(abs(truth[1] + 0.1) < 0.03 and abs(truth[0]) < 0.03)

        told(driver, is_there, messages=encode_references([0.0] * N))


def test_a_robot_that_leaves_is_noticed(robot):
    with opened(robot) as driver:
        robot.lab.close()
        until(lambda: f"{robot._goals} and {robot._motors} any longer" in driver.bus_off)

        def is_silent() -> bool:
            heard, _ = contract.listen(driver, driver._clock, 0.5)
            return not heard

        until(is_silent)


def test_messages_of_other_shapes_are_lost(robot):
    with opened(robot) as driver:
        other = Node(DOMAIN)
        other.write(robot._states, messages.JointState)
        until(lambda: other.is_heard(robot._states))
        for names, angles in (
            (["joint_1"], [1.0, 2.0]),
            (["joint_1"], [math.nan]),
            (["wheel"], [3.0]),
            ([], [1.0]),
        ):
            said = messages.JointState(
                messages.stamped(1.0), name=names, position=angles, velocity=[], effort=[]
            )
            other.say(robot._states, said)
        assert other.has_arrived(robot._states, 10.0)
        found, _ = contract.listen(driver, driver._clock, 0.3)
        other.close()
        assert max(abs(one.value.angle) for one in found if isinstance(one.value, JointState)) < 0.1


def test_a_robot_that_is_not_there_is_refused_with_what_to_check(space, monkeypatch):
    monkeypatch.setattr("laticauda_ros2.bus.PATIENCE", 0.3)
    address = f"{space}/a,b:{DOMAIN}"
    wanted = (
        rf"No node subscribes to {space}/forward_position_controller/commands in domain {DOMAIN}:"
    )
    with pytest.raises(DeviceFailed, match=rf"{wanted} .* \(for {address}\)"):
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
    served = lab.Lab(tank, bus=Controllers(len(tank.nodes), DOMAIN, space))
    served.server = Poses(DOMAIN, topic)
    result = swum(
        served, tmp_path, bus=f"ros2@{space}/{JOINTS}:{DOMAIN}", mocap=f"ros2@{topic}:{DOMAIN}"
    )
    assert result.accepted, result.reason
    trial = lc.load_trial(tmp_path / "whole.nc")
    assert trial.forward_velocity > 0.0
    assert math.radians(10) < abs(trial.joint_angle).max() < math.radians(40)
    assert TOPIC in topic
