import pytest
from hypothesis import given, strategies as st

from laticauda.tank.operate.procedure.clocks import update_clock
from laticauda.tank.operate.procedure.state import MeanCurrent


@given(st.floats(-100, 100), st.lists(st.floats(0.0, 0.2), min_size=3, max_size=30))
def test_the_clock_offset_is_never_less_than_the_truth_and_off_by_the_smallest_latency(
    offset, latencies
):
    state = None
    for k, latency in enumerate(latencies):
        stamp = 0.01 * k
        state = update_clock(state, stamp + offset + latency, stamp, window=5.0)
    assert state is not None
    assert state.offset == pytest.approx(offset + min(latencies), abs=1e-9)


def test_the_smallest_latency_of_the_window_before_still_counts_in_the_next():
    state = None
    for k in range(10):
        state = update_clock(state, 0.1 * k + 7.0, 0.1 * k, window=1.0)
    for arrival in (8.05, 8.5, 8.9):  # the next window, in which every frame is late
        state = update_clock(state, arrival, arrival - 7.0 - 0.03, window=1.0)
        assert state.offset == pytest.approx(7.0)
    assert update_clock(state, 9.06, 9.06 - 7.0 - 0.03, window=1.0).offset == pytest.approx(7.03)


def offsets(stamps, seconds):
    """The offset at every frame, for a clock of the cameras `stamps(t)` that is read at 100 Hz."""
    state, found = None, []
    for k in range(round(100 * seconds)):
        state = update_clock(state, 0.01 * k, stamps(0.01 * k), window=1.0)
        found.append(state.offset)
    return found


def test_a_clock_that_runs_slower_is_followed():
    assert offsets(lambda t: t * (1.0 - 5e-5) - 3.0, 100)[-1] == pytest.approx(
        3.0 + 100.0 * 5e-5, abs=2e-4
    )


@given(st.floats(-30.0, 30.0))
def test_a_clock_that_jumps_is_believed_again_after_two_windows(jump):
    assert offsets(lambda t: t - jump * (t > 3.0), 6)[-90:] == pytest.approx([jump] * 90)


def test_a_clock_that_was_not_seen_for_long_begins_anew():
    assert (
        update_clock(update_clock(None, 0.0, 5.0, window=1.0), 2.0, 1.0, window=1.0).offset == 1.0
    )


def test_the_mean_current_is_that_of_all_readings_and_none_without_one():
    mean = MeanCurrent()
    assert mean.mean is None
    for value in (1.0, 2.0, 6.0):
        mean = mean.step(value)
    assert (mean.mean, mean.count) == (3.0, 3)
