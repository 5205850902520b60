import dataclasses

import pytest

from laticauda.cli import flags
from laticauda.cli.groups import WaterChanges
from laticauda.fluid.laws import PolynomialDrag
from laticauda.quantities import texts_of
from laticauda.robot import Ground, Water, load_ground, load_water


def test_every_field_of_water_but_its_name_is_an_option():
    wanted = {field.name for field in dataclasses.fields(Water)} - {"name", "drag"}
    wanted |= {"linear_drag", "quadratic_drag", "reference_speed", "sway_friction"}  # of the law
    offered = {field.name for field in dataclasses.fields(WaterChanges)}
    assert offered == wanted | {"no_linear_drag", "no_quadratic_drag"}


def test_the_help_of_an_option_is_what_its_field_is(run):
    text = " ".join(run("swim --help").out.replace("│", " ").split())
    for name, said in texts_of(Water).items():
        assert name in ("name", "drag") or " ".join(said.split()) in text


def test_water_without_changes_stays_the_same():
    water = load_water("paper-eel")
    assert flags.changed(water, WaterChanges()) is water


def test_changes_replace_fields_and_the_name_says_so():
    water = load_water("paper-eel")
    changed = flags.changed(water, WaterChanges(normal_drag=0.0, no_linear_drag=True, current=(0.1, 0.0)))
    assert changed == dataclasses.replace(
        water,
        normal_drag=0.0,
        drag=PolynomialDrag(linear=False),
        current=(0.1, 0.0),
        name="paper-eel with normal_drag 0, linear_drag off, current (0.1, 0)",
    )


def test_a_part_of_the_drag_can_be_switched_on_again():
    water = load_water("paper-vortex")
    assert flags.changed(water, WaterChanges(linear_drag=True)).drag.linear


def test_a_contradiction_is_refused():
    with pytest.raises(ValueError, match="`linear_drag` and `no_linear_drag` must not be given together"):
        flags.changed(load_water("paper-eel"), WaterChanges(linear_drag=True, no_linear_drag=True))


def test_options_can_be_made_of_other_dataclasses_too():
    options = flags.changes(Ground, omit=("name", "friction"), otherwise="the ground's")
    assert flags.changed(load_ground("viscous"), options(normal=4.0)).normal == 4.0
