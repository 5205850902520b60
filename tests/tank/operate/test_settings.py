import math
import tomllib
from pathlib import Path

import pytest

from laticauda.control.estimation import Learning
from laticauda.motion.joints import Servo
from laticauda.robot import load_parameters, load_robot
from laticauda.tank.operate.settings import (
    Connection,
    Operation,
    OperationFileError,
    SeriesFile,
    load_operation,
    parse_operation,
)

TRIAL = """
kind = "trial"
name = "line-1"
duration = 60.0
[gait]
kind = "lateral-undulation"
amplitude_deg = 30
frequency_deg_s = 90
phase_shift_deg = 40
[following]
max_offset_deg = 20
"""
SERIES = """
kind = "series"
name = "two"
repeats = 3
[common]
duration = 5.0
[common.gait]
amplitude_deg = 30
frequency_deg_s = 90
phase_shift_deg = 40
[[trials]]
name = "a"
[[trials]]
name = "b"
robot = "mamba-fin"
gait.amplitude_deg = 20
start = { position = [0.0, 1.5], heading_deg = 7.7 }
"""


def test_a_trial_file_has_degrees_where_the_name_says_so():
    operation = parse_operation(TRIAL)
    assert isinstance(operation, Operation)
    assert operation.gait.amplitude == pytest.approx(math.radians(30))
    assert operation.gait.frequency == pytest.approx(math.radians(90))
    assert operation.following is not None
    assert operation.following.max_offset == pytest.approx(math.radians(20))
    assert operation.following.controller(operation.gait).heading.gain == 0.4


def test_parameters_give_robot_water_and_joint_law_for_the_gait_of_the_trial():
    operation = parse_operation(f"robot = 'mamba-fin'\nparameters = 'mamba-identified'\n{TRIAL}")
    assert isinstance(operation, Operation)
    parameters = load_parameters("mamba-identified")
    robot = load_robot("mamba-fin")
    assert operation.body() == parameters.robot(robot, "lateral_undulation") != robot
    assert operation.pool() == parameters.every_gait
    assert operation.joint_law() == parameters.joints
    eel = TRIAL.replace("lateral-undulation", "eel-like")
    by_gait = parse_operation(f"parameters = 'paper'\n{eel}")
    assert isinstance(by_gait, Operation)
    assert by_gait.pool() == load_parameters("paper").water("eel_like")


def test_usual_times_of_an_operation_are_as_said():
    operation = parse_operation(TRIAL)
    assert isinstance(operation, Operation)
    assert operation.calibration.still_time == 2.0
    assert (operation.limits.straighten_time, operation.limits.joint_error_time) == (2.0, 2.0)
    assert operation.offset_bandwidth == 25.0


def test_without_parameters_or_with_those_of_prescribed_joints_modules_are_servos():
    plain = parse_operation(TRIAL)
    prescribed = parse_operation(f"parameters = 'paper'\n{TRIAL}")
    assert isinstance(plain, Operation)
    assert isinstance(prescribed, Operation)
    assert plain.joint_law() == prescribed.joint_law() == Servo()
    assert plain.body() == load_robot("mamba")


def test_a_table_says_that_a_twin_learns_and_what():
    assert parse_operation(TRIAL).learning is None
    assert parse_operation(f"{TRIAL}[learning]\n").learning == Learning()
    told = "[learning]\nunknown = ['normal_drag', 'added_mass']\nwindow = 40\n"
    assert parse_operation(TRIAL + told).learning == Learning(
        unknown=("normal_drag", "added_mass"), window=40.0
    )


def test_nothing_is_learnt_in_depth():
    with pytest.raises(
        OperationFileError, match="`learning`: must be left out in space, where nothing is learned"
    ):
        parse_operation(f"{TRIAL}path_depth = [0.5]\n[learning]\n")


