import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from clusters import local_cluster

import laticauda as lc
from laticauda.cli.studies import _describe_front
from laticauda.studies import Front, Optimization, optimization, optimize
from laticauda.studies.point_trials import QUANTITIES
from laticauda.values.installation import advise_extra

SHORT = "--duration 1 --budget 24 --population 12 --output a"


def test_the_command_writes_the_front_and_prints_some_of_it(run, folder: Path):
    done = run(f"optimize --seed 1 {SHORT}")
    assert (done.status, done.err) == (0, "")
    assert (
        "lateral-undulation, robot mamba, forward velocity against mechanical power: 24 points tried"
        in done.out
    )
    names = ["checkpoint.npz", "front.csv", "front.nc", "front.pdf", "front.png"]
    assert sorted(path.name for path in (folder / "a").iterdir()) == names
    rows = [row.split() for row in done.out.splitlines() if re.match(r"\s+\d", row)]
    powers = [float(row[4]) for row in rows]
    assert powers == sorted(powers) and 2 < len(powers) <= 8
    header = (folder / "a" / "front.csv").read_text(encoding="utf-8").split("\n")[0].split(",")
    columns = {title.split(" [")[0]: column for column, title in enumerate(header)}
    table = np.loadtxt(folder / "a" / "front.csv", delimiter=",", skiprows=1)
    assert powers[-1] == pytest.approx(table[-1, columns["mechanical_power"]], rel=1e-3)
    assert float(rows[-1][0]) == pytest.approx(np.degrees(table[-1, 0]), rel=1e-3)

    # Run again it has nothing to do, and says the same.
    assert run(f"optimize --seed 1 {SHORT}").out == done.out
    as_json = json.loads(run(f"optimize --seed 1 {SHORT} --json").out)
    assert (as_json["n_trials"], as_json["n_points"]) == (24, len(table))
    assert as_json["points"][-1]["mechanical_power"] == table[-1, columns["mechanical_power"]]
    assert as_json["points"][-1]["steady_velocity"] is None
    assert as_json["files"][:2] == ["a/front.csv", "a/front.nc"]


def test_what_it_finds_is_what_the_call_finds(run, folder: Path):
    words = (
        "--vary amplitude-deg=10:60 robot.caudal-fin.length=0.2:0.5 --objective cost-of-transport"
    )
    done = run(
        f"optimize --robot mamba-fin --joints prescribed --gait eel-like {words} {SHORT} --json "
        "--joint-rate-limit-deg-s 100"
    )
    assert done.status == 0
    gait = lc.eel_like(
        amplitude=np.radians(30),
        frequency=float(np.radians(130)),
        phase_shift=float(np.radians(40)),
    )
    front = optimize(
        Optimization(
            scenario=lc.build_scenario("mamba-fin", gait, 1.0),
            bounds={
                "gait.amplitude": (np.radians(1.0) * 10, np.radians(1.0) * 60),
                "robot.caudal_fin.length": (0.2, 0.5),
            },
            objectives="cost_of_transport",
            joint_rate_limit=float(np.radians(100)),
        ),
        budget=24,
        population=12,
    )
    (point,) = json.loads(done.out)["points"]
    assert point["gait.amplitude"] == pytest.approx(front.values[0, 0], rel=1e-12)
    assert point["cost_of_transport"] == pytest.approx(
        front.figures["cost_of_transport"][0], rel=1e-9
    )
    assert not (folder / "a" / "front.png").exists()


def test_a_stopped_optimization_says_how_to_go_on(
    run, folder: Path, monkeypatch: pytest.MonkeyPatch
):
    swim_points, calls = optimization.swim_points, []

    def stop(*args, **how):
        calls.append(args)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return swim_points(*args, **how)

    with monkeypatch.context() as context:
        context.setattr(optimization, "swim_points", stop)
        done = run(f"optimize {SHORT}")
    assert (done.status, done.out) == (130, "")
    assert (
        done.err
        == "laticauda: stopped; 12 of 24 trials are stored in a. Run the same command again to resume.\n"
    )
    resumed = run(f"optimize {SHORT}")
    assert resumed.out == run(f"optimize {SHORT.replace(' a', ' b')}").out.replace("b/", "a/")


def test_an_optimization_on_a_cluster_comes_to_the_same_bits(run, folder: Path):
    with local_cluster() as address:
        done = run(f"optimize {SHORT} --scheduler {address}")
    assert (done.status, done.err) == (0, "")
    assert run(f"optimize {SHORT.replace(' a', ' b')}").status == 0
    assert (folder / "a/front.csv").read_bytes() == (folder / "b/front.csv").read_bytes()


def test_where_nothing_is_feasible_it_ends_with_status_1(run):
    done = run(f"optimize --objective steady-velocity {SHORT}")
    assert done.status == 1
    assert "24 points tried, 24 of them not feasible; none is feasible" in done.out


