import math
import warnings

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import StraightLine
from laticauda.show.cockpit.changes import adapt_scenario
from laticauda.show.cockpit.gait_map import draw_gait_map
from laticauda.show.cockpit.gait_trials import (
    AMPLITUDES,
    DURATION,
    FREQUENCIES,
    change_wave,
    find_best_trial,
    map_gaits,
    name_limit,
    strip_scenario,
)

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=math.radians(40.0))
SCENARIO = adapt_scenario(lc.build_scenario("mamba", GAIT), current=(0.05, 0.0))


@pytest.fixture(scope="module")
def gaits():
    return map_gaits(SCENARIO)


def test_every_value_of_the_map_is_what_swim_says(gaits):
    values = gaits["forward_velocity"]
    assert values.shape == (len(FREQUENCIES), len(AMPLITUDES))
    for i, j in ((0, 0), (5, 5), (-1, 2)):
        gait = change_wave(GAIT, AMPLITUDES[j], FREQUENCIES[i])
        trial = lc.swim(SCENARIO.robot, gait, DURATION, environment=SCENARIO.environment)
        assert values[i, j] == pytest.approx(trial.speed_through_water, rel=1e-6)


def test_scenarios_that_differ_in_what_the_map_spans_share_it():
    same = adapt_scenario(
        SCENARIO, gait=change_wave(GAIT, 12.0, 34.0), model="spatial", path=StraightLine()
    )
    assert strip_scenario(same) == strip_scenario(SCENARIO)
    assert strip_scenario(adapt_scenario(SCENARIO, joints="pd")) != strip_scenario(SCENARIO)
    assert strip_scenario(adapt_scenario(SCENARIO, current=(0.0, 0.0))) != strip_scenario(SCENARIO)


RED, GRAY = (230, 60, 30), (200, 200, 200)


def area(picture, color):
    """How many pixels have a color; letters have some of any gray at their edges."""
    return int(np.all(picture == color, axis=2).sum())


def test_the_picture_marks_the_gait_and_what_failed_is_gray():
    values = np.full((len(FREQUENCIES), len(AMPLITUDES)), 1.0)
    values[3, 4] = 5.0
    beyond = change_wave(GAIT, 80.0, 100.0)
    assert area(draw_gait_map(values, "forward_velocity", GAIT), RED) > 100
    whole = draw_gait_map(values, "forward_velocity", beyond)
    assert (area(whole, RED), area(whole, GRAY) < 100) == (0, True)
    values[0, 0] = np.nan
    assert area(draw_gait_map(values, "forward_velocity", beyond), GRAY) > 400


def test_a_quantity_that_no_trial_has_is_drawn_gray():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        picture = draw_gait_map(
            np.full((len(FREQUENCIES), len(AMPLITUDES)), np.nan), "cost_of_transport", GAIT
        )
    assert area(picture, GRAY) > 100_000


def test_the_best_is_what_the_robot_can_do():
    values = np.full((len(FREQUENCIES), len(AMPLITUDES)), 1.0)
    values[3, 4], values[5, 6], values[0, 0] = 4.0, 5.0, np.nan
    shares = np.full(values.shape, 0.5)
    assert find_best_trial(values, shares, "forward_velocity") == (AMPLITUDES[6], FREQUENCIES[5])
    shares[5, 6] = 1.1
    assert find_best_trial(values, shares, "forward_velocity") == (AMPLITUDES[4], FREQUENCIES[3])
    values[2, 1] = 0.5
    assert find_best_trial(values, shares, "mean_power") == (AMPLITUDES[1], FREQUENCIES[2])
    assert find_best_trial(values, shares + 1.0, "mean_power") == (AMPLITUDES[1], FREQUENCIES[2])
    assert find_best_trial(np.full(values.shape, np.nan), shares, "mean_power") is None


ORANGE = (213, 94, 0)


def test_the_map_shows_where_the_robot_comes_to_its_limit_and_what_limits_it(gaits):
    assert name_limit(SCENARIO, gaits) == "servos"
    values, shares = gaits["forward_velocity"], gaits["utilization"]
    assert area(draw_gait_map(values, "forward_velocity", GAIT, shares, "servos"), ORANGE) > 100
    assert area(draw_gait_map(values, "forward_velocity", GAIT, 0.0 * shares), ORANGE) == 0
    identified = lc.build_scenario("mamba", GAIT, parameters="mamba-identified")
    assert name_limit(identified, map_gaits(identified)) == "servos' top speed"
    weak = {"forward_velocity": values, "utilization": 0.0 * shares}
    slow = lc.build_scenario("amphibot", GAIT)
    assert name_limit(slow, {**weak, "forward_velocity": 1.0 - 0.0 * values}) == ""
