import csv
import dataclasses
import json
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from rendering import skip_without_rendering

from laticauda import load_trial
from laticauda.cli.output_files import list_endings
from laticauda.show.pictures import video, window
from laticauda.trials import FIGURES


@pytest.fixture
def stored(run) -> list[str]:
    for name, options in {
        "bare.nc": "--joints prescribed",
        "fin.nc": "--robot mamba-fin --joints prescribed",
        "servo.nc": "--joints servo",
    }.items():
        assert run(f"swim {options} --duration 20 --save {name}").status == 0
    return ["bare.nc", "fin.nc", "servo.nc"]


def test_a_stored_trial_is_shown_as_it_was_when_it_swam(run, stored):
    swam = run("swim --joints prescribed --duration 20 --all").out
    shown = run("trial show bare.nc").out
    table = swam[swam.index("simulated") :]
    assert shown.endswith(table)
    assert shown.startswith(f"made     {load_trial('bare.nc').created}")


def test_a_stored_trial_can_be_read_by_a_program(run, stored):
    swam, shown = (
        json.loads(run(line).out)
        for line in ("swim --joints prescribed --duration 20 --json", "trial show bare.nc --json")
    )
    assert shown == swam


def test_trials_are_compared_with_the_first(run, stored):
    text = run("trial compare bare.nc fin.nc bare.nc").out
    note, below, header, *rows = text.splitlines()
    assert note == "Different robots: bare.nc mamba; fin.nc mamba-fin; bare.nc mamba."
    assert not below
    assert header.split() == ["bare.nc", "fin.nc", "difference", "bare.nc", "difference"]
    (row,) = [row for row in rows if row.startswith("forward velocity")]
    assert row.endswith("+0.0 %")


def test_a_comparison_can_be_read_by_a_program(run, stored):
    found = json.loads(run("trial compare bare.nc fin.nc --json").out)
    assert found["trials"] == ["bare.nc", "fin.nc"]
    speed = found["figures"]["forward_velocity"]
    values = [load_trial(name).forward_velocity for name in found["trials"]]
    assert speed["unit"] == "m/s"
    assert speed["values"] == values
    assert speed["differences_percent"] == pytest.approx(
        [0.0, 100.0 * (values[1] / values[0] - 1.0)]
    )


def test_a_difference_from_next_to_nothing_is_shown_in_the_figures_unit(run, stored):
    still = load_trial("bare.nc")
    dataclasses.replace(still, center_of_mass=1e-9 * still.center_of_mass).save("still.nc")
    text = run("trial compare still.nc bare.nc").out
    (row,) = [row for row in text.splitlines() if row.startswith("forward velocity")]
    assert row.endswith(f"+{load_trial('bare.nc').forward_velocity:.4f} m/s")
    assert "nan" not in text
    found = json.loads(run("trial compare still.nc bare.nc --json").out)["figures"][
        "forward_velocity"
    ]
    assert found["differences_percent"] == [None, None]
    assert found["differences"][1] == pytest.approx(load_trial("bare.nc").forward_velocity)


WILD = "--joints prescribed --dt 0.5 --frequency-deg-s 700 --sample-interval 0.5"
TASK = """
kind = "identification"
name = "tank"
title = "in the tank"
robot = "mamba"
parameters = ["water.normal_drag"]

[[trials]]
file = "failed.nc"
"""


@pytest.fixture
def failed(run) -> str:
    done = run(f"swim {WILD} --save failed.nc --json")
    assert done.status == 1
    facts = json.loads(done.out)
    assert not facts["succeeded"] and "diverged" in facts["status"]
    assert {facts[figure.name] for figure in FIGURES} == {None}
    return "failed.nc"


def test_a_trial_that_failed_is_marked_by_every_command(run, stored, failed, folder: Path):
    status = load_trial(failed).status
    compared = run(f"trial compare bare.nc {failed} fin.nc")
    head = " ".join(compared.out.split())
    assert head.startswith(f"FAILED: failed.nc has no figures. {status} Different robots: bare.nc")
    assert "Different durations: bare.nc 20 s; failed.nc " in head
    assert "failed.nc FAILED" in compared.out
    facts = json.loads(run(f"trial compare bare.nc {failed} --json").out)
    assert facts["succeeded"] == [True, False] and facts["status"][1] == status
    assert all(figure["values"][1] is None for figure in facts["figures"].values())
    shown = run(f"trial show {failed}").out
    assert "FAILED  " in shown and "forward velocity" not in shown
    for files in (failed, f"bare.nc {failed}"):
        drawn = run(f"trial plot {files} --output both.svg")
        assert drawn.status == 0 and "failed.nc FAILED" in drawn.out
        assert "FAILED" in (folder / "both.svg").read_text()
    for options in ("--interval", "--all", ""):
        again = run(f"swim {WILD} {options}")
        assert again.status == 1 and "FAILED" in again.out and "Traceback" not in again.err


