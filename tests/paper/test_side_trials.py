from dataclasses import replace
from math import degrees
from unittest.mock import Mock

import numpy as np
import pytest

import laticauda as lc
from laticauda.paper import Coefficients, SideSettings, run_side_trials
from laticauda.trials import Trial


@pytest.fixture(scope="module")
def side():
    settings = SideSettings()
    return run_side_trials(
        replace(
            settings,
            phase_shifts=replace(settings.phase_shifts, step=5 * settings.phase_shifts.step),
        )
    )


def test_the_sweep_has_pd_joints_and_the_papers_coefficients(side):
    values = side.settings.phase_shifts.values
    gait = side.settings.phase_shifts.gait("lateral_undulation", values[2])
    trial = lc.swim(lc.load_robot("mamba"), gait, 30.0, joints="pd")
    assert side.pd_velocity[2] == trial.forward_velocity
    assert side.pd_optimum == values[np.argmax(side.pd_velocity)]
    assert degrees(side.pd_optimum) == pytest.approx(25.0, abs=2.5)


def test_sensitivities_are_taken_at_the_fastest_gait_of_table_1(side):
    assert [(gait.kind, round(degrees(gait.frequency))) for gait in side.settings.gaits] == [
        ("lateral_undulation", 150),
        ("eel_like", 150),
    ]
    gait = side.settings.gaits[0]
    deep, shallow = (
        lc.swim(
            lc.load_robot("mamba"),
            gait,
            environment=replace(lc.load_water("paper-lateral"), depth=depth),
        )
        for depth in (None, 0.06)
    )
    expected = 100.0 * (shallow.forward_velocity / deep.forward_velocity - 1.0)
    assert side.by_depth["lateral_undulation"] == pytest.approx(expected)


def test_the_added_inertia_is_of_no_effect(side):
    assert all(abs(change) < 1e-3 for change in side.by_added_inertia.values())
    assert any(change != 0.0 for change in side.by_added_inertia.values())


# ---- twice the links -----------------------------------------------------------------------------


def test_every_run_is_what_swim_gives_for_that_many_links(side):
    assert len(side.doublings) == 4
    for doubling in side.doublings:
        assert (doubling.shorter.robot.n_links, doubling.longer.robot.n_links) == (10, 20)
        for run in (doubling.shorter, doubling.longer):
            n_links = run.robot.n_links
            trial = lc.swim(lc.load_robot("mamba", n_links=n_links), run.gait, 30.0)
            assert run.forward_velocity == trial.forward_velocity
            assert run.mechanical_power == trial.mechanical_power
            assert run.robot.length == pytest.approx(0.18 * n_links)


def test_what_is_kept_is_the_phase_shift_or_the_number_of_waves(side):
    assert [doubling.in_common for doubling in side.doublings] == [
        "phase shift",
        "number of waves",
    ] * 2
    for doubling in side.doublings:
        ratio = doubling.longer.gait.phase_shift / doubling.shorter.gait.phase_shift
        assert ratio == pytest.approx(1.0 if doubling.in_common == "phase shift" else 0.5)
        assert doubling.longer.gait.amplitude == doubling.shorter.gait.amplitude


def test_changes_are_those_of_speed_and_power(side):
    one = side.doublings[0]
    speed, power = one.shorter.forward_velocity, one.shorter.mechanical_power
    twice = replace(
        one, longer=Mock(spec=Trial, forward_velocity=2 * speed, mechanical_power=5 * power)
    )
    assert twice.velocity_change == pytest.approx(100.0)
    assert twice.power_factor == pytest.approx(5.0)


# ---- all of it -----------------------------------------------------------------------------------


def test_joints_water_and_progress_reach_the_runs():
    told: list[tuple[int, int]] = []
    waters = Coefficients(
        name="mine",
        title="mine",
        waters={
            "eel_like": replace(lc.load_water("paper-eel"), density=900),
            "lateral_undulation": "paper-lateral",
        },
    )
    usual = SideSettings()
    phase_shifts = replace(usual.phase_shifts, high=usual.phase_shifts.low)
    eel = usual.doubled[1:]
    settings = SideSettings(
        phase_shifts=phase_shifts,
        gaits=eel,
        n_links=(3, 4),
        doubled=eel,
        duration=20.0,
        coefficients=waters,
    )
    study = run_side_trials(settings, joints="pd", progress=lambda *what: told.append(what))
    assert study.trial_settings["joints"] == "pd"
    assert told == [(i + 1, 8) for i in range(8)]
    shorter = study.doublings[0].shorter
    water = waters.water("eel_like")
    trial = lc.swim(
        lc.load_robot("mamba", n_links=3), shorter.gait, 20.0, environment=water, joints="pd"
    )
    assert shorter.forward_velocity == trial.forward_velocity


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"n_links": (20, 10)}, r"`n_links` must be two increasing numbers, got \(20, 10\)"),
        ({"n_links": (1, 10)}, r"`n_links\[0\]` must be a whole number >= 2, got 1"),
        ({"duration": 0}, "`duration` must be > 0 s, got 0"),
    ],
)
def test_settings_that_make_no_sense_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        SideSettings(**change)
