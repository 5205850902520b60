from dataclasses import replace

import numpy as np
import pytest

from laticauda.paper import (
    compute_meter_costs,
    find_fin_gains,
    score_null_predictions,
    score_simulations,
)
from laticauda.paper.fin_effect import simulate_band_gains
from laticauda.paper.scores import score_study


def test_a_study_that_meets_every_measurement_has_no_error(following):
    cases = tuple(
        replace(case, run=replace(case.run, forward_velocity=case.measured.forward_velocity))
        for case in following.cases
    )
    perfect = replace(following, cases=cases)
    assert score_simulations(perfect)[0].overall == 0.0
    assert score_simulations(perfect)[0].by_group == (0.0,) * 4


def test_the_overall_error_is_the_mean_of_those_of_the_groups(following):
    for score in score_study(following):
        assert score.overall == pytest.approx(np.mean(score.by_group))
        assert len(score.speeds) == 12


def test_every_way_is_there_once_and_the_chosen_one_comes_first(following):
    assert [score.name for score in score_simulations(following)] == [
        "prescribed joints, 10 rad/s, delay 0 s, raw heading",
        "prescribed joints, 4 rad/s, delay 0 s, raw heading",
        "prescribed joints, 10 rad/s, delay 0 s, cycle-mean heading",
    ]
    assert score_simulations(following)[0].speeds == tuple(
        case.run.forward_velocity for case in following.cases
    )
    assert all(score.n_fitted is None for score in score_simulations(following))


def test_a_stride_from_table_1_predicts_table_2_to_11_percent_with_4_numbers(following):
    errors = {
        score.name: (score.n_fitted, score.overall) for score in score_null_predictions(following)
    }
    assert errors["mean stride per group"] == (4, pytest.approx(11.3, abs=0.05))
    assert errors["constant stride per group"] == (4, pytest.approx(11.7, abs=0.05))
    assert errors["constant stride + fin + eel"] == (3, pytest.approx(12.8, abs=0.05))
    assert errors["constant per group"][1] > 30.0


def test_nothing_of_table_2_goes_into_the_null_models(following):
    faster = replace(
        following,
        cases=tuple(
            replace(case, measured=replace(case.measured, forward_velocity=2.0))
            for case in following.cases
        ),
    )
    for usual, other in zip(
        score_null_predictions(following), score_null_predictions(faster), strict=True
    ):
        assert usual.speeds == other.speeds
        assert usual.overall != other.overall


def test_the_fin_changes_follow_from_the_speeds_and_powers(following):
    gains = find_fin_gains(following.cases)
    assert len(gains) == 6
    for gain in gains:
        before, after = gain.without, gain.with_fin
        assert (before.group.gait, before.measured.case) == (after.group.gait, after.measured.case)
        assert (before.group.has_fin, after.group.has_fin) == (False, True)
        for found, old, new in (
            (
                gain.measured.velocity,
                before.measured.forward_velocity,
                after.measured.forward_velocity,
            ),
            (gain.measured.power, before.measured.mean_power, after.measured.mean_power),
            (
                gain.simulated_change(lambda case: case.run.forward_velocity),
                before.run.forward_velocity,
                after.run.forward_velocity,
            ),
            (
                gain.simulated_change(lambda case: case.run.mechanical_power),
                before.run.mechanical_power,
                after.run.mechanical_power,
            ),
        ):
            assert old * (1.0 + found / 100.0) == pytest.approx(new)
        band = simulate_band_gains(gain)
        assert len(band) == len(before.band)
        assert gain.simulated_change(lambda case: case.run.forward_velocity) in band


def test_the_paper_prints_two_changes_that_do_not_follow_from_its_table(following):
    wrong = [
        (gain.with_fin.figure, gain.measured.misprints)
        for gain in find_fin_gains(following.cases)
        if gain.measured.misprints
    ]
    assert wrong == [
        (15, {"power": (89.04, pytest.approx(89.11, abs=0.005))}),
        (22, {"power": (94.51, pytest.approx(94.91, abs=0.005))}),
    ]


def test_a_meter_of_eel_like_motion_costs_no_less_with_the_fin(following):
    costs = compute_meter_costs(following)
    assert np.mean(costs["eel-like motion, without fin"][0]) == pytest.approx(574, abs=0.5)
    assert np.mean(costs["eel-like motion, with fin"][0]) == pytest.approx(590.7, abs=0.5)
    first = following.cases[0]
    power, speed = first.run.mechanical_power, first.run.forward_velocity
    assert costs[first.group.name][1, 0] == pytest.approx(power / speed)
