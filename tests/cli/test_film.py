import json

import cv2
import numpy as np
import pytest
from film import tracker_files
from film.tag_films import LEVEL, SURFACE, rendered

import laticauda as lc
from laticauda.cli import main
from laticauda.film import write_example
from laticauda.film.calibration import calibrate_by_ruler, load_calibration, save_calibration
from laticauda.film.tags import load_layout, save_layout
from laticauda.robot.files import to_toml


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot.toml").write_text(to_toml(rendered().robot))
    save_layout(rendered().layout, tmp_path / "tags.toml")
    return tmp_path


def test_a_sheet_of_tags_comes_with_their_places_and_what_to_do(folder, capsys):
    assert main(["tags", "--robot", "mamba", "--output", "sheet.pdf", "--area", "2", "1"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("sheet.pdf: 12 pages; sheet.toml: places of the tags\n1. Print at 100 %")
    assert load_layout("sheet.toml").floor[2].x == 2.0


def test_animals_get_tags_for_the_floor_only(folder, capsys):
    assert main(["tags", "--output", "floor.pdf", "--floor-only"]) == 0
    assert "arrow to the head" not in capsys.readouterr().out
    assert load_layout("floor.toml").links == ()


def test_a_film_becomes_a_trial_a_picture_and_a_calibration(folder, capsys):
    options = ["--robot", "robot.toml", "--tags", "tags.toml", "--water", "paper-lateral"]
    options += ["--height", str(LEVEL), "--water-surface", str(SURFACE)]
    options += ["--save", "swim.nc", "--picture", "swim.png", "--save-calibration", "camera.toml"]
    assert main(["track", str(rendered().path), *options]) == 0
    text = capsys.readouterr().out
    assert "camera   marks fit to 0." in text
    assert "note     Tags on the robot were lost in" in text
    trial = lc.load_trial("swim.nc")
    true = rendered().trial
    moved = np.linalg.norm(trial.center_of_mass[-1] - trial.center_of_mass[0])
    at = [np.interp(trial.time[-1], true.time, true.center_of_mass[:, k]) for k in (0, 1)]
    assert moved == pytest.approx(np.hypot(*(at - true.center_of_mass[0, :2])), abs=4e-3)
    assert (folder / "swim.png").stat().st_size > 10_000
    again = ["--robot", "robot.toml", "--tags", "tags.toml", "--calibration", "camera.toml"]
    assert main(["track", str(rendered().path), *again, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["scale_deviation"] > 0.0


def test_a_camera_is_calibrated_by_tags_on_the_floor_or_by_a_ruler(folder, capsys):
    film = str(rendered().path)
    tags = ["--tags", "tags.toml", "--height", str(LEVEL), "--water-surface", str(SURFACE)]
    assert main(["camera", film, *tags, "--output", "camera.toml"]) == 0
    text = capsys.readouterr().out
    assert "camera   marks fit to 0." in text
    assert load_calibration("camera.toml").plane_height == LEVEL
    ruler = ["--ruler-px", "100", "500", "900", "500", "--ruler-length", "2"]
    assert main(["camera", film, *ruler, "--output", "ruler.toml"]) == 0
    assert load_calibration("ruler.toml").metres_per_pixel == pytest.approx(0.0025)
    assert main(["camera", film, *ruler, *tags, "--output", "ruler.toml"]) == 2
    error = capsys.readouterr().err
    assert "one of --tags, --columns, --ruler-px must be given, got 2 of them" in error


def test_a_lens_needs_a_film_that_shows_the_checkerboard(folder, capsys):
    writer = cv2.VideoWriter("blank.avi", cv2.VideoWriter_fourcc(*"MJPG"), 10.0, (160, 120))
    for _ in range(6):
        writer.write(np.full((120, 160, 3), 200, np.uint8))
    writer.release()
    board = ["--columns", "9", "--rows", "6", "--square", "0.025"]
    assert main(["lens", "blank.avi", *board]) == 2
    error = capsys.readouterr().err
    assert "whole checkerboard in at least 5 pictures, got 0 of 6" in error


def test_points_of_a_tracker_become_a_trial(folder, capsys):
    tracker_files.write_deeplabcut_csv(folder / "eel.csv")
    save_calibration(calibrate_by_ruler((640, 480), (0, 0), (500, 0), 1.0), "camera.toml")
    options = ["--robot", "robot.toml", "--calibration", "camera.toml", "--frame-rate", "30"]
    assert main(["track", "eel.csv", *options]) == 2
    assert "--along must say where the points sit on the body" in capsys.readouterr().err
    wrong = ["--along", "nose=x"]
    assert main(["track", "eel.csv", *options, *wrong]) == 2
    assert "--along must be NAME=METRES, got 'nose=x'" in capsys.readouterr().err
    alone = ["--along", "nose=0.44"]
    assert main(["track", "eel.csv", *options, *alone]) == 2
    assert "--along must place at least 2 points: one has no direction" in capsys.readouterr().err
    along = ["--along", "nose=0.44", "middle=0.36", "tail=0.28"]
    assert main(["track", "eel.csv", *options, *along, "--save", "eel.nc"]) == 0
    speed = np.diff(lc.load_trial("eel.nc").center_of_mass[[0, -1], 0])[0] / (11 / 30)
    assert speed == pytest.approx(3.0 / 500.0 * 30.0, rel=0.02)


def test_a_film_without_its_tags_is_refused(folder, capsys):
    assert main(["track", "swim.mp4"]) == 2
    assert "--tags must be given for a film" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            "--robot mambo",
            "laticauda: there is no robot preset named `mambo`; did you mean `mamba`?",
        ),
        ("--start 2 --stop 1", "--stop must be > --start = 2 s, got 1"),
        ("--start 5", "--start must be before the body was last seen, at 3.833 s, got 5 s"),
        ("--stop 0", "--stop must be after the trial begins, at 0 s, got 0 s"),
        ("--height 100", "--height must be a plane that the camera sees where the marks are"),
        ("--along nose=0.3", "--along must be left out for a film: it would do nothing"),
        ("--likelihood-floor 0.3", "--likelihood-floor must be left out for a film"),
    ],
)
def test_what_is_wrong_with_a_film_is_said_by_its_option(folder, capsys, words, message):
    write_example(folder)
    assert main(["track", "glide.mp4", "--tags", "tags.toml", "--straight", *words.split()]) == 2
    assert message in capsys.readouterr().err


def test_options_of_films_do_nothing_for_points_and_are_refused(folder, capsys):
    tracker_files.write_deeplabcut_csv(folder / "eel.csv")
    for option in (["--straight"], ["--save-calibration", "camera.toml"]):
        assert main(["track", "eel.csv", "--robot", "robot.toml", *option]) == 2
        message = f"{option[0]} must be left out for points of a tracker: it would do nothing"
        assert message in capsys.readouterr().err


def test_points_that_their_tracker_is_unsure_of_are_lost_below_the_floor(folder, capsys):
    tracker_files.write_deeplabcut_csv(folder / "eel.csv")
    save_calibration(calibrate_by_ruler((640, 480), (0, 0), (500, 0), 1.0), "camera.toml")
    options = ["--robot", "robot.toml", "--calibration", "camera.toml", "--frame-rate", "30"]
    options += ["--along", "nose=0.44", "middle=0.36", "tail=0.28", "--json"]
    assert main(["track", "eel.csv", *options, "--likelihood-floor", "1"]) == 2
    assert "eel.csv" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("ends", "message"),
    [
        ("1 2 1 2", "--ruler-px: the end must be at least 10 px from its other end, got 0 px"),
        ("-1 2 300 4", "--ruler-px: the begin must be in the picture, which is 1280 by 720 px"),
        ("1 2 3000 4", "--ruler-px: the end must be in the picture, which is 1280 by 720 px"),
    ],
)
def test_the_ends_of_a_ruler_are_two_places_in_the_picture(folder, capsys, ends, message):
    write_example(folder)
    words = ["camera", "glide.mp4", "--output", "camera.toml", "--ruler-length", "1"]
    assert main([*words, "--ruler-px", *ends.split()]) == 2
    assert message in capsys.readouterr().err


def test_tags_on_the_floor_do_not_lie_on_each_other(folder, capsys):
    assert main(["tags", "--area", "0", "2", "--output", "sheet.pdf"]) == 2
    message = "--area must be longer and wider than a tag, 0.13 m, got 0 by 2 m"
    assert message in capsys.readouterr().err
