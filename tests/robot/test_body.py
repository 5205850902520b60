import dataclasses
import math

import numpy as np
import pytest

from laticauda.robot import Actuator, Joint, Module, Section


def test_the_servo_defaults_are_the_published_figures_rounded():
    servo = Actuator()
    assert servo.stall_torque == pytest.approx(30.0 * 0.0980665, rel=0.02)  # 30 kg cm
    assert servo.no_load_speed == pytest.approx(math.radians(60.0) / 0.14, rel=0.005)
    assert servo.stall_current == pytest.approx(7.4 / 1.6, rel=0.01)
    assert servo.servo_gain * math.radians(10.0) == pytest.approx(1.0, rel=0.01)


def test_the_gear_of_the_default_servo_neither_makes_energy_nor_wastes_most_of_it():
    servo = Actuator()
    assert (
        0.4 < servo.stall_torque * servo.no_load_speed / (servo.voltage * servo.stall_current) < 1.0
    )


def test_the_pd_gains_are_those_of_the_published_simulations():
    assert (Actuator().proportional_gain, Actuator().derivative_gain) == (20.0, 5.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"axis": "roll"}, r"`axis` must be one of `yaw`, `pitch`, got 'roll'"),
        ({"limit": 0.0}, r"`limit` must be > 0 rad"),
        ({"limit": 4.0}, r"`limit` must be between 0 and 3\.14159 rad, got 4\.0"),
        ({"stiffness": -1.0}, r"`stiffness` must be >= 0 N m/rad"),
        ({"damping": math.inf}, r"`damping` must be a finite number in N m s/rad, got inf"),
        ({"actuator": 3}, r"`actuator` must be of class Actuator, got int"),
    ],
)
def test_a_joint_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        Joint(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"proportional_gain": -1.0}, r"`proportional_gain` must be >= 0 N m/rad"),
        ({"stall_torque": 0.0}, r"`stall_torque` must be > 0 N m, got 0\.0"),
        ({"no_load_speed": -7.5}, r"`no_load_speed` must be > 0 rad/s"),
        ({"servo_gain": math.nan}, r"`servo_gain` must be a finite number in 1/rad"),
        ({"friction_torque": -0.1}, r"`friction_torque` must be >= 0 N m"),
        ({"voltage": True}, r"`voltage` must be a number in V, got True"),
        ({"stall_current": 0.0}, r"`stall_current` must be > 0 A"),
        ({"idle_current": -1.0}, r"`idle_current` must be >= 0 A"),
    ],
)
def test_an_actuator_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        Actuator(**changes)


SECTION = Section(half_height=0.055, half_width=0.05)


def module(**changes):
    return Module(**{"length": 0.18, "mass": 0.8, "section": SECTION, **changes})


def test_a_uniform_link_has_the_papers_moment_of_inertia():
    assert module().moment_of_inertia == pytest.approx(0.8 * 0.09**2 / 3.0)
    assert module().moment_of_inertia == pytest.approx(0.8 * 0.18**2 / 12.0)
    assert module(inertia=0.01).moment_of_inertia == 0.01


def test_a_module_of_mamba_displaces_0_7775_kg():
    assert 1000.0 * module(length=0.09).volume == pytest.approx(0.7775, abs=5e-5)


def test_whole_numbers_and_numbers_of_numpy_become_floats():
    one = module(length=1, mass=np.float32(0.5), normal_drag=2)
    assert all(type(value) is float for value in (one.length, one.mass, one.normal_drag))
    assert one == module(length=1.0, mass=0.5, normal_drag=2.0)
    assert hash(one) == hash(module(length=1.0, mass=0.5, normal_drag=2.0))


def test_a_module_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        module().mass = 1.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"length": 0.0}, r"`length` must be > 0 m, got 0\.0\."),
        ({"length": None}, r"`length` must be a number in m, got None\."),
        ({"mass": -1.0}, r"`mass` must be > 0 kg, got -1\.0\."),
        ({"mass": "0.8"}, r"`mass` must be a number in kg, got '0\.8'\."),
        ({"mass": math.nan}, r"`mass` must be a finite number in kg, got nan\."),
        ({"section": 0.05}, r"`section` must be of class Section, got float\."),
        ({"normal_drag": -0.1}, r"`normal_drag` must be >= 0, got -0\.1\."),
        ({"added_mass": math.inf}, r"`added_mass` must be a finite number, got inf\."),
        ({"inertia": 0.0}, r"`inertia` must be > 0 kg m\^2, got 0\.0\."),
        (
            {"center": 0.1},
            r"`center` must lie inside the module, between -0\.09 and 0\.09 m, got 0\.1\.",
        ),
    ],
)
def test_a_module_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        module(**changes)


def test_a_section_refuses_what_is_no_ellipse():
    with pytest.raises(ValueError, match=r"`half_width` must be > 0 m, got 0\."):
        Section(half_height=0.05, half_width=0)
