from types import SimpleNamespace

import numpy as np
import pytest
from derivatives import check_compiled, check_complex_steps
from hypothesis import assume, given, strategies as st

from laticauda.compiling import for_python
from laticauda.compiling.formulas import in_numbers
from laticauda.values.scalars import magnitude
from laticauda.water.fluid.laws import (
    MOTION,
    CoulombFriction,
    Element,
    PolynomialDrag,
    TotalSpeedDrag,
    ViscousFriction,
    plate,
)

# Subnormal numbers are left out: they do not round like others.
velocities = st.floats(-3.0, 3.0, allow_subnormal=False)
coefficients = st.floats(0.0, 50.0, allow_subnormal=False)
switches = st.sampled_from([0.0, 1.0])
sways = st.floats(0.0, 5.0)
shares = st.floats(0.1, 1.0)
between = st.floats(0.0, 1.0, allow_subnormal=False)
angles = st.floats(-np.pi, np.pi)
signed = st.one_of(st.floats(-3.0, -0.01), st.floats(0.01, 3.0))

AEROSONDE = {"lift_slope": 3.45, "stall_angle": 0.4712, "sharpness": 50.0}
PLATE = {"half_density_area": 5.0, **AEROSONDE, "parasitic_drag": 0.0}


def polynomial_drag(v_t, v_n, rate, c_t, c_n, lambda_2, lambda_3, *numbers):
    """The law in the plane as a function of numbers alone, which derivatives are taken of."""
    law = SimpleNamespace(
        **dict(
            zip(("reference_speed", "linear", "quadratic", "sway_friction"), numbers, strict=True)
        )
    )
    return PolynomialDrag.__call__(
        law, v_t, v_n, magnitude(v_n), rate, Element(c_t, c_n, lambda_2, lambda_3)
    )


def total_speed_drag(v_t, v_n, above, rate, c_t, c_n, lambda_3, beta, gamma):
    """The law of the total speed in space, where something moves up and down as well."""
    law, across = SimpleNamespace(beta=beta, gamma=gamma), (v_n * v_n + above * above) ** 0.5
    return TotalSpeedDrag.__call__(law, v_t, v_n, across, rate, Element(c_t, c_n, 0.0, lambda_3))


def coulomb_friction(v_t, v_n, rate, c_t, c_n, eps):
    """The same of dry friction."""
    law = SimpleNamespace(regularization_speed=eps)
    return CoulombFriction.__call__(
        law, v_t, v_n, magnitude(v_n), rate, Element(c_t, c_n, 0.1, 0.2)
    )


def moving(angle: float, speed: float = 1.0) -> tuple[float, float]:
    """Velocity along and across a plate that meets the water at this angle of attack."""
    return speed * np.cos(angle), -speed * np.sin(angle)


def lift_and_drag(angle: float, **changes: float) -> tuple[float, float]:
    """Coefficients at unit speed: force to the left of the velocity, and against it."""
    v_t, v_n = moving(angle)
    f_t, f_n = plate(v_t, v_n, **{**PLATE, "half_density_area": 1.0, **changes})
    return -v_n * f_t + v_t * f_n, -(v_t * f_t + v_n * f_n)


# --- magnitude ------------------------------------------------------------------------------------


@given(st.floats(-1e6, 1e6))
def test_the_magnitude_is_the_absolute_value_and_its_complex_step_the_sign(x: float):
    assert magnitude(x) == abs(x)
    perturbed = magnitude(x + 1e-30j)  # pyright: ignore[reportArgumentType]
    assert perturbed.real == abs(x)
    assert perturbed.imag == (1e-30 if x >= 0.0 else -1e-30)


# --- drag in water --------------------------------------------------------------------------------


@given(
    velocities,
    velocities,
    velocities,
    *[coefficients] * 4,
    st.floats(0.0, 3.0),
    switches,
    switches,
    sways,
)
def test_drag_never_feeds_energy_in_neither_along_nor_across_nor_turning(
    v_t: float,
    v_n: float,
    rate: float,
    c_t: float,
    c_n: float,
    l2: float,
    l3: float,
    u: float,
    lin: float,
    quad: float,
    sway: float,
):
    f_t, f_n, tau = polynomial_drag(v_t, v_n, rate, c_t, c_n, l2, l3, u, lin, quad, sway)
    assert f_t * v_t <= 0.0
    assert f_n * v_n <= 0.0
    assert tau * rate <= 0.0


