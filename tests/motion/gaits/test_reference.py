import math
from typing import Any

import numpy as np
import pytest
from derivatives import check_compiled, check_complex_steps
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp  # pyright: ignore[reportUnknownVariableType]  # has no types

from laticauda.motion.gaits.reference import (
    WaveMotion,
    filter_acceleration,
    filter_step,
    ramped,
    smooth_start,
    wave_reference,
)

values = st.floats(-2.0, 2.0)
# Of these a solver may square its errors: 0 / 0 is none of the filter's.
not_minute = values.filter(lambda value: value == 0.0 or abs(value) > 1e-100)
bandwidths = st.floats(0.5, 30.0)
steps = st.floats(0.0, 2.0)
durations = st.floats(0.2, 5.0)


def first_joint(*numbers: float) -> tuple[float, float, float]:
    """The reference of a wave's first joint."""
    sine, cosine, envelope, a, a_1, a_2, f, f_1, o, o_1, o_2 = numbers
    return wave_reference(
        sine, cosine, envelope, 0.0, WaveMotion(a, a_1, a_2, f, f_1, 0.0, 0.0, o, o_1, o_2)
    )


def advance(
    y: float, rate: float, target: float, w: float, dt: float
) -> tuple[float, float, float]:
    return filter_step(y, rate, target, w, math.exp(-w * dt), dt)


# --- the filter -----------------------------------------------------------------------------------


@given(values, values, values, bandwidths, steps, st.integers(2, 20))
def test_many_small_steps_of_the_filter_are_one_large_one(
    y: float, rate: float, target: float, w: float, dt: float, n: int
):
    once = advance(y, rate, target, w, dt)
    total = 0.0
    for _ in range(n):
        y, rate, part = advance(y, rate, target, w, dt / n)
        total += part
    np.testing.assert_allclose((y, rate, total), once, rtol=0.0, atol=1e-11)


