"""Water from tables: what rulers say of a robot, and what they cannot."""

import math
from dataclasses import replace
from operator import attrgetter

import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

import laticauda as lc
from laticauda.robot import Module, Robot, Section, Tether, tether_drag, textbook_water
from laticauda.robot.textbook import VISCOSITY, skin_friction
from laticauda.trials.metrics import towing_drag

MAMBA = lc.load_robot("mamba")
SIZES = st.floats(0.01, 0.3)


def chain(a=0.0275, b=0.0185, length=0.0965, n=7, shape="ellipse", **changes):
    section = Section(half_height=a, half_width=b, shape=shape)
    module = Module(length=length, mass=1000.0 * section.area * length, section=section)
    return Robot(
        **{
            "name": "chain-of-ours",
            "modules": (module,) * n,
            "joints": MAMBA.joints[:1] * (n - 1),
            **changes,
        }
    )


def friction(robot, **how):
    return textbook_water(robot, **how).water.tangential_friction


def test_the_friction_of_two_robots_is_what_was_worked_out_by_hand():
    assert round(friction(chain(), speed=0.6), 3) == 0.027  # AmphiBot's lengths
    assert round(friction(MAMBA, speed=0.15), 3) == 0.029


@given(a=SIZES, b=SIZES, n=st.integers(1, 12), shape=st.sampled_from(["ellipse", "box"]))
@settings(max_examples=60, deadline=None)
def test_every_number_lies_in_its_interval_and_has_a_source(a, b, n, shape):
    book = textbook_water(chain(a, b, n=n, shape=shape))
    for name, (low, high) in book.intervals.items():
        assert low < attrgetter(name.removeprefix("water."))(book.water) < high
    assert book.sources.keys() == book.intervals.keys()


@given(scale=st.floats(0.2, 5.0), a=SIZES, b=SIZES)
@settings(max_examples=60, deadline=None)
def test_a_model_at_the_same_reynolds_number_has_the_same_coefficients(scale, a, b):
    one = textbook_water(chain(a, b), speed=0.5).water
    other = textbook_water(chain(scale * a, scale * b, scale * 0.0965), speed=0.5 / scale).water
    for name in ("tangential_friction", "normal_drag", "added_mass"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-9)


@pytest.mark.parametrize("name", ["mamba", "mamba-fin", "chain"])
def test_towed_straight_a_robot_has_the_drag_of_its_areas(name):
    robot, speed = lc.load_robot(name), 0.4
    sections = [module.section for module in robot.modules]
    skin = sum(module.section.perimeter * module.length for module in robot.modules)
    if robot.caudal_fin:
        skin += (
            2.0
            * robot.caudal_fin.height
            * (robot.caudal_fin.length - robot.caudal_fin.opening_length)
        )
    area = (
        skin * skin_friction(speed, robot.length) + (0.4 + 0.01 * robot.n_joints) * sections[0].area
    )
    water = textbook_water(robot, speed=speed).water
    assert towing_drag(robot, water, speed) == pytest.approx(500.0 * area * speed**2, rel=1e-12)


def test_drag_grows_with_gaps_wrinkles_and_bluntness():
    robot = chain()
    smooth, jointed, skinned = (
        friction(robot, surface=one) for one in ("smooth", "jointed", "skinned")
    )
    assert smooth < jointed < skinned
    faired, rounded, blunt = (
        friction(replace(robot, nose=one, tail=one)) for one in ("faired", "round", "blunt")
    )
    assert faired < rounded < blunt
    end = (
        math.pi * 0.0275 * 0.0185 / (math.pi * 0.023 * robot.length)
    )  # of its section, over what C_f refers to
    bullet = friction(replace(robot, nose="faired", tail="blunt"))
    assert (bullet - faired) / end + 0.05 == pytest.approx(0.295, rel=0.1)  # of a bullet
    _, high = textbook_water(robot, surface="skinned").intervals["water.tangential_friction"]
    assert high == pytest.approx(10.0 * skinned)