@given(velocities, velocities, velocities)
def test_drag_is_odd_in_the_velocities(v_t: float, v_n: float, rate: float):
    rest = (0.3, 4.0, 0.1, 0.2, 0.7, 1.0, 1.0, 0.6)
    forward, backward = (
        polynomial_drag(v_t, v_n, rate, *rest),
        polynomial_drag(-v_t, -v_n, -rate, *rest),
    )
    np.testing.assert_array_equal(np.array(backward), -np.array(forward))


@given(velocities, velocities, velocities, st.floats(0.1, 3.0))
def test_linear_and_quadratic_drag_add_up_and_are_equal_at_the_reference_speed(
    v_t: float, v_n: float, rate: float, u: float
):
    c = (0.3, 4.0, 0.1, 0.2)
    linear, quadratic, both = (
        np.array(polynomial_drag(v_t, v_n, rate, *c, u, *parts, 0.0))
        for parts in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
    )
    np.testing.assert_allclose(linear + quadratic, both, atol=1e-14)
    at_reference = [
        polynomial_drag(u, -u, 0.0, *c, u, *parts, 0.0)[:2] for parts in ((1.0, 0.0), (0.0, 1.0))
    ]
    np.testing.assert_allclose(*at_reference, rtol=1e-14)


@given(velocities, velocities, velocities, st.floats(0.1, 4.0))
def test_the_parts_of_the_drag_grow_with_the_first_and_the_second_power(
    v_t: float, v_n: float, rate: float, factor: float
):
    rest = (0.3, 4.0, 0.1, 0.2, 0.7)
    for power, parts in ((1, (1.0, 0.0)), (2, (0.0, 1.0))):
        slow = np.array(polynomial_drag(v_t, v_n, rate, *rest, *parts, 0.6 * parts[1]))
        fast = np.array(
            polynomial_drag(
                factor * v_t, factor * v_n, factor * rate, *rest, *parts, 0.6 * parts[1]
            )
        )
        np.testing.assert_allclose(fast, factor**power * slow, rtol=1e-12, atol=1e-14)


def test_drag_has_its_textbook_values():
    f_t, f_n, tau = polynomial_drag(0.5, -2.0, 3.0, 0.3, 4.0, 0.1, 0.2, 1.0, 1.0, 1.0, 0.6)
    assert f_t == pytest.approx(-0.3 * 0.5 * (1.0 + 0.5 + 0.6 * 2.0))
    assert f_n == pytest.approx(4.0 * 2.0 * 3.0)
    assert tau == pytest.approx(-(0.1 + 0.2 * 3.0) * 3.0)


@given(velocities, velocities, st.floats(0.1, 3.0), switches, switches, sways)
def test_sway_friction_adds_its_share_of_the_sideways_speed_to_the_drag_along_and_to_nothing_else(
    v_t: float, v_n: float, u: float, lin: float, quad: float, sway: float
):
    rest = (2.0, 0.3, 4.0, 0.1, 0.2, u, lin, quad)
    with_sway, without = (
        polynomial_drag(v_t, v_n, *rest, sway),
        polynomial_drag(v_t, v_n, *rest, 0.0),
    )
    assert with_sway[0] - without[0] == pytest.approx(-0.3 * v_t * sway * abs(v_n), abs=1e-13)
    assert with_sway[1:] == without[1:]


def test_the_reference_speed_acts_on_the_torque_too():
    assert polynomial_drag(0.0, 0.0, 1.0, 0.0, 0.0, 0.1, 0.0, 0.25, 1.0, 1.0, 0.0)[
        2
    ] == pytest.approx(-0.025)


@given(st.tuples(*[signed] * 3, *[st.floats(0.1, 3.0)] * 8))
def test_every_derivative_of_the_drag_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    check_complex_steps(polynomial_drag, arguments)


# --- drag by the total speed ----------------------------------------------------------------------

moving_element = st.tuples(*[velocities] * 4, *[coefficients] * 3, between, between)


@given(moving_element)
def test_drag_by_the_total_speed_takes_energy_out_along_across_and_turning(
    numbers: tuple[float, ...],
):
    v_t, v_n, _, rate, *_ = numbers
    f_t, f_n, tau = total_speed_drag(*numbers)
    assert max(f_t * v_t, f_n * v_n, tau * rate) <= 0.0


