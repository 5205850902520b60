import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cockpit import Setting
from laticauda.cockpit.chart import with_values
from laticauda.cockpit.gait_map import (
    AMPLITUDES,
    DURATION,
    FREQUENCIES,
    QUANTITIES,
    GaitMap,
    at,
    base,
    chart,
    gait_map,
    title,
)
from laticauda.control import StraightLine
from laticauda.figures.gait_map import gait_map_picture

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=math.radians(40.0))
SETTING = Setting(robot=lc.load_robot("mamba"), gait=GAIT, current=(0.05, 0.0))


def test_every_value_of_the_map_is_what_swim_says():
    values = gait_map(SETTING).values["forward_velocity"]
    assert values.shape == (len(FREQUENCIES), len(AMPLITUDES))
    for i, j in ((0, 0), (5, 5), (-1, 2)):
        gait = at(GAIT, AMPLITUDES[j], FREQUENCIES[i])
        trial = lc.swim(SETTING.robot, gait, DURATION, environment=SETTING.environment)
        assert values[i, j] == pytest.approx(trial.forward_velocity, rel=1e-6)


def test_settings_that_differ_in_what_the_map_spans_share_it():
    same = replace(SETTING, gait=at(GAIT, 12.0, 34.0), model="spatial", path=StraightLine())
    assert base(same) == base(SETTING)
    assert base(replace(SETTING, joints="pd")) != base(SETTING)
    assert base(replace(SETTING, current=(0.0, 0.0))) != base(SETTING)


def test_the_nearest_trial_is_found():
    nothing = np.zeros((len(FREQUENCIES), len(AMPLITUDES)))
    drawn = chart(GaitMap(setting=base(SETTING), values=dict.fromkeys(QUANTITIES, nothing)), "mean_power")

    def found(amplitude, frequency):
        return with_values(SETTING, drawn.nearest(amplitude, frequency)).gait

    assert found(42.4, 151.0) == at(GAIT, 40.0, 160.0)
    assert found(-5.0, 999.0) == at(GAIT, AMPLITUDES[0], FREQUENCIES[-1])
    assert drawn.place_of(replace(SETTING, gait=at(GAIT, 42.4, 151.0))) == (42.4, 151.0)


def test_a_quantity_that_there_is_not_is_refused():
    with pytest.raises(ValueError, match="`quantity` must be one of"):
        title("beauty")


def test_the_picture_says_where_its_axes_are():
    values = np.full((len(FREQUENCIES), len(AMPLITUDES)), 1.0)
    values[0, 0], values[3, 4] = np.nan, 5.0
    picture = gait_map_picture(AMPLITUDES, FREQUENCIES, values, "Speed [m/s]")
    (left, bottom, wide, high), ((low, top), (down, up)) = picture.box, picture.limits
    n_rows, n_columns, _ = picture.pixels.shape

    def color(amplitude, frequency):
        x = (left + wide * (amplitude - low) / (top - low)) * n_columns
        y = (1.0 - bottom - high * (frequency - down) / (up - down)) * n_rows
        return tuple(picture.pixels[round(y), round(x)])

    assert color(AMPLITUDES[0], FREQUENCIES[0]) == (200, 200, 200)
    assert color(AMPLITUDES[4], FREQUENCIES[3]) != color(AMPLITUDES[5], FREQUENCIES[3])
