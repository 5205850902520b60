import json
import re
import subprocess
import sys
from math import radians
from pathlib import Path

import numpy as np
import pytest
from clusters import local_cluster

import laticauda as lc
from laticauda.cli import vary
from laticauda.models.simulate import list_parameters
from laticauda.studies import open_sweep, point_trials
from laticauda.values.installation import advise_extra

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
KNOWN = list_parameters(lc.build_scenario("mamba-fin", GAIT))
SHORT = "--duration 1 --output a"
POINTS = "--vary amplitude-deg=10:50:3 normal-drag=1,2"


def test_the_command_fills_a_folder_and_prints_the_best(run, folder: Path):
    done = run(f"sweep {POINTS} {SHORT}")
    assert (done.status, done.err) == (0, "")
    assert (
        "The robot can do 2 of them; the others come last. The best in forward velocity:"
        in done.out
    )
    assert "All results: a/results.zarr" in done.out
    found = open_sweep(folder / "a")
    assert found["gait.amplitude"].to_numpy() == pytest.approx(np.radians([10.0, 30.0, 50.0]))
    # The table begins with the best that the robot can do.
    speeds = [float(row.split()[2]) for row in done.out.splitlines() if re.match(r"\s+\d", row)]
    feasible, beyond = speeds[:2], speeds[2:]
    assert feasible == sorted(feasible, reverse=True)
    assert beyond == sorted(beyond, reverse=True) and len(beyond) == 3
    best = found.forward_velocity.where(found.utilization <= 1.0).max()
    assert speeds[0] == pytest.approx(float(best), rel=1e-3)

    # Run again it has nothing to do, and says the same.
    assert run(f"sweep {POINTS} {SHORT}").out == done.out
    as_json = json.loads(run(f"sweep {POINTS} {SHORT} --json --best mechanical-power").out)
    assert (as_json["n_trials"], as_json["n_failed"], as_json["best_in"]) == (
        6,
        0,
        "mechanical_power",
    )
    assert as_json["best"][0]["mechanical_power"] == float(found.mechanical_power.min())
    assert as_json["best"][0]["steady_velocity"] is None
    assert as_json["status"] and as_json["robot"] == "mamba"


def test_the_best_are_those_that_the_robot_can_do_and_the_others_say_their_limit(run, folder: Path):
    grid = "--joints prescribed --vary amplitude-deg=5,10,110 --duration 4 --output a"
    done = run(f"sweep {grid}")
    assert (done.status, done.err) == (0, "")
    assert "The robot can do 2 of them; the others come last." in done.out
    rows = [row.split() for row in done.out.splitlines() if re.match(r"\s*\d", row)]
    assert [f"{float(row[0]):g}" for row in rows] == ["10", "5", "110"]
    assert [row[-1] == "-" for row in rows] == [True, True, False]
    as_json = json.loads(run(f"sweep {grid} --json").out)
    assert as_json["n_infeasible"] == 1
    beyond = [point["beyond"] for point in as_json["best"]]
    assert beyond[:2] == [None, None]
    assert beyond[2] == "servos"


def test_what_is_varied_may_be_given_in_pieces(run, folder: Path):
    assert run(f"sweep --vary amplitude-deg=10:50:3 --vary normal-drag=1,2 {SHORT}").status == 0
    assert open_sweep(folder / "a").sizes == {"gait.amplitude": 3, "water.normal_drag": 2}


def test_samples_fill_the_ranges(run, folder: Path):
    done = run(f"sweep --samples 6 --seed 2 --vary amplitude-deg=10:50 n-links=5:9 {SHORT}")
    assert (done.status, done.err) == (0, "")
    found = open_sweep(folder / "a")
    assert found.sizes == {"trial": 6}
    assert set(found["robot.n_links"].to_numpy()) <= {5, 6, 7, 8, 9}


def test_points_can_come_from_a_file(run, folder: Path):
    (folder / "points.csv").write_text("amplitude-deg,gait.frequency\n30,2.0\n\n40,2.5\n")
    assert run(f"sweep --list points.csv {SHORT}").status == 0
    found = open_sweep(folder / "a")
    assert found["gait.amplitude"].to_numpy() == pytest.approx(np.radians([30.0, 40.0]))
    assert found["gait.frequency"].to_numpy().tolist() == [2.0, 2.5]


