"""`laticauda inverse`: from points tracked in a film to forces."""

import json

import numpy as np
import pytest
from point_films import film_of

import laticauda as lc
from laticauda.cli.app import main
from laticauda.film.chain import build_eel
from laticauda.robot import textbook_of

SCALE = 950.0


@pytest.fixture(scope="module")
def film():
    eel = build_eel(0.4)
    gait = lc.eel_like(amplitude=0.5, frequency=12.0, phase_shift=0.65)
    water = textbook_of(eel)
    return film_of(eel, gait, noise=0.0007, n_points=11, duration=2.5, environment=water)


@pytest.fixture(scope="module")
def table(film, tmp_path_factory):
    """The film as DeepLabCut writes it: nose first, in px, y down."""
    places = film.points.position[:, ::-1]
    names = ["snout", *(f"mid{i}" for i in range(1, 10)), "tailtip"]
    lines = [
        "scorer," + ",".join(["DLC_resnet50"] * 33),
        "bodyparts," + ",".join(name for name in names for _ in range(3)),
        "coords," + ",".join(["x,y,likelihood"] * 11),
    ]
    for frame, row in enumerate(places):
        cells = [f"{200 + SCALE * x:.3f},{540 - SCALE * y:.3f},0.99" for x, y in row]
        lines.append(f"{frame}," + ",".join(cells))
    path = tmp_path_factory.mktemp("film") / "eelDLC.csv"
    path.write_text("\n".join(lines) + "\n")
    return str(path)


OPTIONS = ["--robot", "eel", "--length", "0.4", "--frame-rate", "60", "--draws", "40"]


def test_a_file_of_deeplabcut_becomes_forces_with_a_page(film, table, tmp_path, capsys):
    page = tmp_path / "page"
    along = [f"{one:.4f}" for one in film.along[::-1]]
    words = ["inverse", table, *OPTIONS, "--pixels-per-meter", str(SCALE), "--json"]
    assert main([*words, "--along", *along, "--output", str(page)]) == 0
    facts = json.loads(capsys.readouterr().out)
    center = film.truth("center_of_mass")
    duration = film.points.time[-1]
    speed = np.linalg.norm(center[-1] - center[0]) / duration
    assert facts["figures"]["speed"]["median"] == pytest.approx(speed, rel=0.02)
    assert facts["frequency"] == pytest.approx(12.0 / (2.0 * np.pi), rel=0.01)
    assert facts["figures"]["mechanical_power"]["shares"]["water"] > 0.5
    html = (page / "inverse.html").read_text()
    assert "95 % interval" in html
    assert (page / "forces.png").stat().st_size > 10_000
    assert (page / "chain.png").stat().st_size > 10_000
    assert "must lie on the points in every one" in html
    assert len((page / "links.csv").read_text().splitlines()) == 11


def test_a_trial_with_measured_angles_does_as_well(film, tmp_path, capsys):
    path = tmp_path / "run.nc"
    robot = lc.load_robot("amphibot")
    gait = lc.eel_like(amplitude=0.6, frequency=8.5, phase_shift=0.7)
    trial = lc.swim(robot, gait, 4.0, environment=textbook_of(robot), sample_interval=0.02)
    trial.save(path)
    words = ["inverse", str(path), "--robot", "amphibot", "--span", "2", "3.8", "--draws", "40"]
    assert main(words) == 0
    assert "amphibot swims at" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (OPTIONS, "pixels-per-meter must be given for points in px, or a --calibration"),
        (
            ["--robot", "eel", "--frame-rate", "60"],
            "length must be given for a body of the kind eel",
        ),
        (
            [*OPTIONS, "--pixels-per-meter", "95"],
            "must span about 0.4 m, the length of `eel`, from nose to tail tip, got 3.",
        ),
        (
            ["--robot", "amphibot", "--length", "0.4", "--frame-rate", "60"],
            "length must be left out unless",
        ),
        (
            ["--robot", "eal", "--length", "0.4"],
            "--robot must be one of `eel`, `fish`, `amphibot`, ",
        ),
    ],
)
def test_what_is_missing_or_wrong_is_said_by_its_name(table, words, message, capsys):
    assert main(["inverse", table, *words]) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_a_film_itself_is_sent_to_track(tmp_path, capsys):
    film = tmp_path / "swim.mp4"
    film.write_bytes(b"")
    assert main(["inverse", str(film), "--robot", "mamba"]) == 2
    assert "not the film itself: `laticauda track` finds tags" in capsys.readouterr().err


def test_a_name_that_is_no_robot_is_said_before_its_length(table, capsys):
    assert main(["inverse", table, "--robot", "ell", *OPTIONS[2:]]) == 2
    assert "length" not in capsys.readouterr().err


def test_a_trial_is_not_taken_for_the_swim_of_another_body(tmp_path, capsys):
    path = tmp_path / "run.nc"
    gait = lc.eel_like(amplitude=0.6, frequency=8.5, phase_shift=0.7)
    lc.swim("amphibot", gait, 1.0).save(path)
    assert main(["inverse", str(path), "--robot", "eel", "--length", "0.4"]) == 2
    message = "--robot must be as long as what swam in the trial, `amphibot`: 7 links, 0.6755 m, "
    assert f"{message}got 10 links, 0.4 m" in " ".join(capsys.readouterr().err.split())
