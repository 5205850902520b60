import dataclasses

import pytest
from hypothesis import given
from robot.strategies import grounds, robots, waters

from laticauda.robot import (
    Joint,
    PectoralFin,
    Tether,
    describe,
    load_robot,
    load_water,
    summarize_robot,
)


def test_the_main_facts_are_plain_data():
    facts = summarize_robot(load_robot("mamba-modules-fin"))
    assert (facts["name"], facts["n_links"], facts["n_joints"]) == ("mamba-modules-fin", 19, 18)
    assert facts["caudal_fin"] is True


@pytest.mark.parametrize(
    ("name", "fact"),
    [
        ("mamba", "length          1.62 m"),
        ("mamba", "all yaw"),
        ("mamba-modules", "alternating yaw and pitch, yaw at the tail"),
        ("mamba-modules", "modules 0-18"),
        ("mamba-fin", "opening_length 0.12 m"),
        ("mamba-thruster", "thruster on link 0  x -0.09 m, thrust 5 N"),
    ],
)
def test_a_preset_is_described(name, fact):
    assert fact in describe(load_robot(name))


def test_a_fin_without_an_opening_is_not_called_open():
    robot = load_robot("mamba-fin")
    whole = dataclasses.replace(
        robot, caudal_fin=dataclasses.replace(robot.caudal_fin, opening_length=0.0)
    )
    assert "opening open" in describe(robot)
    assert "opening" not in describe(whole)


def test_what_differs_from_the_plain_robot_is_told():
    plain = load_robot("mamba", n_links=3)
    special = dataclasses.replace(
        plain,
        modules=(
            *plain.modules[:2],
            dataclasses.replace(plain.modules[2], center=0.01, inertia=0.1, normal_drag=2.0),
        ),
        joints=(Joint(stiffness=1.0, damping=2.0), Joint()),
        pectoral_fins=(PectoralFin(link=2, area=0.01, lift_slope=3.0, stall_angle=0.4),),
        tether=Tether(drag=0.5),
    )
    text = describe(special)
    for fact in (
        "modules 0-1",
        "modules 2 ",
        "normal_drag 2, center 0.01 m, inertia 0.1 kg m^2",
        "limit 90 deg, stiffness 1 N m/rad, damping 2 N m s/rad",
        "pectoral fin on link 2  area 0.01 m^2, lift_slope 3 1/rad, stall_angle 22.9183 deg",
        "drag 0.5 kg/m",
    ):
        assert fact in text


def test_a_water_is_described():
    text = describe(load_water("paper-vortex"))
    assert "quadratic, equal at" not in text
    assert "quadratic only" in text


@given(robots() | waters() | grounds)
def test_anything_can_be_described_in_aligned_lines(thing):
    assert thing.name in describe(thing)
