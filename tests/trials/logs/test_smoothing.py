import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.trials.logs.measured_log import fill_gaps
from laticauda.trials.logs.rates import differentiate_signal

coefficients = st.tuples(*[st.floats(-2.0, 2.0)] * 4)


@given(coefficients=coefficients, n=st.integers(5, 60), window=st.floats(0.01, 2.0))
def test_the_slope_of_a_cubic_polynomial_is_exact_to_both_ends(coefficients, n, window):
    time = 3.0 + 0.05 * np.arange(n)
    a, b, c, d = coefficients
    x = time - 4.0
    found = differentiate_signal(time, a + x * (b + x * (c + x * d)), window)
    assert found == pytest.approx(b + x * (2.0 * c + x * 3.0 * d), abs=1e-8)


@given(n=st.integers(2, 7), slope=st.floats(-3.0, 3.0))
def test_even_two_samples_have_a_slope(n, slope):
    time = 0.1 * np.arange(n)
    assert differentiate_signal(time, slope * time, 0.5) == pytest.approx(
        np.full(n, slope), abs=1e-10
    )


def test_one_sample_has_none():
    assert differentiate_signal(np.zeros(1), np.ones((1, 2)), 0.1).tolist() == [[0.0, 0.0]]


def test_columns_do_not_mix():
    time = 0.01 * np.arange(50)
    both = np.stack((time, time**2), axis=1)
    assert differentiate_signal(time, both, 0.1) == pytest.approx(
        np.stack((np.ones(50), 2.0 * time), axis=1), abs=1e-9
    )


def test_noise_shrinks_with_a_longer_window():
    time = 0.01 * np.arange(2000)
    noise = np.random.default_rng(1).normal(size=time.size)
    short, long = (np.std(differentiate_signal(time, noise, window)) for window in (0.1, 0.4))
    assert long < short / 4.0


def test_uneven_samples_are_as_good_as_even_ones():
    rng = np.random.default_rng(2)
    time = 0.01 * (np.arange(1000) + 0.3 * rng.random(1000))
    found = differentiate_signal(time, np.sin(2.0 * time), 0.1)
    assert found[20:-20] == pytest.approx(2.0 * np.cos(2.0 * time)[20:-20], abs=0.01)


def test_a_short_gap_is_a_straight_line():
    time = 0.1 * np.arange(6)
    values = np.array([0.0, 1.0, np.nan, np.nan, 4.0, 7.0])
    found, lost = fill_gaps("x", time, values, 0.3)
    assert found == pytest.approx([0.0, 1.0, 2.0, 3.0, 4.0, 7.0])
    assert np.flatnonzero(lost).tolist() == [2, 3]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            [0, np.nan, np.nan, 3],
            r"`x` must have no gap longer than `longest_gap` = 0.2 s, got one of 0.3 s from 0 s",
        ),
        (
            [np.nan, 1, 2, 3],
            r"`x` must hold numbers at both ends, but it begins at 0.1 s; cut it off with `start`",
        ),
        ([0, 1, np.nan, np.nan], r"`x` must hold numbers at both ends, but it ends at 0.1 s"),
        ([np.nan] * 4, r"`x` must hold numbers, but it holds none from 0 s to 0.3 s"),
    ],
)
def test_a_gap_that_cannot_be_filled_is_named(values, message):
    with pytest.raises(ValueError, match=message):
        fill_gaps("x", 0.1 * np.arange(4), np.array(values, dtype=float), 0.2)
