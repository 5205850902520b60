import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.trials.cycles import (
    course_cycle_mean,
    cycle_mean,
    direction_of,
    interpolated,
    steady_part,
)

PERIODS = st.floats(0.5, 4.0)


@given(period=PERIODS, slope=st.floats(-1.0, 1.0), level=st.floats(-10.0, 10.0))
def test_a_straight_line_is_its_own_cycle_mean(period, slope, level):
    time = np.linspace(0.0, 10.0, 501)
    mean = cycle_mean(time, level + slope * time, np.full_like(time, slope), period)
    np.testing.assert_allclose(mean.value, level + slope * mean.time, atol=1e-11)


@given(period=PERIODS, harmonic=st.integers(1, 3), phase=st.floats(0.0, 6.3))
def test_a_ripple_of_the_gait_has_no_cycle_mean(period, harmonic, phase):
    time = np.linspace(0.0, 10.0, 1001)
    omega = harmonic * 2.0 * np.pi / period
    mean = cycle_mean(
        time, np.sin(omega * time + phase), omega * np.cos(omega * time + phase), period
    )
    assert np.max(np.abs(mean.value)) < 1e-4 * (0.5 * omega) ** 4 * 0.01**2 + 1e-6


def test_the_error_of_a_cycle_mean_falls_with_the_fourth_power_of_the_sampling_step():
    steps = np.geomspace(
        0.1, 0.005, 25
    )  # many, because the place of the ends between samples varies with the step
    errors = []
    for step in steps:
        time = np.arange(0.0, 10.0, step)
        mean = cycle_mean(time, np.exp(0.3 * time), 0.3 * np.exp(0.3 * time), 1.234)
        exact = (np.exp(0.3 * (mean.time + 0.617)) - np.exp(0.3 * (mean.time - 0.617))) / (
            0.3 * 1.234
        )
        errors.append(np.max(np.abs(mean.value - exact)))
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.3)


def test_a_vector_is_averaged_column_by_column():
    time = np.linspace(0.0, 10.0, 501)
    signal, rate = (
        np.stack((time, time**2), axis=1),
        np.stack((np.ones_like(time), 2.0 * time), axis=1),
    )
    mean = cycle_mean(time, signal, rate, 2.0)
    assert mean.value.shape == (mean.time.size, 2)
    np.testing.assert_allclose(mean.value[:, 1], mean.time**2 + 1.0 / 3.0, rtol=1e-12)


def test_a_log_of_exactly_one_cycle_has_one_mean():
    for period in np.linspace(1.0, 3.0, 41):
        time = np.linspace(0.0, period, 34)
        assert cycle_mean(time, time, np.ones_like(time), period).value == pytest.approx(
            [0.5 * period]
        )


def test_interpolation_meets_the_samples_and_is_exact_for_cubics():
    time = np.array([0.0, 0.3, 1.0, 1.1])
    cubic, rate = time**3 - time, 3.0 * time**2 - 1.0
    np.testing.assert_array_equal(interpolated(time, cubic, rate, time[:-1]), cubic[:-1])
    at = np.linspace(0.0, 1.1, 57)
    np.testing.assert_allclose(interpolated(time, cubic, rate, at), at**3 - at, atol=1e-15)


@given(period=st.floats(0.5, 8.0), duration=st.floats(20.0, 100.0))
def test_the_steady_part_is_whole_cycles_at_the_end_after_a_third_and_ten_seconds(period, duration):
    part = steady_part(np.linspace(3.0, 3.0 + duration, 2001), period)
    transient = max(duration / 3.0, 10.0)
    assert part.stop == 3.0 + duration
    assert part.stop - part.start == pytest.approx(part.n_cycles * period)
    assert part.start - 3.0 >= transient - 1e-6
    assert part.start - 3.0 - transient < period + 1e-6  # one more would not fit


def test_a_cycle_that_fits_exactly_is_not_lost_to_rounding():
    for period in np.linspace(0.7, 3.0, 101):
        assert steady_part(np.linspace(0.0, 10.0 + 3 * period, 601), period).n_cycles == 3


@pytest.mark.parametrize(
    ("duration", "period", "message"),
    [
        (2.0, 2.5, r"must span at least 12.5 s for a steady part.* got 2 s"),
        (12.4, 2.5, r"must span at least 12.5 s"),
        (30.0, 40.0, r"must span at least 60 s"),
        (10.0, None, r"must span more than 10 s for a steady part, got 10 s"),
    ],
)
def test_a_run_without_a_steady_part_says_how_long_it_must_be(duration, period, message):
    with pytest.raises(ValueError, match=message):
        steady_part(np.linspace(0.0, duration, 501), period)


def test_the_advised_length_is_enough():
    assert steady_part(np.linspace(0.0, 12.5, 501), 2.5).n_cycles == 1
    assert steady_part(np.linspace(0.0, 60.0, 501), 40.0).n_cycles == 1
    assert steady_part(np.linspace(0.0, 10.1, 501), None).n_cycles is None


def test_a_log_that_is_too_coarse_or_too_short_to_see_a_cycle_is_refused():
    coarse = np.linspace(0.0, 30.0, 31)
    with pytest.raises(
        ValueError, match=r"at least 10 samples per gait cycle of 2.5 s, got one every 1 s"
    ):
        cycle_mean(coarse, coarse, np.ones_like(coarse), 2.5)
    with pytest.raises(ValueError, match="at least 10 samples per gait cycle"):
        steady_part(coarse, 2.5)
    short = np.linspace(0.0, 2.0, 101)
    with pytest.raises(ValueError, match=r"at least one gait cycle of 2.5 s, got 2 s"):
        cycle_mean(short, short, np.ones_like(short), 2.5)
    with pytest.raises(ValueError, match="must have at least 2 samples, got 1"):
        cycle_mean(short[:1], short[:1], short[:1], 2.5)


def test_the_course_of_a_circle_keeps_turning_past_half_a_turn():
    time = np.linspace(0.0, 30.0, 1501)
    path = np.stack((np.sin(0.5 * time), -np.cos(0.5 * time)), axis=1)
    velocity = 0.5 * np.stack((np.cos(0.5 * time), np.sin(0.5 * time)), axis=1)
    course = course_cycle_mean(time, path, velocity, 2.5)
    np.testing.assert_allclose(course.value, 0.5 * course.time, atol=1e-6)


def test_a_robot_that_stands_still_has_no_course():
    with pytest.raises(ValueError, match="must travel to have a course"):
        direction_of(np.array([[1.0, 0.0], [1e-9, 0.0]]))
