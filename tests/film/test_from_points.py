"""From tracked points to forces in one call, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from point_films import film_of

import laticauda as lc
from laticauda.film.forces import (
    from_points,
    guess_places,
    invert_points,
    points_of_trial,
    scale_points,
)


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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"n_draws": 39}, "`n_draws` must be a whole number >= 40, got 39."),
        ({"seed": -1}, "`seed` must be a whole number >= 0, got -1."),
        ({"threads": 0}, "`threads` must be a whole number >= 1, got 0."),
        ({"body_deviation": float("nan")}, "`body_deviation` must be a finite number, got nan."),
        ({"scale_deviation": -0.1}, "`scale_deviation` must be between 0 and 1, got -0.1."),
        ({"span": (0.5, 9.0)}, "`span` must go from a begin to a later end within the film, 0 to 2 s"),
        ({"water": "paper"}, "`water` must be of class Water or Assumptions"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_before_a_film_is_fitted(
    film, monkeypatch: pytest.MonkeyPatch, arguments, message
):
    robot = lc.load_robot("amphibot")
    monkeypatch.setattr(from_points, "fit_chain", lambda *_, **__: pytest.fail("it was fitted"))
    with pytest.raises(ValueError, match="must") as refusal:
        invert_points(film.points, robot, **arguments)
    assert message in str(refusal.value)


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
