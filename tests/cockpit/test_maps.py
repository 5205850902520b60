import math

import numpy as np
import pytest

import laticauda as lc
from laticauda.cockpit.board import BOX, gait_map_picture
from laticauda.cockpit.maps import AMPLITUDES, DURATION, FREQUENCIES, base_of, map_of_gaits, with_numbers, with_wave
from laticauda.cockpit.simulation import changed
from laticauda.control import StraightLine

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=math.radians(40.0))
SCENARIO = changed(lc.scenario("mamba", GAIT), current=(0.05, 0.0))


@pytest.fixture(scope="module")
def gaits():
    return map_of_gaits(SCENARIO)


def test_every_value_of_the_map_is_what_swim_says(gaits):
    values = np.asarray(gaits.chart("forward_velocity", "gait.amplitude", "gait.frequency").cut)
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


def test_the_nearest_trial_is_found(gaits):
    drawn = gaits.chart("mean_power", "gait.amplitude", "gait.frequency")
    assert drawn.title == "Mean power [W]"

    def found(amplitude, frequency):
        return with_numbers(SCENARIO, drawn.nearest(amplitude, frequency)).gait

    assert found(42.4, 151.0) == with_wave(GAIT, 40.0, 160.0)
    assert found(-5.0, 999.0) == with_wave(GAIT, AMPLITUDES[0], FREQUENCIES[-1])
    assert drawn.place_of(changed(SCENARIO, gait=with_wave(GAIT, 42.4, 151.0))) == (42.4, 151.0)


def test_the_picture_says_where_its_axes_are():
    values = np.full((len(FREQUENCIES), len(AMPLITUDES)), 1.0)
    values[0, 0], values[3, 4] = np.nan, 5.0
    picture = gait_map_picture(AMPLITUDES, FREQUENCIES, values, "Speed [m/s]", ("amplitude [deg]", "frequency [deg/s]"))
    (left, bottom, wide, high), ((low, top), (down, up)) = BOX, picture.limits
    n_rows, n_columns, _ = picture.pixels.shape

    def color(amplitude, frequency):
        x = (left + wide * (amplitude - low) / (top - low)) * n_columns
        y = (1.0 - bottom - high * (frequency - down) / (up - down)) * n_rows
        return tuple(picture.pixels[round(y), round(x)])

    assert color(AMPLITUDES[0], FREQUENCIES[0]) == (200, 200, 200)
    assert color(AMPLITUDES[4], FREQUENCIES[3]) != color(AMPLITUDES[5], FREQUENCIES[3])
