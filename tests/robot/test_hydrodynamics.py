from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.robot import CaudalFin, Ground, Joint, Module, Robot, Section, Water, load_robot
from laticauda.robot.hydrodynamics import (
    Coefficients,
    immersion_factor,
    link_coefficients,
    wake_mass,
)
from laticauda.water.fluid.laws import CoulombFriction, Element, PolynomialDrag, ViscousFriction

LOADS = ("c_t", "c_n", "mu_t", "mu_n", "lambda_1", "lambda_2", "lambda_3")
UNIT = Water(tangential_friction=0.03, normal_drag=1.0, added_mass=1.0)

lengths = st.floats(0.02, 0.5)
half_axes = st.floats(0.01, 0.1)
numbers = st.floats(0.0, 3.0)


def module(length: float = 0.14, a: float = 0.03, b: float = 0.05, **changes: Any) -> Module:
    return Module(length=length, mass=0.7, section=Section(half_height=a, half_width=b), **changes)


def robot(*modules: Module, fin: CaudalFin | None = None) -> Robot:
    return Robot(
        name="test", modules=modules, joints=(Joint(),) * (len(modules) - 1), caudal_fin=fin
    )


def of(one: Module, water: Water) -> dict[str, float]:
    """The loads of a link, by name."""
    coefficients = link_coefficients(robot(one), water)
    return {name: float(getattr(coefficients, name)[0]) for name in LOADS}


def fin_strips(water: Any = UNIT, **changes: Any) -> Coefficients:
    found = link_coefficients(robot(module(), fin=CaudalFin(**changes)), water).fin
    assert found is not None
    return found


# --- the trailing edge ----------------------------------------------------------------------------


@given(half_axes, numbers, st.none() | numbers, st.none() | st.floats(0.11, 2.0), st.booleans())
def test_the_edge_sheds_what_the_last_piece_of_the_body_carries(
    a: float, C_A: float, own: float | None, depth: float | None, with_fin: bool
):
    water = replace(UNIT, added_mass=C_A, depth=depth)
    fin = CaudalFin(added_mass=own) if with_fin else None
    one = robot(module(a=a, added_mass=None if with_fin else own), module(), fin=fin)
    carried = link_coefficients(one, water)
    last, i = (carried.fin, -1) if carried.fin else (carried, 0)
    assert wake_mass(one, water) == pytest.approx(
        last.mu_n[i] / (2.0 * last.half_length[i]), rel=1e-13
    )


# --- links ----------------------------------------------------------------------------------------


def test_the_published_link_has_its_published_coefficients():
    found = of(module(), UNIT)
    published = (0.26389, 4.2, 0.0, 0.39584, 2.29881e-7, 4.31027e-4, 2.26289e-5)
    for name, value in zip(LOADS, published, strict=True):
        assert found[name] == pytest.approx(value, rel=3e-5), name


@given(lengths, half_axes, half_axes, st.floats(1.0, 3000.0))
def test_all_loads_grow_with_the_density(length: float, a: float, b: float, density: float):
    one = module(length, a, b)
    light, heavy = of(one, replace(UNIT, density=1.0)), of(one, replace(UNIT, density=density))
    for name in LOADS:
        assert heavy[name] == pytest.approx(density * light[name]), name


@given(lengths, half_axes, half_axes, st.floats(0.05, 0.95), st.sampled_from(["paper", "strip"]))
def test_a_link_cut_in_two_has_the_loads_of_the_whole(
    length: float, a: float, b: float, at: float, form: Any
):
    water = replace(UNIT, rotational=form, tangential_added_mass=0.4)
    whole = of(module(length, a, b), water)
    cut = link_coefficients(
        robot(module(at * length, a, b), module((1.0 - at) * length, a, b)), water
    )
    for name in ("c_t", "c_n", "mu_t", "mu_n"):
        assert getattr(cut, name).sum() == pytest.approx(whole[name]), name


@given(lengths, half_axes, half_axes, st.floats(0.05, 0.95))
def test_the_strip_forms_inertia_and_linear_torque_obey_the_parallel_axis_theorem(
    length: float, a: float, b: float, at: float
):
    water = replace(UNIT, rotational="strip")
    whole = of(module(length, a, b), water)
    cut = link_coefficients(
        robot(module(at * length, a, b), module((1.0 - at) * length, a, b)), water
    )
    middle = np.array([0.5 * at, 0.5 * (1.0 + at)]) * length - 0.5 * length
    assert np.sum(cut.lambda_1 + cut.mu_n * middle**2) == pytest.approx(whole["lambda_1"])
    assert np.sum(cut.lambda_2 + cut.c_n * middle**2) == pytest.approx(whole["lambda_2"])


