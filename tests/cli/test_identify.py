import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.identify import fit, from_table
from laticauda.identify.tasks import load_task

FRICTION, DRAG = "water.tangential_friction", "water.normal_drag"
TRUE = 0.22
FAST = "--starts 1 --threads 1"


@pytest.fixture(scope="module")
def trials(tmp_path_factory) -> Path:
    """Simulated trials in another water than their files say, with a camera's noise."""
    folder = tmp_path_factory.mktemp("trials")
    usual = lc.load_water("paper-lateral")
    for i, (amplitude, frequency) in enumerate(((30.0, 110.0), (25.0, 140.0), (35.0, 90.0))):
        gait = lc.lateral_undulation(
            amplitude=np.radians(amplitude),
            frequency=np.radians(frequency),
            phase_shift=np.radians(40.0),
        )
        trial = lc.swim(
            lc.load_robot("mamba"), gait, 6.0, environment=replace(usual, tangential_friction=TRUE)
        )
        noise = 0.004 * np.random.default_rng(i).standard_normal(trial.center_of_mass.shape)
        scenario = replace(trial.scenario, environment=usual)
        trial = replace(trial, center_of_mass=trial.center_of_mass + noise, scenario=scenario)
        trial.save(folder / f"run-{i}.nc")
    other = lc.swim(lc.load_robot("mamba").with_links(5), gait, 2.0)
    other.save(folder / "other.nc")
    return folder


def test_trials_become_a_parameter_file_a_report_and_a_table(run, folder: Path, trials: Path):
    files = " ".join(str(trials / f"run-{i}.nc") for i in range(3))
    done = run(
        f"identify {files} --parameters {FRICTION} --robot mamba --measured center_of_mass=0.004 {FAST}"
    )
    assert (done.status, done.err) == (0, "")
    assert "1 of 1 parameters identified from 3 measurements" in done.out
    assert "and 9 numbers for where the trials began." in done.out
    out = folder / "identification"
    kept = lc.load_parameters(out / "parameters.toml")
    assert kept.joints == "prescribed"
    found = json.loads((out / "fit.json").read_text())
    (friction,) = (row for row in found["parameters"] if row["name"] == FRICTION)
    assert friction["low"] < TRUE < friction["high"]
    assert kept.water("lateral_undulation").tangential_friction == friction["best"]
    page = (out / "identify.html").read_text()
    assert "laticauda identify " in page
    assert "run-1.nc, SHA-256 " in page
    assert "<script" not in page
    for name in (
        "parity.png",
        "parity.pdf",
        "residuals.png",
        "intervals.png",
        "residuals.csv",
        "directions.csv",
    ):
        assert (out / name).stat().st_size > 0
    again = run("swim --parameters identification/parameters.toml --duration 1 --json")
    assert again.status == 0


def test_a_file_says_everything_and_json_is_printed(run, folder: Path, trials: Path):
    task = f"""
kind = "identification"
name = "tank"
title = "in the tank"
joints = "prescribed"
noise = "known"
starts = 1
robot = "mamba"
parameters = ["{FRICTION}", {{name = "{DRAG}", lower = 0.5, upper = 4.0, prior = [1.75, 0.2]}}]

[fixed.water]
added_mass = 1.4

[fixed.actuator]
tracking = 1.0

[[trials]]
file = "{trials}/run-0.nc"
figures = {{forward_velocity = 0.003}}

[[trials]]
file = "{trials}/run-1.nc"
name = "second"
figures = {{forward_velocity = 0.003}}
"""
    (folder / "tank.toml").write_text(task)
    done = run("identify tank.toml --quick --threads 1 --json --output a")
    assert (done.status, done.err) == (0, "")
    found = json.loads(done.out)
    assert [row["name"] for row in found["parameters"]] == [FRICTION, DRAG]
    assert found["noise"] == "known"
    assert set(found["sources"]) == {"tank.toml", "run-0.nc", "run-1.nc"}
    assert "identify.html" in found["files"]
    kept = lc.load_parameters(folder / "a" / "parameters.toml")
    assert (kept.name, kept.title, kept.every_gait.added_mass) == ("tank", "in the tank", 1.4)
    assert kept.changes == {"actuator": {"tracking": 1.0}}
    assert (
        "not be given with tank.toml"
        in run("identify tank.toml --parameters water.normal_drag").err
    )


