"""The fit of a chain to all frames of a film."""

from dataclasses import replace

import numpy as np
import pytest
from point_films import film_of

import laticauda as lc
from laticauda.film.chain import build_body, build_eel, fit_chain, places_at
from laticauda.film.chain.arrow import ArrowMatrix, fill_band
from laticauda.film.chain.basis import Harmonics, SplineBasis

EEL = lc.eel_like(amplitude=0.6, frequency=6.0, phase_shift=0.7)


def angles_of(fit, points):
    return fit.motion(points.time).joint_angle


@pytest.fixture(scope="module")
def robot():
    return lc.load_robot("amphibot")


@pytest.fixture(scope="module")
def noisy(robot):
    film = film_of(robot, EEL, noise=0.003, outliers=0.02, lost=0.05)
    return film, fit_chain(film.points, robot, places_at(film.along))


@pytest.fixture(scope="module")
def splines(noisy, robot):
    """The same film's fit without harmonics."""
    film, _ = noisy
    return fit_chain(film.points, robot, places_at(film.along), harmonics=0)


def test_exact_points_give_the_joint_angles_back(robot):
    film = film_of(robot, EEL, duration=2.5)
    fit = fit_chain(film.points, robot, places_at(film.along))
    missed = angles_of(fit, film.points) - film.truth("joint_angle")
    assert np.abs(missed).max() < 1e-4
    assert fit.frequency == pytest.approx(6.0 / (2.0 * np.pi), rel=1e-4)


def test_the_prior_does_not_eat_the_amplitude(noisy):
    film, fit = noisy
    truth = film.truth("joint_angle")
    fitted = angles_of(fit, film.points)
    assert np.sum(fitted * truth) / np.sum(truth**2) == pytest.approx(1.0, abs=0.01)


def test_without_harmonics_it_does_not_either(noisy, splines):
    film, _ = noisy
    truth = film.truth("joint_angle")
    fitted = angles_of(splines, film.points)
    assert np.sum(fitted * truth) / np.sum(truth**2) == pytest.approx(1.0, abs=0.03)


def test_the_film_prefers_harmonics_where_the_gait_repeats(noisy, splines):
    _, fit = noisy
    assert fit.log_evidence > splines.log_evidence + 10.0
    assert fit.freedoms < splines.freedoms


def test_noise_and_outliers_are_found_for_what_they_are(noisy):
    film, fit = noisy
    assert np.median(fit.noise) == pytest.approx(0.003, rel=0.1)
    n_seen = np.isfinite(film.points.position[..., 0]).sum()
    assert fit.n_outliers == pytest.approx(0.02 * n_seen, rel=0.4)


def test_draws_spread_as_far_as_the_fit_misses(noisy):
    film, fit = noisy
    draws = fit.draw(100, film.points.time)
    spread = draws.joint_angle.std(axis=0)
    missed = angles_of(fit, film.points) - film.truth("joint_angle")
    assert 0.6 < np.sqrt(np.mean((missed / spread) ** 2)) < 1.6


def test_accelerations_are_good_enough_for_forces(noisy):
    film, fit = noisy
    inside = slice(20, -20)
    time = film.points.time
    truth = np.gradient(np.gradient(film.truth("joint_angle"), time, axis=0), time, axis=0)[inside]
    fitted = fit.motion(time).accelerations[inside, 3:]
    assert np.linalg.norm(fitted - truth) < 0.12 * np.linalg.norm(truth)


def test_points_that_sit_elsewhere_than_said_are_found(robot):
    film = film_of(robot, EEL, duration=2.5, noise=0.001)
    elsewhere = film.along.copy()
    elsewhere[4] += 0.02
    places = replace(places_at(elsewhere), along_deviation=0.01)
    fit = fit_chain(film.points, robot, places)
    assert fit.places.along[4] == pytest.approx(film.along[4], abs=0.004)


