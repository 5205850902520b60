"""A real animal: a sea lamprey, its midline tracked by others, its water that of tables, and nothing fitted to it."""

import numpy as np
import pytest

from laticauda.film import read_points
from laticauda.film.chain import build_body, fit_chain
from laticauda.film.example_films import FOLDER
from laticauda.film.forces import find_forces, guess_places, list_remarks

FILE = FOLDER / "lamprey.csv"
WIDTH = [0.01, 0.035, 0.05, 0.057, 0.06, 0.06, 0.056, 0.045, 0.02]
"""Width by length, tail first: about that of a lamprey; the height is taken to be 1.15 times as much."""


@pytest.fixture(scope="module")
def points():
    return read_points(FILE)


@pytest.fixture(scope="module")
def forces(points):
    steps = np.linalg.norm(np.diff(points.position, axis=1), axis=2)
    length = float(np.mean(np.sum(steps, axis=1)))
    width = length * np.array(WIDTH)
    body = build_body("lamprey", length, width.tolist(), (1.15 * width).tolist())
    fit = fit_chain(points, body, guess_places(points, body))
    return find_forces(fit, body_deviation=0.1, n_draws=100)


def test_its_midline_breathes_and_the_chain_does_not(points, forces):
    steps = np.linalg.norm(np.diff(points.position, axis=1), axis=2)
    lengths = np.sum(steps, axis=1)
    assert np.std(lengths) > 0.015 * np.mean(lengths)
    assert np.median(forces.fit.noise) < 0.001


def test_the_model_swims_as_fast_as_the_lamprey_did(forces):
    measured, model = forces.figures["speed"], forces.figures["model_speed"]
    assert measured.median == pytest.approx(0.268, abs=0.003)
    assert model.holds(measured.median)
    assert model.high - model.low < 0.6 * model.median


def test_the_water_explains_its_motion_and_its_power_has_an_interval(forces):
    power = forces.figures["mechanical_power"]
    assert forces.explains
    assert 0.002 < power.low < power.high < 0.02
    assert power.shares["body"] > 0.5  # its height is not known


def test_remarks_say_that_its_noise_lasts_from_frame_to_frame(forces):
    assert forces.fit.noise_correlation > 0.3
    assert any("Noise of consecutive frames is correlated" in one for one in list_remarks(forces))