def test_bad_input_is_named(run, folder: Path, trials: Path):
    (folder / "broken.nc").write_text("no")
    (folder / "bad.toml").write_text('kind = "identification"\nparameter = []\n')
    one, other = trials / "run-0.nc", trials / "other.nc"
    cases = {
        "identify all.toml --no-free-start": "--free-start must not be given with all.toml",
        "identify all.toml --free_start": "--free-start must not be given with all.toml",
        "identify all.toml --table1": "--table1 must not be given with all.toml, which defines all, got True.",
        "identify": "FILE must be one TOML task file, or at least one trial, got none.",
        f"identify {one}": "--parameters must name at least one parameter",
        f"identify {one} --parameters water.normal_drug": "'water.normal_drug'; the nearest are",
        f"identify {one} --parameters {DRAG}=a:b": "--parameters must be NAME, NAME=LOW:HIGH or NAME=MEAN+-SD",
        f"identify {one} --parameters {DRAG} {FRICTION} --measured forward_velocity=0.01": "at least 3 numbers",
        f"identify {one} {other} --parameters {DRAG}": "must be of one body",
        f"identify {one} --robot chain --parameters {DRAG}": "must be of one body",
        f"identify broken.nc --parameters {DRAG}": "broken.nc",
        f"identify missing.nc --parameters {DRAG}": "missing.nc",
        "identify missing.toml": "missing.toml",
        "identify bad.toml": "bad.toml: key `parameter`: is not known; did you mean `parameters`?",
        f"identify {one} --parameters {DRAG} --measured speed=0.1": "must be one of",
        f"identify {one} --parameters {DRAG} --measured forward_velocity": "--measured must be NAME=SIGMA",
        f"identify {one} --parameters gait.amplitude": "must not be of the gait",
        f"identify {one} --parameters robot.module[3].mas": "--parameters must name numbers of the",
        f"identify {one} --parameters robot.module[33].mass": "`robot.module` counts from [0] at the tail to [8]",
        f"identify {one} --parameters gait.phase[8]": "`gait.phase` counts from [0] at the tail to [7]",
        f"identify {one} --parameters robot.taper.mass.nose": "then .tail or head or bulge",
        f"identify {one} --parameters robot.module[3].mass robot.module.mass": "--parameters must name each number "
        "once, got `robot.module[3].mass` and `robot.module.mass`",
        f"identify {one} --parameters robot.module[:4].mass lateral_undulation.robot.module[3].mass "
        "robot.taper.mass.head": "must name each number once",
        f"identify {one} --parameters robot.module[3].mass=-1:1": "`lower` of `robot.module[3].mass` must be in its "
        "range, got -1: `mass` must be > 0 kg",
    }
    for line, text in cases.items():
        done = run(f"{line} {FAST}" if line != "identify" else line)
        assert done.status == 2, (line, done.err)
        assert text in done.err, (line, done.err)
        assert done.out == ""


def test_numbers_of_single_parts_are_in_a_robot_and_a_scenario(run, folder: Path, trials: Path):
    names = "robot.module[3].normal-drag=0.5:4 gait.amplitude[2]=0.52+-0.05"
    done = run(f"identify {trials / 'run-0.nc'} --parameters {names} --quick {FAST}")
    assert (done.status, done.err) == (0, "")
    left_out = "without robot.module[3].normal_drag, gait.amplitude[2], which it cannot hold"
    assert f"identification/parameters.toml: for --parameters, {left_out}" in done.out
    assert "identification/robot.toml: the robot, with all values, for --robot" in done.out
    out = folder / "identification"
    found = json.loads((out / "fit.json").read_text())
    drag, amplitude, *_ = (row["best"] for row in found["parameters"])
    robot = lc.load_robot(out / "robot.toml")
    assert [module.normal_drag for module in robot.modules[2:4]] == [None, drag]
    scenario = lc.load_scenario(out / "scenario.toml")
    assert scenario.robot == robot
    angles = scenario.gait.amplitude * scenario.gait.joint_envelope(robot.n_links)[2]
    assert angles == pytest.approx(amplitude, rel=1e-12)
    page = (out / "identify.html").read_text()
    assert "It cannot hold robot.module[3].normal_drag, gait.amplitude[2]: scenario.toml" in page


