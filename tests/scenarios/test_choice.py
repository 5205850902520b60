from dataclasses import replace

import pytest

import laticauda as lc
from laticauda.actuation.laws import Servo
from laticauda.scenarios import Choice, named_after

LATERAL = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
EEL = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)


def test_without_names_it_is_mamba_in_the_papers_water_for_the_gait():
    chosen = Choice().resolved(EEL)
    assert chosen.robot == lc.load_robot("mamba")
    assert chosen.environment == lc.load_water("paper-eel")
    assert chosen.origin == "the paper's for eel-like motion"
    assert Choice().resolved(LATERAL).environment == lc.load_water("paper-lateral")


def test_names_become_values():
    chosen = Choice(robot="chain", n_links=5, ground="viscous", model="spatial", joints="servo").resolved(LATERAL)
    assert chosen.robot.n_links == 5
    assert chosen.environment == lc.load_ground("viscous")
    assert chosen.model.joints == Servo()
    assert chosen.origin == "as asked for"


def test_parameters_say_robot_water_and_joint_law_unless_a_law_is_asked_for():
    found = lc.load_parameters("mamba-speed-limited")
    chosen = Choice(parameters="mamba-speed-limited").resolved(EEL)
    assert chosen.environment == found.water("eel_like")
    assert chosen.robot == found.robot(lc.load_robot("mamba"), "eel_like")
    assert chosen.model.joints == Choice(joints=found.joints).resolved(EEL).model.joints


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ({"parameters": "paper", "water": "paper-eel"}, "`parameters` must not be given with `water`: both say what"),
        ({"ground": "viscous", "water": "paper-eel"}, "`water` must not be given with `ground`: it belongs to water"),
        ({"ground": "viscous", "parameters": "paper"}, "`parameters` must not be given with `ground`"),
        ({"joints": "servos"}, "`joints` must be one of .*, got 'servos'; did you mean `servo`"),
        ({"n_links": 0}, "`n_links` must be a whole number >= 1, got 0"),
        ({"model": "mujoco"}, "`model` must be one of `planar`, `spatial`, got 'mujoco'"),
    ],
)
def test_names_that_do_not_go_together_are_refused(names, message):
    with pytest.raises(ValueError, match=message):
        Choice(**names).resolved(LATERAL)


def test_a_changed_water_says_in_what_it_differs():
    before = lc.load_water("paper-eel")
    changed = replace(before, normal_drag=0.0, current=(0.1, 0.0), depth=0.5)
    assert named_after(changed, before).name == "paper-eel with normal_drag 0, current (0.1, 0), depth 0.5"
    assert named_after(before, before) is before