def test_the_names_are_listed(run):
    done = run("optimize --robot mamba-fin --names")
    assert done.status == 0
    assert "robot.caudal-fin.length" in done.out and "amplitude-deg" in done.out


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--vary amplitude-deg=1:2:3", "--vary must be NAME=LOW:HIGH, such as amplitude-deg=10:50, got 'ampl.*3'"),
        ("--vary amplitude-deg", "--vary must be NAME=LOW:HIGH, such as amplitude-deg=10:50, got 'amplitude-deg'"),
        ("--vary amplitud-deg=1:2", "got 'amplitud-deg'; the nearest are `amplitude-deg`"),
        ("--vary amplitude-deg=2:1", "--vary must have low < high, got 'amplitude-deg=2:1'."),
        ("--vary amplitude-deg=-3:3", "--vary must be within the bounds .* gait.amplitude = -0.0523599: ampl"),
        ("--vary n-links=5.5:8", "robot.n_links. must be a whole number, got 5.5"),
        ("--objective speed", "--objective must be one of `speed-power`, .* got 'speed'; did you mean `speed-power`"),
        ("--objective mean-power mean-power", "--objective must be one, or two different ones, got mean_power"),
        ("--budget 10", "--budget must be a whole number >= 100, got 10"),
        ("--population 2", "--population must be a whole number >= 4, got 2"),
        ("--threads 0", "--threads must be a whole number >= 1, got 0"),
        ("--joint-rate-limit-deg-s -5", "--joint-rate-limit-deg-s must be > 0 deg/s, got -5"),
        ("--robot mamba --battery 20", "--battery must come with one of --battery-range and --battery-time, got nei"),
        ("--battery-range 20", "--battery must be given with --battery-range, got None"),
        ("--shortest-module 0.2 --longest-module 0.1", "--longest-module must be >= --shortest-module, 0.2 m"),
        ("--ballast --buoyancy-tolerance 0.1", "--buoyancy-tolerance must be left out with --ballast, .* got 0.1"),
        ("--edge-clip 1", "--edge-clip must be None unless --trailing-edge is `finite-span`"),
        ("--output file", "--output must be a folder, got the file file"),
        ("--output full", "--output must be empty, or hold this optimization, got full with thesis"),
    ],
)  # fmt: skip
def test_bad_input_is_said_in_the_words_of_the_command(run, folder: Path, line: str, message: str):
    (folder / "file").write_text("")
    (folder / "full").mkdir()
    (folder / "full" / "thesis.tex").write_text("")
    done = run(f"optimize {line}")
    assert (done.status, done.out) == (2, "")
    assert re.search(message, done.err), done.err


def test_the_folder_of_another_optimization_is_refused(run):
    assert run(f"optimize --joints prescribed {SHORT}").status == 0
    done = run(f"optimize --joints prescribed {SHORT} --normal-drag 2")
    assert done.status == 2
    assert (
        "--output must be empty, or hold this optimization, got a with another one: environment.name is"
        in done.err
    )


def test_without_the_extra_it_says_what_to_install(folder: Path):
    code = "import sys; sys.modules['pymoo'] = None; from laticauda.cli import main; sys.exit(main(sys.argv[1:]))"
    words = ["optimize", "--duration", "1"]
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == f"laticauda: An optimization needs pymoo; {advise_extra('scale')}.\n"


def test_an_optimum_at_an_end_of_its_range_is_said_with_the_end(run):
    line = f"optimize --vary amplitude-deg=10:20 frequency-deg-s=50:150 --objective forward-velocity {SHORT}"
    found = json.loads(run(f"{line} --json").out)["at_bounds"]
    said = [line for line in run(line).out.splitlines() if "of its range" in line]
    assert len(said) == len(found)
    front = optimize(sought_at_an_end(), budget=24, population=12)
    assert [row["name"] for row in found] == [row["name"] for row in front.at_bounds()]


def test_a_front_at_an_end_of_a_range_says_how_many_points_lie_there(
    monkeypatch: pytest.MonkeyPatch,
):
    sought = sought_at_an_end()
    values = np.array([[np.radians(20.0), 1.0], [np.radians(20.0), 2.0], [np.radians(15.0), 2.0]])
    figures = {name: np.arange(3.0) for name in QUANTITIES}
    front = Front(
        optimization=sought, values=values, figures=figures, n_trials=9, n_infeasible=0, seed=0
    )
    words = "the best may be beyond it; widen it with --vary."
    said = f"amplitude-deg is 20.00 deg at 2 of the 3 points, the greatest of its range: {words}"
    assert said in _describe_front(front, Path("a"))
    alone = replace(
        front, values=values[:1], figures={name: column[:1] for name, column in figures.items()}
    )
    assert f"amplitude-deg is 20.00 deg, the greatest of its range: {words}" in _describe_front(
        alone, Path("a")
    )


def sought_at_an_end() -> Optimization:
    gait = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
    bounds = {
        "gait.amplitude": tuple(np.radians([10.0, 20.0])),
        "gait.frequency": tuple(np.radians([50.0, 150.0])),
    }
    return Optimization(
        scenario=lc.build_scenario("mamba", gait, 1.0), bounds=bounds, objectives="forward_velocity"
    )


def test_what_joints_carry_is_bounded_by_a_flag_and_minimized_by_name(run, folder: Path):
    joints = "--joints prescribed --beyond-actuators --vary amplitude-deg=10:50"
    words = "--objective forward-velocity --peak-bending-moment-limit 2 --rms-shear-force-limit 9"
    done = run(f"optimize {joints} {words} --duration 5 --budget 40 --output a --json")
    assert (done.status, done.err) == (0, "")
    facts = json.loads(done.out)
    assert 0.0 < facts["points"][0]["peak_bending_moment"] <= 2.0
    assert facts["points"][0]["rms_shear_force"] <= 9.0
    header = (folder / "a" / "front.csv").read_text(encoding="utf-8").split("\n")[0]
    assert "peak_bending_moment [N m]" in header
    front = run(
        f"optimize {joints} --objective forward-velocity peak-shear-force "
        f"{SHORT.replace(' a', ' b')}"
    )
    assert (front.status, front.err) == (0, "")
    assert "forward velocity against peak shear force: 24 points tried" in front.out
    assert "peak shear force [N]" in front.out
    impossible = run(
        f"optimize {joints} --objective forward-velocity --peak-axial-force-limit 0.0001 "
        "--duration 1 --budget 40 --output c"
    )
    assert impossible.status == 1
    assert "none is feasible: " in impossible.out
    assert "by peak axial force" in impossible.out