@given(moving_element)
def test_it_is_that_of_the_mirror_image_in_the_mirror(numbers: tuple[float, ...]):
    v_t, v_n, above, rate, *rest = numbers
    f_t, f_n, tau = total_speed_drag(*numbers)
    assert total_speed_drag(v_t, -v_n, above, -rate, *rest) == (f_t, -f_n, -tau)
    assert total_speed_drag(-v_t, v_n, above, rate, *rest) == (-f_t, f_n, tau)


@given(moving_element, st.floats(0.1, 4.0))
def test_it_grows_with_the_second_power_of_all_speeds(numbers: tuple[float, ...], factor: float):
    slow, fast = (
        total_speed_drag(*numbers),
        total_speed_drag(*(factor * v for v in numbers[:4]), *numbers[4:]),
    )
    np.testing.assert_allclose(fast, factor**2 * np.array(slow), rtol=1e-12, atol=1e-12)


@given(velocities, velocities, velocities, *[coefficients] * 3)
def test_with_both_shares_zero_it_is_the_polynomial_law_without_its_linear_part(
    v_t: float, v_n: float, rate: float, c_t: float, c_n: float, l3: float
):
    element = Element(c_t, c_n, 0.3, l3)
    expected = PolynomialDrag(linear=False)(v_t, v_n, abs(v_n), rate, element)
    found = TotalSpeedDrag(beta=0.0, gamma=0.0)(v_t, v_n, abs(v_n), rate, element)
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-13)


@given(velocities, velocities, velocities, st.floats(0.1, 50.0))
def test_with_both_shares_one_it_acts_against_the_whole_velocity(
    v_t: float, v_n: float, above: float, c: float
):
    f_t, f_n, _ = total_speed_drag(v_t, v_n, above, 0.0, c, c, 0.0, 1.0, 1.0)
    speed = np.linalg.norm([v_t, v_n, above])
    np.testing.assert_allclose(
        [f_t, f_n], [-c * speed * v_t, -c * speed * v_n], rtol=1e-12, atol=1e-12
    )


@given(st.floats(0.0, 1.0), st.floats(0.1, 3.0))
def test_at_small_incidence_the_drag_across_grows_with_the_angle_times_beta(
    beta: float, speed: float
):
    angle = 1e-8
    _, f_n, _ = total_speed_drag(speed, speed * angle, 0.0, 0.0, 1.0, 2.0, 0.0, beta, 1.0)
    assert f_n == pytest.approx(-2.0 * beta * speed**2 * angle, abs=1e-14 * speed**2)


def test_it_has_its_textbook_values_in_the_plane_and_in_space():
    assert total_speed_drag(0.3, -0.4, 0.0, 2.0, 2.0, 10.0, 0.5, 0.5, 1.0) == (
        pytest.approx(-2.0 * 0.3 * 0.5),
        pytest.approx(10.0 * 0.4 * np.hypot(0.4, 0.15)),
        pytest.approx(-0.5 * 4.0),
    )
    f_t, f_n, _ = total_speed_drag(0.1, 0.3, 0.4, 0.0, 2.0, 10.0, 0.0, 1.0, 0.6)
    assert (f_t, f_n) == (
        pytest.approx(-0.2 * np.hypot(0.1, 0.3)),
        pytest.approx(-3.0 * np.sqrt(0.26)),
    )


def test_a_share_is_no_more_than_the_whole():
    with pytest.raises(ValueError, match="`beta` must be between 0 and 1"):
        TotalSpeedDrag(beta=1.1)
    with pytest.raises(ValueError, match="`gamma` must be between 0 and 1"):
        TotalSpeedDrag(gamma=-0.1)


@given(st.tuples(*[signed] * 4, *[st.floats(0.1, 3.0)] * 3, shares, shares))
def test_every_derivative_of_it_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    check_complex_steps(total_speed_drag, arguments)


# --- dry friction ---------------------------------------------------------------------------------


@given(velocities, velocities, velocities, coefficients, coefficients, st.floats(1e-4, 0.1))
def test_dry_friction_never_feeds_energy_in_and_never_exceeds_its_limit(
    v_t: float, v_n: float, rate: float, c_t: float, c_n: float, eps: float
):
    f_t, f_n, tau = coulomb_friction(v_t, v_n, rate, c_t, c_n, eps)
    assert f_t * v_t <= 0.0
    assert f_n * v_n <= 0.0
    assert abs(f_t) <= c_t * (1.0 + 1e-15)
    assert abs(f_n) <= c_n * (1.0 + 1e-15)
    assert tau == 0.0


