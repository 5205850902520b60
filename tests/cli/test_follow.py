import json
import re

import pytest

from laticauda.trials.logs import load_trial


def test_follow_prints_how_soon_the_robot_came_to_the_path(run):
    done = run(
        "follow --robot mamba-fin --frequency-deg-s 90 --position 0 1.848 --heading-deg 7.7 --duration 60"
    )
    assert done.status == 0
    assert re.search(
        r"^path    reached after [\d.]+ s and [\d.]+ m, to within 0\.1 m$", done.out, re.MULTILINE
    )
    assert "tank" not in done.out.lower()  # what was measured straight ahead is no path


def test_follow_prints_all_figures_of_the_path_when_asked(run):
    done = run("follow --robot mamba-fin --frequency-deg-s 90 --duration 30 --all")
    assert "time until the mean error stays within 0.1 m for a cycle" in done.out
    assert "offset at its limit" in done.out


def test_follow_says_that_a_path_was_not_reached(run):
    assert "path    not reached" in run("follow --duration 12").out


def test_follow_as_json_has_the_figures_of_path_following(run):
    done = run("follow --frequency-deg-s 90 --duration 60 --json --save run.nc --plot run.png")
    found = json.loads(done.out)
    assert found["status"] == "The run reached its end."
    assert found["path_following"]["convergence_time"] < 60.0
    assert abs(found["path_following"]["last_third_error"]) < 0.05
    assert found["settings"]["heading_estimate"] == "raw"
    assert set(load_trial("run.nc").signals) >= {"cross_track_error", "heading_ref", "offset"}


def test_follow_takes_waypoints_and_the_integral_law(run):
    path = "--waypoints 0 0 3 0 5 2 --smooth --position 0 0.3"
    done = run(
        f"follow --robot mamba-fin {path} --guidance integral-line-of-sight --duration 30 --json"
    )
    assert done.status == 0
    settings = json.loads(done.out)["settings"]
    assert settings["path"].startswith("Spline(")
    assert settings["guidance"].startswith("IntegralLineOfSight(")


def test_follow_plans_ahead_in_a_current_within_a_power(run):
    done = run(
        "follow --robot mamba-fin --parameters paper --frequency-deg-s 90 --current 0 0.03 --guidance model-predictive "
        "--frequency-limits-deg-s 60 120 --power-limit 12 --duration 60 --json"
    )
    assert done.status == 0
    found = json.loads(done.out)
    assert abs(found["path_following"]["last_third_error"]) < 0.02
    assert found["mean_power"] < 13.0
    assert found["settings"]["controller"] == "model-predictive"


def test_follow_observes_the_current_and_says_how_well_it_knows_it(run):
    done = run(
        "follow --robot mamba-fin --frequency-deg-s 90 --current 0 0.03 --observe-current --look-ahead-distance 1.62 "
        "--gain 0.25 --duration 60 --json --save run.nc"
    )
    assert done.status == 0
    assert abs(json.loads(done.out)["path_following"]["last_third_error"]) < 0.05
    signals = load_trial("run.nc").signals
    assert abs(signals["drift_y"][-1] - 0.03) < 2.0 * signals["drift_y_std"][-1] < 0.03


def test_a_plan_without_a_limit_of_power_has_none_in_the_json(run):
    done = run("follow --robot mamba --guidance model-predictive --duration 2 --json")
    assert (done.status, json.loads(done.out)["settings"]["power_limit"]) == (0, None)


@pytest.mark.parametrize(
    "typed",
    [
        "--waypoints 0 0 3 1",
        "--guidance integral-line-of-sight",
        "--guidance=model-predictive",
        "--smooth",
        "--circle 0 0 1 1",
        "--path-depth 0.3",
    ],
)
def test_a_file_with_a_controller_refuses_another_path_or_guidance(run, folder, typed):
    assert run("follow --duration 2 --save-scenario path.toml").status == 0
    done = run(f"follow path.toml {typed} --duration 2")
    assert done.status == 2
    option = typed.replace("=", " ").split()[0]
    assert (
        done.err
        == f"laticauda: {option} must not be given with path.toml, whose controller has its own path "
        "and guidance.\n"
    )


def test_a_file_with_a_planning_controller_refuses_an_observer(run):
    plan = "--guidance model-predictive --duration 2 --save-scenario plan.toml"
    assert run(f"follow --robot mamba-fin {plan}").status == 0
    assert run("follow plan.toml --duration 2").status == 0
    done = run("follow plan.toml --observe-current --duration 2")
    assert done.status == 2
    assert "--observe-current must not be given with plan.toml" in done.err


def test_a_file_with_a_controller_follows_its_path_with_the_numbers_typed(run):
    assert run("follow --waypoints 0 0 3 0 --duration 2 --save-scenario path.toml").status == 0
    done = run("follow path.toml --look-ahead-distance 1 --observe-current --duration 2 --json")
    settings = json.loads(done.out)["settings"]
    assert settings["path"].startswith("Polyline(waypoints=((0.0, 0.0), (3.0, 0.0))")
    assert settings["guidance"] == "LineOfSight(look_ahead_distance=1.0)"
    assert settings["observer"].startswith("CurrentObserver(")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "--guidance model-predictive --observe-current",
            "--observe-current must be left out with model-predictive guidance",
        ),
        (
            "--guidance model-predictive --path-depth 0.3",
            "--path-depth must be left out with model-predictive guidance",
        ),
        ("--power-limit 3", "Unrecognized options: --power-limit"),
        (
            "--guidance model-predictive --heading-estimate raw",
            "Unrecognized options: --heading-estimate",
        ),
        ("--guidance model-predictive --speed 0", "--speed must be > 0 m/s, got 0"),
        (
            "--guidance model-predictive --frequency-deg-s 90 --frequency-limits-deg-s 100 120",
            "--frequency-limits-deg-s must enclose the gait's frequency of 1.571 rad/s, got 1.745 and 2.094.",
        ),
        (
            "--guidance model-predictive --frequency-limits-deg-s 120 60",
            "--frequency-limits-deg-s must be 0 < smallest < largest in rad/s, got 2.0944 and 1.0472.",
        ),
        ("--look-ahead-distance 0", "--look-ahead-distance must be > 0 m, got 0"),
        ("--waypoints 0 0", "must"),
        ("--waypoints 0 0 0 0", "must"),
        (
            "--waypoints 0 0 1",
            "--waypoints must be pairs of numbers, x1 y1 x2 y2 ..., got 3 numbers.",
        ),
        ("--waypoints 0 0 nan 1", "must be a finite number in m, got nan"),
        ("--max-offset-deg 80", "or joint 0 goes beyond its limit"),
        ("--max-offset-deg -1", "--max-offset-deg must be"),
        ("--gain -0.4", "--gain must be"),
        ("--position 1", "Missing value for argument '--position'. Expected 2 values."),
        ("--position nan 0", "must be a finite number in m, got nan"),
        ("--control-interval 0", "must be >= 0.0001 s, got 0"),
        ("--duration 0", "--duration must be > 0 s, got 0"),
        ("--guidance pure-pursuit", "pure-pursuit"),
        ("--look-ahead 1", "look-ahead"),
    ],
)
def test_bad_input_is_refused_with_a_message(run, line, message):
    done = run(f"follow {line}")
    assert done.status == 2
    assert message in done.err
    assert "Traceback" not in done.err + done.out