def test_a_fin_carries_points_behind_the_body():
    robot = lc.load_robot("mamba-fin")
    film = film_of(robot, EEL, duration=2.0)
    fit = fit_chain(film.points, robot, places_at(np.linspace(0.04, 0.96, 9) * robot.length))
    assert fit.n_outliers == 0


def test_points_in_pixels_are_refused(noisy, robot):
    film, _ = noisy
    with pytest.raises(ValueError, match=r"points.unit"):
        fit_chain(replace(film.points, unit="px"), robot, places_at(film.along))


def test_a_place_off_the_body_is_refused(noisy, robot):
    film, _ = noisy
    along = film.along.copy()
    along[0] = -0.1
    with pytest.raises(ValueError, match=r"along\[0\].* on the body of `amphibot`, got -0.1"):
        fit_chain(film.points, robot, places_at(along))


def test_a_point_that_was_never_seen_is_refused_by_name(noisy, robot):
    film, _ = noisy
    position = film.points.position.copy()
    position[:, 3] = np.nan
    with pytest.raises(ValueError, match=r"point_3.*at least three frames"):
        fit_chain(replace(film.points, position=position), robot, places_at(film.along))


def test_an_eel_of_three_lines_swims():
    eel = build_eel(0.4)
    trial = lc.swim(eel, lc.eel_like(amplitude=0.5, frequency=9.0, phase_shift=0.7), 5.0)
    assert trial.forward_velocity > 0.05
    assert eel.mass == pytest.approx(1000.0 * eel.volume)


def test_a_profile_of_nothing_is_refused():
    with pytest.raises(ValueError, match=r"width.*some of them > 0"):
        build_body("nothing", 0.1, [0.0, 0.0], [0.01, 0.01])


def test_splines_and_harmonics_have_the_derivatives_that_they_say():
    basis = SplineBasis(begin=1.0, step=0.1, n_intervals=30)
    harmonics = Harmonics(n_orders=2, middle=2.0, frequency=3.0, frequency_deviation=1.0)
    time, step = np.linspace(1.1, 3.9, 30), 1e-5
    coefficients = np.random.default_rng(0).standard_normal(basis.size)
    for order in range(3):
        ahead = basis.matrix(time + step, order) @ coefficients
        behind = basis.matrix(time - step, order) @ coefficients
        slope = basis.matrix(time, order + 1) @ coefficients
        np.testing.assert_allclose((ahead - behind) / (2.0 * step), slope, rtol=1e-4, atol=1e-2)
        ahead = harmonics.values(time + step, 3.0, order)
        behind = harmonics.values(time - step, 3.0, order)
        slope = harmonics.values(time, 3.0, order + 1)
        np.testing.assert_allclose((ahead - behind) / (2.0 * step), slope, atol=1e-5)


def test_a_band_with_a_border_is_solved_and_drawn_as_the_whole_matrix():
    chance = np.random.default_rng(1)
    n_knots, m, n_border = 6, 2, 3
    root = chance.standard_normal((n_knots * m + n_border, 40))
    whole = root @ root.T
    apart = np.subtract.outer(np.arange(n_knots * m) // m, np.arange(n_knots * m) // m)
    whole[: n_knots * m, : n_knots * m] *= np.abs(apart) <= 2
    whole += 40.0 * np.eye(len(whole))
    n = n_knots * m
    blocks = np.zeros((3, n_knots, m, m))
    for offset in range(3):
        for k in range(n_knots - offset):
            rows = slice((k + offset) * m, (k + offset + 1) * m)
            blocks[offset, k] = whole[rows, k * m : (k + 1) * m]
    arrow = ArrowMatrix(band=fill_band(blocks), border=whole[:n, n:], corner=whole[n:, n:])
    factor = arrow.factor()
    right = chance.standard_normal((len(whole), 2))
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(whole, right))
    assert factor.log_determinant == pytest.approx(np.linalg.slogdet(whole)[1])
    root = factor.whiten_back(np.eye(len(whole)))
    np.testing.assert_allclose(root @ root.T, np.linalg.inv(whole), atol=1e-12)
