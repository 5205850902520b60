import dataclasses
import math

import numpy as np
import pytest

from laticauda.robot import Module, Section

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
        ({"center": 0.1}, r"`center` must lie inside the module, between -0\.09 and 0\.09 m, got 0\.1\."),
    ],
)
def test_a_module_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        module(**changes)


def test_a_section_refuses_what_is_no_ellipse():
    with pytest.raises(ValueError, match=r"`half_width` must be > 0 m, got 0\."):
        Section(half_height=0.05, half_width=0)
