import dataclasses
import math
import pydoc
import re
from dataclasses import fields

import pytest

from laticauda.robot import Ground, Water, check_fits, load_ground, load_robot, load_water
from laticauda.water.fluid.laws import CoulombFriction, PolynomialDrag, ViscousFriction


def water(**changes):
    return Water(**{"tangential_friction": 0.3, "normal_drag": 1.75, "added_mass": 1.5, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": ""}, r"`name` must be a text on one line that is not blank, got ''"),
        ({"density": 0.0}, r"`density` must be > 0 kg/m\^3"),
        ({"tangential_friction": -0.3}, r"`tangential_friction` must be >= 0, got -0\.3"),
        ({"normal_drag": math.nan}, r"`normal_drag` must be a finite number, got nan"),
        ({"added_mass": "1.5"}, r"`added_mass` must be a number, got '1\.5'"),
        ({"drag": 1}, r"`drag` must be of class DragLaw, got int"),
        ({"friction_taper": 1.1}, r"`friction_taper` must be between -1 and 1, got 1\.1"),
        (
            {"added_mass_form": "kirchoff"},
            r"`added_mass_form` must be one of .*did you mean `kirchhoff`\?",
        ),
        ({"rotational": "none"}, r"`rotational` must be one of `paper`, `strip`, got 'none'"),
        ({"trailing_edge": "sharp"}, r"`trailing_edge` must be one of `none`, `elongated`"),
        (
            {"trailing_edge": "elongated"},
            r"`trailing_edge` must be `none` unless `added_mass_form` is `kirchhoff`",
        ),
        (
            {"current": (0.1,)},
            r"`current` must be two or three numbers in m/s or a Flow, got 1 of them",
        ),
        ({"current": (0.1, math.inf)}, r"`current\[1\]` must be a finite number in m/s"),
        ({"depth": 0.0}, r"`depth` must be > 0 m"),
    ],
)
def test_water_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        water(**changes)


def test_the_trailing_edge_goes_with_kirchhoff():
    assert (
        water(added_mass_form="kirchhoff", trailing_edge="elongated").trailing_edge == "elongated"
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"friction": "slippery"}, r"`friction` must be of class DragLaw, got str"),
        ({"tangential": -1.0}, r"`tangential` must be >= 0, got -1\.0"),
        ({"friction": CoulombFriction(), "normal": -1.0}, r"`normal` must be >= 0, got -1\.0"),
        ({"gravity": -9.81}, r"`gravity` must be >= 0 m/s\^2"),
    ],
)
def test_ground_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        Ground(**{"friction": ViscousFriction(), "tangential": 0.5, "normal": 3.0, **changes})


def test_a_robot_must_be_below_the_surface():
    mamba = load_robot("mamba")
    check_fits(mamba, water(depth=0.0551))
    check_fits(mamba, water())
    check_fits(mamba, load_ground("viscous"))
    with pytest.raises(
        ValueError,
        match=r"`depth` must be > 0\.055 m, the half height of `modules\[.\]` of robot `mamba`",
    ):
        check_fits(mamba, water(depth=0.055))


def test_so_must_its_fin():
    finned = load_robot("mamba-fin")
    tall = dataclasses.replace(
        finned, caudal_fin=dataclasses.replace(finned.caudal_fin, height=0.2)
    )
    with pytest.raises(
        ValueError, match=r"`depth` must be > 0\.1 m, the half height of `caudal_fin`"
    ):
        check_fits(tall, water(depth=0.09))


@pytest.mark.parametrize(
    ("name", "coefficients"),
    [
        ("paper-lateral", (0.3, 1.75, 1.5)),
        ("paper-eel", (0.17, 1.75, 1.5)),
        ("paper-vortex", (0.1, 0.3, 1.27)),
        ("published-2015", (0.03, 1.0, 1.0)),
    ],
)
def test_the_waters_have_the_published_coefficients(name, coefficients):
    found = load_water(name)
    assert (found.tangential_friction, found.normal_drag, found.added_mass) == coefficients
    assert found.name == name
    assert found.drag == PolynomialDrag(linear=name != "paper-vortex")


def test_help_shows_every_field_of_water_with_its_unit():
    shown = pydoc.render_doc(Water, renderer=pydoc.plaintext)
    for field in fields(Water):
        assert re.search(rf"^ \|      {field.name}: [\w`]", shown, re.MULTILINE), field.name
    assert "density: rho [kg/m^3], > 0; default 1000.0." in shown
