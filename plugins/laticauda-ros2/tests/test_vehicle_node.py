"""A scenario as a node of ROS 2, in a program of its own, reached over the loopback interface."""

import itertools
import json
import math
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from patience import running, until

pytest.importorskip("cyclonedds", reason="the DDS library is not installed: pip install cyclonedds")

import laticauda as lc
from laticauda.models.spatial.scene import Pegs
from laticauda.robot import Thruster
from laticauda.scenarios import Planar, Spatial
from laticauda.values import BadArgument, RobotFileError
from laticauda_ros2 import app, messages, node
from laticauda_ros2.drive import Drive, Wish, load_drive
from laticauda_ros2.node import Node
from laticauda_ros2.vehicle_node import VehicleNode

DOMAIN = 20 + (os.getpid() + 40) % 80
SPACES = (f"/vehicle_{os.getpid()}_{count}" for count in itertools.count())
LOOPBACK = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>60</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""
SCENARIO = """
kind = "scenario"
robot = "mamba"
water = "paper-lateral"
[gait]
kind = "lateral-undulation"
amplitude_deg = 0
frequency_deg_s = 150
phase_shift_deg = 40
[model]
joints = "servo"
"""
GAIT = lc.lateral_undulation(amplitude=0.3, frequency=2.0, phase_shift=0.7)
EEL = replace(
    lc.load_robot("mamba-modules"),
    thrusters=[Thruster(link=9, thrust=0.0, max_thrust=12.0, elevation=math.pi / 2)],
)


