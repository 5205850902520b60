"""Files that laticauda 0.1.0 wrote mean the same today."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

import laticauda as lc
from laticauda.robot import (
    Ground,
    PectoralFin,
    Robot,
    Tether,
    Thruster,
    Water,
    from_toml,
    load_ground,
    load_parameters,
    to_toml,
)
from laticauda.values.errors import RobotFileError
from laticauda.water.fluid.laws import CoulombFriction, PolynomialDrag, ViscousFriction

FOLDER = Path(__file__).parent.parent / "data" / "files-0.1.0"
FILES = [path for path in sorted(FOLDER.glob("*.toml")) if path.stem != "parameters"]


def test_the_numbers_of_a_waters_drag_are_those_of_its_law():
    water = from_toml(FOLDER / "water.toml", Water)
    assert water.drag == PolynomialDrag(
        reference_speed=0.7, linear=False, quadratic=True, sway_friction=0.4
    )
    assert (water.current, water.depth, water.added_mass_form) == ((0.1, -0.05), 0.3, "kirchhoff")


def test_a_friction_is_a_law():
    dry, viscous = (
        load_ground(FOLDER / "ground-coulomb.toml"),
        load_ground(FOLDER / "ground-viscous.toml"),
    )
    assert dry == Ground(
        name="coulomb",
        friction=CoulombFriction(regularization_speed=1e-3),
        tangential=0.1,
        normal=0.5,
    )
    assert viscous == Ground(name="viscous", friction=ViscousFriction(), tangential=0.5, normal=3.0)


def test_a_robot_is_the_same():
    mamba = lc.load_robot("mamba-fin")
    assert from_toml(FOLDER / "robot.toml", Robot) == replace(
        mamba,
        name="older",
        joints=tuple(
            replace(joint, axis="pitch" if i % 2 else "yaw", limit=1.2345)
            for i, joint in enumerate(mamba.joints)
        ),
        thrusters=(Thruster(link=1, thrust=2.0, angle=math.radians(30.0)),),
        pectoral_fins=(PectoralFin(link=3, area=0.01, lift_slope=3.0, stall_angle=0.3),),
        tether=Tether(drag=0.2),
        active_power=40.0,
    )


def test_parameters_are_the_same_also_where_a_gait_differs():
    found, drag = load_parameters(FOLDER / "parameters.toml"), PolynomialDrag(reference_speed=0.13)
    numbers = {"tangential_friction": 0.136, "normal_drag": 1.75, "added_mass": 1.5}
    assert found.every_gait == Water(name="older", drag=drag, **numbers)
    eel = found.water("eel_like")
    assert eel.drag == replace(drag, sway_friction=0.9)
    assert replace(eel, drag=drag, name="older") == found.every_gait
    assert found.own_changes == {"eel_like": {"caudal_fin": {"normal_drag": 1.1}}}


def test_written_again_they_mean_the_same():
    for path in FILES:
        thing = from_toml(path)
        assert from_toml(to_toml(thing)) == thing
        assert "format = 2" in to_toml(thing)


def test_a_file_of_the_future_is_refused_by_its_format():
    text = to_toml(from_toml(FOLDER / "water.toml")).replace("format = 2", "format = 9")
    with pytest.raises(
        RobotFileError, match="key `format`: must be 1 to 2, which this version of laticauda reads"
    ):
        from_toml(text)
