"""Flat plates: limits and numbers of others."""

import math

import pytest
from hypothesis import given, strategies as st

from laticauda.water.mujoco.shape_drag import drag_of_box
from laticauda.water.mujoco.shape_mass import added_mass
from laticauda.water.plates import plate_drag, plate_lift_share, plate_mass_share


def test_the_added_mass_of_plates_is_the_handbook_s():
    for length_over_height, share in ((1.0, 0.579), (2.0, 0.757), (4.0, 0.872)):
        assert plate_mass_share(1.0 / length_over_height) == pytest.approx(share, rel=0.01)


@given(st.floats(0.02, 50.0))
def test_a_plate_carries_the_same_water_by_the_vortex_lattice_and_by_the_panels_of_boxes(aspect):
    box = added_mass("box", (0.5, 1e-6, 0.5 * aspect))
    share = box.mass[1] / (0.25 * math.pi * aspect**2)
    assert plate_mass_share(aspect) == pytest.approx(share, rel=0.02)


@given(st.floats(1e-3, 1e3))
def test_height_and_length_may_change_places(aspect):
    # M = k(A) rho pi h^2 / 4 c is the same for the plate that lies on its side.
    upright = plate_mass_share(aspect) * aspect**2
    lying = plate_mass_share(1.0 / aspect) * aspect
    assert upright == pytest.approx(lying, rel=0.02)


def test_slender_and_broad_plates_have_the_limits_of_theory():
    assert plate_mass_share(1e-6) == pytest.approx(1.0, abs=1e-5)
    assert plate_lift_share(1e-6) == pytest.approx(1.0, abs=1e-5)
    assert plate_mass_share(1e5) * 1e5 == pytest.approx(1.0, rel=1e-3)
    assert plate_lift_share(1e5) * 1e5 == pytest.approx(4.0, rel=1e-3)


@given(st.floats(1e-3, 1e3), st.floats(1.001, 2.0))
def test_shares_fall_as_a_plate_grows_higher(aspect, factor):
    assert plate_mass_share(factor * aspect) < plate_mass_share(aspect)
    assert plate_lift_share(factor * aspect) <= plate_lift_share(aspect) + 1e-3


def test_the_drag_of_plates_is_the_handbook_s_and_that_of_flat_geoms():
    for proportion, drag in ((1.0, 1.16), (0.2, 1.20), (0.1, 1.50), (0.0, 1.90)):
        assert plate_drag(1.0, proportion) == pytest.approx(drag)
        assert plate_drag(proportion, 1.0) == pytest.approx(drag)
        if proportion:
            assert drag_of_box((1.0, 1e-9, proportion), 1) == pytest.approx(drag)