@pytest.fixture(autouse=True)
def alone(monkeypatch):
    """Nothing leaves this computer."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)


class Other:
    """Another node: it hears what the robot tells, and tells it what to do."""

    def __init__(self, space):
        self.space = space
        self.node = Node(DOMAIN)
        self.last = {}
        kinds = {
            f"{space}/odom": messages.Odometry,
            f"{space}/joint_states": messages.JointState,
            f"{space}/imu/data": messages.Imu,
            f"{space}/pressure": messages.FluidPressure,
            f"{space}/range_0": messages.Range,
            f"{space}/range_1": messages.Range,
            "/tf": messages.TFMessage,
            "/clock": messages.Clock,
        }
        for topic, kind in kinds.items():
            self.node.read(topic, kind)
        self.node.write(f"{space}/cmd_vel", messages.Twist)
        self.node.write(f"{space}/forward_position_controller/commands", messages.Float64MultiArray)
        self.node.write(f"{space}/reset", messages.Empty)

    def hear(self, topic):
        """The last message of a topic, once there is one."""
        name = topic
        if not topic.startswith("/"):
            name = f"{self.space}/{topic}"

        def has_come():
            for message in self.node.taken(name):
                self.last[name] = message
            return name in self.last

        until(has_come, 60.0)
        return self.last[name]

    def ask(self, forward=0.0, turn=0.0):
        twist = messages.Twist(
            linear=messages.Vector3(x=forward, y=0.0, z=0.0),
            angular=messages.Vector3(x=0.0, y=0.0, z=turn),
        )
        self.node.say(f"{self.space}/cmd_vel", twist)


@pytest.fixture
def robot(tmp_path):
    """The node in a program of its own, faster than real time, and another node here."""
    space = next(SPACES)
    (tmp_path / "plane.toml").write_text(SCENARIO)
    command = [sys.executable, "-m", "laticauda_ros2.app", str(tmp_path / "plane.toml"), "--json"]
    command += ["--namespace", space, "--domain", str(DOMAIN), "--speed", "4"]
    folders = [str(Path(module.__file__).parents[1]) for module in (lc, node)]
    path = os.pathsep.join([*folders, os.environ.get("PYTHONPATH", "")])
    with running(command, env=os.environ | {"PYTHONPATH": path}, stdout=subprocess.PIPE) as program:
        program.announcement = json.loads(program.stdout.readline())
        program.other = Other(space)
        yield program
        program.other.node.close()


def x_of(other):
    return other.hear("odom").pose.pose.position.x


def test_a_twist_swims_and_turns_the_robot_and_without_one_it_stops(robot):
    other = robot.other
    assert f"{other.space}/cmd_vel" in robot.announcement["topics"]
    other.hear("odom")
    until(lambda: other.ask(forward=0.5, turn=0.1) or x_of(other) > 0.3, 60.0)
    until(lambda: other.ask(turn=0.1) or other.hear("odom").pose.pose.orientation.z > 0.05, 60.0)

    def is_still():  # no more of `ask`: half a second later, it forgets
        rates = other.hear("joint_states").velocity
        return max(abs(rate) for rate in rates) < 1e-3

    until(is_still, 60.0)
    robot.send_signal(signal.SIGINT)
    assert robot.wait(20.0) == 0


def test_joint_positions_are_held_until_a_twist_comes_and_a_reset_begins_again(robot):
    other = robot.other
    angles = [0.02 * number for number in range(8)]

    def are_there():
        topic = f"{other.space}/forward_position_controller/commands"
        other.node.say(topic, messages.numbers([0.5] * 3))
        other.node.say(topic, messages.numbers(angles))
        return np.allclose(other.hear("joint_states").position, angles, atol=0.01)

    until(are_there, 60.0)
    states = other.hear("joint_states")
    assert states.name == [f"joint_{number}" for number in range(8)]
    other.ask()
    until(lambda: np.allclose(other.hear("joint_states").position, 0.0, atol=0.01), 60.0)
    before = other.hear("/clock").clock.sec
    assert before >= 1
    other.node.say(f"{other.space}/reset", messages.Empty(structure_needs_at_least_one_member=0))
    until(lambda: other.hear("/clock").clock.sec == 0, 60.0)
    robot.send_signal(signal.SIGINT)
    assert json.loads(robot.stdout.read())["refused"] >= 1  # those of three joints


def test_messages_of_one_step_agree_with_one_another(robot):
    other = robot.other
    until(lambda: other.ask(forward=0.5, turn=0.1) or x_of(other) > 0.2, 60.0)

    def are_of_one_step():
        stamp = other.hear("odom").header.stamp
        return stamp == other.hear("/tf").transforms[0].header.stamp

    until(are_of_one_step, 60.0)
    odometry = other.last[f"{other.space}/odom"]
    tf = other.last["/tf"]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    of_base, of_root = tf.transforms
    assert (of_base.header.frame_id, of_base.child_frame_id) == ("odom", "base_link")
    assert (of_root.header.frame_id, of_root.child_frame_id) == ("odom", "module_0")
    base = of_base.transform.translation
    root = of_root.transform.translation
    length = lc.load_robot("mamba").length
    assert math.hypot(base.x - root.x, base.y - root.y) == pytest.approx(0.5 * length, rel=0.2)
    assert other.hear("imu/data").linear_acceleration.z == pytest.approx(9.80665, abs=1e-6)
    assert other.hear("pressure").fluid_pressure == pytest.approx(101_325.0)


def test_rays_are_ranges_and_a_robot_in_space_has_a_depth():
    model = Spatial(joints=lc.Servo(), scene=Pegs(), rays=(0.0, math.pi))
    scenario = replace(
        lc.build_scenario(EEL, GAIT),
        model=model,
        start=lc.Start(center_of_mass=(-3.0, 0.0), depth=0.5),
    )
    space = next(SPACES)
    vehicle_node = VehicleNode(scenario, Drive(thruster=0, thrust=12.0), domain=DOMAIN, space=space)
    other = Other(space)
    n_steps = itertools.count()
    ends = {"range_0", "range_1", "pressure"}

    def has_told():
        for name in ends:
            for message in other.node.taken(f"{space}/{name}"):
                other.last[name] = message
        return ends <= set(other.last) or next(n_steps) > 2000

    vehicle_node.run(has_told, speed=0.0)
    vehicle_node.close()
    ahead, behind = other.last["range_0"], other.last["range_1"]
    assert 0.0 < ahead.range < 100.0
    assert ahead.header.frame_id == "module_18"
    assert behind.range == math.inf or behind.range < 100.0
    depth = (other.last["pressure"].fluid_pressure - 101_325.0) / (1000.0 * 9.80665)
    assert depth == pytest.approx(0.5, abs=0.05)
    other.node.close()


# ---- what a Twist becomes ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wish", "amplitude", "phase_shift", "offset"),
    [
        (Wish(), 0.0, 0.7, 0.0),
        (Wish(forward=0.1, turn=0.1), 0.25, 0.7, 0.1),
        (Wish(forward=-0.2, turn=-0.2), 0.5, -0.7, -0.2),
        (Wish(forward=9.0, turn=9.0), 0.5, 0.7, 0.2),
    ],
)
def test_a_twist_sets_wave_and_bend_in_proportion_up_to_their_most(
    wish, amplitude, phase_shift, offset
):
    command = Drive().command(GAIT, EEL, wish)
    assert command.gait.amplitude == pytest.approx(amplitude)
    assert command.gait.phase_shift == phase_shift
    assert command.offset == pytest.approx(offset)
    assert command.thrusts is None


def test_climbing_is_thrust_upward_and_pitch_joints_that_nose_up():
    drive = Drive(thruster=0, thrust=12.0, pitch_offset=0.1)
    command = drive.command(GAIT, EEL, Wish(climb=0.05))
    assert command.thrusts == (6.0,)
    assert command.pitch_offset == pytest.approx(-0.05)


@pytest.mark.parametrize(
    ("drive", "model", "rule"),
    [
        (Drive(thruster=1), Spatial(), "thruster.*must be below 1, .* got 1"),
        (
            Drive(pitch_offset=0.1),
            Planar(),
            "pitch_offset.*must be 0 without pitch joints, in space",
        ),
    ],
)
def test_a_drive_with_what_the_robot_does_not_have_is_refused(drive, model, rule):
    with pytest.raises(BadArgument, match=rule):
        drive.check(EEL, model)


def test_a_drive_is_a_file(tmp_path):
    file = tmp_path / "drive.toml"
    file.write_text('kind = "drive"\nforward_speed = 0.12\namplitude_deg = 25\n')
    assert load_drive(file) == Drive(forward_speed=0.12, amplitude=math.radians(25.0))
    file.write_text('kind = "drive"\nforward_speed = 0\n')
    with pytest.raises(RobotFileError, match=r"drive\.toml.*forward_speed.*must be > 0"):
        load_drive(file)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["nowhere.toml"], "nowhere.toml"),
        (["x.toml", "--namespace", "eel"], "`namespace` must be such as /eel, got 'eel'"),
        (["x.toml", "--domain", "300"], "domain must be between 0 and 232"),
    ],
)
def test_the_command_refuses_what_it_cannot_serve(words, complaint, capsys):
    assert app.main(words) == 2
    assert complaint in " ".join(capsys.readouterr().err.split())
