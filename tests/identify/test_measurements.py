from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from identify.trials import FRICTION, ROBOT, WATER, gaits

import laticauda as lc
from laticauda.identify import Measurement, fit, from_table1, from_trial
from laticauda.identify.problem import make_problem
from laticauda.identify.selection_bias import mean_of_the_greatest
from laticauda.scenarios import Experiment

GAIT = gaits(1)[0]
SCENARIO = lc.build_scenario(ROBOT, GAIT)
TIME = np.linspace(0.0, 2.0, 5)


def one(**fields):
    return Measurement(
        **({"name": "a", "scenario": SCENARIO, "figures": {"x": (1.0, 0.1)}} | fields)
    )


@given(st.integers(1, 40))
def test_the_greatest_of_more_numbers_is_greater(n):
    assert mean_of_the_greatest(n) < mean_of_the_greatest(n + 1)


def test_the_greatest_of_a_few_numbers_is_known():
    known = {1: 0.0, 2: 1 / np.sqrt(np.pi), 3: 1.5 / np.sqrt(np.pi), 10: 1.53875}
    assert {n: mean_of_the_greatest(n) for n in known} == pytest.approx(known, abs=1e-5)
    with pytest.raises(ValueError, match="`n` must be a whole number >= 1"):
        mean_of_the_greatest(0)


def test_speeds_that_were_selected_lose_their_bias_and_powers_do_not():
    chosen = one(
        figures={"forward_velocity": (0.2, 0.01), "mean_power": (90.0, 5.0)}, selected_from=2
    )
    assert chosen.without_bias("forward_velocity") == pytest.approx(0.2 - 0.01 / np.sqrt(np.pi))
    assert chosen.without_bias("mean_power") == 90.0


def test_table_1_has_twenty_speeds_of_which_twelve_less_two_are_selected():
    # Two of the twelve stars stand at settings whose numbers are not printed.
    rows = from_table1()
    assert len(rows) == 20 and len({row.name for row in rows}) == 20
    assert sum(row.selected_from > 1 for row in rows) == 12
    value, sigma = rows[0].figures["forward_velocity"]
    assert (value, sigma) == (0.1514, pytest.approx(0.05 * 0.1514))
    assert rows[0].name == "lateral undulation, without fin, 30/130/40"
    powers = from_table1("mean_power", sigma=0.1)
    assert len(powers) == 18
    with pytest.raises(ValueError, match="`figure` must be one of"):
        from_table1("heading")


def test_a_trial_becomes_what_was_asked_for_of_it():
    trial = lc.swim(
        ROBOT, GAIT, 4.0, environment=WATER, start=lc.Start(center_of_mass=(1.0, 2.0), heading=0.1)
    )
    figures = {"forward_velocity": 0.01, "y": 0.02}
    seen = from_trial(trial, name="a", figures=figures, series={"center_of_mass": 0.01}, every=20)
    start = seen.scenario.start
    assert start.center_of_mass == pytest.approx((1.0, 2.0)) and start.heading == pytest.approx(0.1)
    assert seen.figures["y"] == (trial.center_of_mass[-1, 1], 0.02)
    np.testing.assert_array_equal(seen.series["center_of_mass"][0], trial.center_of_mass[::20])
    assert seen.scenario.duration == 4.0
    assert seen.scenario.motion is trial.gait and seen.scenario.environment is trial.environment
    unknown = Experiment(robot=trial.robot, environment=trial.environment)
    with pytest.raises(ValueError, match="`trial` must have a gait"):
        from_trial(replace(trial, scenario=unknown), name="a", figures=figures)
    with pytest.raises(ValueError, match="`figures` must be one of"):
        from_trial(trial, name="a", figures={"speed": 0.1})


@pytest.mark.parametrize("model", [None, "planar"])
def test_a_fit_begins_as_smoothly_as_the_trial_did(model):
    trial = lc.swim(ROBOT, GAIT, 8.0, environment=WATER, ramp=3.0)
    measurement = from_trial(trial, name="a", series={"center_of_mass": 0.01}, every=20)
    problem = make_problem([measurement], ["water.normal_drag"], model=model)
    (used,) = problem.measurements
    assert used.scenario.model.ramp == 3.0
    identified = fit([measurement], parameters=["water.normal_drag"], model=model, n_starts=1)
    assert identified.values["water.normal_drag"] == pytest.approx(WATER.normal_drag, rel=1e-6)
    (changed,) = make_problem([measurement], ["water.normal_drag"], ramp=0.5).measurements
    assert changed.scenario.model.ramp == 0.5
    usual = from_trial(lc.swim(ROBOT, GAIT, 1.0), name="a", figures={"x": 0.1})
    assert usual.scenario.model == lc.Planar()