def test_dry_friction_is_independent_of_the_speed_but_for_the_regularization():
    f_t, f_n, _ = coulomb_friction(0.5, -2.0, 0.0, 3.0, 4.0, 1e-3)
    assert (f_t, f_n) == (pytest.approx(-3.0, rel=1e-5), pytest.approx(4.0, rel=1e-5))
    at_eps = coulomb_friction(1e-3, 0.0, 0.0, 3.0, 4.0, 1e-3)[0]
    assert at_eps == pytest.approx(-3.0 / np.sqrt(2.0))


@given(st.tuples(*[velocities] * 3, *[st.floats(0.1, 3.0)] * 3))
def test_every_derivative_of_dry_friction_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    check_complex_steps(coulomb_friction, arguments)


# --- plates ---------------------------------------------------------------------------------------


@given(
    velocities,
    velocities,
    st.floats(0.0, 50.0),
    st.floats(0.0, 7.0),
    st.floats(0.01, 1.57),
    st.floats(0.1, 500.0),
    shares,
)
def test_a_plate_never_feeds_energy_in_all_around_the_circle(
    v_t: float,
    v_n: float,
    area: float,
    slope: float,
    stall: float,
    sharpness: float,
    parasitic: float,
):
    f_t, f_n = plate(v_t, v_n, area, slope, stall, sharpness, parasitic)
    rounding = 1e-13 * np.hypot(f_t, f_n) * np.hypot(v_t, v_n)
    assert f_t * v_t + f_n * v_n <= rounding


@given(angles, st.floats(0.0, 0.3))
def test_the_power_of_a_plate_is_that_of_its_drag_alone(angle: float, parasitic: float):
    _, drag = lift_and_drag(angle, parasitic_drag=parasitic)
    assert drag == pytest.approx(parasitic + 2.0 * abs(np.sin(angle)) ** 3, abs=1e-12)


@given(velocities, velocities)
def test_a_plate_is_the_same_from_both_sides_and_from_both_ends(v_t: float, v_n: float):
    f_t, f_n = plate(v_t, v_n, **PLATE)
    assert plate(v_t, -v_n, **PLATE) == (
        pytest.approx(f_t, abs=1e-13),
        pytest.approx(-f_n, abs=1e-13),
    )
    assert plate(-v_t, v_n, **PLATE) == (
        pytest.approx(-f_t, abs=1e-13),
        pytest.approx(f_n, abs=1e-13),
    )


@given(angles, st.floats(0.1, 5.0))
def test_the_force_on_a_plate_grows_with_the_square_of_the_speed(angle: float, speed: float):
    fast = np.array(plate(*moving(angle, speed), **PLATE))
    np.testing.assert_allclose(
        fast, speed**2 * np.array(plate(*moving(angle), **PLATE)), atol=1e-11
    )


@given(st.floats(0.5, 7.0))
def test_at_small_angles_the_lift_has_its_slope_and_pushes_towards_where_the_flow_goes(
    slope: float,
):
    lift, _ = lift_and_drag(1e-4, lift_slope=slope)
    assert lift == pytest.approx(1e-4 * slope, rel=1e-6)
    # Positive angle of attack: the plate drifts to the right, and is pushed to the left.
    assert plate(*moving(1e-4), **PLATE)[1] > 0.0


def test_at_a_right_angle_a_plate_has_twice_the_dynamic_pressure_and_no_lift():
    lift, drag = lift_and_drag(np.pi / 2.0, parasitic_drag=0.1)
    assert (lift, drag) == (pytest.approx(0.0, abs=1e-12), pytest.approx(2.1))


@given(st.floats(0.75, np.pi / 2.0))
def test_behind_the_stall_the_force_is_normal_to_the_plate(angle: float):
    f_t, f_n = plate(*moving(angle), **PLATE)
    assert abs(f_t) < 1e-3 * abs(f_n)
    assert f_n == pytest.approx(5.0 * 2.0 * np.sin(angle) ** 2, rel=1e-3)


