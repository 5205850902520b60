"""Films of missions: what a picture shows at a moment."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.patches import FancyArrowPatch, Rectangle

from laticauda.missions import (
    Conditions,
    change_scenario,
    draw_conditions,
    draw_phases,
    film_mission,
    load_mission,
    run_mission,
)
from laticauda.sensing import Sonar, surroundings_of


@pytest.fixture(scope="module")
def result():
    """The first seconds of the mission in waves, with a compass that fails from 16 s on."""
    mission = replace(load_mission("net-inspection"), duration=20.0)
    conditions = Conditions(failing=("compass",), fault_begin=1e-9)
    draw = draw_conditions(conditions, 14)
    draw = replace(draw, fault=replace(draw.fault, begin=16.0, end=40.0, kind="silent"))
    return run_mission(change_scenario(mission, conditions, draw))


@pytest.fixture(scope="module")
def film(result):
    return film_mission(result, speed=6.0)


def words_of(film):
    return {text.get_text() for text in film._fig.texts}


def test_a_film_says_phase_time_speed_water_and_which_sensor_fails(film, result):
    film._draw_sample(90)
    assert {"search", "18 s", "compass silent", "after undock: done"} <= words_of(film)
    assert any("6 times real time, current 0.09 m/s, waves 7 cm" in each for each in words_of(film))
    film._draw_sample(10)
    assert {"undock", "2 s", ""} <= words_of(film)
    film._draw_sample(result.trial.time.size - 1)
    assert "ended in search" in words_of(film)


def test_the_echoes_on_a_picture_lie_on_what_the_sonar_has_seen(film, result):
    film._draw_sample(45)
    ax, _ = film._fig.axes
    (echoes,) = [line for line in ax.lines if line.get_label() == "echoes of the sonar"]
    x, y = echoes.get_data()
    assert x.size > 5
    points = np.stack((x, y, np.full(x.size, -0.5)), axis=-1)
    places = surroundings_of(result.trial.scenario.model.places)
    (sonar,) = [each for each in result.trial.scenario.model.sensors if isinstance(each, Sonar)]
    # A beam is as wide as this at the distances here, and has only one direction.
    assert np.median(np.abs(places.distances(points))) < sonar.beam_width * 2.0
    assert not np.any(places.distances(points) > 1.0)


def beams_of(film, sample):
    film._draw_sample(sample)
    ax, _ = film._fig.axes
    lines = [each for each in ax.collections if isinstance(each, LineCollection)]
    return sum(len(each.get_segments()) for each in lines if each.get_alpha())


def test_there_is_a_beam_for_every_echo_of_the_last_ping(film, result):
    ranges = [values for name, values in result.trial.signals.items() if "sonar_range" in name]
    n_echoes = np.isfinite(ranges).sum(axis=0)
    (changes,) = np.nonzero(np.diff(n_echoes))
    assert len(changes) > 5
    for sample in (changes[:5] + 1).tolist():
        assert beams_of(film, sample) == n_echoes[sample]


def test_pictures_fall_on_samples_and_the_last_one_stays(film, result):
    moments = film._moments
    assert moments[:3] == [0, 1, 2]  # 6 times real time, 30 pictures a second, 0.2 s a sample
    assert moments[-60:] == [result.trial.time.size - 1] * 60
    assert next(film.pictures()).shape == (720, 1280, 3)


def test_a_film_lasts_about_twenty_seconds_unless_its_speed_is_given(result):
    film = film_mission(result, frames_per_second=5.0)
    assert len(film._moments) == 100 + 2 * 5


@pytest.mark.parametrize(("name", "n_reasons"), [("net-inspection", 10), ("tank-inspection", 8)])
def test_no_reason_in_a_diagram_hides_a_way_past_it(name, n_reasons):
    panel = draw_phases(load_mission(name).motion).axes[0]
    panel.figure.canvas.draw()
    lines = []
    for arrow in panel.patches:
        if isinstance(arrow, FancyArrowPatch):
            lines += arrow.get_path().to_polygons(panel.transData, closed_only=False)
    reasons = [text for text in panel.texts if text.get_bbox_patch() is not None]
    assert len(reasons) == n_reasons
    for reason in reasons:
        box = reason.get_window_extent()
        for line in lines:
            for (x, y), (next_x, next_y) in pairwise(line):
                is_beside = min(y, next_y) < box.y1 and max(y, next_y) > box.y0
                assert not (abs(x - next_x) < 0.5 and is_beside and box.x0 < x < box.x1)


@pytest.mark.parametrize("name", ["net-inspection", "tank-inspection"])
def test_no_reason_in_a_diagram_hides_a_phase(name):
    panel = draw_phases(load_mission(name).motion).axes[0]
    panel.figure.canvas.draw()
    phases = [patch for patch in panel.patches if isinstance(patch, Rectangle)]
    assert len(phases) == len(load_mission(name).motion.phases)
    reasons = [text for text in panel.texts if text.get_bbox_patch() is not None]
    for reason in reasons:
        for phase in phases:
            assert not reason.get_window_extent().overlaps(phase.get_window_extent())


def test_a_diagram_names_every_reason_inside_its_picture():
    figure = draw_phases(load_mission("net-inspection").motion)
    (ax,) = figure.axes
    figure.canvas.draw()
    reasons = {text.get_text() for text in ax.texts}
    assert "done\nor longer than 60 s" in reasons
    assert "sonar silent\nfor 3 s" in reasons
    left, right = figure.bbox.x0, figure.bbox.x1
    for text in ax.texts:
        box = text.get_window_extent()
        assert left <= box.x0 and box.x1 <= right, text.get_text()