@given(lengths, half_axes, half_axes, numbers, numbers, st.floats(-5.0, 5.0), st.floats(0.1, 2.0))
def test_the_strip_form_is_the_sum_of_the_normal_loads_along_a_turning_link(
    length: float, a: float, b: float, C_D: float, C_A: float, rate: float, u: float
):
    water = replace(
        UNIT,
        normal_drag=C_D,
        added_mass=C_A,
        rotational="strip",
        drag=PolynomialDrag(reference_speed=u),
    )
    found = of(module(length, a, b), water)
    x, weight = np.polynomial.legendre.leggauss(
        6
    )  # exact on each half, where x |x| is a polynomial
    x, weight = np.concatenate((x - 1.0, x + 1.0)) * length / 4.0, np.tile(weight, 2) / 4.0
    across = Element(0.0, found["c_n"], 0.0, 0.0)
    normal = [water.drag(0.0, xi * rate, abs(xi * rate), 0.0, across)[1] for xi in x]
    tau = water.drag(0.0, 0.0, 0.0, rate, Element(0.0, 0.0, found["lambda_2"], found["lambda_3"]))[
        2
    ]
    assert tau == pytest.approx(np.sum(weight * x * normal), rel=1e-12, abs=1e-15)
    assert found["lambda_1"] == pytest.approx(np.sum(weight * x**2) * found["mu_n"], rel=1e-12)


def test_the_strip_form_leaves_the_forces_alone():
    paper, strip = of(module(), UNIT), of(module(), replace(UNIT, rotational="strip"))
    assert all(paper[name] == strip[name] for name in ("c_t", "c_n", "mu_t", "mu_n"))


def test_tangential_added_mass_is_a_share_of_the_displaced_mass():
    one = module()
    assert of(one, replace(UNIT, tangential_added_mass=0.2))["mu_t"] == pytest.approx(
        0.2 * 1000.0 * one.volume
    )


@pytest.mark.parametrize(
    ("override", "changed"),
    [
        ("tangential_friction", {"c_t", "lambda_2", "lambda_3"}),
        ("normal_drag", {"c_n"}),
        ("added_mass", {"mu_n"}),
        ("added_inertia", {"lambda_1"}),
    ],
)
def test_a_coefficient_of_its_own_changes_that_link_alone_and_only_what_it_is_about(
    override: str, changed: set[str]
):
    plain = link_coefficients(robot(module(), module(), module()), UNIT)
    own = link_coefficients(robot(module(), module(**{override: 0.015}), module()), UNIT)
    doubled = link_coefficients(robot(*[module()] * 3), replace(UNIT, **{override: 0.015}))
    for name in LOADS:
        before, after = getattr(plain, name), getattr(own, name)
        np.testing.assert_array_equal(after[[0, 2]], before[[0, 2]])
        assert (after[1] != before[1]) == (name in changed), name
        assert after[1] == getattr(doubled, name)[1]


def test_a_coefficient_of_its_own_may_be_zero():
    assert of(module(normal_drag=0.0), UNIT)["c_n"] == 0.0


def test_links_of_different_length_come_tail_first():
    found = link_coefficients(robot(module(0.1), module(0.2), module(0.4)), UNIT)
    np.testing.assert_allclose(found.half_length, [0.05, 0.1, 0.2])
    np.testing.assert_allclose(found.position, found.half_length)
    np.testing.assert_allclose(found.c_n, 1000.0 * 0.03 * np.array([0.1, 0.2, 0.4]))
    assert found.fin is None


# --- friction along the body ----------------------------------------------------------------------


@given(
    st.lists(lengths, min_size=1, max_size=8),
    st.floats(-1.0, 1.0),
    st.sampled_from(["paper", "strip"]),
)
def test_a_taper_spreads_the_friction_along_the_body_and_leaves_all_else_and_its_mean_alone(
    each: list[float], taper: float, form: Any
):
    one = robot(*(module(length) for length in each), fin=CaudalFin())
    water = replace(UNIT, rotational=form)
    even, tapered = (link_coefficients(one, replace(water, friction_taper=t)) for t in (0.0, taper))
    place = (np.cumsum(each) - np.array(each) / 2.0) / np.sum(each)
    np.testing.assert_allclose(
        tapered.c_t, even.c_t * (1.0 + taper * (1.0 - 2.0 * place)), rtol=1e-12
    )
    assert tapered.c_t.sum() == pytest.approx(even.c_t.sum())
    for name in ("c_n", "mu_t", "mu_n", "lambda_1"):
        np.testing.assert_array_equal(getattr(tapered, name), getattr(even, name))
    assert tapered.fin is not None and even.fin is not None
    np.testing.assert_array_equal(tapered.fin.c_t, even.fin.c_t)


