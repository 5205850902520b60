"""Films as measurements from which the water is identified."""

from dataclasses import replace

import numpy as np
import pytest
from point_films import SETTLING, film_of

import laticauda as lc
from laticauda.film.chain import fit_chain, places_at
from laticauda.film.forces import Assumptions, find_forces, measure_glide
from laticauda.identify import fit as identify
from laticauda.robot import textbook_of

STILL = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.0)


def glide_of(robot, water, seed):
    """A robot that glides, filmed at 60 frames/s with 1.5 mm of noise."""
    film = film_of(
        robot,
        STILL,
        duration=3.0,
        noise=0.0015,
        outliers=0.02,
        lost=0.05,
        seed=seed,
        environment=water,
        start=lc.Start(velocity=1.2, heading=0.3),
    )
    return film, fit_chain(film.points, robot, places_at(film.along))


@pytest.fixture(scope="module")
def usual_glide():
    robot = lc.load_robot("amphibot")
    return glide_of(robot, textbook_of(robot), 0)


def test_a_glide_gives_the_friction_with_the_truth_in_its_interval():
    robot = lc.load_robot("amphibot")
    known = textbook_of(robot)
    water = replace(known, tangential_friction=0.045)
    inside = 0
    for seed in range(3):
        _, fit = glide_of(robot, water, seed)
        found = identify(
            [measure_glide(fit, known)], parameters=["water.tangential_friction"], n_starts=1
        )
        estimate = found["water.tangential_friction"]
        assert estimate.value == pytest.approx(0.045, rel=0.05)
        low, high = estimate.interval
        inside += low <= 0.045 <= high
    assert inside == 3


def test_water_that_a_glide_identified_goes_into_the_forces_of_a_swim(usual_glide):
    robot = lc.load_robot("amphibot")
    known = textbook_of(robot)
    _, glide = usual_glide
    found = identify(
        [measure_glide(glide, known)], parameters=["water.tangential_friction"], n_starts=1
    )
    gait = lc.eel_like(amplitude=0.6, frequency=8.5, phase_shift=0.7)
    film = film_of(robot, gait, noise=0.001, environment=known)
    fit = fit_chain(film.points, robot, places_at(film.along))
    forces = find_forces(fit, Assumptions.of_identified(found), n_draws=60, n_swims=0)
    tables = find_forces(fit, n_draws=60, n_swims=0)
    assert forces.explains
    left, wide = (one.figures["left_over"] for one in (forces, tables))
    assert left.high - left.low < 0.3 * (wide.high - wide.low)


def test_a_glide_says_how_sure_it_is(usual_glide):
    film, fit = usual_glide
    measured = measure_glide(fit, textbook_of(lc.load_robot("amphibot")))
    path, deviation = measured.series["center_of_mass"]
    truth = np.array(
        [
            np.interp(measured.time + SETTLING, film.trial.time, one)
            for one in film.trial.center_of_mass.T
        ]
    ).T
    assert np.sqrt(np.mean(((path - truth) / deviation) ** 2)) < 1.5
    assert np.median(deviation) < 0.0015  # surer than a single point in a single frame


def test_a_body_that_swims_does_not_glide():
    robot = lc.load_robot("amphibot")
    film = film_of(robot, lc.eel_like(amplitude=0.6, frequency=8.5, phase_shift=0.7), duration=2.0)
    fit = fit_chain(film.points, robot, places_at(film.along))
    with pytest.raises(ValueError, match=r"fit.*straight body.*within 7 deg"):
        measure_glide(fit, textbook_of(robot))
