"""From tracked points to forces in one call, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from point_films import film_of

import laticauda as lc
from laticauda.film.forces import guess_places, points_of_trial, scale_points


@pytest.fixture(scope="module")
def film():
    gait = lc.eel_like(amplitude=0.6, frequency=8.5, phase_shift=0.7)
    return film_of(lc.load_robot("amphibot"), gait, duration=2.0)


def test_points_from_nose_to_tail_are_placed_by_their_distances(film):
    robot = lc.load_robot("amphibot")
    ends = replace(film.points, position=film.points.position[:, ::-1])
    places = guess_places(ends, robot)
    assert places.along[0] == pytest.approx(robot.length)
    assert places.along[-1] == pytest.approx(0.0)
    assert np.all(np.diff(places.along) < 0.0)


def test_points_of_another_scale_are_refused(film):
    large = replace(film.points, position=10.0 * film.points.position)
    with pytest.raises(ValueError, match=r"points.*about 0.675 m.*is the scale right"):
        guess_places(large, lc.load_robot("amphibot"))


def test_pixels_become_meters_with_y_up(film):
    pixels = replace(film.points, position=film.points.position * [100.0, -100.0], unit="px")
    np.testing.assert_allclose(scale_points(pixels, 100.0).position, film.points.position)


def test_points_in_meters_need_no_scale(film):
    with pytest.raises(ValueError, match=r"pixels_per_meter.*left out: the points are in m"):
        scale_points(film.points, 100.0)


def test_a_trial_has_its_joints_as_points(film):
    points = points_of_trial(film.trial)
    assert points.names == ("tail", *(f"joint_{i}" for i in range(1, 7)), "head")
    lengths = np.linalg.norm(np.diff(points.position, axis=1), axis=2)
    np.testing.assert_allclose(lengths, 0.0965)
