import sys
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.paper import load_path_following_settings, run_path_following
from laticauda.trials import following as figures
from laticauda.values.errors import SimulationFailed

SETTINGS = replace(load_path_following_settings(), own=())
ONE = replace(
    SETTINGS,
    duration=15.0,
    joint_laws=("prescribed",),
    groups=(replace(SETTINGS.groups[1], figures=(15,)),),
)


def test_every_case_starts_where_table_2_says_straight_and_at_rest(following):
    assert [case.measured for case in following.cases] == [
        row for group in following.settings.groups for row in group.path_following_cases
    ]
    for case in following.cases:
        row, trial = case.measured, case.trial
        assert trial.center_of_mass[0] == pytest.approx([0.0, row.initial_cross_track_error])
        assert trial.signals["cross_track_error"][0] == pytest.approx(row.initial_cross_track_error)
        assert trial.link_angle[0] == pytest.approx(row.initial_heading)
        assert np.all(trial.center_of_mass_velocity[0] == 0.0)
        assert trial.robot.name == case.group.robot
        assert trial.gait == row.gait


def test_a_case_is_what_run_gives_with_the_same_settings(following):
    case = following.cases[3]
    plant = lc.build_plant(lc.load_robot("mamba-fin"), lc.load_water("paper-lateral"))
    controller = lc.PathFollowing(
        gait=case.measured.gait,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=0.18),
        heading=lc.HeadingController(gain=0.4, max_offset=np.deg2rad(20)),
    )
    start = lc.Start(center_of_mass=(0.0, 1.848), heading=np.deg2rad(7.7))
    trial = lc.run(plant, controller, 18.0, start=start)
    assert np.array_equal(trial.center_of_mass, case.trial.center_of_mass)
    assert case.run.forward_velocity == trial.forward_velocity
    assert case.run.mechanical_power == trial.mechanical_power
    assert case.run.figures == figures.summarize_following(trial)
    assert case.run.joules_per_meter == pytest.approx(trial.joules_per_meter)


def test_the_chosen_run_is_one_of_the_band_and_the_others_differ_in_one_thing(following):
    for case in following.cases:
        assert [run.offset_bandwidth for run in case.band] == [4.0, 10.0]
        assert case.band[1] is case.run
        assert {run.heading_estimate for run in case.band} == {"raw"}
        mean = case.cycle_mean
        assert (mean.joints, mean.offset_bandwidth, mean.heading_estimate) == (
            "prescribed",
            10.0,
            "cycle_mean",
        )
        assert len({run.forward_velocity for run in (*case.band, mean)}) == 3
    assert (
        following.cases[0].cycle_mean.name
        == "prescribed joints, 10 rad/s, delay 0 s, cycle-mean heading"
    )


def test_the_unsteered_speed_is_that_of_swim(following):
    case = following.cases[6]
    assert (
        case.free_velocity
        == lc.swim(lc.load_robot("mamba"), case.measured.gait, 18.0).steady_velocity
    )
    assert [each.free_velocity for each in following.cases[6:9]] == [case.free_velocity] * 3


def test_the_last_third_is_judged_by_its_largest_mean_error_too(following):
    for case in following.cases:
        trial, run = case.trial, case.run
        middle, error = figures.mean_error(
            trial.time, trial.signals["cross_track_error"], trial.period
        )
        last = error[middle >= 12.0]
        assert run.last_third_rms == pytest.approx(np.sqrt(np.mean(last**2)))
        assert run.last_third_largest == pytest.approx(np.max(np.abs(last)))
        assert run.last_third_rms <= run.last_third_largest


def test_a_run_ends_when_it_has_gone_the_distance():
    study = run_path_following(replace(ONE, duration=40.0, distance=1.5))
    (case,) = study.cases
    x = case.trial.center_of_mass[:, 0]
    assert case.run.reached == "distance"
    assert case.run.duration < 40.0
    assert x[-2] < 1.5 <= x[-1]
    assert case.trial.succeeded


def test_a_run_too_short_for_a_figure_has_none():
    (case,) = run_path_following(replace(ONE, distance=0.05)).cases
    assert case.run.duration < 6.0
    assert case.run.steady_velocity is None
    assert case.run.last_third_rms is None
    assert not case.run.converged
    assert case.change_by_the_loop(case.run) is None


def test_progress_counts_up_to_all_runs():
    told: list[tuple[int, int]] = []
    run_path_following(ONE, progress=lambda done, total: told.append((done, total)))
    assert told == [(i, 5) for i in range(1, 6)]


def test_joints_and_bandwidth_outside_the_band_are_run_besides():
    study = run_path_following(ONE, joints="pd", offset_bandwidth=6.0, dt=0.004)
    (case,) = study.cases
    assert [(run.joints, run.offset_bandwidth) for run in case.band] == [
        ("pd", 6.0),
        ("prescribed", 4.0),
        ("prescribed", 10.0),
    ]
    assert case.run is case.band[0]
    assert [run.dt for run in case.band] == [0.004, 0.05, 0.05]
    assert tuple(study.trial_settings[name] for name in ("joints", "offset_bandwidth", "dt")) == (
        "pd",
        6.0,
        0.004,
    )
    assert (case.cycle_mean.joints, study.held_out.run.joints) == ("pd", "pd")


def test_the_held_out_trial_is_said_to_leave_the_published_ranges_by_what_was_logged(following):
    held = following.held_out
    trial = held.trial
    assert trial.heading[0] == pytest.approx(np.deg2rad(-88.3))
    assert trial.center_of_mass[0] == pytest.approx([0.0, 1.97])
    assert trial.gait == lc.eel_like(
        amplitude=np.deg2rad(40), frequency=np.deg2rad(120), phase_shift=np.deg2rad(40)
    )
    assert held.offset == (trial.signals["offset"].min(), trial.signals["offset"].max())
    assert held.velocity[0] < held.mean_velocity[0] <= held.mean_velocity[1] < held.velocity[1]


def test_a_run_that_blows_up_is_named(monkeypatch):
    def fail(*args, **settings):
        raise SimulationFailed("The run blew up at 3 s.")

    monkeypatch.setattr(sys.modules["laticauda.paper.runs"], "run_scenario", fail)
    message = "lateral undulation, with fin, unsteered, joints prescribed, bandwidth 10 rad/s: The run blew up at 3 s."
    with pytest.raises(SimulationFailed, match=message):
        run_path_following(ONE)


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"joints": "magic"}, "`joints` must be one of"),
        ({"model": "magic"}, "`model` must be one of"),
        ({"offset_bandwidth": 0.0}, "`offset_bandwidth` must be > 0 1/s, got 0.0"),
    ],
)
def test_a_bad_choice_is_refused(choices, message):
    with pytest.raises(ValueError, match=message):
        run_path_following(ONE, **choices)


@pytest.mark.parametrize("group", SETTINGS.groups, ids=lambda group: group.name)
def test_the_papers_gains_keep_every_group_within_5_cm_with_prescribed_joints_and_a_fast_filter(
    group,
):
    settings = replace(
        SETTINGS,
        groups=(replace(group, figures=group.figures[:1]),),
        joint_laws=("prescribed",),
        offset_bandwidths=(10.0,),
    )
    (case,) = run_path_following(settings).cases
    assert case.run.converged
    assert case.run.last_third_largest < 0.05
    assert (
        case.cycle_mean.last_third_largest > 0.05
    )  # the mean heading is late, and the look-ahead distance short