def test_what_has_no_effect_and_what_is_repeated_is_said(run, folder: Path, trials: Path):
    one = trials / "run-0.nc"
    (folder / "copy.nc").write_bytes(one.read_bytes())
    measured = "--measured forward_velocity=0.01"
    parameters = "--parameters robot.joint.actuator.servo_gain"
    line = f"identify {one} copy.nc {parameters} {measured} --quick --noise known {FAST}"
    done = run(line)
    assert done.status == 0
    assert "has no effect on what was measured" in done.out
    assert "All measurements are of the same gait with the same robot" in done.out


def test_the_shipped_file_of_the_preset_fixes_what_the_preset_has():
    task = load_task(Path(__file__).parents[2] / "examples" / "mamba-identified.toml")
    preset = lc.load_parameters("mamba-identified")
    assert len(task.measurements) == 20
    assert len(task.unknowns) == 2
    for unknown in task.unknowns:
        assert unknown.lower < unknown.start < unknown.upper
    robot = task.measurements[-1].scenario.robot
    assert robot.n_links == 9
    assert robot.caudal_fin == preset.robot(robot, "eel_like").caudal_fin
    assert task.base.every_gait.normal_drag == preset.every_gait.normal_drag
    assert task.base.changes == preset.changes
    assert task.options["joints"] == preset.joints


SPEEDS = [
    "gait,alpha_deg,omega_deg_s,delta_deg,v_m_s",
    "LU,30,90,40,0.093",
    "LU,30,120,40,0.124",
    "LU,36,110,40,0.13",
]


def test_a_table_of_speeds_gives_what_python_gives(run, folder: Path):
    (folder / "speeds.csv").write_text("\n".join(SPEEDS))
    done = run(f"identify --table speeds.csv --parameters {FRICTION} --quick {FAST} --json")
    assert (done.status, done.err) == (0, "")
    said = json.loads(done.out)
    found = fit(
        from_table(folder / "speeds.csv"), parameters=[FRICTION], noise="estimated", n_starts=1
    )
    assert said["parameters"] == [row | {"best": found[FRICTION].value} for row in found.table()]
    assert set(said["sources"]) == {"speeds.csv"}
    assert any(words.startswith("no coast-down") for words in said["warnings"])
    assert not (folder / "identification" / "best.json").exists()
    (folder / "speeds.csv").write_text("\n".join([SPEEDS[0], "LU,30,90,40,9.3"]))
    refused = run(f"identify --table speeds.csv --parameters {FRICTION} {FAST}")
    assert refused.status == 2 and "`v_m_s` of 9.3 at `omega_deg_s` of 90" in refused.err


def test_laws_stand_side_by_side_with_null_models(run, folder: Path):
    (folder / "speeds.csv").write_text("\n".join(SPEEDS))
    laws = "--laws paper mamba-identified"
    done = run(f"identify --table speeds.csv --parameters {FRICTION} {laws} --quick {FAST}")
    assert (done.status, done.err) == (0, "")
    rows = [
        line
        for line in done.out.splitlines()
        if line.startswith(("paper ", "mamba-identified ", "null model"))
    ]
    assert len(rows) == 6
    for name in ("paper", "mamba-identified"):
        kept = lc.load_parameters(folder / "identification" / name / "parameters.toml")
        assert kept.name == f"identified-{name}"
    both = run(f"identify --table speeds.csv --parameters {FRICTION} {laws} --base paper {FAST}")
    assert both.status == 2 and "--laws must not be given together with" in both.err


def test_ctrl_c_after_the_search_leaves_what_was_found(run, folder: Path, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("laticauda.identify.validation.leave_out", stop)
    done = run(f"identify --table1 --parameters {FRICTION} {FAST}")
    assert done.status == 1
    assert "interrupted: these are the best values so far" in done.out
    assert (folder / "identification" / "identify.html").exists()
