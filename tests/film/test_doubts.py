"""What may be wrong with a filmed swim is said before its figures, or refused."""

from dataclasses import replace

import numpy as np
import pytest
from point_films import film_of

import laticauda as lc
from laticauda.film.chain import build_eel, fit_chain, places_at
from laticauda.film.forces import find_forces, invert_points, list_doubts, list_remarks, summarize
from laticauda.film.tracking import follow_points
from laticauda.robot import textbook_of

GAIT = lc.eel_like(amplitude=0.5, frequency=12.0, phase_shift=0.65)
N_DRAWS = 40


@pytest.fixture(scope="module")
def eel():
    return build_eel(0.4)


@pytest.fixture(scope="module")
def film(eel):
    return film_of(eel, GAIT, noise=0.0007, n_points=11, duration=2.0, environment=textbook_of(eel))


def swim(film, robot, along=None, **changes):
    points = replace(film.points, **changes)
    chosen = film.along if along is None else along
    return invert_points(points, robot, chosen, water=textbook_of(robot), n_draws=N_DRAWS)


@pytest.fixture(scope="module")
def shares():
    """What is done of the usual swim, told again and again."""
    return []


@pytest.fixture(scope="module")
def usual(film, eel, shares):
    water = textbook_of(eel)
    how = {"water": water, "n_draws": N_DRAWS, "on_progress": shares.append}
    return invert_points(film.points, eel, film.along, **how)


def test_nothing_speaks_against_a_swim_in_its_own_water(usual):
    assert list_doubts(usual) == []


def test_the_first_sentences_say_speed_and_power_and_whether_the_chain_holds(usual):
    assert "m/s (" in summarize(usual)
    assert " W (" in summarize(usual)
    assert "mm from the fitted chain" in summarize(usual)
    assert "of the body's length" in summarize(usual)


def test_what_was_taken_for_exact_is_said(usual):
    exact = [one for one in list_remarks(usual) if "take for exact" in one]
    assert exact
    assert "--scale-deviation" in exact[0]
    assert "--body-deviation" in exact[0]


def test_points_in_the_order_from_tail_to_nose_are_doubted(film, eel):
    forces = swim(film, eel, along=film.along[::-1])
    assert any("It swims tail first" in one for one in list_doubts(forces))


def test_a_body_of_another_length_is_doubted_and_its_speed_gets_an_interval(film, eel):
    longer = build_eel(0.44)
    forces = swim(film, longer, along=1.1 * film.along)
    doubt = [one for one in list_doubts(forces) if "closer together" in one]
    assert doubt
    assert "9% closer together than on a body of 0.44 m" in doubt[0]
    speed = forces.figures["speed"]
    assert speed.high - speed.low > 0.2 * speed.median


def test_a_point_that_is_hardly_ever_seen_is_left_out_with_a_note(film, eel):
    position = film.points.position.copy()
    position[2:, 4] = np.nan
    forces = swim(film, eel, position=position)
    assert forces.fit.points.n_points == 10
    assert any("left out: point_4" in note for note in forces.fit.points.notes)


def test_a_film_of_five_frames_is_too_short_for_forces(film, eel):
    points = replace(
        film.points,
        time=film.points.time[:5],
        position=film.points.position[:5],
        likelihood=film.points.likelihood[:5],
    )
    with pytest.raises(ValueError, match=r"points.*at least 12 frames.*accelerations, got 5"):
        invert_points(points, eel, film.along)


def test_a_body_that_does_not_move_is_refused(film, eel):
    position = np.repeat(film.points.position[:1], film.points.n_frames, axis=0)
    points = replace(film.points, position=position)
    with pytest.raises(ValueError, match=r"points.*a body that moves: it stays within"):
        find_forces(fit_chain(points, eel, places_at(film.along)))


def test_one_point_has_no_motion_of_the_body(film, eel):
    points = film.points.only(("point_3",))
    with pytest.raises(ValueError, match=r"points.*two at least.*such as a centroid"):
        invert_points(points, eel)


@pytest.mark.usefixtures("usual")
def test_progress_goes_from_the_fit_to_the_last_draw(shares):
    assert shares == sorted(shares)
    assert len(shares) > N_DRAWS
    assert 0.0 < shares[0] < shares[-1] <= 1.0


def test_a_speed_that_only_a_wrong_frame_rate_has_is_doubted(film, eel):
    forces = swim(film, eel, time=0.05 * film.points.time)
    assert any("is the film of 1200 frames per second?" in one for one in list_doubts(forces))


def test_points_of_another_unit_make_no_trial(film, eel):
    far = replace(film.points, position=100.0 * film.points.position)
    with pytest.raises(
        ValueError, match=r"points.*0.368 m apart along the body.*is the scale in m"
    ):
        follow_points(far, places_at(film.along), None, eel)
