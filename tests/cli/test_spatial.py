"""The commands with `--model spatial`."""

import json

import numpy as np
import pytest

from laticauda.trials.logs import load_trial


def test_both_models_of_one_robot_print_the_same_speed(run):
    speeds = []
    for model in ("planar", "spatial"):
        done = run(f"swim --joints prescribed --duration 5 --model {model} --json")
        assert done.status == 0
        speeds.append(json.loads(done.out)["forward_velocity"])
    assert speeds[1] == pytest.approx(speeds[0], rel=1e-5)


def test_a_stored_spatial_run_is_resumed_as_one(run):
    whole = run("swim --duration 4 --model spatial --joints servo --save whole.nc --json")
    first = run("swim --duration 2 --model spatial --joints servo --save first.nc --json")
    second = run("swim --resume first.nc --duration 2 --save second.nc --json")
    assert [done.status for done in (whole, first, second)] == [0, 0, 0]
    whole_trial, joined_trial = load_trial("whole.nc"), load_trial("second.nc")
    assert joined_trial.settings["model"] == "spatial"
    np.testing.assert_allclose(
        joined_trial.center_of_mass[-1], whole_trial.center_of_mass[-1], atol=1e-8
    )


def test_the_physical_robot_follows_a_line_in_space(run):
    done = run(
        "follow --robot mamba-modules-fin --model spatial --frequency-deg-s 90 --position 0 0.5 --duration 40 --json"
    )
    assert done.status == 0
    found = json.loads(done.out)
    assert found["settings"]["root"] == "free"
    assert abs(found["path_following"]["last_third_error"]) < 0.05


def test_a_plot_of_a_spatial_run_can_be_made(run):
    done = run(
        "swim --robot mamba-modules-fin --duration 5 --model spatial --plot run.png --link-forces --json"
    )
    assert done.status == 0, done.err


def test_a_root_belongs_to_the_spatial_model(run):
    done = run("swim --root free")
    assert done.status == 2
    assert "Unrecognized options: --root" in done.err


def test_a_second_wave_can_be_asked_for(run):
    done = run(
        "swim --model spatial --robot mamba-modules --pitch-amplitude-deg 20 --pitch-phase-deg 90 --duration 2 --json"
    )
    found = json.loads(done.out)
    assert found["gait_parameters"]["pitch"]["amplitude"] == pytest.approx(np.deg2rad(20.0))
    assert found["gait_parameters"]["pitch"]["frequency"] == found["gait_parameters"]["frequency"]
    assert found["measured"] is None  # the tank's robot had none
    text = " ".join(
        run(
            "swim --model spatial --robot mamba-modules --pitch-amplitude-deg 20 --duration 2"
        ).out.split()
    )
    assert "pitch (amplitude 20 deg, frequency 130 deg/s" in text


def test_the_planar_model_refuses_a_second_wave(run):
    done = run("swim --pitch-offset-deg 2")
    assert done.status == 2
    assert (
        "must be None unless --model is `spatial`: the planar model has no pitch joints" in done.err
    )


DRIVEN = """
kind = "robot"
extends = "mamba"
name = "driven"
[caudal_fin]
n_hinges = 1
flexural_rigidity = 2.0
[caudal_fin.joint]
"""


def test_a_driven_fin_has_a_wave_of_its_own(run, tmp_path):
    (tmp_path / "driven.toml").write_text(DRIVEN)
    own = "--fin-amplitude-deg 20 --fin-frequency-deg-s 100 --fin-phase-deg 30 --fin-offset-deg 5"
    done = run(f"swim --robot {tmp_path / 'driven.toml'} {own} --duration 2 --json")
    assert done.status == 0, done.err
    wave = json.loads(done.out)["gait_parameters"]["fin"]
    wanted = {"amplitude": 20.0, "frequency": 100.0, "phase": 30.0, "offset": 5.0}
    assert {name: pytest.approx(np.rad2deg(wave[name])) for name in wanted} == wanted
    text = " ".join(run(f"swim --robot {tmp_path / 'driven.toml'} {own} --duration 2").out.split())
    assert "fin (amplitude 20 deg, frequency 100 deg/s, phase 30 deg, offset 5 deg" in text
    refused = run("swim --robot mamba-fin --fin-amplitude-deg 20")
    assert refused.status == 2
    assert "must be None unless the fin is driven (`caudal_fin.joint`)" in refused.err
