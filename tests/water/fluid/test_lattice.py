"""The vortex lattice of a plate: against the table that the law ships, and against plates whose answer is known."""

import numpy as np
import pytest

from laticauda.water.fluid.edges import TABLE
from laticauda.water.fluid.lattice import compute_plate, rectangle


@pytest.mark.parametrize(("aspect", "functions"), [row for row in TABLE if row[0] >= 0.24])
def test_the_table_of_the_law_is_that_of_the_lattice(aspect, functions):
    found = rectangle(aspect)
    assert found[:3] == pytest.approx(functions[:3], rel=0.01)
    assert found.center == pytest.approx(functions.center, abs=0.002)


@pytest.mark.parametrize("aspect", [0.3, 1.0, 5.0])
def test_lift_and_control_point_of_a_rectangle_are_mirrored_by_the_flow_reversal_theorem(aspect):
    loads = compute_plate(1.0 / aspect, 1.0)
    assert (loads.center + loads.control) * aspect == pytest.approx(1.0, abs=0.002)


def test_a_disk_has_the_added_mass_of_the_textbook():
    loads = compute_plate(2.0, 2.0, lambda x, z: (x - 1.0) ** 2 + z**2 < 1.0)
    assert loads.added_mass[0, 0] == pytest.approx(8.0 / 3.0, rel=0.05)
    assert loads.added_mass[0, 1] == pytest.approx(loads.added_mass[0, 0], rel=1e-6)


def test_a_slender_triangle_lifts_by_its_span_alone_and_at_two_thirds_of_its_length():
    length = 8.0
    loads = compute_plate(length, 1.0, lambda x, z: z < 0.5 * x / length)
    assert loads.lift == pytest.approx(0.25 * np.pi, rel=0.07)
    assert loads.center == pytest.approx(2.0 / 3.0 * length, rel=0.07)


def test_an_added_mass_is_symmetric():
    mass = compute_plate(0.7, 1.0, lambda x, z: z < 0.2 + 0.4 * x).added_mass
    assert mass[0, 1] == pytest.approx(mass[1, 0], rel=1e-3)