def test_a_positive_taper_is_more_friction_at_the_tail_and_modules_with_their_own_keep_it():
    found = link_coefficients(
        robot(module(), module(tangential_friction=0.03), module()),
        replace(UNIT, friction_taper=0.6),
    )
    even = link_coefficients(robot(*[module()] * 3), UNIT)
    np.testing.assert_allclose(found.c_t / even.c_t, [1.4, 1.0, 0.6])
    found = link_coefficients(
        robot(module(tangential_friction=0.03), module()), replace(UNIT, friction_taper=0.6)
    )
    np.testing.assert_allclose(found.c_t / even.c_t[:2], [1.0, 0.7])


def test_the_taper_of_modules_that_merge_to_a_link_is_that_of_the_link():
    halves, whole = robot(*[module(0.07)] * 6), robot(*[module(0.14)] * 3)
    water = replace(UNIT, friction_taper=-0.5)
    each = link_coefficients(halves, water).c_t
    np.testing.assert_allclose(
        each[::2] + each[1::2], link_coefficients(whole, water).c_t, rtol=1e-13
    )


# --- the surface ----------------------------------------------------------------------------------


@given(half_axes, st.floats(1.001, 100.0))
def test_the_surface_adds_between_nothing_and_half_the_added_mass(a: float, depths: float):
    factor = immersion_factor(a, depths * a)
    assert factor == pytest.approx(1.0 + 0.5 / depths**2)
    assert 1.0 < factor < 1.5


def test_far_below_the_surface_nothing_is_added():
    assert immersion_factor(0.05, None) == 1.0


@pytest.mark.parametrize("depth", [0.05, 0.0, float("nan")])
def test_an_element_that_is_not_covered_is_refused(depth: float):
    with pytest.raises(
        ValueError, match=rf"`depth` must be > 0.05 m, the element's half height, got {depth}\."
    ):
        immersion_factor(0.05, depth)
    if depth == 0.05:
        with pytest.raises(ValueError, match=r"`depth` must be > 0\.06 m"):
            link_coefficients(robot(module(a=0.06)), replace(UNIT, depth=depth))


def test_the_surface_acts_on_the_normal_added_mass_of_links_and_fin_alone():
    fin = CaudalFin(height=0.08)
    deep, shallow = (
        link_coefficients(robot(module(a=0.03), fin=fin), replace(UNIT, depth=depth))
        for depth in (None, 0.1)
    )
    assert shallow.mu_n[0] == pytest.approx(deep.mu_n[0] * (1.0 + 0.03**2 / 0.02))
    assert deep.fin is not None and shallow.fin is not None
    np.testing.assert_allclose(shallow.fin.mu_n, deep.fin.mu_n * (1.0 + 0.04**2 / 0.02))
    for name in set(LOADS) - {"mu_n"}:
        np.testing.assert_array_equal(getattr(shallow, name), getattr(deep, name))
        np.testing.assert_array_equal(getattr(shallow.fin, name), getattr(deep.fin, name))


# --- the caudal fin -------------------------------------------------------------------------------


def added_inertia(strips: Coefficients, behind: float = 0.18) -> float:
    """About the joint at the head end of a tail link of that length."""
    return float(np.sum(strips.lambda_1 + strips.mu_n * (behind - strips.position) ** 2))


@pytest.mark.parametrize(
    ("opening", "mass", "inertia"), [("open", 2.42, 0.610), ("closed", 3.18, 0.654)]
)
def test_mambas_fin_has_the_added_mass_and_inertia_of_its_plate(
    opening: str, mass: float, inertia: float
):
    strips = fin_strips(opening=opening)
    np.testing.assert_allclose(strips.mu_n / (2.0 * strips.half_length), 6.36, rtol=1e-3)
    assert strips.mu_n.sum() == pytest.approx(mass, abs=0.005)
    exact = added_inertia(fin_strips(replace(UNIT, rotational="strip"), opening=opening))
    assert exact == pytest.approx(inertia, abs=0.0005)
    assert added_inertia(strips) == pytest.approx(exact, rel=1e-3)


@given(st.integers(1, 40), st.sampled_from(["open", "closed"]))
def test_in_strip_form_the_fin_does_not_depend_on_the_number_of_strips(n_strips: int, opening: str):
    water = replace(UNIT, rotational="strip")
    few, many = (fin_strips(water, n_strips=n, opening=opening) for n in (n_strips, 100))
    assert few.mu_n.sum() == pytest.approx(many.mu_n.sum())
    assert added_inertia(few) == pytest.approx(added_inertia(many))