def test_a_series_file_puts_what_differs_over_what_is_common():
    series = parse_operation(SERIES)
    assert isinstance(series, SeriesFile)
    first, second = series.trials
    assert (series.repeats, first.robot, second.robot) == (3, "mamba", "mamba-fin")
    assert (first.duration, second.duration) == (5.0, 5.0)
    assert math.degrees(second.gait.amplitude) == pytest.approx(20)
    assert math.degrees(second.gait.phase_shift) == pytest.approx(40)
    assert second.start is not None
    assert math.degrees(second.start.heading) == pytest.approx(7.7)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("duraton = 3", r"key `duraton`: is not known; did you mean `duration`\?"),
        ("rate = 5", r"key `rate`: must be between 10 and 500 1/s, got 5"),
        ("duration_deg = 3", r"key `duration_deg`: is not known"),
        ("robot = 3\ngait = 4", r"key `gait`: must be a table, got 4"),
        (
            "following.max_offset_deg = -2",
            r"key `following.max_offset_deg`: must be > 0 deg, got -2",
        ),
        (
            "following.max_offset_deg = 'x'",
            r"key `following.max_offset_deg`: must be a number in deg, got 'x'",
        ),
        ("following.guidance = 'los'", r"key `following.guidance`: must be one of `line_of_sight`"),
        (
            "following.waypoints = [[0, 0]]",
            r"key `following.waypoints`: must hold at least 2 points",
        ),
        ("limits.max_current = 0", r"key `limits.max_current`: must be > 0 A, got 0"),
        ("tank.volume_x = [3, 1]", r"key `tank.volume_x`: must be a lower and an upper limit in m"),
        (
            "connection.bus_address = 'usb:can0'",
            r"key `connection.bus_address`: must be one of `virtual`",
        ),
        (
            "connection.bus = 'cam'",
            r"key `connection.bus`: must be one of `can`.*, got 'cam'; did you mean `can`\?",
        ),
        ("connection.mocap = 'os'", r"key `connection.mocap`: must be one of `qtm`.*, got 'os'"),
        (
            "connection.mocap_address = 'here'",
            r"key `connection.mocap_address`: must be HOST:PORT, .*, got 'here'",
        ),
        (
            "connection.stop_address = '/dev/ttyS0:tx'",
            r"key `connection.stop_address`: must be one of `cts`, `dsr`",
        ),
        (
            "connection.mocap_port = 4",
            r"key `connection.mocap_port`: is not known; did you mean `mocap_body`",
        ),
        (
            "connection.mocap_address = 'a:70000'",
            r"key `connection.mocap_address`: must be HOST:PORT, with a port from 1",
        ),
        (
            "connection.meter_address = '/dev/ttyUSB0'",
            r"key `supply_voltage`: must be given in V with a power meter",
        ),
        ("learning.window = 1", r"key `learning.window`: must be > 5 s, got 1"),
        (
            "learning.unknown = ['drag']",
            r"key `learning.unknown\[0\]`: must be one of `normal_drag`, .* got 'drag'",
        ),
        (
            "parameters = 'mamba-identified'\nwater = 'paper-eel'",
            r"key `parameters`: must not be given with `water`: both define the water",
        ),
        ("supply_voltage = 0", r"key `supply_voltage`: must be > 0 V, got 0"),
        (
            "calibration.still_speed = 'fast'",
            r"key `calibration.still_speed`: must be a number in m/s, got 'fast'",
        ),
        ("start.heading = 0.1", r"key `start.position`: is missing; every Placement needs it"),
        (
            "name = 'a b'",
            r"key `name`: must be a file name of letters, digits, `-` and `_`, got 'a b'",
        ),
    ],
)
def test_what_is_wrong_with_a_trial_file_is_said_with_its_key(text, message):
    own = text.partition(" = ")[0]
    base = TRIAL.replace('name = "line-1"\n', "") if own == "name" else TRIAL
    base = base[: base.index("[gait]")] if "gait = 4" in text else base
    head, _, tables = base.partition("[gait]")
    tables = tables.replace("max_offset_deg = 20\n", "") if own.endswith("offset_deg") else tables
    if own.startswith("following"):
        whole = f"{head}[gait]{tables}{text.partition('.')[2]}"
    else:
        whole = f"{head}{text}\n" + (f"[gait]{tables}" if tables else "")
    tomllib.loads(whole)
    with pytest.raises(OperationFileError, match=message):
        parse_operation(whole)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = 1", r"key `kind`: is missing; it must be one of \"trial\", \"series\""),
        ("kind = 'robot'", r"key `kind`: must be one of \"trial\", \"series\", got 'robot\'"),
        ("kind = 'trial'\nname = 'a'", r"key `gait`: is missing; every Operation needs it"),
        ("kind = 'series'\nname = 'a'", r"key `trials`: is missing; every SeriesFile needs it"),
        (
            "kind = 'series'\nname = 'a'\ntrials = []",
            r"key `trials`: must hold at least one trial, got none",
        ),
        ("kind = 'series'\nrepeat = 2", r"key `repeat`: is not known; did you mean `repeats`\?"),
        (SERIES.replace('"b"', '"a"'), r"key `trials`: must have distinct names, got 'a' twice"),
        (
            SERIES.replace("gait.amplitude_deg = 20", "gait.amplitude_dg = 20"),
            r"key `trials\[1\].gait.amplitude_dg`",
        ),
        (
            TRIAL + "max_offset = 0.3",
            r"key `following.max_offset_deg`: must not be given together with `max_offset`",
        ),
        ("kind = ", r"is not valid TOML"),
    ],
)
def test_other_files_are_refused_with_a_reason(text, message):
    with pytest.raises(OperationFileError, match=message):
        parse_operation(text)


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path):
    with pytest.raises(OperationFileError, match=r"no\.toml: no such file"):
        load_operation(tmp_path / "no.toml")
    (tmp_path / "x.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(OperationFileError, match=r"x\.toml: is not UTF-8 text"):
        load_operation(tmp_path / "x.toml")
    with pytest.raises(OperationFileError, match=r"is a folder, not a file"):
        load_operation(tmp_path)


@pytest.mark.parametrize(
    ("wave", "message"),
    [
        ("pitch", "`gait.pitch` must be None for a robot without pitch joints"),
        ("fin", "`gait.fin` must be None unless the fin is driven"),
    ],
)
def test_a_wave_of_joints_that_the_robot_does_not_have_is_refused(wave, message):
    line = f"{wave} = {{ amplitude = 0.1, frequency = 1.0 }}"
    operation = parse_operation(
        TRIAL.replace("phase_shift_deg = 40", "phase_shift_deg = 40\n" + line)
    )
    assert isinstance(operation, Operation)
    with pytest.raises(ValueError, match=message):
        operation.body()


def test_joints_that_cannot_bend_that_far_are_refused():
    operation = parse_operation(TRIAL.replace("amplitude_deg = 30", "amplitude_deg = 80"))
    assert isinstance(operation, Operation)
    with pytest.raises(ValueError, match="`max_offset` must be <="):
        operation.body()


def test_what_is_typed_replaces_what_holds_otherwise():
    usual = Connection(mocap_body="last-module")
    found = usual.at(bus="udp_multicast:239.1.2.3:4000", mocap="qtm@10.0.0.7:22225")
    assert found.of("bus") == ("can", "udp_multicast:239.1.2.3:4000")
    assert found.of("mocap") == ("qtm", "10.0.0.7:22225")
    assert found.mocap_body == "last-module"
    assert usual.at() == usual


@pytest.mark.parametrize("text", ["10.0.0.7", ":22223", "here:there"])
def test_a_motion_capture_without_host_or_port_is_refused(text):
    with pytest.raises(
        ValueError, match=f"`mocap` must be HOST:PORT, with a port from 1 to 65535, got '{text}'"
    ):
        Connection().at(mocap=text)
