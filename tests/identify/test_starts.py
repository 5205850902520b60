"""What a fit says about noise that is not what it was stated to be, and about starts that nobody knows exactly."""

from dataclasses import replace

import numpy as np
import pytest
from identify.trials import FRICTION, ROBOT, WATER, gaits, speeds, within

import laticauda as lc
from laticauda.identify import fit, from_trial, leave_out
from laticauda.identify.problem import make_problem

SHORT = ROBOT.with_links(5)
SIGMA = 0.004
TRUE = 0.2


def tracked(n=2, *, lag=0.0, seed=0, **changes):
    """Paths of a short robot in another water than the trials say, with noise that may be correlated."""
    rng = np.random.default_rng(seed)
    found = []
    for i, gait in enumerate(gaits(n)):
        trial = lc.swim(SHORT, gait, 8.0, environment=replace(WATER, tangential_friction=TRUE))
        noise = rng.standard_normal((trial.time.size, 3))
        for k in range(1, len(noise)):
            noise[k] = lag * noise[k - 1] + np.sqrt(1.0 - lag**2) * noise[k]
        path, heading = (
            trial.center_of_mass + SIGMA * noise[:, :2],
            trial.heading + 2.0 * SIGMA * noise[:, 2],
        )
        seen = replace(trial, center_of_mass=path, heading=heading)
        series = {"center_of_mass": SIGMA, "heading": 2.0 * SIGMA}
        found.append(
            within(
                from_trial(seen, name=f"{i}", series=series, every=4, **changes), environment=WATER
            )
        )
    return found


def named(found, name):
    return [words for words in found.warnings if words.startswith(name)]


def test_a_noisy_first_sample_pushes_only_a_start_that_is_taken_for_exact():
    truth = {FRICTION: TRUE, "water.current_x": 0.0, "water.current_y": 0.0}
    free, exact = (
        fit(tracked(free_start=free), parameters=[*truth], n_starts=1) for free in (True, False)
    )
    assert [one.name for one in free.estimates[3:6]] == [
        "0.start.x",
        "0.start.y",
        "0.start.heading",
    ]
    assert free.status.startswith("3 of 3 parameters identified")
    assert all(
        free[name].interval[0] < value < free[name].interval[1] for name, value in truth.items()
    )
    assert not named(free, "chi^2")
    assert len(exact.estimates) == 3
    assert named(
        exact, "correlated residuals"
    )  # and by the intervals that are wider for it, it is still wrong
    assert (
        max(abs(exact[name].value - value) / exact[name].sigma for name, value in truth.items())
        > 2.5
    )


def test_a_start_that_was_seen_before_the_series_has_the_sensors_noise_for_a_prior():
    (one,) = tracked(1)
    later = replace(
        one, time=one.time[1:], series={name: (v[1:], s) for name, (v, s) in one.series.items()}
    )
    priors = {
        unknown.name: unknown.prior for unknown in make_problem([later], [FRICTION]).unknowns[1:]
    }
    assert priors == {
        "0.start.x": (0.0, SIGMA),
        "0.start.y": (0.0, SIGMA),
        "0.start.heading": (0.0, 2.0 * SIGMA),
    }
    own = make_problem([later], [FRICTION, "start.x"]).unknowns
    assert [unknown.name for unknown in own[1:]] == ["start.x", "0.start.y", "0.start.heading"]
    assert len(make_problem(speeds(2), [FRICTION]).unknowns) == 1


def test_a_trial_that_was_left_out_is_predicted_from_where_it_began():
    found = fit(tracked(), parameters=[FRICTION], n_starts=1)
    off = (leave_out(found).predictions - found.problem.observed) / found.problem.sigma
    assert np.sqrt(np.mean(off**2)) < 1.5


def test_noise_of_another_size_than_stated_is_warned_of_in_both_directions():
    for factor, is_odd in ((1.0, False), (3.0, True), (0.2, True)):
        measured = speeds(12, noise=0.002 * factor)
        warned = named(fit(measured, parameters=[FRICTION], n_starts=1), "chi^2 out of range")
        assert len(warned) == is_odd
    assert not named(fit(measured, parameters=[FRICTION], n_starts=1, noise="estimated"), "chi^2")


def test_a_friction_from_swims_alone_is_not_called_the_waters():
    found = fit(speeds(4), parameters=[FRICTION], n_starts=1)
    assert "`water.tangential_friction`" in named(found, "no coast-down")[0]
    assert not named(fit(speeds(4), parameters=["water.normal_drag"], n_starts=1), "no coast-down")


def test_a_coast_down_says_what_the_friction_is():
    """Of another robot, let go at a speed that nobody knows exactly."""
    still = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.5)
    water = replace(WATER, tangential_friction=0.03)
    trial = lc.swim(SHORT, still, 6.0, environment=water, start=lc.Start(velocity=0.4))
    noise = np.random.default_rng(2).standard_normal(trial.center_of_mass.shape)
    seen = replace(trial, center_of_mass=trial.center_of_mass + 0.003 * noise)
    one = within(
        from_trial(seen, name="glide", series={"center_of_mass": 0.003}, every=4), environment=WATER
    )
    one = within(one, start=replace(one.scenario.start, velocity=0.37))
    found = fit([one], parameters=[FRICTION], n_starts=1)
    assert found.warnings == ()
    low, high = found[FRICTION].interval
    assert low < 0.03 < high < 2.0 * low
    assert 0.37 + found["glide.start.velocity"].value == pytest.approx(0.4, abs=0.02)


def test_a_search_that_is_stopped_keeps_the_best_until_then():
    kept = []

    def stop(values, cost):
        kept.append((values, cost))
        if len(kept) == 3:
            raise KeyboardInterrupt

    for noise in ("known", "estimated"):
        kept.clear()
        found = fit(speeds(4), parameters=[FRICTION], n_starts=2, keep=stop, noise=noise)
        assert named(found, "interrupted")
        assert not found.searches[0].converged
        assert found.values == kept[-1][0] and found.chi2 == pytest.approx(kept[-1][1])
        assert [cost for _, cost in kept] == sorted((cost for _, cost in kept), reverse=True)