def test_the_lift_drops_at_the_stall_halfway_between_both_laws():
    alpha = AEROSONDE["stall_angle"]
    lift, _ = lift_and_drag(alpha)
    linear, separated = (
        3.45 * np.sin(alpha) * np.cos(alpha),
        2.0 * np.sin(alpha) ** 2 * np.cos(alpha),
    )
    assert lift == pytest.approx(0.5 * (linear + separated), rel=1e-9)
    assert lift_and_drag(alpha - 0.1)[0] > lift > lift_and_drag(alpha + 0.1)[0]


@given(st.floats(-0.1, 0.1), st.floats(20.0, 200.0))
def test_the_flow_separates_as_suddenly_as_the_sharpness_says(beyond: float, sharpness: float):
    sine = np.sin(AEROSONDE["stall_angle"]) + beyond
    lift, _ = lift_and_drag(np.arcsin(sine), sharpness=sharpness)
    separated = (3.45 - lift / (sine * np.sqrt(1.0 - sine * sine))) / (3.45 - 2.0 * sine)
    assert separated == pytest.approx(1.0 / (1.0 + np.exp(-sharpness * beyond)), abs=1e-6)


def test_before_and_behind_the_stall_the_lift_is_that_of_the_textbook():
    def textbook(alpha: float, slope: float, stall: float, sharpness: float) -> float:
        minus, plus = np.exp(-sharpness * (alpha - stall)), np.exp(sharpness * (alpha + stall))
        blend = (1.0 + minus + plus) / ((1.0 + minus) * (1.0 + plus))
        return (1.0 - blend) * slope * alpha + blend * 2.0 * np.sign(alpha) * np.sin(
            alpha
        ) ** 2 * np.cos(alpha)

    alphas = np.array([-1.5, -1.0, -0.8, -0.2, -0.1, 0.05, 0.2, 0.8, 1.2, 1.5])
    ours = [lift_and_drag(alpha)[0] for alpha in alphas]
    np.testing.assert_allclose(
        ours, [textbook(alpha, *AEROSONDE.values()) for alpha in alphas], rtol=0.03
    )


def test_a_plate_at_rest_bears_nothing_however_sharp_its_stall():
    assert plate(0.0, 0.0, 5.0, 3.0, 0.4, 1e6, 0.1) == (0.0, 0.0)
    attached, separated = (lift_and_drag(alpha, sharpness=1e6)[0] for alpha in (0.47, 0.48))
    assert attached == pytest.approx(3.45 * np.sin(0.47) * np.cos(0.47))
    assert separated == pytest.approx(2.0 * np.sin(0.48) ** 2 * np.cos(0.48))


@given(
    st.tuples(
        velocities,
        signed,
        st.floats(0.1, 5.0),
        shares,
        st.floats(0.1, 1.4),
        st.floats(1.0, 50.0),
        shares,
    )
)
def test_every_derivative_of_a_plate_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    assume(np.hypot(arguments[0], arguments[1]) > 0.5)
    check_complex_steps(plate, arguments)


# --- compiled -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("law", "arguments"),
    [
        (magnitude, (-0.3,)),
        (plate, (0.5, -0.3, 5.0, 3.0, 0.4, 50.0, 0.1)),
    ],
)
def test_the_laws_compile_for_real_and_for_complex_numbers(
    law: object, arguments: tuple[float, ...]
):
    check_compiled(law, arguments)  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    "law",
    [
        PolynomialDrag(reference_speed=0.7, sway_friction=0.6),
        TotalSpeedDrag(beta=0.3, gamma=0.8),
        CoulombFriction(regularization_speed=0.1),
        ViscousFriction(),
    ],
    ids=lambda law: type(law).__name__,
)
def test_the_formula_of_a_law_with_its_numbers_in_rows_is_the_law(law):
    compiled = for_python(in_numbers(law.formula, Element, MOTION))
    element = Element(0.3, 4.0, 0.1, 0.2)
    for motion in ((0.5, -2.0, 2.0, 3.0), (-0.5, 0.3, 0.8, -1.0), (0.0, 0.0, 0.0, 0.0)):
        np.testing.assert_allclose(
            compiled(*motion, *element, *law.numbers), law(*motion, element), rtol=1e-14
        )
        turned = compiled(*(one + 1e-30j for one in (*motion, *element, *law.numbers)))
        np.testing.assert_allclose(np.real(turned), law(*motion, element), rtol=1e-14, atol=1e-50)