def test_the_names_are_those_of_the_options_where_there_is_one(run):
    out = run("sweep --robot mamba-fin --names").out
    assert re.search(r"^frequency-deg-s +deg/s +omega", out, re.MULTILINE)
    assert re.search(r"^robot.caudal-fin.length +m +Length from root", out, re.MULTILINE)
    help = run("swim --help").out
    plain = [
        vary.spell_parameter(parameter)
        for parameter in KNOWN.values()
        if "." not in vary.spell_parameter(parameter)
    ]
    plain = [word for word in plain if not word.startswith("current")]
    assert len(plain) > 10 and all(f"--{word} " in help for word in plain)


def test_every_name_that_is_listed_can_be_varied():
    for parameter in KNOWN.values():
        assert list(vary.parse_grid([f"{vary.spell_parameter(parameter)}=1"], KNOWN).values) == [
            parameter.name
        ]
        (value,) = vary.parse_grid([f"{parameter.name}=1"], KNOWN).values[parameter.name]
        assert value == 1.0  # with dots it is as in Python: SI


def test_degrees_are_in_the_name():
    values = vary.parse_grid(
        ["amplitude-deg=10,20", "gait.frequency-deg-s=90", "gait.phase_shift=0.5"], KNOWN
    ).values
    assert values["gait.amplitude"].tolist() == [radians(10), radians(20)]
    assert values["gait.frequency"].tolist() == [radians(90)]
    assert values["gait.phase_shift"].tolist() == [0.5]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("", "--vary must be given, or --list: NAME=LOW:HIGH:COUNT"),
        ("--vary amplitude-deg", "--vary must be NAME=LOW:HIGH:COUNT or .* got 'amplitude-deg'"),
        ("--vary amplitude-deg=", "--vary must be NAME=LOW:HIGH:COUNT"),
        (
            "--vary amplitude-deg=1:2",
            "--vary must be NAME=LOW:HIGH:COUNT .* got 'amplitude-deg=1:2'",
        ),
        (
            "--vary amplitude-deg=1:2:x",
            "--vary must be NAME=LOW:HIGH:COUNT .* got 'amplitude-deg=1:2:x'",
        ),
        (
            "--vary amplitude-deg=1:2:0",
            "--vary must have a whole COUNT between 1 and 10000000, got 'ampl",
        ),
        ("--vary amplitude-deg=1,", "--vary must be NAME=LOW:HIGH:COUNT"),
        ("--vary amplitud-deg=1:2:3", "got 'amplitud-deg'; the nearest are `amplitude-deg`"),
        (
            "--vary amplitude-deg=1 gait.amplitude=2",
            "--vary must name each parameter only once, got 'gait.amplitude'",
        ),
        (
            "--vary amplitude-deg=-3:3:5",
            "--vary must be within the bounds .* gait.amplitude = -0.0523599: ampl",
        ),
        (
            "--vary amplitude-deg=1:2 --samples 0",
            "--samples|n_points.* must be a whole number >= 1, got 0",
        ),
        ("--vary amplitude-deg=1:2:3 --samples 4", "--vary must be NAME=LOW:HIGH with --samples"),
        ("--vary amplitude-deg=1:2:3 --seed 4", "--seed must be given with --samples"),
        ("--vary amplitude-deg=1 --threads 0", "--threads must be a whole number >= 1, got 0"),
        ("--list nothing.csv", "nothing.csv: no such file"),
        (
            "--list empty.csv",
            "empty.csv: it is not a text file of columns, or it is empty",
        ),
        (
            "--list strange.csv",
            "--list of strange.csv must name a parameter of robot, gait or water, got 'colour'",
        ),
        (
            "--list negative.csv",
            "--list of negative.csv must be within the bounds of the parameters",
        ),
        ("--list ragged.csv", "ragged.csv: row 3 must have 2 cells, as row 1 has, got 1"),
        ("--list words.csv", "--list must be a table of numbers, got 'x in words.csv, line 2'"),
        (
            "--list words.csv --samples 3",
            "--list must not be given together with --vary or --samples",
        ),
        ("--vary amplitude-deg=1 --output file", "--output must be a folder, got the file file"),
        (
            "--vary amplitude-deg=1 --output full",
            "--output must be empty, or hold this sweep, got full with thesis",
        ),
        ("--vary amplitude-deg=1 --scheduler nowhere", "no Dask scheduler answers at nowhere"),
    ],
)
def test_bad_input_is_said_in_the_words_of_the_command(run, folder: Path, line: str, message: str):
    (folder / "empty.csv").write_text("")
    (folder / "strange.csv").write_text("colour\n1\n")
    (folder / "negative.csv").write_text("normal-drag\n-1\n")
    (folder / "ragged.csv").write_text("amplitude-deg,offset-deg\n1,2\n3\n")
    (folder / "words.csv").write_text("amplitude-deg\nx\n")
    (folder / "file").write_text("")
    (folder / "full").mkdir()
    (folder / "full" / "thesis.tex").write_text("")
    done = run(f"sweep {line}")
    assert (done.status, done.out) == (2, "")
    assert re.search(message, done.err), done.err