def test_the_skin_friction_is_that_of_the_line():
    assert skin_friction(1.0, 1e7 * VISCOSITY) == pytest.approx(0.003)  # Re 1e7: .075 / 25
    assert (
        friction(chain(), speed=0.3) > friction(chain(), speed=0.6) > friction(chain(), speed=1.2)
    )


def rectangle(corner):
    """Width over height of a rectangle and its C_A, by its map from the outside of the unit circle.

    dz/dzeta = sqrt(1 - 2 cos(2 corner) / zeta^2 + 1 / zeta^4), and mu = 2 pi (1 - cos(2 corner)) -
    area.
    """
    c = math.cos(2.0 * corner)
    high, _ = quad(lambda t: math.sqrt(max(2.0 * (math.cos(2.0 * t) - c), 0.0)), 0.0, corner)
    wide, _ = quad(
        lambda t: math.sqrt(max(2.0 * (c - math.cos(2.0 * t)), 0.0)), corner, math.pi / 2.0
    )
    return wide / high, (2.0 * math.pi * (1.0 - c) - 4.0 * wide * high) / (math.pi * high**2)


@pytest.mark.parametrize("ratio", [0.02, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0])
def test_the_added_mass_of_a_box_is_that_of_potential_flow(ratio):
    corner = brentq(lambda x: rectangle(x)[0] - ratio, 1e-3, math.pi / 2.0 - 1e-3)
    found = textbook_water(chain(0.05, 0.05 * ratio, shape="box")).water.added_mass
    assert found == pytest.approx(
        rectangle(corner)[1], rel=0.012
    )  # linear between the table's places


def test_sections_have_the_drag_of_circle_plate_and_square():
    drag = {(b, shape): textbook_water(chain(0.05, b, shape=shape)).water.normal_drag
            for b in (1e-6, 0.05) for shape in ("ellipse", "box")}  # fmt: skip
    assert drag[0.05, "ellipse"] == 1.20
    assert drag[0.05, "box"] == 2.0
    assert drag[1e-6, "ellipse"] == pytest.approx(1.98, abs=1e-3)
    assert (
        textbook_water(chain(0.03, 0.06)).water.added_mass == 1.0
    )  # an ellipse's, whatever its axes


def test_a_box_displaces_what_a_box_does():
    box, ellipse = chain(shape="box"), chain()
    assert box.volume == pytest.approx(7 * 0.0965 * 0.055 * 0.037)
    assert ellipse.volume == pytest.approx(box.volume * math.pi / 4.0)


@pytest.mark.parametrize("speed", [0.0, -1.0, math.nan, math.inf])
def test_a_speed_that_is_none_is_refused(speed):
    with pytest.raises(ValueError, match="`speed` must be > 0 m/s"):
        textbook_water(MAMBA, speed=speed)


def test_a_surface_that_nobody_knows_is_refused():
    with pytest.raises(
        ValueError, match="`surface` must be one of `smooth`, `jointed`, `skinned`, got 'wet'"
    ):
        textbook_water(MAMBA, surface="wet")


def test_a_tether_pulls_with_the_friction_of_its_skin():
    drag = tether_drag(4.0, 0.008, 0.2)
    assert drag == pytest.approx(500.0 * skin_friction(0.2, 4.0) * math.pi * 0.008 * 4.0)
    assert replace(MAMBA, tether=Tether(drag=drag)).tether.drag == drag


def test_the_edge_is_that_of_a_finite_span_unless_the_fin_bends_or_the_body_is_stubby():
    def edge(robot):
        return textbook_water(robot).water.trailing_edge

    assert edge(MAMBA) == edge(lc.load_robot("mamba-fin")) == "finite-span"
    fin = replace(lc.load_robot("mamba-fin").caudal_fin, n_hinges=2, flexural_rigidity=2.0)
    assert edge(replace(MAMBA, caudal_fin=fin)) == "elongated"
    assert edge(chain(a=0.3, n=2)) == "elongated"