def test_in_the_papers_form_the_error_of_the_strips_falls_with_the_square_of_their_number():
    exact = added_inertia(fin_strips(replace(UNIT, rotational="strip")))
    errors = [exact - added_inertia(fin_strips(n_strips=n)) for n in (4, 8, 16)]
    np.testing.assert_allclose(errors, errors[1] * np.array([4.0, 1.0, 0.25]), rtol=1e-9)
    assert 0.0 < errors[1] < 1e-3 * exact


def test_a_strip_has_two_wet_faces_and_the_area_of_its_side():
    strips = fin_strips(length=0.4, opening_length=0.0, height=0.1, n_strips=4)
    np.testing.assert_allclose(strips.c_t, 0.5 * 1000.0 * 0.03 * 2.0 * 0.1 * 0.1)
    np.testing.assert_allclose(strips.c_n, 0.5 * 1000.0 * 1.0 * 0.1 * 0.1)
    np.testing.assert_array_equal(strips.mu_t, 0.0)
    np.testing.assert_array_equal([strips.lambda_1, strips.lambda_2, strips.lambda_3], 0.0)


def test_strips_follow_each_other_from_the_root_to_the_trailing_edge():
    for opening, root in (("open", 0.12), ("closed", 0.0)):
        strips = fin_strips(opening=opening)
        front, back = strips.position + strips.half_length, strips.position - strips.half_length
        np.testing.assert_allclose(front[1:], back[:-1], atol=1e-15)
        assert (front[0], back[-1]) == (pytest.approx(-root), pytest.approx(-0.5))
    assert len(fin_strips().mass) == 8
    assert (
        len(fin_strips(opening="closed").mass) == 11
    )  # 0.12 m of opening in pieces of at most 0.0475 m


def test_the_opening_has_mass_but_no_strip():
    plate = CaudalFin()
    assert fin_strips().mass.sum() == pytest.approx(plate.mass * 0.38 / 0.5)
    assert fin_strips(opening="closed").mass.sum() == pytest.approx(plate.mass)


@pytest.mark.parametrize(
    ("override", "changed"),
    [("tangential_friction", "c_t"), ("normal_drag", "c_n"), ("added_mass", "mu_n")],
)
def test_a_fin_may_have_coefficients_of_its_own(override: str, changed: str):
    plain, own = fin_strips(), fin_strips(**{override: 0.5})
    ratio = 0.5 / getattr(UNIT, override)
    for name in LOADS:
        factor = ratio if name == changed else 1.0
        np.testing.assert_allclose(getattr(own, name), factor * getattr(plain, name))


# --- the ground -----------------------------------------------------------------------------------


def test_viscous_ground_gives_every_link_the_same_friction_and_nothing_else():
    found = link_coefficients(
        robot(module(0.1), module(0.2)),
        Ground(friction=ViscousFriction(), tangential=1.0, normal=3.0),
    )
    np.testing.assert_array_equal(found.c_t, 1.0)
    np.testing.assert_array_equal(found.c_n, 3.0)
    assert all(not np.any(getattr(found, name)) for name in LOADS[2:])


def test_dry_ground_gives_every_link_a_share_of_its_weight():
    ground = Ground(friction=CoulombFriction(), tangential=0.1, normal=0.5, gravity=10.0)
    found = link_coefficients(robot(module(), replace(module(), mass=1.4)), ground)
    np.testing.assert_allclose(found.c_t, [0.7, 1.4])
    np.testing.assert_allclose(found.c_n, [3.5, 7.0])
    assert all(not np.any(getattr(found, name)) for name in LOADS[2:])


def test_on_the_ground_the_fin_keeps_its_mass_and_dry_friction_acts_on_its_weight():
    for friction, weight in ((CoulombFriction(), 10.0), (ViscousFriction(), 0.0)):
        ground = Ground(friction=friction, tangential=0.1, normal=0.5, gravity=10.0)
        strips = fin_strips(ground)
        assert strips.mass.sum() == pytest.approx(CaudalFin().mass)
        np.testing.assert_allclose(strips.c_t, 0.1 * weight * strips.mass)
        np.testing.assert_allclose(strips.c_n, 0.5 * weight * strips.mass)
        assert all(not np.any(getattr(strips, name)) for name in LOADS[2:])


def test_mamba_has_the_coefficients_of_its_section():
    found = link_coefficients(
        load_robot("mamba"), Water(tangential_friction=0.3, normal_drag=1.75, added_mass=1.5)
    )
    assert len(found.mass) == 9
    np.testing.assert_allclose(found.mu_n, 1000.0 * np.pi * 1.5 * 0.055**2 * 0.18)
    np.testing.assert_allclose(found.c_n, 0.5 * 1000.0 * 1.75 * 0.11 * 0.18)