def test_trials_of_a_changed_robot_are_refused_by_what_may_have_changed_it():
    joints = tuple(replace(joint, stiffness=0.5) for joint in ROBOT.joints)
    changed = replace(ROBOT, joints=joints)
    measurement = from_trial(lc.swim(changed, GAIT, 1.0), name="a", figures={"x": 0.1})
    message = "modules or joints are not those of .*: one of the two was changed, as by identified"
    with pytest.raises(ValueError, match=message):
        make_problem([measurement], ["water.normal_drag"], ROBOT)


def test_trials_that_began_in_different_ways_are_not_fitted_as_one():
    measurements = [
        from_trial(lc.swim(ROBOT, GAIT, 1.0, ramp=ramp), name=f"{ramp}", figures={"x": 0.1})
        for ramp in (1.0, 2.0)
    ]
    with pytest.raises(ValueError, match=r"must all be of one model, got another one in `2\.0`"):
        make_problem(measurements, ["water.normal_drag"])


@pytest.mark.parametrize(
    "fields, words",
    [
        ({"name": " "}, "`name` must be a non-empty text"),
        ({"figures": {}}, "`figures` or `series` of `a` must hold something"),
        (
            {"figures": {"x": (np.nan, 0.1)}},
            r"`figures\['x'\]` of `a` must be a finite number in m, got nan",
        ),
        ({"figures": {"x": (1.0, 0.0)}}, "must be > 0 m"),
        ({"figures": {"x": (1.0, 1e-200)}}, "must be >= 1e-09 m"),
        ({"figures": {"x": (1e200, 0.1)}}, r"must be <= 1e\+07 m"),
        ({"figures": {"speed": (1.0, 0.1)}}, "`figures` of `a` must be one of"),
        ({"selected_from": 0}, "`selected_from` of `a` must be a whole number >= 1"),
        ({"time": TIME}, "`time` of `a` must be given with series, and only with series"),
        (
            {"time": TIME, "series": {"heading": (np.zeros(4), 0.1)}},
            r"must have shape \(5\), got \(4,\)",
        ),
        (
            {"time": TIME, "series": {"center_of_mass": (np.zeros((5, 3)), 0.1)}},
            r"must have shape \(5, 2\)",
        ),
        (
            {"time": TIME, "series": {"heading": (np.full(5, np.nan), 0.1)}},
            "finite numbers only, got nan at sample 0",
        ),
        (
            {"time": TIME, "series": {"heading": (np.full(5, 1e200), 0.1)}},
            r"numbers up to 1e\+12, got 1e\+200",
        ),
        (
            {"time": TIME[::-1], "series": {"heading": (np.zeros(5), 0.1)}},
            "`time` of `a` must increase strictly",
        ),
        (
            {"time": TIME + 29.0, "series": {"heading": (np.zeros(5), 0.1)}},
            "between 0 and its `duration` of 30 s",
        ),
    ],
)
def test_bad_measurements_are_refused_by_name(fields, words):
    with pytest.raises(ValueError, match=words):
        one(**fields)


def test_every_sample_of_a_series_may_have_its_own_noise():
    time = np.array([0.5, 1.0, 1.5])
    path = np.arange(6.0).reshape(3, 2)
    noise = 0.01 * (1.0 + path)

    def measure(sigma):
        return Measurement(
            name="path", scenario=SCENARIO, time=time, series={"center_of_mass": (path, sigma)}
        )

    problem = make_problem([measure(noise)], [FRICTION])
    np.testing.assert_array_equal(problem.sigma, noise.ravel())
    starts = measure(noise).starts
    assert starts["start.x"].sd == pytest.approx(np.sqrt(np.mean(noise[0] ** 2)))
    assert starts["start.heading"] is None
    alike = make_problem([measure(np.full((3, 2), 0.02))], [FRICTION])
    np.testing.assert_array_equal(alike.sigma, make_problem([measure(0.02)], [FRICTION]).sigma)
    with pytest.raises(ValueError, match=r"`sigma of series.* must have shape \(3, 2\)"):
        measure(noise[:2])
    with pytest.raises(ValueError, match=r"`sigma of series.* must be > 0, got -0\.06"):
        measure(-noise)
