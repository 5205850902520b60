"""Fins and flat modules in the textbook's water are plates of their own proportions."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate import intervals_of
from laticauda.robot import CaudalFin, Joint, Robot, Section, fin_plate, textbook_water
from laticauda.robot.body import is_flat
from laticauda.robot.hydrodynamics import link_coefficients, wake_mass
from laticauda.robot.plates import plate_of_fin, plates_of_modules
from laticauda.water.fluid.edges import plate_functions
from laticauda.water.plates import plate_drag

FISH = lc.load_robot("tendon-fish")
MAMBA_FIN = lc.load_robot("mamba-fin")
WATER = replace(lc.load_water("paper-lateral"), added_mass_form="kirchhoff")
PLATES = replace(WATER, plate_drag=1.0, plate_added_mass=1.0)


def share_of(aspect: float) -> float:
    return plate_functions(aspect).added_mass


def flat(robot: Robot) -> Robot:
    """The tail of the fish alone, flat from end to end."""
    return replace(
        robot, modules=robot.modules[:5], joints=robot.joints[:4], caudal_fin=None, drag_areas=()
    )


def test_a_fin_has_drag_and_added_mass_of_a_plate_of_its_height_and_length():
    fin = CaudalFin(length=0.0365, height=0.203, opening_length=0.0)
    rod = replace(FISH.modules[0], section=Section(half_height=0.01, half_width=0.01))
    free = replace(FISH, modules=(rod, *FISH.modules[1:]), caudal_fin=fin)
    strips = link_coefficients(free, PLATES).fin
    area = fin.height * fin.length
    assert strips.c_n.sum() == pytest.approx(500.0 * plate_drag(0.203, 0.0365) * area)
    slender = 1000.0 * np.pi * 0.203**2 / 4.0 * 0.0365
    assert strips.mu_n.sum() == pytest.approx(slender * share_of(0.203 / 0.0365))
    assert strips.mu_n.sum() == pytest.approx(0.193, rel=0.01)  # [kg]; a slender one has 1.18


def test_the_fish_has_the_fin_of_its_source_behind_the_plates_of_its_tail():
    fin, plate = FISH.caudal_fin, fin_plate(FISH)
    assert fin.area == pytest.approx(0.007542, rel=0.003)  # of the mesh [m^2]
    assert fin.mass == pytest.approx(0.010, rel=0.001)
    assert FISH.reach == pytest.approx(0.077 + 0.4824, abs=1e-3)  # from the nose to the tips
    free = fin_plate(replace(FISH, caudal_fin=replace(fin, joint=Joint())))
    assert plate.lift == pytest.approx(0.571, abs=0.005)
    assert free.lift == pytest.approx(0.482, abs=0.005)
    assert 1000.0 * np.pi * 0.203**2 / 4.0 * free.mass == pytest.approx(0.208, rel=0.01)  # [kg]
    np.testing.assert_allclose(
        link_coefficients(FISH, PLATES).fin.c_n.sum(),
        0.5 * 1000.0 * fin.area * plate_drag(0.203, fin.area / 0.203),
        rtol=0.02,
    )


def test_the_law_of_a_finite_span_takes_off_what_the_span_does_only_once():
    finite = replace(PLATES, trailing_edge="finite-span")
    elongated = replace(PLATES, trailing_edge="elongated")
    for fin in (CaudalFin(opening_length=0.0, height=0.2, length=0.06), CaudalFin()):
        robot = replace(MAMBA_FIN, caudal_fin=fin)
        ours, theirs = (link_coefficients(robot, water).fin.mu_n for water in (finite, elongated))
        assert ours.sum() == pytest.approx(theirs.sum(), rel=1e-12)


def test_an_open_opening_is_no_part_of_the_plate_and_a_closed_one_is():
    opened = plate_of_fin(MAMBA_FIN)
    closed = plate_of_fin(replace(MAMBA_FIN, caudal_fin=CaudalFin(opening="closed")))
    assert opened.added_mass == pytest.approx(share_of(0.09 / 0.38))
    # It adjoins the body: one free end.
    assert closed.added_mass == pytest.approx(0.5 * (1.0 + share_of(0.09 / 0.5)), rel=0.01)


def test_flat_modules_in_a_row_are_one_plate_whose_closed_ends_carry_all():
    assert [is_flat(module) for module in FISH.modules] == [True] * 5 + [False]
    plates = plates_of_modules(FISH)
    assert plates[5] is None
    assert plates[:5] == (plates[0],) * 5
    assert plates[0].added_mass == 1.0  # fin behind, body ahead
    length = sum(m.length for m in FISH.modules[:5])
    height = sum(2.0 * m.section.half_height * m.length for m in FISH.modules[:5]) / length
    assert plates[0].drag == pytest.approx(plate_drag(height, length))
    free = plates_of_modules(replace(FISH, caudal_fin=None))[0]
    lacking = 1.0 - share_of(height / length)
    assert free.added_mass == pytest.approx(1.0 - 0.5 * lacking)
    both = plates_of_modules(flat(FISH))[0]
    assert both.added_mass == pytest.approx(1.0 - lacking)


def test_factors_scale_what_plates_have_and_nothing_else():
    doubled = replace(PLATES, plate_drag=2.0, plate_added_mass=3.0)
    before, after = link_coefficients(FISH, PLATES), link_coefficients(FISH, doubled)
    np.testing.assert_allclose(after.fin.c_n, 2.0 * before.fin.c_n)
    np.testing.assert_allclose(after.fin.mu_n, 3.0 * before.fin.mu_n)
    np.testing.assert_allclose(after.c_n[:5], 2.0 * before.c_n[:5])
    np.testing.assert_allclose(after.mu_n[:5], 3.0 * before.mu_n[:5])
    assert after.c_n[5] == before.c_n[5]
    assert after.mu_n[5] == before.mu_n[5]
    assert wake_mass(FISH, doubled) == pytest.approx(3.0 * wake_mass(FISH, PLATES))
    assert wake_mass(flat(FISH), doubled) == pytest.approx(3.0 * wake_mass(flat(FISH), PLATES))


def test_coefficients_of_a_part_itself_come_first():
    fin = replace(MAMBA_FIN.caudal_fin, normal_drag=2.0, added_mass=1.5)
    with_own = replace(MAMBA_FIN, caudal_fin=fin)
    of_plate, of_water = (link_coefficients(with_own, water).fin for water in (PLATES, WATER))
    np.testing.assert_array_equal(of_plate.c_n, of_water.c_n)
    np.testing.assert_array_equal(of_plate.mu_n, of_water.mu_n)
    modules = tuple(replace(m, normal_drag=1.1, added_mass=0.9) for m in FISH.modules)
    own = replace(FISH, modules=modules)
    for name in ("c_n", "mu_n"):
        np.testing.assert_array_equal(
            getattr(link_coefficients(own, PLATES), name),
            getattr(link_coefficients(own, WATER), name),
        )


def test_waters_without_factors_treat_fins_as_before():
    strips = link_coefficients(MAMBA_FIN, WATER).fin
    assert strips.c_n.sum() == pytest.approx(500.0 * 1.75 * 0.09 * 0.38)


def test_the_textbook_has_factors_with_intervals_for_robots_with_plates_only():
    book = textbook_water(FISH)
    assert book.water.plate_drag == book.water.plate_added_mass == 1.0
    for name in ("water.plate_drag", "water.plate_added_mass"):
        low, high = book.intervals[name]
        assert low < 1.0 < high
        assert "rectangular plates" in book.sources[name]
    for name in ("mamba", "amphibot"):
        water = textbook_water(lc.load_robot(name)).water
        assert water.plate_drag is water.plate_added_mass is None
    assert textbook_water(MAMBA_FIN).water.plate_drag == 1.0


def test_the_textbook_averages_over_what_is_no_plate():
    head = replace(FISH, modules=FISH.modules[5:], joints=(), caudal_fin=None, drag_areas=())
    assert textbook_water(FISH).water.added_mass == textbook_water(head).water.added_mass
    assert textbook_water(flat(FISH)).water.added_mass == pytest.approx(1.062, abs=0.001)


def test_an_interval_of_a_run_varies_the_factors_of_plates():
    gait = lc.lateral_undulation(amplitude=0.35, frequency=5.0, phase_shift=0.5)
    trial = lc.swim("tendon-fish", gait, 4.0, environment="textbook", dt=0.005)
    assert {"water.plate_drag", "water.plate_added_mass"} <= intervals_of(trial.scenario).keys()
