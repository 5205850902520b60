"""What holds for one number holds for lanes: every function that the kernels use gives the same in each lane."""

import numpy as np
import pytest
from numba import njit

from laticauda.compiling import (
    PROCESSOR,
    compile_once_across_processes,
    compile_scalar,
    entry,
    for_python,
    functions,
    inner,
    kernel,
    lane_types,
    lanes,
)

WIDTH = 8
rows_of = lane_types.rows_of(WIDTH)
rng = np.random.default_rng(7)


def by_lanes(function, *columns):
    """What `function` gives for eight lanes: one row per number that it returns."""

    @njit(**inner.OPTIONS)
    def run(flat, n_out):
        S = rows_of(flat)
        out = function(S)
        for i in range(n_out):
            S[i] = out[i]

    def call(n_out):
        flat = np.zeros((max(n_out, len(columns)), WIDTH))
        flat[: len(columns)] = columns
        run(flat, n_out)
        return flat[:n_out]

    return call


def test_arithmetic_and_comparisons_go_lane_by_lane():
    where, magnitude = lanes.where, lanes.magnitude

    @njit(**inner.OPTIONS)
    def mixed(S):
        x, y = S[0], S[1]
        total = 0.0
        for i in range(2):
            total += S[i] * 2
        total -= 1
        total *= x
        total /= 3.0
        both = (x > 0.0) & ~(y >= x) | (x == y) ^ (x != x)
        return (
            total,
            where(both, x, 1.0),
            where(x.real < 0.5, 1.0, 0.0),
            magnitude(x) + abs(y) - (-x),
            (x * x) ** 0.5 + np.sqrt(y * y),
            max(min(x, 0.3), y),
            np.floor(4.0 * x),
            1.0 / (2.0 + x) - y**3.0,
        )

    x, y = rng.uniform(-1, 1, (2, WIDTH))
    expected = (
        (2 * x + 2 * y - 1) * x / 3,
        np.where((x > 0) & ~(y >= x), x, 1.0),
        x < 0.5,
        np.abs(x) + np.abs(y) + x,
        np.abs(x) + np.abs(y),
        np.maximum(np.minimum(x, 0.3), y),
        np.floor(4 * x),
        1 / (2 + x) - y**3,
    )
    np.testing.assert_allclose(by_lanes(mixed, x, y)(8), np.array(expected), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize(
    ("name", "bound"), [("sin", 1e5), ("cos", 1e5), ("tanh", 1.0), ("tanh", 60.0), ("exp", 30.0)]
)
def test_functions_of_lanes_are_those_of_numpy(name, bound):
    function = getattr(np, name)

    @njit(**inner.OPTIONS)
    def one(S):
        return (function(S[0]),)

    for _ in range(50):
        x = rng.uniform(-bound, bound, WIDTH)
        np.testing.assert_allclose(by_lanes(one, x)(1)[0], function(x), rtol=1e-15, atol=3e-16)
        break
    x = np.array([0.0, -0.0, 1e-300, -1e-9, bound, -bound, 0.5, -0.5])
    np.testing.assert_allclose(by_lanes(one, x)(1)[0], function(x), rtol=1e-15, atol=3e-16)


def test_sines_of_floats_and_their_complex_steps_are_right():
    x = np.concatenate((rng.uniform(-1e5, 1e5, 1000), rng.uniform(-4, 4, 1000)))
    sincos = for_python(functions.sincos)
    s, c = np.array([sincos(v) for v in x]).T
    np.testing.assert_allclose(s, np.sin(x), rtol=0, atol=2.3e-16)
    np.testing.assert_allclose(c, np.cos(x), rtol=0, atol=2.3e-16)
    s, c = sincos(1.3 + 1e-30j)
    assert (s.imag, c.imag) == pytest.approx((1e-30 * np.cos(1.3), -1e-30 * np.sin(1.3)), rel=1e-14)


def test_small_numbers_keep_their_digits_in_tanh_and_expm1():
    tanh, expm1 = for_python(functions.tanh), for_python(functions.expm1)
    for x in (1e-18, -3e-9, 1e-3):
        assert tanh(x) == pytest.approx(np.tanh(x), rel=1e-15)
        assert expm1(x) == pytest.approx(np.expm1(x), rel=1e-15)
    assert expm1(-1e9) == -1.0


def test_a_law_that_branches_is_called_lane_by_lane():
    def law(x, y):
        if x > 0.2:
            return x, y
        return -x, 2.0 * y

    call = PROCESSOR.in_lanes(compile_scalar(law))

    @njit(**inner.OPTIONS)
    def both(S):
        a, b = call(S[0], S[1])
        c, d = call(S[0], 3.0)
        return a, b, c, d

    x, y = rng.uniform(-1, 1, (2, WIDTH))
    expected = [np.where(x > 0.2, x, -x), np.where(x > 0.2, y, 2 * y)]
    expected += [expected[0], np.where(x > 0.2, 3.0, 6.0)]
    np.testing.assert_array_equal(by_lanes(both, x, y)(4), expected)


def test_any_lane_sees_a_single_one():
    any_lane = lanes.any_lane

    @njit(**inner.OPTIONS)
    def some(S):
        return (1.0 if any_lane(S[0] > 0.5) else 0.0,)

    x = np.zeros(WIDTH)
    assert not by_lanes(some, x)(1).any()
    x[5] = 1.0
    assert by_lanes(some, x)(1).all()


@pytest.mark.parametrize(
    "take", [kernel, compile_scalar, entry, for_python, compile_once_across_processes]
)
@pytest.mark.parametrize("what", [range, 3, None, "tanh"])
def test_what_is_no_function_is_refused(take, what):
    with pytest.raises(
        ValueError, match=f"`function` must be of class function, got {type(what).__name__}"
    ):
        take(what)
