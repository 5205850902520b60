"""The command in a process of its own, over real sockets."""

import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from patience import running

import laticauda as lc
import laticauda_ardupilot
from laticauda_ardupilot import LockStep, Server, app
from laticauda_ardupilot.emulator import Ardupilot, Pilot, fly
from laticauda_ardupilot.mixing import FILES
from laticauda_ardupilot.schedules import Clockwork

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
MIXING = """
kind = "mixing"
channels = [
  { kind = "amplitude", servo = 1, at_min_deg = -15, at_max_deg = 15 },
  { kind = "amplitude", servo = 2, at_min_deg = -15, at_max_deg = 15 },
  { kind = "offset", servo = 1, at_min_deg = -10, at_max_deg = 10 },
  { kind = "offset", servo = 2, at_min_deg = 10, at_max_deg = -10 },
]
"""


def environment_of_programs():
    """The environment of a program that finds both packages."""
    places = [str(Path(module.__file__).parents[1]) for module in (lc, laticauda_ardupilot)]
    return os.environ | {"PYTHONPATH": os.pathsep.join([*places, os.environ.get("PYTHONPATH", "")])}


@pytest.fixture
def robot(tmp_path):
    """The command's process; `address` is where it listens."""
    (tmp_path / "plane.toml").write_text(SCENARIO)
    (tmp_path / "mix.toml").write_text(MIXING)
    argv = [sys.executable, "-m", "laticauda_ardupilot.app", str(tmp_path / "plane.toml")]
    argv += ["--mixing", str(tmp_path / "mix.toml"), "--port", "0", "--json"]
    argv += ["--save", str(tmp_path / "run.nc")]
    with running(argv, env=environment_of_programs(), stdout=subprocess.PIPE) as program:
        said = json.loads(program.stdout.readline())
        program.address = said["host"], said["port"]
        yield program


def test_ardupilots_double_flies_restarts_and_ends_with_the_program(robot, tmp_path):
    pilot = Pilot(heading=math.radians(30.0), depth=0.0)
    readings = fly(Ardupilot(frame_rate=200), pilot, robot.address, duration=12.0)
    assert len(readings) == 12 * 200
    assert readings[-1]["timestamp"] == [pytest.approx(12.0)]
    errors = [math.degrees(numbers["attitude"][2]) - 30.0 for numbers in readings[-2 * 480 :]]
    assert sum(errors) / len(errors) == pytest.approx(0.0, abs=3.0)  # two cycles of the gait
    # Another process, as far as the server can tell: it begins again.
    again = fly(Ardupilot(frame_rate=200, n_channels=32), pilot, robot.address, duration=0.1)
    assert again[0]["timestamp"] == [pytest.approx(1 / 200)]
    assert again[0]["position"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    robot.send_signal(signal.SIGINT)
    counts = json.loads(robot.stdout.read())
    assert robot.wait(20.0) == 0
    assert counts["frames"] == 12 * 200 + 20
    assert counts["resets"] == 1
    assert lc.load_trial(tmp_path / "run.nc").time[-1] == pytest.approx(0.1)  # since the restart


def test_packets_that_a_socket_loses_and_doubles_are_survived():
    vehicle = Clockwork()
    server = Server(LockStep(vehicle), port=0)
    thread = threading.Thread(target=server.run)
    thread.start()
    ardupilot = Ardupilot(frame_rate=400)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.settimeout(0.4)  # more than `REPEAT_AFTER`
        link.sendto(b"not a packet", (server.host, server.port))
        for count in range(30):
            copies = 2 if count % 3 == 0 else 1
            for _ in range(copies):
                link.sendto(ardupilot.packet((1500,)), (server.host, server.port))
            if count % 15 == 7:
                link.recv(65536)  # this answer is lost on its way
                with pytest.raises(TimeoutError):
                    link.recv(65536)
                link.sendto(ardupilot.packet((1500,)), (server.host, server.port))
            ardupilot.receive(link.recv(65536))
    server.close()
    thread.join()
    assert vehicle.time == pytest.approx(30 / 400)
    assert ardupilot.time == pytest.approx(30 / 400)
    assert ardupilot.longest_step == pytest.approx(1 / 400)
    assert ardupilot.n_backward == 0


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["nowhere.toml"], "nowhere.toml"),
        (["--port", "70000"], "--port must be between 0 and 65535"),
        (["--mixing", "nowhere.toml"], "nowhere.toml"),
    ],
)
def test_the_command_refuses_what_it_cannot_serve(words, complaint, capsys):
    assert app.main(words) == 2
    assert complaint in " ".join(capsys.readouterr().err.split())


def test_other_computers_are_let_in_with_a_warning(capsys, monkeypatch):
    monkeypatch.setattr(app, "Vehicle", lambda scenario, mixing: Clockwork())
    monkeypatch.setattr(Clockwork, "step", lambda self, pwm, duration: None)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("0.0.0.0", 0))
        port = taken.getsockname()[1]
        words = ["eel", "--host", "0.0.0.0", "--port", str(port)]
        assert app.main(words) == 2  # the port is taken, but it was about to
    assert "Anyone who can reach this computer can drive" in capsys.readouterr().err


def test_a_port_that_is_taken_is_refused():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        with pytest.raises(ValueError, match=rf"`port` must be free on 127.0.0.1, got {port}: "):
            Server(LockStep(Clockwork()), port=port)


def test_every_parameter_of_the_frame_is_a_name_and_a_number():
    lines = [
        line for line in (FILES / "eel.parm").read_text().splitlines() if not line.startswith("#")
    ]
    parameters = dict(line.split() for line in lines)
    assert len(parameters) == len(lines)
    assert all(math.isfinite(float(value)) for value in parameters.values())
    assert parameters["FRAME_CONFIG"] == "4"


def test_pid_loops_in_another_process_hold_heading_and_depth_of_the_eel():
    env = environment_of_programs()
    server = [sys.executable, "-m", "laticauda_ardupilot.app", "eel", "--port", "0", "--json"]
    with running(server, env=env, stdout=subprocess.PIPE) as program:
        port = json.loads(program.stdout.readline())["port"]
        pilot = [sys.executable, "-m", "laticauda_ardupilot.emulator", "--port", str(port)]
        pilot += ["--rate", "50", "--heading-deg", "30", "--depth", "0.8", "--duration", "60"]
        with running(pilot, env=env, stdout=subprocess.PIPE) as flight:
            held = json.loads(flight.stdout.read())
    assert held["frames"] == 3000
    assert held["largest_heading_error_deg"] < 3.0
    assert held["largest_depth_error_m"] < 0.02
    assert held["north_m"] > 1.0  # it swam
    assert held["battery_V"] < 42.0
