"""What the water does to the straight robot that is towed: by the recursion, whose bias force it is."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from printed_equations import Chain, Options, fluid_forces

import laticauda as lc
from laticauda.models.planar.model import PlanarPlant
from laticauda.robot import textbook_water
from laticauda.robot.hydrodynamics import link_coefficients, wake_mass
from laticauda.trials.metrics import towing_drag
from laticauda.water.fluid.laws import TotalSpeedDrag

MAMBA, FINNED = lc.load_robot("mamba"), lc.load_robot("mamba-fin")
BOOK = replace(textbook_water(MAMBA, speed=0.15).water, normal_drag=1.5)
X = replace(
    BOOK,
    tangential_friction=0.271,
    normal_drag=1.75,
    added_mass=1.5,
    drag=TotalSpeedDrag(beta=1.0),
    added_mass_form="relative",
    rotational="paper",
    trailing_edge="none",
)
WATERS = {
    "beta 0": (replace(BOOK, drag=TotalSpeedDrag(beta=0.0)), 1.8, 0.31),
    "textbook's": (BOOK, 3.4, 0.31),
    "beta 1": (replace(BOOK, normal_drag=1.2, drag=TotalSpeedDrag(beta=1.0)), 4.8, 0.31),
    "relative": (X, 6.5, 0.0),
}
SPEEDS, ANGLES = st.floats(0.05, 1.0), st.floats(-1.2, 1.2)


def towed(robot, water, speed, angle=0.0):
    return np.array(PlanarPlant(robot=robot, environment=water).towing_load(speed, angle))


@pytest.mark.parametrize(("water", "side", "moment"), WATERS.values(), ids=WATERS)
def test_the_oblique_tow_of_mamba_is_that_of_the_calculation_by_hand(water, side, moment):
    _, across, yaw = towed(MAMBA, water, 0.4, math.radians(15))
    assert across == pytest.approx(side, abs=0.05)
    assert yaw == pytest.approx(moment, abs=0.005)


@pytest.mark.parametrize("robot", [MAMBA, FINNED], ids=["no fin", "fin"])
def test_a_straight_tow_is_pulled_by_the_towing_drag_and_by_nothing_else(robot):
    along, across, yaw = towed(robot, BOOK, 0.3)
    assert along == pytest.approx(-towing_drag(robot, BOOK, 0.3), rel=1e-9)
    assert (across, yaw) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_a_fin_that_could_bend_is_held_as_a_rigid_one():
    soft = replace(FINNED.caudal_fin, n_hinges=2, flexural_rigidity=2.0)
    water = replace(BOOK, trailing_edge="elongated")
    rigid, bending = (
        towed(replace(FINNED, caudal_fin=fin), water, 0.4, 0.2) for fin in (FINNED.caudal_fin, soft)
    )
    np.testing.assert_allclose(bending, rigid, rtol=1e-9)


@settings(max_examples=30, deadline=None)
@given(speed=SPEEDS, angle=ANGLES, water=st.sampled_from([one for one, _, _ in WATERS.values()]))
def test_loads_are_those_of_the_equations_that_are_written_out(speed, angle, water):
    c = link_coefficients(MAMBA, water)
    names = (
        "half_length",
        "mass",
        "c_t",
        "c_n",
        "mu_t",
        "mu_n",
        "lambda_1",
        "lambda_2",
        "lambda_3",
    )
    chain = Chain(**{name: getattr(c, name) for name in names}, inertia=np.ones(9))
    shed = wake_mass(MAMBA, water) if water.trailing_edge != "none" else 0.0
    options = Options(form=water.added_mass_form, drag=water.drag, wake_mass=shed)
    velocity = speed * np.array([math.cos(angle), -math.sin(angle)])
    f_x, f_y, tau = fluid_forces(np.zeros(9), np.zeros(9), velocity, chain, options)
    place = np.cumsum(2 * c.half_length) - c.half_length - np.sum(c.half_length)
    wanted = [f_x.sum(), f_y.sum(), (tau + place * f_y).sum()]
    np.testing.assert_allclose(towed(MAMBA, water, speed, angle), wanted, rtol=1e-6, atol=1e-9)


@settings(max_examples=30, deadline=None)
@given(speed=SPEEDS, angle=ANGLES, current=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)))
def test_a_tow_takes_work_has_a_mirror_image_and_does_not_see_the_current(speed, angle, current):
    loads = towed(FINNED, BOOK, speed, angle)
    assert loads[0] * math.cos(angle) - loads[1] * math.sin(angle) < 0.0
    np.testing.assert_allclose(
        towed(FINNED, BOOK, speed, -angle), loads * [1, -1, -1], rtol=1e-9, atol=1e-12
    )
    moving = towed(FINNED, replace(BOOK, current=current), speed, angle)
    np.testing.assert_allclose(moving, loads, rtol=1e-7, atol=1e-9)
