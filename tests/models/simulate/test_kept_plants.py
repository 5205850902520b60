"""Plants that are kept for later runs: what follows from a robot is computed once, and never for another one."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate import plants
from laticauda.water.fluid.laws import FunctionDrag
from laticauda.water.fluid.waves import Sea

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
MAMBA = lc.load_robot("mamba")
WATER = lc.load_water("paper-lateral")


def heavier(robot):
    module = replace(robot.modules[3], mass=1.2 * robot.modules[3].mass)
    return replace(robot, modules=(*robot.modules[:3], module, *robot.modules[4:]))


def weaker(robot):
    joints = [
        replace(joint, actuator=replace(joint.actuator, servo_gain=3.0)) for joint in robot.joints
    ]
    return replace(robot, joints=tuple(joints))


SCENARIOS = {
    "as it is": lc.build_scenario(MAMBA, GAIT, 3.0),
    "one module heavier": lc.build_scenario(heavier(MAMBA), GAIT, 3.0),
    "another drag": lc.build_scenario(
        MAMBA, GAIT, 3.0, environment=replace(WATER, normal_drag=1.1 * WATER.normal_drag)
    ),
    "in a current": lc.build_scenario(MAMBA, GAIT, 3.0, current=(0.1, 0.02)),
    "servos": lc.build_scenario(MAMBA, GAIT, 3.0, joints="servo"),
    "weaker servos": lc.build_scenario(weaker(MAMBA), GAIT, 3.0, joints="servo"),
    "smaller steps": lc.build_scenario(MAMBA, GAIT, 3.0, dt=0.025),
    "another gait": lc.build_scenario(MAMBA, replace(GAIT, amplitude=0.4), 3.0),
    "a fin": lc.build_scenario("mamba-fin", GAIT, 3.0),
    "pitch joints": lc.build_scenario("mamba-modules", GAIT, 3.0),
}


@pytest.fixture(scope="module")
def alone():
    """Every scenario's samples when nothing is kept of the others."""
    trials = {}
    for name, scenario in SCENARIOS.items():
        plants.kept_plant.cache_clear()
        trials[name] = lc.swim(scenario)
    return trials


@pytest.mark.filterwarnings("ignore::laticauda.InfeasibleWarning")
def test_every_run_is_the_same_to_the_last_bit_whatever_ran_before(alone):
    names = [*SCENARIOS]
    for name in [*names, *reversed(names), *names[::3]]:
        series = lc.swim(SCENARIOS[name]).series()
        for quantity, values in alone[name].series().items():
            np.testing.assert_array_equal(series[quantity], values, err_msg=f"{name}: {quantity}")
    ends = {name: tuple(trial.center_of_mass[-1]) for name, trial in alone.items()}
    assert len(set(ends.values())) == len(SCENARIOS)


def test_a_robot_that_swims_again_has_the_same_plant():
    assert lc.build_plant(MAMBA, WATER) is lc.build_plant(MAMBA, WATER)
    assert lc.build_plant(MAMBA, WATER) is lc.build_plant(MAMBA, WATER, joints="prescribed")


@pytest.mark.parametrize(
    ("robot", "water", "joints"),
    [
        (replace(MAMBA), WATER, "prescribed"),
        (MAMBA, replace(WATER), "prescribed"),
        (MAMBA, WATER, "servo"),
    ],
    ids=["copied robot", "copied water", "other joints"],
)
def test_whatever_was_replaced_has_a_plant_of_its_own(robot, water, joints):
    assert lc.build_plant(robot, water, joints=joints) is not lc.build_plant(MAMBA, WATER)


def test_flowing_water_which_may_be_large_is_not_kept():
    waves = replace(WATER, current=Sea(seed=2))
    assert lc.build_plant(MAMBA, waves) is not lc.build_plant(MAMBA, waves)


def test_a_law_that_is_the_users_own_may_have_changed_and_is_not_kept():
    def drag(v_t, v_n, across, rate, element):
        return element.c_t * v_t, element.c_n * v_n, 0.0

    water = replace(WATER, drag=FunctionDrag(function=drag))
    assert lc.build_plant(MAMBA, water) is not lc.build_plant(MAMBA, water)


def test_few_plants_are_kept():
    for _ in range(2 * plants.MOST_KEPT_PLANTS):
        lc.build_plant(replace(MAMBA), WATER)
    assert plants.kept_plant.cache_info().currsize == plants.MOST_KEPT_PLANTS