def test_nothing_is_identified_from_a_trial_that_failed(run, failed, folder: Path):
    (folder / "task.toml").write_text(TASK)
    refused = run("identify task.toml --output found")
    assert refused.status == 2
    assert "failed.nc: A run that failed has no figures: The run diverged at" in refused.err


def test_mechanical_and_electrical_power_are_not_compared(run, stored):
    assert (
        "mean_power" not in json.loads(run("trial compare bare.nc servo.nc --json").out)["figures"]
    )


def test_a_trial_is_converted_to_a_table_of_numbers(run, stored, folder: Path):
    done = run("trial convert bare.nc bare.csv")
    assert done.out == "bare.csv: 401 samples\n"
    header, *rows = list(csv.reader((folder / "bare.csv").read_text().splitlines()))
    assert header[0] == "time [s]"
    assert len(rows) == 401
    assert json.loads(run("trial convert bare.nc bare.csv --json").out) == {
        "output": "bare.csv",
        "n_samples": 401,
    }


@pytest.mark.parametrize("ending", ["nc", "mcap", "parquet", "mat"])
def test_a_trial_is_the_same_in_every_format(run, stored, ending):
    for package in {"mcap": ["mcap"], "parquet": ["pyarrow"], "mat": ["scipy"]}.get(ending, []):
        pytest.importorskip(package)
    assert run(f"trial convert servo.nc other.{ending}").status == 0
    assert load_trial(f"other.{ending}").equals(load_trial("servo.nc"))
    assert run(f"trial show other.{ending} --json").out == run("trial show servo.nc --json").out


MAP = """
kind = "columns"
robot = "mamba"

[time]
column = "time [s]"

[center_of_mass]
position = ["center_of_mass_x [m]", "center_of_mass_y [m]"]
"""


def test_a_log_is_shown_and_compared_with_a_simulation(run, stored, folder: Path):
    assert run("trial convert bare.nc log.csv").status == 0
    (folder / "map.toml").write_text(MAP)
    shown = run("trial show log.csv --columns map.toml")
    assert shown.status == 0
    assert "measured" in shown.out
    assert "simulated" not in shown.out
    assert "must have a measured `work`" in " ".join(shown.out.split())
    found = json.loads(run("trial show log.csv --columns map.toml --json").out)
    assert found["forward_velocity"] == pytest.approx(
        load_trial("bare.nc").forward_velocity, rel=1e-12
    )
    assert "joint_torque" in found["not_measured"]
    compared = json.loads(run("trial compare bare.nc log.csv --columns map.toml --json").out)
    assert compared["figures"]["forward_velocity"]["differences_percent"][1] == pytest.approx(
        0.0, abs=1e-9
    )


def test_a_log_without_a_map_and_a_map_with_a_mistake_are_refused_by_name(
    run, stored, folder: Path
):
    run("trial convert bare.nc log.csv")
    refused = run("trial show log.csv")
    assert refused.status == 2
    assert (
        "does not state the robot; give a column map (`columns`, on the command line --columns)"
        in refused.err
    )
    (folder / "map.toml").write_text(MAP.replace("position", "positions"))
    refused = run("trial show log.csv --columns map.toml")
    assert refused.status == 2
    assert (
        "map.toml: key `center_of_mass.positions`: is not known; did you mean `position`?"
        in refused.err
    )


pytest.importorskip("mujoco")
pytest.importorskip("PIL")


@pytest.fixture
def swum(run):
    assert run("swim --duration 1 --save run.nc").status == 0
    return run


SMALL = "--size 128 72 --fps 3"


@pytest.fixture
def screen():
    skip_without_rendering()


def test_a_stored_trial_becomes_a_film_and_a_picture(swum, folder, screen):
    done = swum(f"view run.nc --video run.mp4 --still run.png --time 0.5 --speed 2 --json {SMALL}")
    assert done.status == 0
    assert all(" % filmed, " in line for line in done.err.splitlines())  # where it takes long
    assert json.loads(done.out) == {"file": "run.nc", "video": "run.mp4", "still": "run.png"}
    assert (folder / "run.png").read_bytes().startswith(b"\x89PNG")
    assert b"ftyp" in (folder / "run.mp4").read_bytes()[:12]


@pytest.mark.parametrize("command", ["swim --duration 1", "follow --duration 1"])
def test_a_run_can_be_filmed_at_once(run, folder, screen, command):
    done = run(f"{command} --video run.mp4 {SMALL}")
    assert done.status == 0
    assert b"ftyp" in (folder / "run.mp4").read_bytes()[:12]


def test_a_film_that_cannot_be_made_is_refused_before_the_run(run, monkeypatch):
    monkeypatch.setattr(video.shutil, "which", lambda name: None)
    done = run("swim --duration 50000 --video run.mp4")
    assert done.status == 2
    assert done.err == (
        "laticauda: Writing a video needs the program ffmpeg; on Debian and Ubuntu run `apt-get install ffmpeg`.\n"
    )


