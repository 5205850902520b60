import json
import sys
import types

import numpy as np
import pytest
from rendering import skip_without_rendering

from laticauda import load_trial
from laticauda.pictures import render, replay

pytest.importorskip("mujoco")
pytest.importorskip("PIL")


@pytest.fixture
def stored(run):
    assert run("swim --duration 1 --save run.nc").status == 0
    return run


SMALL = "--size 128 72 --fps 3"


@pytest.fixture
def screen():
    skip_without_rendering()


def test_a_stored_trial_becomes_a_film_and_a_picture(stored, folder, screen):
    done = stored(f"view run.nc --video run.mp4 --still run.png --time 0.5 --speed 2 --json {SMALL}")
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
    monkeypatch.setattr(render.shutil, "which", lambda name: None)
    done = run("swim --duration 50000 --video run.mp4")
    assert done.status == 2
    assert done.err == (
        "laticauda: Writing a video needs the program ffmpeg; on Debian and Ubuntu run `apt-get install ffmpeg`.\n"
    )


def test_without_a_screen_the_message_says_what_to_do_instead(stored, monkeypatch):
    monkeypatch.setattr(replay.platform, "system", lambda: "Linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    done = stored("view run.nc")
    assert done.status == 2
    assert done.err == (
        "laticauda: A window needs a screen, and there is none here; write a film with `--video FILE.mp4` or a picture "
        "with `--still FILE.png` instead.\n"
    )


def test_a_screen_that_cannot_be_used_is_no_crash(stored, monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setitem(sys.modules, "glfw", types.SimpleNamespace(init=lambda: False))
    done = stored("view run.nc")
    assert done.status == 2
    assert "A window needs a screen, and the one that is named here cannot be used; write a film" in done.err


def test_the_window_shows_the_trial_from_its_start_until_it_is_closed(stored, monkeypatch, folder):
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
    monkeypatch.setitem(sys.modules, "mujoco.viewer", types.SimpleNamespace(launch_passive=launch_passive))
    monkeypatch.setattr(replay.time, "sleep", lambda seconds: None)
    ticks = iter([0.0, 0.25, 0.5, 1.25])
    monkeypatch.setattr(replay.time, "monotonic", lambda: next(ticks))
    replay.show(load_trial(folder / "run.nc"))
    assert len(shown) == 3
    np.testing.assert_array_equal(shown[0], shown[2])  # after 1 s it begins again
    assert not np.array_equal(shown[0], shown[1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--video run.avi", "--video must be a file that ends in .mp4, got run.avi."),
        ("--still run.jpg", "--still must be a file that ends in .png, got run.jpg."),
        ("--still run.png --time 3", "--time must be between 0 and 1 s, got 3.0."),
        ("--time 1", "--time must be given with --still: it is the moment of the picture."),
        ("--video run.mp4 --speed 0", "--speed must be > 0, got 0."),
        ("--video run.mp4 --size 128 73", "--size must be even for a video, got (128, 73)."),
        ("--video run.mp4 --size 12 72", "--size must be a whole number >= 64, got 12."),
        ("--video run.mp4 --from 0.5 --to 0.2", "--to must be between 0.5 and 1 s, got 0.2."),
        ("--video no/run.mp4", "--video must be a file in a folder that exists, got no/run.mp4."),
    ],
)
def test_bad_input_is_refused_by_name(stored, options, message):
    done = stored(f"view run.nc {options}")
    assert (done.status, done.err) == (2, f"laticauda: {message}\n")
