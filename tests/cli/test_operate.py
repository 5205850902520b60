import json
import math
import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest
from lab_parts import EXACT
from tank.operate.tank import DRAWN, IDLE, record

import laticauda as lc
from laticauda.cli import main
from laticauda.control.estimation import Learned
from laticauda.tank import operate
from laticauda.tank.lab import Lab, Tank, VirtualRobot
from laticauda.tank.operate import session
from laticauda.tank.operate.verdict import verdict_of
from laticauda.tank.protocol import bus_address
from laticauda.trials.logs import load_trial

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
[acceptance]
pose_age = 3
longest_silence = 3
missing_in_run = 0.9
"""


@pytest.fixture
def lab():
    """A tank whose sensors read what is so, and whose modules wait for a computer that is busy with other tests."""
    robot = lc.load_robot("mamba")
    world = VirtualRobot(
        robot,
        lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo"),
        lc.Start(heading=0.1),
    )
    settings = replace(EXACT, nodes=replace(EXACT.nodes, hold_after=3.0, limp_after=4.0))
    return Lab(Tank(world, settings), bus=bus_address("virtual:cli-operate"), port=0)


@pytest.fixture
def trial(tmp_path: Path) -> str:
    file = tmp_path / "trial.toml"
    file.write_text(TRIAL, encoding="utf-8")
    return str(file)


def words(addresses) -> list[str]:
    mocap = f"{addresses.mocap_host}:{addresses.mocap_port}"
    return ["--bus", "virtual:cli-operate", "--mocap", mocap, "--meter", addresses.meter]


def test_a_trial_file_becomes_a_trial_a_recording_and_one_json_object(lab, trial, tmp_path, capsys):
    with lab as addresses:
        assert (
            main(
                ["operate", trial, "--json", "--output", str(tmp_path / "runs"), *words(addresses)]
            )
            == 0
        )
    found = json.loads(capsys.readouterr().out)
    assert found["accepted"]
    assert found["initial_heading"] == pytest.approx(0.1, abs=math.radians(0.3))
    assert lc.load_trial(tmp_path / "runs" / "cli.nc").forward_velocity == found["forward_velocity"]
    picture, sheet = tmp_path / "timing.png", tmp_path / "run.png"
    words_of = ["--plot-timing", str(picture), "--plot", str(sheet)]
    assert main(["replay", str(tmp_path / "runs" / "cli.mcap"), *words_of]) == 0
    out = capsys.readouterr().out
    assert f"{found['timing']['ticks']} ticks of 50.00 ms" in out
    assert "simulated" not in out
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert sheet.read_bytes().startswith(b"\x89PNG")


def test_a_check_says_that_all_devices_are_well_and_keeps_nothing(lab, trial, tmp_path, capsys):
    with lab as addresses:
        assert (
            main(
                ["operate", trial, "--check", "--output", str(tmp_path / "runs"), *words(addresses)]
            )
            == 0
        )
        assert not any(node.is_on for node in lab.tank.nodes)
    out, err = capsys.readouterr()
    assert "All devices are OK." in out
    assert "8 modules and the motion capture respond" in err
    assert not (tmp_path / "runs").exists()


def series_of(names: str, tmp_path: Path) -> str:
    common = TRIAL.replace('kind = "trial"\nname = "cli"\n', "").replace("[", "[common.")
    common = common.replace("[common.-1, 11]", "[-1, 11]")
    trials = "".join(f'[[trials]]\nname = "{name}"\n' for name in names)
    file = tmp_path / "series.toml"
    file.write_text(
        f'kind = "series"\nname = "s"\nrepeats = 1\n[common]\n{common}{trials}', encoding="utf-8"
    )
    return str(file)


def test_ctrl_c_after_a_run_while_it_is_judged_ends_the_series_and_the_run_counts(
    lab, tmp_path, capsys, monkeypatch
):
    def judged(*args):
        os.kill(os.getpid(), signal.SIGINT)
        return verdict_of(*args)

    monkeypatch.setattr(session, "verdict_of", judged)
    with lab as addresses:
        file, folder = series_of("ab", tmp_path), tmp_path / "runs"
        assert main(["operate", file, "--json", "--output", str(folder), *words(addresses)]) == 1
    (only,) = json.loads(capsys.readouterr().out)["settings"]
    assert (only["name"], only["accepted"], only["rejected"]) == ("a", 1, [])
    assert {path.name for path in (folder / "s").glob("*")} == {"a-1.mcap", "a-1.nc", "repeats.csv"}


def test_a_check_of_a_series_checks_each_robot_once_and_keeps_nothing(lab, tmp_path, capsys):
    with lab as addresses:
        check = [
            "operate",
            series_of("ab", tmp_path),
            "--check",
            "--output",
            str(tmp_path / "runs"),
        ]
        assert main([*check, *words(addresses)]) == 0
    assert capsys.readouterr().out.count("All devices are OK.") == 1
    assert not (tmp_path / "runs").exists()


def test_what_is_wrong_is_said_on_standard_error_with_status_2(trial, tmp_path, capsys):
    for args, message in (
        ([str(tmp_path / "no.toml")], "no such file"),
        (
            [trial, "--mocap", "here"],
            "--mocap must be HOST:PORT, with a port from 1 to 65535, got 'here'",
        ),
        (
            [trial, "--bus", "virtual:a", "--mocap", "127.0.0.1:1"],
            "motion capture at 127.0.0.1:1 cannot be reached",
        ),
        ([trial, "--speed", "0"], "--speed must be > 0"),
    ):
        assert main(["operate", *args]) == 2
        assert message in capsys.readouterr().err


def test_a_robot_that_does_not_exist_is_told_with_the_file_that_names_it(tmp_path, capsys):
    file = tmp_path / "trial.toml"
    file.write_text(
        TRIAL.replace("supply_voltage", 'robot = "mamnba"\nsupply_voltage'), encoding="utf-8"
    )
    assert main(["operate", str(file), "--check"]) == 2
    assert (
        f"{file}: there is no robot preset named `mamnba`; did you mean `mamba`?"
        in capsys.readouterr().err
    )


def test_its_help_has_an_example(capsys):
    assert main(["operate", "--help"]) == 0
    out = capsys.readouterr().out
    assert "laticauda operate trial.toml" in out
    assert "emergency stop" in " ".join(out.split())


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "run.mcap"
    record(path)
    return path


def test_it_prints_the_figures_and_writes_the_trial(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    assert main(["replay", str(file), "--save", str(tmp_path / "run.nc"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    trial = load_trial(tmp_path / "run.nc")
    assert found["forward_velocity"] == trial.forward_velocity
    assert found["electrical_power"] == pytest.approx(35.0 * (DRAWN - IDLE))
    assert found["lost"] == "" and found["status"] == "The end of the tank."


def test_what_was_learnt_is_told_and_learnt_again(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    log, told = (
        operate.read_operation(file),
        {"value": {"normal_drag": 2.0}, "deviation": {"normal_drag": 0.1}},
    )
    learned = [Learned(time=1.0, changes=("The fin is gone.",), **told), Learned(time=2.5, **told)]
    with operate.OperationRecorder(tmp_path / "a.mcap", log.header) as recorder:
        for entry in (*log.entries, *learned):
            recorder.record(entry)
    assert main(["replay", str(tmp_path / "a.mcap")]) == 0
    out = capsys.readouterr().out
    assert "Learned: normal drag 2.0000 ± 0.1960." in out
    assert "1.00 s: The fin is gone." in out
    assert main(["replay", str(tmp_path / "a.mcap"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["learned"][1] == {"time": 2.5, "changes": [], **told}
    assert main(["replay", str(file), "--learn"]) == 0
    assert "Learned: nothing, from so few cycles." in capsys.readouterr().out


def test_estimator_and_controller_run_again(file: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["replay", str(file), "--estimate", "--control"]) == 0
    assert "the same again, to the last bit, at all 31 control instants" in capsys.readouterr().out
    assert main(["replay", str(file), "--kinematics", "--control", "--json"]) == 0
    control = json.loads(capsys.readouterr().out)["control"]
    assert control["n_different"] > 0 and control["largest_difference"] > 0.0


def test_a_recording_that_ends_in_the_middle_says_what_is_missing(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(file.read_bytes()[: int(0.8 * file.stat().st_size)])
    assert main(["replay", str(cut)]) == 1
    lost, status = capsys.readouterr().err.splitlines()
    assert "cut.mcap is not intact" in lost
    assert status == "The recording ends before the run does."


def test_a_run_that_failed_says_why_although_nothing_is_missing(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    log = operate.read_operation(file)
    with operate.OperationRecorder(tmp_path / "killed.mcap", log.header) as recorder:
        for entry in log.entries:
            if not (isinstance(entry, operate.Event) and entry.kind == "stop"):
                recorder.record(entry)
    assert main(["replay", str(tmp_path / "killed.mcap")]) == 1
    assert capsys.readouterr().err == "The recording ends before the run does.\n"


def test_a_broken_file_is_refused_in_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(b"no recording")
    assert main(["replay", str(broken)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "it is not an MCAP file" in said
    assert main(["replay", str(tmp_path / "none.mcap")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_a_recording_without_a_clock_has_no_timing_to_draw(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    assert main(["replay", str(file), "--plot-timing", str(tmp_path / "timing.png")]) == 2
    assert (
        "--plot-timing must go with a recording whose loop had a clock" in capsys.readouterr().err
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "--sensors must be given with --mission, which steers by what they tell"),
        (
            ["--sensors", "127.0.0.1:22224"],
            "--mission must be one of the robot in the trial file, with the same parameters, got one of `mamba-fin`",
        ),
    ],
)
def test_a_mission_needs_sensors_and_its_own_robot(trial, words, message, capsys):
    assert main(["operate", trial, "--mission", "tank-inspection", *words]) == 2
    assert message in " ".join(capsys.readouterr().err.split())
