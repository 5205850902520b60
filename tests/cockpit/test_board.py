import math
import warnings

import numpy as np
import pytest

import laticauda as lc
from laticauda.cockpit.board import (
    AMPLITUDES,
    BOX,
    DURATION,
    FREQUENCIES,
    base_of,
    gait_map_picture,
    map_of_gaits,
    with_wave,
)
from laticauda.cockpit.simulation import changed
from laticauda.control import StraightLine

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=math.radians(40.0))
SCENARIO = changed(lc.scenario("mamba", GAIT), current=(0.05, 0.0))


@pytest.fixture(scope="module")
def gaits():
    return map_of_gaits(SCENARIO)


def test_every_value_of_the_map_is_what_swim_says(gaits):
    values = gaits["forward_velocity"]
    assert values.shape == (len(FREQUENCIES), len(AMPLITUDES))
    for i, j in ((0, 0), (5, 5), (-1, 2)):
        gait = with_wave(GAIT, AMPLITUDES[j], FREQUENCIES[i])
        trial = lc.swim(SCENARIO.robot, gait, DURATION, environment=SCENARIO.environment)
        assert values[i, j] == pytest.approx(trial.forward_velocity, rel=1e-6)


def test_scenarios_that_differ_in_what_the_map_spans_share_it():
    same = changed(SCENARIO, gait=with_wave(GAIT, 12.0, 34.0), model="spatial", path=StraightLine())
    assert base_of(same) == base_of(SCENARIO)
    assert base_of(changed(SCENARIO, joints="pd")) != base_of(SCENARIO)
    assert base_of(changed(SCENARIO, current=(0.0, 0.0))) != base_of(SCENARIO)


def test_the_picture_says_where_its_axes_are():
    values = np.full((len(FREQUENCIES), len(AMPLITUDES)), 1.0)
    values[0, 0], values[3, 4] = np.nan, 5.0
    picture = gait_map_picture(values, "forward_velocity")
    (left, bottom, wide, high), ((low, top), (down, up)) = BOX, picture.limits
    n_rows, n_columns, _ = picture.pixels.shape

    def color(amplitude, frequency):
        x = (left + wide * (amplitude - low) / (top - low)) * n_columns
        y = (1.0 - bottom - high * (frequency - down) / (up - down)) * n_rows
        return tuple(picture.pixels[round(y), round(x)])

    assert color(AMPLITUDES[0], FREQUENCIES[0]) == (200, 200, 200)
    assert color(AMPLITUDES[4], FREQUENCIES[3]) != color(AMPLITUDES[5], FREQUENCIES[3])


def test_a_quantity_that_no_trial_has_is_drawn_gray():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        picture = gait_map_picture(np.full((len(FREQUENCIES), len(AMPLITUDES)), np.nan), "cost_of_transport")
    assert tuple(picture.pixels[picture.pixels.shape[0] // 2, picture.pixels.shape[1] // 2]) == (200, 200, 200)
