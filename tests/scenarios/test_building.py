"""Scenarios from a robot, a gait and a few words, or from names."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
import tomli_w

import laticauda as lc
from laticauda.motion.joints.laws import PD, Servo
from laticauda.robot import textbook_of
from laticauda.scenarios import Choice, default_water, named_after

GAIT = EEL = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
LATERAL = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)


def test_words_mean_what_the_values_mean():
    words = lc.build_scenario(
        "mamba", GAIT, 5.0, environment="paper-lateral", joints="servo", dt=0.01
    )
    values = lc.Scenario(
        robot=lc.load_robot("mamba"),
        motion=GAIT,
        environment=lc.load_water("paper-lateral"),
        model=lc.Planar(joints=Servo(), dt=0.01),
        duration=5.0,
    )
    assert words == values


def test_the_water_is_the_paper_s_for_the_gait():
    assert lc.build_scenario("mamba", GAIT).environment == lc.load_water("paper-eel")
    still = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    assert lc.build_scenario("mamba", still).environment == lc.load_water("paper-lateral")
    assert lc.build_scenario("mamba", GAIT, environment="viscous").environment == lc.load_ground(
        "viscous"
    )


def test_a_scenario_swims_as_its_robot_and_gait_do():
    chosen = lc.build_scenario("mamba", GAIT, 4.0, joints="pd")
    assert chosen.model == lc.Planar(joints=PD())
    one, two = lc.swim(chosen), lc.swim(chosen.robot, GAIT, 4.0, joints="pd")
    np.testing.assert_array_equal(one.center_of_mass, two.center_of_mass)
    many = lc.swim_many([chosen, replace(chosen, start=lc.Start(heading=1.0))])
    np.testing.assert_allclose(many.forward_velocity, one.forward_velocity, rtol=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"root": "free"}, "`root` must be left out unless `model` is `spatial`, got 'free'."),
        ({"model": "flat"}, "`model` must be one of `planar`, `spatial`, got 'flat'"),
        (
            {"joints": "servos"},
            "`joints` must be one of `prescribed`, `pd`, `servo`, `ekeberg`, `hill`, `speed-servo`, got 'servos'",
        ),
        ({"dt": 0.0}, "`dt` must be between 1e-07 and 1000 s, got 0.0."),
        ({"duration": -1.0}, "`duration` must be > 0 s, got -1.0."),
        ({"motion": 3}, "`gait` must be of class Gait or Controller, got int"),
    ],
)
def test_what_does_not_go_is_refused(changes, message):
    with pytest.raises(ValueError) as refused:
        lc.build_scenario(**{"robot": "mamba", "motion": GAIT, **changes})
    assert str(refused.value).startswith(message)


def test_what_nobody_knows_is_refused_as_python_does():
    with pytest.raises(TypeError, match="joint_law"):
        lc.build_scenario("mamba", GAIT, joint_law="pd")


def test_a_batch_is_planar_and_of_one_length():
    short = lc.build_scenario("mamba", GAIT, 4.0)
    with pytest.raises(ValueError, match="`duration` must be the same"):
        lc.swim_many([short, replace(short, duration=5.0)])
    with pytest.raises(ValueError, match=r"`scenarios\[1\].model` must be of class Planar"):
        lc.swim_many([short, replace(short, model=lc.Spatial())])


def test_a_model_that_is_none_is_refused():
    with pytest.raises(ValueError, match="`model` must be of class Planar or Spatial, got list"):
        lc.swim("mamba", lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7), model=[3])


def test_without_names_it_is_mamba_in_the_papers_water_for_the_gait():
    chosen = Choice().resolved(EEL)
    assert chosen.robot == lc.load_robot("mamba")
    assert chosen.environment == lc.load_water("paper-eel")
    assert chosen.origin == "the paper's for eel-like motion"
    assert Choice().resolved(LATERAL).environment == lc.load_water("paper-lateral")


def test_names_become_values():
    chosen = Choice(
        robot="chain", n_links=5, ground="viscous", model="spatial", joints="servo"
    ).resolved(LATERAL)
    assert chosen.robot.n_links == 5
    assert chosen.environment == lc.load_ground("viscous")
    assert chosen.model.joints == Servo()
    assert chosen.origin == "as requested"


def test_parameters_say_robot_water_and_joint_law_unless_a_law_is_asked_for():
    found = lc.load_parameters("mamba-textbook")
    chosen = Choice(parameters="mamba-textbook").resolved(EEL)
    assert chosen.environment == found.water("eel_like")
    assert chosen.robot == found.robot(lc.load_robot("mamba"), "eel_like")
    assert chosen.model.joints == found.joints


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (
            {"parameters": "paper", "water": "paper-eel"},
            "`parameters` must not be given with `water`: both define",
        ),
        (
            {"ground": "viscous", "water": "paper-eel"},
            "`water` must not be given with `ground`: it applies to water",
        ),
        (
            {"ground": "viscous", "parameters": "paper"},
            "`parameters` must not be given with `ground`",
        ),
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
    assert (
        named_after(changed, before).name
        == "paper-eel with normal_drag 0, current (0.1, 0), depth 0.5"
    )
    assert named_after(before, before) is before


def named(robot, name):
    return replace(lc.load_robot(robot), name=name)


def test_a_robot_that_is_not_mamba_takes_the_textbooks_water():
    robot = lc.load_robot("chain")
    water = textbook_of(robot)
    assert lc.build_scenario("chain", LATERAL).environment is water
    assert lc.build_scenario("mamba", LATERAL, environment="textbook").environment == textbook_of(
        lc.load_robot("mamba")
    )
    assert lc.build_scenario(named("mamba-fin", "mine"), GAIT).environment.name == "textbook"
    assert Choice(robot="chain", n_links=5).resolved(EEL).environment == textbook_of(
        robot.with_links(5)
    )
    chosen = Choice(robot="mamba", water="textbook").resolved(EEL)
    assert (chosen.environment.name, chosen.origin[:11]) == ("textbook", "from tables")
    many = lc.swim_many([lc.load_robot("mamba"), robot], LATERAL, 4.0)
    alone = [lc.swim(one, LATERAL, 4.0).forward_velocity for one in ("mamba", "chain")]
    np.testing.assert_allclose(many.forward_velocity, alone, rtol=1e-9)


@pytest.mark.parametrize("name", ["mamba", "mamba-fin", "mamba-modules", "mamba-modules-fin"])
def test_mamba_keeps_the_papers_water_of_its_gait(name):
    assert default_water(lc.load_robot(name), EEL) == lc.load_water("paper-eel")
    assert default_water(lc.load_robot(name), LATERAL) == lc.load_water("paper-lateral")
    assert default_water(lc.load_robot(name)) == lc.load_water("paper-lateral")


def test_a_scenario_file_with_a_robot_of_its_own_has_the_textbooks_water(tmp_path):
    robot = named("chain", "mine")
    lc.save_scenario(lc.build_scenario(robot, GAIT), tmp_path / "whole.toml")
    table = tomllib.loads((tmp_path / "whole.toml").read_text())
    del table["environment"]
    (tmp_path / "short.toml").write_text(tomli_w.dumps(table))
    assert lc.load_scenario(tmp_path / "short.toml") == lc.load_scenario(tmp_path / "whole.toml")


def test_a_stored_trial_keeps_the_water_that_it_swam_in(tmp_path):
    before = lc.swim("chain", GAIT, 2.0, environment="paper-eel")
    before.save(tmp_path / "before.nc")
    assert lc.load_trial(tmp_path / "before.nc").scenario.environment == lc.load_water("paper-eel")
    of_tables = lc.swim("chain", GAIT, 2.0)
    of_tables.save(tmp_path / "tables.nc")
    assert lc.load_trial(tmp_path / "tables.nc").scenario == of_tables.scenario


@pytest.mark.parametrize("gait", [LATERAL, EEL])
def test_parameters_give_a_scenario_its_water_its_robot_and_its_joint_law(gait):
    found = lc.load_parameters("mamba-identified")
    for parameters in (found, "mamba-identified"):
        scenario = lc.build_scenario("mamba-fin", gait, parameters=parameters)
        assert scenario.environment == found.water(gait.kind)
        assert scenario.robot == found.robot(lc.load_robot("mamba-fin"), gait.kind)
        assert scenario.model.joints == found.joints
    by_hand = lc.build_scenario("mamba-fin", gait, parameters=found, joints="prescribed")
    assert by_hand.model.joints == lc.Prescribed()


def test_parameters_and_an_environment_are_not_given_together():
    with pytest.raises(ValueError, match="`parameters` must not be given with `environment`: both"):
        lc.build_scenario("mamba", LATERAL, parameters="paper", environment="paper-eel")
    with pytest.raises(ValueError, match="`parameters` must be of class Parameters, got float"):
        lc.build_scenario("mamba", LATERAL, parameters=3.0)  # pyright: ignore
