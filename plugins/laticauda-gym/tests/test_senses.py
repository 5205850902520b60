"""What sensors tell in observations: names, values, noise of each episode, what is not told."""

import math

import numpy as np
import pytest

import laticauda as lc
from laticauda.sensing import Compass, DopplerVelocity, Net, Sonar
from laticauda_gym import PathFollowing, SwimmingEnv, SwimmingVectorEnv
from laticauda_gym.episodes import BOUND
from laticauda_gym.swimming import swimmer

SENSORS = (
    Compass(noise=0.01),
    Sonar(beams=(0.0, math.pi), noise=0.0),
    DopplerVelocity(name="through_water", through_water=True, noise=0.0),
)
NAMES = (
    "compass_heading",
    "sonar_range_0",
    "sonar_range_1",
    "through_water_forward",
    "through_water_left",
    "through_water_up",
)
PLACE = {"y": 0.0, "heading": 0.0, "current_speed": 0.05, "current_direction": 0.0}


@pytest.fixture(scope="module")
def task():
    model = lc.Planar(sensors=SENSORS, places=(Net(name="pen", center=(4.0, 0.0), radius=1.0),))
    scenario = swimmer("mamba", duration=2.0, model=model)
    return PathFollowing(scenario=scenario, reading_units={"through_water": 0.05, "sonar": 2.0})


def test_readings_stand_behind_the_sights_by_the_names_of_logs(task):
    env = SwimmingEnv(task)
    assert task.reading_names == NAMES
    assert env.observation_space.shape == (len(task.sights) + len(NAMES),)
    assert env.observation_space.contains(env.reset(seed=1)[0])


def test_what_is_observed_is_what_is_told_in_the_stated_units(task):
    env = SwimmingEnv(task)
    told = env.reset(seed=1, options=PLACE)[0][-len(NAMES) :]
    head_x = env.episodes.school.observe(0).head.position[0]
    assert abs(told[0]) < 0.05
    assert told[1] == pytest.approx((3.0 - head_x) / 2.0, abs=0.05)
    # At rest, the water of this episode flows by from behind.
    assert told[3] == pytest.approx(-1.0)


def test_what_a_sensor_does_not_tell_is_the_bound(task):
    assert SwimmingEnv(task).reset(seed=1, options=PLACE)[0][-4] == BOUND


def test_noise_is_that_of_the_episode_whatever_lane_it_is_in(task):
    single, many = SwimmingEnv(task), SwimmingVectorEnv(2, task=task)
    of_many = many.reset(seed=[3, 4])[0]
    expected = [single.reset(seed=seed)[0] for seed in (3, 4)]
    np.testing.assert_array_equal(of_many, expected)
    step_of_many = many.step(np.zeros((2, 1)))[0]
    np.testing.assert_allclose(step_of_many[1], single.step(np.zeros(1))[0], atol=1e-9)
    many.close()


def test_without_sensors_episodes_draw_what_they_drew_before():
    drawn = []
    for model in (lc.Planar(), lc.Planar(sensors=(Compass(),))):
        env = SwimmingEnv("PathFollowing", robot="mamba", model=model, duration=2.0)
        env.reset(seed=5)
        drawn.append(env.episodes.drawn)
    assert drawn[0] == drawn[1]


def test_a_unit_of_what_no_sensor_tells_is_refused(task):
    with pytest.raises(ValueError, match="`reading_units` must be one of `compass`"):
        PathFollowing(scenario=task.scenario, reading_units={"sonic": 2.0})
