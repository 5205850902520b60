"""The vortex lattice of a plate: against the table that the law ships, and against plates whose answer is known."""

import numpy as np
import pytest

from laticauda.water.fluid.edges import TABLE
from laticauda.water.fluid.lattice import Outline, PlateAhead, compute_plate, rectangle


@pytest.mark.parametrize(("aspect", "functions"), [row for row in TABLE if row[0] >= 0.24])
def test_the_table_of_the_law_is_that_of_the_lattice(aspect, functions):
    found = rectangle(aspect)
    assert found[:3] == pytest.approx(functions[:3], rel=0.01)
    assert found.center == pytest.approx(functions.center, abs=0.002)


@pytest.mark.parametrize("aspect", [0.3, 1.0, 5.0])
def test_lift_and_control_point_of_a_rectangle_are_mirrored_by_the_flow_reversal_theorem(aspect):
    loads = compute_plate(Outline.rectangle(1.0 / aspect, 1.0))
    assert (loads.center + loads.control) * aspect == pytest.approx(1.0, abs=0.002)


def test_a_disk_has_the_added_mass_of_the_textbook():
    disk = Outline(
        height=2.0,
        leading=lambda z: 1.0 - np.sqrt(1.0 - z**2),
        trailing=lambda z: 1.0 + np.sqrt(1.0 - z**2),
    )
    loads = compute_plate(disk)
    assert loads.mass == pytest.approx(8.0 / 3.0, rel=0.005)
    assert loads.inertia == pytest.approx(16.0 / 45.0, rel=0.005)
    assert loads.mass_center == pytest.approx(1.0, abs=1e-6)


def test_a_slender_triangle_lifts_by_its_span_alone_and_at_two_thirds_of_its_length():
    length = 8.0
    triangle = Outline(
        height=1.0,
        leading=lambda z: 2.0 * length * z,
        trailing=lambda z: np.full_like(z, length),
    )
    loads = compute_plate(triangle)
    assert loads.lift == pytest.approx(0.25 * np.pi, rel=0.07)
    assert loads.center == pytest.approx(2.0 / 3.0 * length, rel=0.07)


@pytest.mark.parametrize("aspect", [0.3, 1.0, 5.0])
def test_a_plate_that_is_cut_in_two_is_the_same_plate(aspect):
    whole = compute_plate(Outline.rectangle(1.0 / aspect, 1.0), refinement=2)
    half = 0.5 / aspect
    parts = compute_plate(Outline.rectangle(half, 1.0), PlateAhead(half, 1.0), refinement=2)
    assert parts.mass + parts.mass_ahead == pytest.approx(whole.mass, rel=0.01)
    assert parts.lift == pytest.approx(whole.lift, rel=0.005)
    assert parts.control == pytest.approx(whole.control - half, abs=0.01 / aspect)
    # The Munk moment of the part ahead is no part of the center.
    center = parts.center - parts.mass_ahead / parts.lift
    assert center == pytest.approx(whole.center - half, abs=0.01 / aspect)


def test_a_slender_plate_behind_a_lower_one_lifts_by_its_height_alone():
    loads = compute_plate(Outline.rectangle(8.0, 1.0), PlateAhead(3.0, 0.5))
    assert loads.lift == pytest.approx(0.25 * np.pi, rel=0.01)
    free = rectangle(0.125).added_mass
    assert free < loads.mass / (0.25 * np.pi * 8.0) < 0.5 * (1.0 + free)


def test_a_low_plate_ahead_adds_its_own_edge_to_that_of_a_broad_plate():
    alone = compute_plate(Outline.rectangle(0.18, 1.0))
    behind = compute_plate(Outline.rectangle(0.18, 1.0), PlateAhead(0.77, 0.394))
    assert alone.lift / (0.25 * np.pi) == pytest.approx(0.470, abs=0.003)
    assert behind.lift / (0.25 * np.pi) == pytest.approx(0.470 + 0.394**2, rel=0.06)
