import json
import shutil
from pathlib import Path

import pytest

import laticauda as lc
from laticauda.cli import main

ROBOT = """
kind = "robot"
name = "eel"
description = "six modules"
modules = [{count = 6, length = 0.1, mass = 0.3, section = {half_height = 0.032, half_width = 0.03}}]
joints = [{count = 5, limit_deg = 70}]
caudal_fin = {length = 0.12, height = 0.08, thickness = 0.002, opening_length = 0.0}
"""
SPEEDS = """gait,alpha_deg,omega_deg_s,delta_deg,v_m_s,duration_s
LU,25,120,50,0.095,10
LU,30,120,50,0.105,10
LU,30,180,50,0.170,10
LU,35,180,50,0.185,10
LU,30,240,50,0.235,10
LU,30,180,40,0.200,10
"""
GAIT = "--amplitude-deg 32 --frequency-deg-s 200 --phase-shift-deg 45"


@pytest.fixture(scope="module")
def tank(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of an identification."""
    folder = tmp_path_factory.mktemp("tank")
    (folder / "eel.toml").write_text(ROBOT)
    (folder / "speeds.csv").write_text(SPEEDS)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        line = "identify --table speeds.csv --robot eel.toml --starts 1 --threads 1 --output out"
        assert main([*line.split(), "--parameters", "water.tangential_friction"]) == 0
    return folder / "out"


@pytest.fixture
def out(folder: Path, tank: Path) -> Path:
    """A copy of it in the working directory."""
    return Path(shutil.copytree(tank, folder / "out"))


def test_a_gait_is_predicted_with_one_interval_whose_shares_are_said(run, out: Path):
    done = run(f"predict out {GAIT}")
    assert (done.status, done.err) == (0, "")
    lines = done.out.splitlines()
    assert lines[0] == "eel, 10 s, water identified"
    assert "amplitude 32 deg, frequency 200 deg/s, phase shift 45 deg" in lines[1]
    text = " ".join(done.out.split())
    assert " m/s, 95 % 0." in text
    assert ": coefficients +-" in text
    assert "what was held fixed +-" in text
    assert "model left out +-" in text
    assert "W mechanical, 95 %" in text
    assert "what the model leaves out is not known" in text  # of the power, which nobody measured
    assert "ends at x" in text
    assert "water.drag.beta 0.5 (0 to 1)" in text
    assert "5 % of each was assumed" in text


def test_programs_get_every_number(run, out: Path):
    found = json.loads(run(f"predict out {GAIT} --json").out)
    speed = found["figures"]["forward_velocity"]
    assert speed["low"] < speed["value"] < speed["high"]
    assert set(speed["shares"]) == {"coefficients", "held_fixed", "left_out"}
    assert found["confidence"] == 0.95
    assert len(found["path"]["time"]) == len(found["path"]["half_width"]) == 21
    Path("eel.toml").write_text(ROBOT)
    swim = f"swim --robot eel.toml --parameters out/parameters.toml --duration 10 {GAIT} --json"
    same = json.loads(run(swim).out)
    assert speed["value"] == pytest.approx(same["forward_velocity"], rel=1e-6)


def test_the_gait_is_that_of_the_first_trial_unless_it_is_typed(run, out: Path):
    found = json.loads(run("predict out --json").out)
    assert found["gait_parameters"]["amplitude"] == pytest.approx(0.436332, rel=1e-5)
    eel = json.loads(run("predict out --gait eel-like --frequency-hz 0.4 --duration 6 --json").out)
    assert eel["gait_parameters"]["frequency"] == pytest.approx(2.513274, rel=1e-5)
    assert eel["duration"] == 6.0
    assert any(note.startswith("No trial was of eel-like") for note in eel["notes"])


def test_the_same_body_may_lose_its_fin_but_no_other_robot_is_known(run, out: Path):
    bare = ROBOT.replace("caudal_fin =", "# caudal_fin =")
    Path("bare.toml").write_text(bare)
    done = run(f"predict out --robot bare.toml {GAIT}")
    assert done.status == 0
    assert "without fin: the model may leave out more" in " ".join(done.out.split())
    done = run(f"predict out --robot mamba {GAIT}")
    assert done.status == 2
    assert "must have the modules and joints of `eel`" in done.err


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("predict --amplitude-deg 3 out", "FOLDER must come first"),
        ("predict nowhere", "must be the folder that `laticauda identify` wrote"),
        ("predict out --amplitud-deg 3", "--amplitude-deg"),
    ],
)
def test_what_is_wrong_is_said(run, out: Path, line: str, says: str):
    done = run(line)
    assert done.status == 2
    assert says in done.err


def test_the_files_keep_what_predictions_need(out: Path):
    kept = json.loads((out / "fit.json").read_text())
    basis = kept["prediction"]
    assert [entry["name"] for entry in basis["fitted"]] == ["water.tangential_friction"]
    assert len(basis["covariance"]) == 1
    assert {entry["name"] for entry in basis["held_numbers"]} == {
        "water.normal_drag",
        "water.added_mass",
        "water.drag.beta",
        "water.plate_drag",
        "water.plate_added_mass",
    }
    assert kept["assumed"] == ["The table states no noise of its speeds: 5 % of each was assumed."]
    assert lc.load_parameters(out / "parameters.toml").fitted == ("water.tangential_friction",)
    assert lc.load_scenario(out / "scenario.toml").robot.name == "eel"
    assert "Assumed: The table states no noise" in (out / "identify.html").read_text()


def test_swim_names_predict_for_an_interval_after_a_fit(run, out: Path):
    Path("eel.toml").write_text(ROBOT)
    done = run("swim --robot eel.toml --parameters out/parameters.toml --interval")
    assert done.status == 2
    assert "`laticauda predict out` has the interval of a fit" in done.err


def test_the_help_names_the_folder_and_the_numbers_of_a_gait(run):
    done = run("predict --help")
    assert "FOLDER" in done.out
    assert "--amplitude-deg" in done.out
