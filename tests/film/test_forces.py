"""From a fitted film to forces, power and efficiency with intervals."""

from dataclasses import replace

import numpy as np
import pytest
from point_films import SETTLING, film_of

import laticauda as lc
from laticauda.film.chain import fit_chain, places_at
from laticauda.film.forces import Assumptions, find_forces
from laticauda.robot import textbook_of

GAIT = lc.eel_like(amplitude=0.6, frequency=8.5, phase_shift=0.7)


def true_figures(film, window):
    """Speed and power of the swim over the same span."""
    begin, end = SETTLING + window.begin, SETTLING + window.end
    trial = film.trial
    places = np.array(
        [[np.interp(t, trial.time, one) for one in trial.center_of_mass.T] for t in (begin, end)]
    )
    work = [np.interp(t, trial.time, trial.work[:, 0]) for t in (begin, end)]
    duration = end - begin
    return np.linalg.norm(places[1] - places[0]) / duration, (work[1] - work[0]) / duration


@pytest.fixture(scope="module")
def robot():
    return lc.load_robot("amphibot")


@pytest.fixture(scope="module")
def film(robot):
    return film_of(
        robot, GAIT, noise=0.003, outliers=0.02, lost=0.05, environment=textbook_of(robot)
    )


@pytest.fixture(scope="module")
def fit(robot, film):
    return fit_chain(film.points, robot, places_at(film.along))


@pytest.fixture(scope="module")
def known_water(robot, fit):
    return find_forces(fit, textbook_of(robot), n_draws=100)


@pytest.fixture(scope="module")
def tables(fit):
    return find_forces(fit, n_draws=100)


def test_speed_and_power_lie_in_their_intervals(film, known_water):
    speed, power = true_figures(film, known_water.window)
    figures = known_water.figures
    assert figures["speed"].median == pytest.approx(speed, rel=0.002)
    assert figures["mechanical_power"].median == pytest.approx(power, rel=0.05)
    assert figures["mechanical_power"].holds(power)
    assert figures["model_speed"].median == pytest.approx(speed, rel=0.01)


def test_the_right_water_leaves_no_force_over(known_water):
    assert known_water.explains
    assert abs(known_water.figures["left_over_share"].median) < 0.1


def test_another_water_leaves_a_force_over(robot, fit):
    water = replace(textbook_of(robot), tangential_friction=0.06)
    forces = find_forces(fit, water, n_draws=50, n_swims=10)
    assert not forces.explains
    assert forces.figures["left_over"].low > 0.0  # it brakes too much


def test_the_water_of_tables_widens_the_interval_and_says_so(film, known_water, tables):
    _, power = true_figures(film, tables.window)
    wide, narrow = tables.figures["mechanical_power"], known_water.figures["mechanical_power"]
    assert wide.holds(power)
    assert wide.high - wide.low > 3.0 * (narrow.high - narrow.low)
    assert wide.shares["water"] > 0.8
    assert narrow.shares["film"] > 0.8


def test_a_body_that_is_not_known_has_its_share(robot, fit):
    forces = find_forces(fit, textbook_of(robot), body_deviation=0.1, n_draws=50, n_swims=10)
    assert forces.figures["mechanical_power"].shares["body"] > 0.8


def test_a_scale_that_is_not_known_widens_the_speed(robot, fit):
    forces = find_forces(fit, textbook_of(robot), scale_deviation=0.02, n_draws=50, n_swims=10)
    speed = forces.figures["speed"]
    assert (speed.high - speed.low) / speed.median == pytest.approx(0.08, rel=0.4)


def test_the_tail_pushes_and_the_head_brakes(known_water):
    tail, *_, head = known_water.link_figures
    assert tail.low > 0.0 > head.high


def test_mean_forces_of_a_steady_swim_nearly_cancel(known_water):
    total = known_water.mean_force_along.sum(axis=1)
    assert abs(np.median(total)) < 0.1 * np.median(known_water.thrust)


def test_draws_are_the_same_for_the_same_seed(robot, fit):
    one, other = (
        find_forces(fit, textbook_of(robot), n_draws=40, n_swims=0).speed for _ in range(2)
    )
    np.testing.assert_array_equal(one, other)


def test_a_span_outside_the_film_is_refused(fit):
    with pytest.raises(ValueError, match=r"span.*within the film, .* to 4 s, got 3 to 9"):
        find_forces(fit, span=(3.0, 9.0))


def test_a_span_of_less_than_a_cycle_is_refused(fit):
    with pytest.raises(ValueError, match=r"span.*whole cycle of 0.739 s"):
        find_forces(fit, span=(1.0, 1.5))


def test_an_interval_of_the_body_is_refused_as_one_of_the_water(robot, film):
    with pytest.raises(ValueError, match=r"intervals.*numbers of the water"):
        Assumptions(water=textbook_of(robot), intervals={"robot.module.mass": (1.0, 2.0)})