@settings(max_examples=20)
@given(not_minute, not_minute, not_minute, st.floats(0.5, 10.0), st.floats(0.05, 2.0))
def test_a_step_of_the_filter_solves_its_differential_equation(
    y: float, rate: float, target: float, w: float, dt: float
):
    def slope(_: float, z: np.ndarray) -> list[float]:
        return [z[1], w * w * (target - z[0]) - 2.0 * w * z[1], z[0]]

    solver: Any = solve_ivp  # pyright: ignore[reportUnknownVariableType]
    solution = solver(slope, (0.0, dt), [y, rate, 0.0], method="DOP853", rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(
        advance(y, rate, target, w, dt), solution.y[:, -1], rtol=0.0, atol=1e-10
    )


@given(values, values, values, bandwidths)
def test_the_filters_acceleration_is_the_derivative_of_its_rate(
    y: float, rate: float, target: float, w: float
):
    def rate_at(t: float) -> float:
        return advance(y, rate, target, w, t)[1]

    h = 1e-4
    slope = (8.0 * (rate_at(h) - rate_at(-h)) - rate_at(2.0 * h) + rate_at(-2.0 * h)) / (12.0 * h)
    assert filter_acceleration(y, rate, target, w) == pytest.approx(slope, rel=1e-6, abs=1e-6)


@given(values, values, bandwidths)
def test_the_filter_comes_to_rest_at_its_target_without_overshoot_from_rest(
    y: float, target: float, w: float
):
    end, rate, _ = advance(y, 0.0, target, w, 60.0 / w)
    assert (end, rate) == (pytest.approx(target, abs=1e-12), pytest.approx(0.0, abs=1e-12))
    on_the_way = [advance(y, 0.0, target, w, t / w)[0] for t in np.linspace(0.0, 10.0, 50)]
    distance = np.abs(np.array(on_the_way) - target)
    assert np.all(np.diff(distance) <= 1e-12)
    assert np.all((np.array(on_the_way) - target) * (y - target) >= -1e-12)


@given(values, bandwidths, steps)
def test_a_filter_at_its_target_stays_there_and_integrates_it(target: float, w: float, dt: float):
    end, rate, integral = advance(target, 0.0, target, w, dt)
    assert (end, rate) == (target, 0.0)
    assert integral == pytest.approx(target * dt, rel=1e-15)


# --- the smooth start -----------------------------------------------------------------------------


@given(durations)
def test_the_smooth_start_is_exact_at_both_ends(duration: float):
    assert smooth_start(0.0, duration) == (0.0, 0.0, 0.0)
    assert smooth_start(duration, duration) == (1.0, 0.0, 0.0)
    assert smooth_start(2.0 * duration, duration) == (1.0, 0.0, 0.0)


@given(durations)
def test_the_smooth_start_joins_its_end_with_two_derivatives(duration: float):
    just_before = smooth_start(duration * (1.0 - 1e-7), duration)
    np.testing.assert_allclose(just_before, (1.0, 0.0, 0.0), atol=1e-4 / duration**2)


@given(st.floats(0.01, 0.99), durations)
def test_rate_and_acceleration_of_the_smooth_start_are_its_derivatives(s: float, duration: float):
    t, h = s * duration, 1e-4 * duration * min(s, 1.0 - s)
    _, rate, acceleration = smooth_start(t, duration)
    (before, rate_before, _), (after, rate_after, _) = (
        smooth_start(t - h, duration),
        smooth_start(t + h, duration),
    )
    assert rate == pytest.approx((after - before) / (2.0 * h), rel=1e-5, abs=1e-8 / duration)
    assert acceleration == pytest.approx(
        (rate_after - rate_before) / (2.0 * h), rel=1e-5, abs=1e-5 / duration**2
    )


@given(st.floats(0.0, 1.0), durations)
def test_the_smooth_start_only_rises_and_is_the_same_backward(s: float, duration: float):
    value, rate, _ = smooth_start(s * duration, duration)
    assert 0.0 <= value <= 1.0 + 1e-15
    assert rate >= 0.0
    assert value + smooth_start((1.0 - s) * duration, duration)[0] == pytest.approx(1.0)


def test_without_a_duration_there_is_no_start():
    assert smooth_start(0.0, 0.0) == (1.0, 0.0, 0.0)
    assert smooth_start(0.5, 1.0)[0] == pytest.approx(0.5)


# --- the wave -------------------------------------------------------------------------------------


@given(values, values, values, st.floats(0.0, 1.0))
def test_the_ramped_amplitude_is_a_product_with_its_derivatives(
    a: float, b: float, c: float, t: float
):
    def product(t: float) -> tuple[float, float, float]:
        return ramped(a + b * t + c * t * t, b + 2.0 * c * t, 2.0 * c, *smooth_start(t + 0.5, 2.0))

    h = 1e-5
    before, here, after = product(t - h), product(t), product(t + h)
    assert here[0] == pytest.approx((a + b * t + c * t * t) * smooth_start(t + 0.5, 2.0)[0])
    assert here[1] == pytest.approx((after[0] - before[0]) / (2.0 * h), abs=1e-7)
    assert here[2] == pytest.approx((after[1] - before[1]) / (2.0 * h), abs=1e-7)


@given(st.tuples(*[values] * 8, st.floats(0.0, 3.0)))
def test_rate_and_acceleration_of_a_joint_are_the_derivatives_of_its_angle(
    drawn: tuple[float, ...],
):
    """Amplitude, phase and offset as parabolas in time."""
    g, a0, a1, psi1, psi2, b0, b1, b2, t = drawn

    def joint(t: float) -> tuple[float, float, float]:
        psi = psi1 * t + 0.5 * psi2 * t * t
        return first_joint(
            math.sin(psi),
            math.cos(psi),
            g,
            a0 + a1 * t + 0.5 * t * t,
            a1 + t,
            1.0,
            psi1 + psi2 * t,
            psi2,
            b0 + b1 * t + 0.5 * b2 * t * t,
            b1 + b2 * t,
            b2,
        )

    h = 1e-5
    before, here, after = joint(t - h), joint(t), joint(t + h)
    scale = 1.0 + max(map(abs, here)) * 10.0
    assert here[1] == pytest.approx((after[0] - before[0]) / (2.0 * h), abs=1e-6 * scale)
    assert here[2] == pytest.approx((after[1] - before[1]) / (2.0 * h), abs=1e-6 * scale)


def test_a_settled_joint_is_the_papers_gait():
    angle, rate, acceleration = first_joint(
        math.sin(0.9), math.cos(0.9), 0.8, 0.5, 0, 0, 2.0, 0, 0.1, 0, 0
    )
    assert angle == pytest.approx(0.8 * 0.5 * math.sin(0.9) + 0.1)
    assert rate == pytest.approx(0.8 * 0.5 * 2.0 * math.cos(0.9))
    assert acceleration == pytest.approx(-0.8 * 0.5 * 4.0 * math.sin(0.9))


# --- derivatives and compilation ------------------------------------------------------------------


@given(
    st.tuples(values, values, values, st.floats(0.5, 5.0), st.floats(0.1, 1.0), st.floats(0.1, 1.0))
)
def test_every_derivative_of_the_filter_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    check_complex_steps(filter_step, arguments)
    check_complex_steps(filter_acceleration, arguments[:4])


@given(st.floats(0.1, 0.9), st.floats(1.0, 3.0), st.floats(1.1, 2.0))
def test_every_derivative_of_the_start_by_complex_step_is_that_by_differences(
    s: float, duration: float, late: float
):
    check_complex_steps(smooth_start, (s * duration, duration))
    check_complex_steps(smooth_start, (late * duration, duration))


@given(st.tuples(*[values] * 11))
def test_every_derivative_of_a_joint_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    check_complex_steps(first_joint, arguments)
    check_complex_steps(ramped, arguments[:6])


@pytest.mark.parametrize(
    ("law", "arguments"),
    [
        (filter_step, (0.1, 0.2, 0.3, 10.0, math.exp(-0.2), 0.02)),
        (filter_acceleration, (0.1, 0.2, 0.3, 10.0)),
        (smooth_start, (0.3, 1.0)),
        (smooth_start, (1.3, 1.0)),
        (ramped, (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)),
        (first_joint, (0.6, 0.8, 0.9, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)),
    ],
)
def test_the_laws_compile_for_real_and_for_complex_numbers(
    law: object, arguments: tuple[float, ...]
):
    check_compiled(law, arguments)  # pyright: ignore[reportArgumentType]
