import numpy as np
import pytest
from hypothesis import given, strategies as st

import laticauda as lc
from laticauda.control import Following
from laticauda.trials import following

PERIOD = 4.0
TIME = np.arange(0.0, 90.0 + 1e-9, 0.05)
ALONG = 0.1 * TIME
RIPPLE = 0.03 * np.sin(2.0 * np.pi * TIME / PERIOD)


def approach(start, *, end=0.0, rate=0.2):
    return end + (start - end) * np.exp(-rate * TIME)


def test_convergence_is_when_the_mean_stays_within_the_tolerance():
    reached = following.convergence(TIME, approach(1.0) + RIPPLE, ALONG, PERIOD)
    # The mean over a cycle of exp(-0.2 t) is larger by sinh(0.4)/0.4.
    expected = np.log(10.0 * np.sinh(0.4) / 0.4) / 0.2
    assert reached.time == pytest.approx(expected, abs=0.06)
    assert reached.distance == pytest.approx(0.1 * reached.time)


def test_a_run_that_starts_on_the_path_has_converged_at_once():
    reached = following.convergence(TIME, RIPPLE, ALONG, PERIOD)
    assert reached.time == pytest.approx(
        PERIOD / 2
    )  # the first moment with a whole cycle around it


def test_a_visit_shorter_than_a_cycle_is_no_convergence():
    passing = 0.5 - 0.1 * TIME
    assert following.convergence(TIME, passing, ALONG, PERIOD) is None
    assert following.convergence(TIME, approach(1.0, end=0.2), ALONG, PERIOD) is None
    then_there = np.where(TIME < 40.0, np.abs(passing), 0.0)
    assert following.convergence(TIME, then_there, ALONG, PERIOD).time > 40.0


def test_a_run_that_leaves_its_path_again_does_not_stay():
    swing = 0.4 * np.cos(2.0 * np.pi * TIME / 60.0)  # crosses the path, and ends 0.4 m off
    assert following.convergence(TIME, swing + RIPPLE, ALONG, PERIOD) is not None
    late = following.last_cycles_error(TIME, swing + RIPPLE, PERIOD)
    assert late == pytest.approx(0.39, rel=0.02)
    near = following.last_cycles_error(TIME, 0.05 + approach(1.0, rate=0.5) + RIPPLE, PERIOD)
    assert near == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(
    ("time", "error", "stays"),
    [(20.0, 0.1, True), (20.0, 0.11, False), (20.0, None, False), (None, 0.05, False)],
)
def test_a_run_stays_if_it_came_and_is_there_at_the_end(time, error, stays):
    assert following.stays({"convergence_time": time, "last_cycles_error": error}) is stays


@given(start=st.floats(0.2, 3.0), side=st.sampled_from([-1.0, 1.0]), past=st.floats(0.0, 0.5))
def test_overshoot_is_what_lies_on_the_other_side(start, side, past):
    error = side * (approach(start, end=-past))
    assert following.overshoot(TIME, error + 0.1 * RIPPLE, PERIOD) == pytest.approx(past, abs=2e-3)


def test_without_a_change_of_side_there_is_no_overshoot():
    assert following.overshoot(TIME, approach(1.0, end=0.1), PERIOD) == 0.0


def test_error_and_ripple_add_up():
    error = 0.02 + RIPPLE
    assert following.steady_error(TIME, error, PERIOD, 30.0) == pytest.approx(0.02, rel=1e-6)
    assert following.ripple(TIME, error, PERIOD, 30.0) == pytest.approx(
        0.03 / np.sqrt(2.0), rel=1e-3
    )
    assert following.last_third_error(TIME, -error, PERIOD) == pytest.approx(-0.02, rel=1e-6)


def test_the_last_third_is_of_the_run_and_not_of_the_clock():
    assert following.last_third_error(
        TIME + 1000.0, approach(1.0, end=0.3), PERIOD
    ) == pytest.approx(0.3, abs=1e-4)


def test_the_share_of_saturation_is_one_of_time():
    time = np.array([0.0, 1.0, 4.0, 5.0])
    assert following.saturated_share(time, np.array([0.0, 1.0, 0.0, 1.0])) == pytest.approx(0.6)


def test_what_has_no_meaning_is_refused():
    with pytest.raises(
        ValueError, match="`start` must be <= 88 s, the middle of the last gait cycle, got 89 s"
    ):
        following.ripple(TIME, RIPPLE, PERIOD, 89.0)
    with pytest.raises(ValueError, match="`time` must span at least one gait cycle"):
        following.overshoot(TIME[:20], RIPPLE[:20], PERIOD)
    with pytest.raises(
        ValueError, match="`time` must have at least 3 samples for a mean over a cycle, got 2"
    ):
        following.overshoot(TIME[:2], RIPPLE[:2], PERIOD)
    with pytest.raises(ValueError, match="`tolerance` must be > 0 m, got 0"):
        following.convergence(TIME, RIPPLE, ALONG, PERIOD, 0.0)
    with pytest.raises(
        ValueError, match="`time` must have at least 2 samples for a share of time, got 1"
    ):
        following.saturated_share(TIME[:1], RIPPLE[:1])


def test_a_run_that_followed_no_path_has_no_such_figures(make_trial):
    with pytest.raises(
        ValueError, match="`trial` must be a run that followed a path: it has no signal"
    ):
        following.summarize_following(make_trial())


def test_a_run_that_goes_on_behind_the_end_of_its_path_says_when_it_was_there():
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)

    def end_of(*waypoints):
        trial = lc.swim("mamba-fin", Following(waypoints=waypoints).controller(gait), 15.0)
        return following.summarize_following(trial)["end_time"], trial

    passed, trial = end_of((0.0, 0.0), (1.0, 0.0))
    assert np.interp(passed, trial.time, trial.center_of_mass[:, 0]) == pytest.approx(1.0, abs=0.03)
    assert end_of((0.0, 0.0), (100.0, 0.0))[0] is None


def cut(whole: lc.Trial, begin: float, end: float) -> lc.Trial:
    """A run of which nothing was recorded between two times, as if the computer had stood still."""
    kept = (whole.time < begin) | (whole.time > end)
    names = ("time", "center_of_mass", "center_of_mass_velocity", "joint_angle", "joint_rate")
    series = {name: getattr(whole, name)[kept] for name in (*names, "link_angle", "heading")}
    return lc.Trial.measured(
        series,
        signals={name: signal[kept] for name, signal in whole.signals.items()},
        scenario=whole.scenario,
        version=whole.version,
    )


@pytest.fixture(scope="module")
def followed() -> lc.Trial:
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    return lc.swim("mamba-fin", Following().controller(gait), 20.0)


def test_a_run_that_was_cut_has_no_error_of_its_last_third_and_the_figures_that_it_allows(followed):
    figures = following.summarize_following(cut(followed, 8.0, 19.99))
    assert figures["last_third_error"] is None
    assert figures["overshoot"] is not None
    assert following.summarize_following(followed)["last_third_error"] is not None


def test_a_run_that_was_cut_soon_has_too_few_samples_for_any_mean_over_a_cycle(followed):
    figures = following.summarize_following(cut(followed, 0.7, 19.9))
    assert figures["overshoot"] is figures["convergence_time"] is None
    assert figures["saturated_share"] is not None
