import math

import numpy as np
import pytest

from laticauda.robot import (
    RobotNotFound,
    current_names,
    ground_names,
    load_current,
    load_ground,
    load_robot,
    load_water,
    robot_names,
    water_names,
)


def test_the_presets_are_there():
    assert robot_names() == (
        "amphibot",
        "chain",
        "mamba",
        "mamba-fin",
        "mamba-modules",
        "mamba-modules-fin",
        "mamba-thruster",
        "tendon-fish",
    )
    assert water_names() == ("paper-eel", "paper-lateral", "paper-vortex", "published-2015")
    assert ground_names() == ("coulomb", "viscous")
    assert current_names() == (
        "shear",
        "street",
        "swell",
        "tide",
        "turbulence",
        "vortex",
        "wake",
        "wind-sea",
    )


@pytest.mark.parametrize("name", robot_names())
def test_every_robot_bears_its_files_name_and_says_what_it_is(name):
    robot = load_robot(name)
    assert robot.name == name
    assert robot.description


@pytest.mark.parametrize("name", current_names())
def test_every_current_is_one_in_which_a_robot_can_swim(name):
    x, y, t = np.meshgrid(
        np.linspace(-2.0, 2.0, 9), np.linspace(-1.0, 1.0, 5), np.linspace(0.0, 20.0, 11)
    )
    velocity = load_current(name).velocity(np.stack((x, y, 0.0 * x), axis=-1), t)
    assert 0.02 < np.sqrt(np.mean(np.sum(velocity**2, axis=-1))) < 0.3
    assert np.ptp(velocity, axis=(0, 1, 2)).max() > 0.01


@pytest.mark.parametrize("name", ground_names())
def test_every_ground_bears_its_files_name_and_grips_better_across(name):
    ground = load_ground(name)
    assert ground.name == name
    assert ground.normal > ground.tangential


def test_mamba_has_the_published_numbers():
    mamba = load_robot("mamba")
    assert (mamba.n_links, mamba.n_joints) == (9, 8)
    assert mamba.length == pytest.approx(1.62)
    assert mamba.mass == pytest.approx(7.2)
    section = mamba.modules[0].section
    assert (section.half_height, section.half_width) == (0.055, 0.05)
    assert {joint.axis for joint in mamba.joints} == {"yaw"}
    assert mamba.idle_power == pytest.approx(35.0 * 1.18, abs=0.01)


def test_the_fin_is_31_percent_of_mamba_and_29_percent_of_the_physical_robot():
    for name, share in (("mamba-fin", 0.31), ("mamba-modules-fin", 0.29)):
        robot = load_robot(name)
        assert robot.caudal_fin.length / robot.length == pytest.approx(share, abs=0.005)
        plain = load_robot(name.removesuffix("-fin"))
        assert (robot.modules, robot.joints) == (plain.modules, plain.joints)


def test_the_physical_robot_has_19_bodies_of_9_cm_that_just_float():
    robot = load_robot("mamba-modules")
    assert (robot.n_links, robot.n_joints) == (19, 18)
    assert robot.length == pytest.approx(1.71)
    assert [joint.axis for joint in robot.joints] == ["yaw", "pitch"] * 9
    for module in robot.modules:
        assert 0.98 < module.mass / (1000.0 * module.volume) < 1.0


def test_its_planar_reduction_has_one_short_link_at_the_tail_and_nine_long_ones():
    flat = load_robot("mamba-modules").planar()
    assert [module.length for module in flat.modules] == pytest.approx([0.09] + [0.18] * 9)
    assert [module.mass for module in flat.modules] == pytest.approx([0.77] + [1.54] * 9)
    assert flat.n_joints == 9


def test_the_thruster_sits_at_the_tail_end_and_pushes_forward():
    (thruster,) = load_robot("mamba-thruster").thrusters
    assert (thruster.link, thruster.angle) == (0, 0.0)
    assert thruster.x == -load_robot("mamba-thruster").modules[0].half_length
    assert thruster.thrust > 0.0


def test_the_thrust_is_the_drag_of_the_straight_robot_at_0_11_metres_per_second():
    robot, water, speed = load_robot("mamba-thruster"), load_water("paper-lateral"), 0.11
    section = robot.modules[0].section
    perimeter = math.pi * (section.half_height + section.half_width)
    drag = (
        0.5
        * water.density
        * water.tangential_friction
        * 0.5
        * perimeter
        * robot.length
        * speed
        * (1.0 + speed)
    )
    assert drag == pytest.approx(robot.thrusters[0].thrust, rel=0.03)


def test_the_chain_is_neutrally_buoyant_and_of_any_length():
    chain = load_robot("chain", n_links=12)
    assert (chain.n_links, chain.n_joints) == (12, 11)
    assert chain.mass == pytest.approx(1000.0 * chain.volume, rel=1e-3)


@pytest.mark.parametrize(
    ("load", "name", "message"),
    [
        (
            load_robot,
            "manba",
            r"there is no robot preset named `manba`; did you mean `mamba`\? \(robots: amphibot, chain, mamba,",
        ),
        (load_robot, "", r"there is no robot preset named ``"),
        (load_robot, "manba.toml", r"manba\.toml: no such file; did you mean `mamba`\?"),
        (load_robot, "no/such/robot", r"no/such/robot: no such file"),
        (load_water, "paper", r"there is no water preset named `paper`.*paper-lateral"),
        (
            load_ground,
            "mud",
            r"there is no ground preset named `mud` \(grounds: coulomb, viscous; a path ends in \.toml\)",
        ),
    ],
)
def test_what_is_not_there_is_refused_with_what_is(load, name, message):
    with pytest.raises(RobotNotFound, match=message):
        load(name)
    with pytest.raises(FileNotFoundError):
        load(name)


def test_only_a_name_or_a_path_can_be_loaded():
    with pytest.raises(
        ValueError, match=r"`name_or_path` must be a preset's name or a path, got 3\."
    ):
        load_robot(3)
