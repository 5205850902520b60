"""Added mass of boxes, cylinders and capsules: limits, symmetry, and numbers of others."""

import math

import numpy as np
import pytest
from campaign_scripts import campaign
from hypothesis import given, strategies as st

from laticauda.water.mujoco.lamb import lamb
from laticauda.water.mujoco.shape_drag import drag_across_rod, drag_along_rod, drag_of_box
from laticauda.water.mujoco.shape_mass import added_mass

SIZES = st.floats(0.01, 1.0)
shapes = campaign("added_mass")


@pytest.mark.parametrize("known", shapes.KNOWN, ids=lambda known: known.what)
def test_added_mass_and_inertia_are_those_of_the_books_and_of_another_code(known):
    value = shapes.WATER * shapes.from_tables(known.shape, known.half)[known.quantity]
    assert value == pytest.approx(known.right, rel=known.tolerance)


@given(SIZES, SIZES, SIZES)
def test_a_box_that_is_turned_has_the_same_added_mass_about_its_own_axes(a, b, c):
    upright = added_mass("box", (a, b, c))
    turned = added_mass("box", (c, a, b))
    np.testing.assert_allclose(turned.mass, upright.mass[[2, 0, 1]], rtol=1e-5)
    np.testing.assert_allclose(turned.inertia, upright.inertia[[2, 0, 1]], rtol=1e-5)


@given(st.sampled_from(["ellipsoid", "box"]), SIZES, SIZES, SIZES, st.floats(0.1, 10.0))
def test_added_mass_grows_with_the_volume_and_inertia_with_its_square_times_length(
    shape, a, b, c, scale
):
    small = added_mass(shape, (a, b, c))
    large = added_mass(shape, (scale * a, scale * b, scale * c))
    np.testing.assert_allclose(large.mass, scale**3 * small.mass, rtol=1e-9)
    np.testing.assert_allclose(
        large.inertia, scale**5 * small.inertia, rtol=1e-6, atol=1e-9 * scale**5
    )


@given(SIZES, SIZES, SIZES)
def test_a_box_carries_more_water_than_the_ellipsoid_inside_and_every_number_is_positive(a, b, c):
    box = added_mass("box", (a, b, c))
    inside = added_mass("ellipsoid", (a, b, c))
    assert np.all(box.mass > inside.mass)
    assert np.all(box.inertia > 0.0)


@given(st.floats(0.02, 50.0))
def test_a_cylinder_carries_more_water_than_the_capsule_inside(slenderness):
    half = (max(slenderness, 1.0), 1.0, 1.0)
    assert np.all(added_mass("cylinder", half).mass > added_mass("capsule", half).mass)


@given(SIZES, SIZES, SIZES)
def test_ellipsoids_are_lamb_s(a, b, c):
    volume = 4.0 / 3.0 * math.pi * a * b * c
    loads = added_mass("ellipsoid", (a, b, c))
    np.testing.assert_allclose(loads.mass, volume * lamb((a, b, c)).mass, rtol=1e-5)


def test_drag_goes_from_plates_to_rods_as_handbooks_say():
    thin = 1e-3
    assert drag_of_box((thin, 1.0, 1.0), 0) == pytest.approx(1.16, abs=0.01)
    assert drag_of_box((thin, 0.1, 1.0), 0) == pytest.approx(1.5, abs=0.02)
    assert drag_of_box((2.0, 1.0, 1.0), 0) == pytest.approx(0.87, abs=0.01)
    assert drag_along_rod(0.0) == 1.12
    assert drag_across_rod(5.0) == pytest.approx(0.744, abs=1e-3)