@pytest.mark.parametrize(
    "command", ["swim --duration 1", "follow --duration 1", "trial show run.nc"]
)
@pytest.mark.parametrize("option", ["--from 0.5", "--size 128 72", "--camera top"])
def test_options_of_a_film_without_a_film_are_refused(swum, command, option):
    done = swum(f"{command} {option}")
    message = "--size, --fps, --from, --to and --camera must be given together with --video."
    assert (done.status, done.err.splitlines()[-1]) == (2, f"laticauda: {message}")


def test_without_a_screen_the_message_says_what_to_do_instead(swum, monkeypatch):
    monkeypatch.setattr(window.platform, "system", lambda: "Linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    done = swum("view run.nc")
    assert done.status == 2
    assert done.err == (
        "laticauda: A window needs a screen, but there is none here; write a film with `--video FILE.mp4` or a picture "
        "with `--still FILE.png` instead.\n"
    )


def test_a_screen_that_cannot_be_used_is_no_crash(swum, monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setitem(sys.modules, "glfw", types.SimpleNamespace(init=lambda: False))
    done = swum("view run.nc")
    assert done.status == 2
    assert (
        "A window needs a screen, but the one that is set here cannot be used; write a film"
        in done.err
    )


def test_the_window_shows_the_trial_from_its_start_until_it_is_closed(swum, monkeypatch, folder):
    import contextlib

    shown = []

    class Window:
        def __init__(self, model, data):
            self.model, self.data, self.cam = model, data, types.SimpleNamespace()
            self.user_scn = types.SimpleNamespace(ngeom=9)

        def is_running(self):
            return len(shown) < 3

        def lock(self):
            return contextlib.nullcontext()

        def sync(self):
            shown.append(self.data.qpos.copy())

    @contextlib.contextmanager
    def launch_passive(model, data, *, show_left_ui, show_right_ui):
        yield Window(model, data)

    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setitem(sys.modules, "glfw", types.SimpleNamespace(init=lambda: True))
    monkeypatch.setitem(
        sys.modules, "mujoco.viewer", types.SimpleNamespace(launch_passive=launch_passive)
    )
    monkeypatch.setattr(window.time, "sleep", lambda seconds: None)
    ticks = iter([0.0, 0.25, 0.5, 1.25])
    monkeypatch.setattr(window.time, "monotonic", lambda: next(ticks))
    window.show_in_window(load_trial(folder / "run.nc"))
    assert len(shown) == 3
    np.testing.assert_array_equal(shown[0], shown[2])  # after 1 s it begins again
    assert not np.array_equal(shown[0], shown[1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--video run.avi", "--video must be a file that ends in .mp4, got run.avi."),
        ("--still run.jpg", "--still must be a file that ends in .png, got run.jpg."),
        ("--still run.png --time 3", "--time must be between 0 and 1 s, got 3.0."),
        ("--time 1", "--time must be given with --still: it is the time of the picture."),
        ("--video run.mp4 --speed 0", "--speed must be > 0, got 0."),
        ("--video run.mp4 --size 128 73", "--size must be even for a video, got (128, 73)."),
        ("--video run.mp4 --size 12 72", "--size must be a whole number >= 64, got 12."),
        ("--video run.mp4 --from 0.5 --to 0.2", "--to must be between 0.5 and 1 s, got 0.2."),
        ("--video no/run.mp4", "--video must be a file in a folder that exists, got no/run.mp4."),
    ],
)
def test_bad_input_is_refused_by_name(swum, options, message):
    if message.startswith(("--size must be even", "--to")):
        skip_without_rendering()  # whether films can be made here is said first
    done = swum(f"view run.nc {options}")
    assert (done.status, done.err) == (2, f"laticauda: {message}\n")


def test_one_trial_is_drawn_as_a_sheet_and_several_in_one_figure(run, folder: Path):
    for name, options in {"bare.nc": "", "fin.nc": "--robot mamba-fin"}.items():
        assert run(f"swim {options} --duration 5 --save {name}").status == 0
    assert run("trial plot bare.nc --output one.svg").out == "one.svg: bare.nc\n"
    assert "<svg" in (folder / "one.svg").read_text()
    done = run("trial plot bare.nc fin.nc --output two.png --json")
    facts = {"trials": ["bare.nc", "fin.nc"], "output": "two.png", "succeeded": [True, True]}
    assert json.loads(done.out) == facts
    assert (folder / "two.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("trial plot --output a.png", "FILES must name one or more trials."),
        (
            "trial plot a.nc --output a.gif",
            "--output must be a file that ends in .png or .pdf or .svg, got a.gif.",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused(run, line: str, said: str):
    done = run(line)
    assert (done.status, done.err) == (2, f"laticauda: {said}\n")


def test_the_help_lists_the_endings_of_all_formats(run):
    line = " ".join(run("trial convert --help").out.replace("│", " ").split())
    assert "replace: .nc, .mcap, .parquet, .mat or .csv; or a new FOLDER/" in line
    assert list_endings([".nc"]) == ".nc"