def test_the_folder_of_another_sweep_is_refused(run):
    assert run(f"sweep {POINTS} {SHORT}").status == 0
    done = run(f"sweep {POINTS} --duration 2 --output a")
    assert done.status == 2
    assert (
        "--output must be empty, or hold this sweep, got a with another one: duration is 1.0 there and 2.0"
        in done.err
    )


def test_a_stopped_sweep_says_how_to_go_on(run, folder: Path, monkeypatch: pytest.MonkeyPatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as context:
        context.setattr(point_trials, "run_columns", stop)
        done = run(f"sweep {POINTS} {SHORT}")
    assert (done.status, done.out) == (130, "")
    assert (
        done.err
        == "laticauda: stopped; 0 of 6 trials are stored in a. Run the same command again to resume.\n"
    )
    assert run(f"sweep {POINTS} {SHORT}").status == 0
    assert open_sweep(folder / "a").n_finished == 6


@pytest.mark.usefixtures("limit_case")
def test_a_sweep_in_which_every_trial_blows_up_ends_with_status_1(run):
    done = run(f"sweep --vary normal-drag=1e3,2e3 --dt 0.1 {SHORT}")
    assert done.status == 1
    assert "2 of 2 trials blew up" in done.out


def test_a_sweep_runs_on_a_cluster(run, folder: Path):
    with local_cluster() as address:
        done = run(f"sweep {POINTS} --scheduler {address} {SHORT}")
    assert (done.status, done.err) == (0, "")
    assert run(f"sweep {POINTS} --duration 1 --output b").status == 0
    assert open_sweep(folder / "a").identical(open_sweep(folder / "b"))


def test_without_the_extra_it_says_what_to_install(folder: Path):
    code = "import sys; sys.modules['zarr'] = None; from laticauda.cli import main; sys.exit(main(sys.argv[1:]))"
    words = ["sweep", "--vary", "amplitude-deg=30", "--duration", "1"]
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == f"laticauda: A sweep needs zarr; {advise_extra('scale')}.\n"


def test_a_sweep_is_drawn_if_that_is_asked_for(run, folder: Path):
    assert run(f"sweep {POINTS} {SHORT} --plot map.png").status == 0
    assert (folder / "map.png").read_bytes().startswith(b"\x89PNG")
    done = run(f"sweep {POINTS} {SHORT} --plot map.txt")
    said = "laticauda: --plot must be a file that ends in .png or .pdf or .svg, got map.txt.\n"
    assert (done.status, done.err) == (2, said)


def test_the_best_in_what_joints_carry_store_it_and_carry_least(run, folder: Path):
    done = run(f"sweep {POINTS} {SHORT} --best peak-bending-moment")
    assert (done.status, done.err) == (0, "")
    assert "The best in peak bending moment:" in done.out
    for title in ("peak bending moment [N m]", "peak shear force [N]", "peak axial force [N]"):
        assert title in done.out
    found = open_sweep(folder / "a")
    feasible = found.peak_bending_moment.where(found.utilization <= 1.0)
    as_json = json.loads(run(f"sweep {POINTS} {SHORT} --loads --json").out)
    assert as_json["best_in"] == "forward_velocity"  # the same folder, and nothing to do
    assert {"rms_shear_force", "peak_axial_force"} <= as_json["best"][0].keys()
    ranked = json.loads(run(f"sweep {POINTS} {SHORT} --best peak-bending-moment --json").out)
    assert ranked["best"][0]["peak_bending_moment"] == float(feasible.min())
