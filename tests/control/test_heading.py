import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.control import HeadingController, HeadingEstimate

ANGLE = st.floats(-10.0, 10.0)
LAW = HeadingController(gain=0.4, max_offset=math.radians(20))


@given(reference=ANGLE, heading=ANGLE)
def test_the_offset_stays_within_its_limit_and_says_when_it_is_there(reference, heading):
    offset, is_saturated = LAW.offset(heading_ref=reference, heading=heading)
    assert abs(offset) <= LAW.max_offset
    assert is_saturated == (abs(offset) == LAW.max_offset)


@given(heading=ANGLE, error=st.floats(-0.8, 0.8), turns=st.integers(-3, 3))
def test_the_offset_is_the_gain_times_reference_minus_heading_whatever_the_turns(
    heading, error, turns
):
    offset, _ = LAW.offset(heading_ref=heading + error + turns * 2.0 * math.pi, heading=heading)
    assert offset == pytest.approx(0.4 * error, abs=1e-12)


def test_the_robot_turns_the_short_way():
    assert LAW.offset(heading_ref=math.radians(-170), heading=math.radians(170))[0] > 0.0
    assert LAW.offset(heading_ref=math.radians(170), heading=math.radians(-170))[0] < 0.0


def estimates(window, time, heading):
    law = HeadingEstimate(window=window)
    state, seen = law.init(), []
    for t, theta in zip(time.tolist(), heading.tolist(), strict=True):
        state, mean = law.step(state, t, theta)
        seen.append(mean)
    return np.array(seen), state


def test_a_window_of_zero_gives_the_heading_as_it_is():
    time = np.linspace(0.0, 5.0, 101)
    heading = np.sin(time)
    np.testing.assert_array_equal(estimates(0.0, time, heading)[0], heading)


@given(period=st.floats(1.0, 6.0), interval=st.floats(0.02, 0.1), phase=ANGLE, mean=ANGLE)
def test_a_mean_over_a_cycle_is_free_of_the_gaits_ripple(period, interval, phase, mean):
    time = np.arange(0.0, 3.0 * period, interval)
    heading = mean + 0.3 * np.sin(2.0 * math.pi * time / period + phase)
    seen = estimates(period, time, heading)[0][time >= period]
    # What is left is the error of the trapezoids, of the order of 0.3 (omega h)^2 / 12.
    np.testing.assert_allclose(
        seen, mean, atol=0.3 * (2.0 * math.pi * interval / period) ** 2 / 8.0 + 1e-9
    )


@given(window=st.floats(0.3, 4.0), rate=st.floats(-1, 1), start=ANGLE)
def test_a_mean_lags_a_steady_turn_by_half_its_window(window, rate, start):
    time = np.arange(0.0, 3.0 * window, 0.05)
    seen = estimates(window, time, start + rate * time)[0]
    late = time >= window
    np.testing.assert_allclose(seen[late], (start + rate * (time - 0.5 * window))[late], atol=1e-9)
    np.testing.assert_allclose(
        seen[~late], (start + 0.5 * rate * time)[~late], atol=1e-9
    )  # over what there is


def test_a_mean_remembers_one_window_only():
    _, state = estimates(2.0, np.arange(0.0, 100.0, 0.05), np.zeros(2000))
    assert len(state) == 41


def test_time_must_grow():
    law = HeadingEstimate(window=1.0)
    state, _ = law.step(law.init(), 1.0, 0.0)
    with pytest.raises(
        ValueError, match=r"`time` must increase from step to step, got 1\.0 s and then 1\.0 s"
    ):
        law.step(state, 1.0, 0.0)


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"gain": 0.0, "max_offset": 0.3}, r"`gain` must be > 0, got 0\.0"),
        ({"gain": -0.4, "max_offset": 0.3}, r"`gain` must be > 0, got -0\.4"),
        ({"gain": 0.4, "max_offset": 0.0}, r"`max_offset` must be > 0 rad, got 0\.0"),
        (
            {"gain": 0.4, "max_offset": math.inf},
            "`max_offset` must be a finite number in rad, got inf",
        ),
    ],
)
def test_a_controller_that_cannot_steer_is_refused(choices, message):
    with pytest.raises(ValueError, match=message):
        HeadingController(**choices)


def test_a_negative_window_is_refused():
    with pytest.raises(ValueError, match="`window` must be >= 0 s, got -1"):
        HeadingEstimate(window=-1.0)
