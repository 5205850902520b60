import json
import math
from pathlib import Path

import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.lab import Lab, LabSettings, NodeSettings, Tank, VirtualRobot
from laticauda.protocol import bus_address

TRIAL = """
kind = "trial"
name = "cli"
duration = 1.0
supply_voltage = 35.0
rate = 20
countdown = 0.1
[gait]
amplitude_deg = 20
frequency_deg_s = 90
phase_shift_deg = 40
[tank]
volume_x = [-1, 11]
[calibration]
joint_zeros = true
idle_time = 1
still_time = 0.3
[limits]
max_lateness = 3
joint_timeout = 3
heartbeat_timeout = 3
mocap_timeout = 5
straighten_time = 1
"""


@pytest.fixture
def lab():
    robot = lc.load_robot("mamba")
    world = VirtualRobot(robot, lc.plant(robot, lc.load_water("paper-lateral"), joints="servo"), lc.Start(heading=0.1))
    settings = LabSettings(seed=2, nodes=NodeSettings(startup_time=0.1, calibration_time=0.1))
    return Lab(Tank(world, settings), bus=bus_address("virtual:cli-operate"), port=0)


@pytest.fixture
def trial(tmp_path: Path) -> str:
    file = tmp_path / "trial.toml"
    file.write_text(TRIAL, encoding="utf-8")
    return str(file)


def words(addresses) -> list[str]:
    mocap = f"{addresses.mocap_host}:{addresses.mocap_port}"
    return ["--can", "virtual:cli-operate", "--mocap", mocap, "--meter", addresses.meter]


def test_a_trial_file_becomes_a_trial_a_recording_and_one_json_object(lab, trial, tmp_path, capsys):
    with lab as addresses:
        assert main(["operate", trial, "--json", "--output", str(tmp_path / "runs"), *words(addresses)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["accepted"]
    assert found["initial_heading"] == pytest.approx(0.1, abs=math.radians(1))
    assert lc.load_trial(tmp_path / "runs" / "cli.nc").forward_velocity == found["forward_velocity"]
    picture = tmp_path / "timing.png"
    assert main(["replay", str(tmp_path / "runs" / "cli.mcap"), "--plot-timing", str(picture)]) == 0
    assert f"{found['timing']['ticks']} ticks of 50.0 ms" in capsys.readouterr().out
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_check_says_that_all_devices_are_well_and_keeps_nothing(lab, trial, tmp_path, capsys):
    with lab as addresses:
        assert main(["operate", trial, "--check", "--output", str(tmp_path / "runs"), *words(addresses)]) == 0
        assert not any(node.is_on for node in lab.tank.nodes)
    out, err = capsys.readouterr()
    assert "All devices are well." in out
    assert "8 modules and the motion capture are heard" in err
    assert not (tmp_path / "runs").exists()


def test_what_is_wrong_is_said_on_standard_error_with_status_2(trial, tmp_path, capsys):
    for args, message in (
        ([str(tmp_path / "no.toml")], "no such file"),
        ([trial, "--mocap", "here"], "--mocap must be HOST:PORT, got 'here'"),
        ([trial, "--can", "virtual:a", "--mocap", "127.0.0.1:1"], "motion capture at 127.0.0.1:1 cannot be reached"),
        ([trial, "--speed", "0"], "--speed must be > 0"),
    ):
        assert main(["operate", *args]) == 2
        assert message in capsys.readouterr().err


def test_its_help_has_an_example(capsys):
    assert main(["operate", "--help"]) == 0
    out = capsys.readouterr().out
    assert "laticauda operate trial.toml" in out
    assert "emergency stop" in " ".join(out.split())
