"""Flat plates: limits and numbers of others."""

import math

import pytest
from hypothesis import given, strategies as st

from laticauda.water.fluid.edges import plate_functions
from laticauda.water.mujoco import shape_mass
from laticauda.water.mujoco.shape_drag import drag_of_box
from laticauda.water.mujoco.shape_mass import added_mass
from laticauda.water.plates import plate_drag


def share_of(aspect):
    return plate_functions(aspect).added_mass


def test_the_added_mass_of_plates_is_the_handbook_s():
    for length_over_height, share in ((1.0, 0.579), (2.0, 0.757), (4.0, 0.872)):
        assert share_of(1.0 / length_over_height) == pytest.approx(share, rel=0.01)


@given(st.floats(0.02, 50.0))
def test_a_flat_box_carries_the_water_of_a_fin(aspect):
    box = added_mass("box", (0.5, 1e-9, 0.5 * aspect))
    slender = 0.25 * math.pi * aspect**2
    assert box.mass[1] / slender == pytest.approx(share_of(aspect), rel=0.005)
    rotary = plate_functions(aspect).rotary
    assert box.inertia[2] / (slender / 12.0) == pytest.approx(rotary, rel=0.01)


def test_panels_of_boxes_carry_the_water_of_the_vortex_lattice_within_two_percent():
    table = shape_mass._box_table()
    for k, aspect in enumerate(table.slender[1:], start=1):
        shares = table.shares[0, k, list(shape_mass.ACROSS_PLATE)]
        assert shares == pytest.approx(shape_mass._plate_shares(float(aspect)), rel=0.02)


def test_thin_boxes_carry_more_water_the_thicker_they_are():
    masses = [
        added_mass("box", (0.5, 0.5 * thickness, 0.3)).mass[1]
        for thickness in (1e-9, 1e-3, 3e-3, 0.01, 0.03)
    ]
    assert masses == sorted(masses)


@given(st.floats(1e-3, 1e3))
def test_height_and_length_may_change_places(aspect):
    # M = k(A) rho pi h^2 / 4 c is the same for the plate that lies on its side.
    upright = share_of(aspect) * aspect**2
    lying = share_of(1.0 / aspect) * aspect
    assert upright == pytest.approx(lying, rel=0.02)


def test_the_drag_of_plates_is_the_handbook_s_and_that_of_flat_geoms():
    for proportion, drag in ((1.0, 1.16), (0.2, 1.20), (0.1, 1.50), (0.0, 1.90)):
        assert plate_drag(1.0, proportion) == pytest.approx(drag)
        assert plate_drag(proportion, 1.0) == pytest.approx(drag)
        if proportion:
            assert drag_of_box((1.0, 1e-9, proportion), 1) == pytest.approx(drag)
