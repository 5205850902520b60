"""`laticauda replay`: a recording becomes a trial, is run again, and a broken one is refused in a sentence."""

import json
from pathlib import Path

import pytest
from operate.tank import DRAWN, IDLE, record

from laticauda.cli import main
from laticauda.logs import load_trial


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "run.mcap"
    record(path)
    return path


def test_it_prints_the_figures_and_writes_the_trial(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["replay", str(file), "--save", str(tmp_path / "run.nc"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    trial = load_trial(tmp_path / "run.nc")
    assert found["forward_velocity"] == trial.forward_velocity
    assert found["electrical_power"] == pytest.approx(35.0 * (DRAWN - IDLE))
    assert found["lost"] == "" and found["status"] == "The end of the tank."


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
    assert "cut.mcap is not whole" in capsys.readouterr().err


def test_a_broken_file_is_refused_in_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(b"no recording")
    assert main(["replay", str(broken)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "it is no MCAP file" in said
    assert main(["replay", str(tmp_path / "none.mcap")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_a_recording_without_a_clock_has_no_timing_to_draw(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    assert main(["replay", str(file), "--plot-timing", str(tmp_path / "timing.png")]) == 2
    assert "--plot-timing must go with a recording of a loop that had a clock" in capsys.readouterr().err
