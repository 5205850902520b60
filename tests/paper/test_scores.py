from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from laticauda.paper.scores import score_study
from laticauda.trials.null_models import mape

SPEEDS = arrays(float, 7, elements=st.floats(0.01, 1.0))


@given(SPEEDS)
def test_a_perfect_model_has_no_error(measured):
    assert mape(measured, measured) == 0.0


@given(SPEEDS, st.floats(-0.9, 3.0))
def test_a_model_that_is_off_by_a_factor_has_that_error(measured, share):
    assert mape(measured, (1.0 + share) * measured) == pytest.approx(100.0 * abs(share))


def test_errors_of_what_cannot_be_compared_are_refused():
    with pytest.raises(ValueError, match="`predicted` must have 2 values, at least 1, got 3"):
        mape(np.ones(2), np.ones(3))
    with pytest.raises(ValueError, match="at least 1, got 0"):
        mape(np.ones(0), np.ones(0))
    with pytest.raises(ValueError, match=r"`measured` must be > 0, got 0\.0"):
        mape(np.zeros(2), np.ones(2))


def test_a_study_that_meets_every_measurement_has_no_error(study):
    perfect = [
        replace(
            case, forward_velocity=(case.measured.forward_velocity or 1.0, case.forward_velocity[1])
        )
        for case in study.cases
    ]
    first = score_study(replace(study, cases=tuple(perfect)))[0]
    assert first.overall == 0.0
    assert first.by_group == (0.0,) * 4


def test_the_overall_error_is_the_mean_over_rows_of_those_of_the_groups(study):
    rows = [sum(case.group == group for case in study.measured) for group in study.settings.groups]
    for score in score_study(study):
        assert score.overall == pytest.approx(np.dot(rows, score.by_group) / sum(rows))


def test_the_null_model_of_three_numbers_fits_table_1_to_6_percent(study):
    null = {score.name: score for score in score_study(study)}["constant + fin + eel"]
    assert null.n_fitted == 3
    assert null.overall == pytest.approx(6.2, abs=0.05)
    assert null.leave_one_out == pytest.approx(7.3, abs=0.05)
    assert null.leave_one_group_out == pytest.approx(9.1, abs=0.05)


def test_a_number_per_group_cannot_predict_a_group_that_was_left_out(study):
    for score in score_study(study):
        if score.name.endswith("per group"):
            assert score.leave_one_group_out is None
            assert score.leave_one_out is not None and score.leave_one_out > score.overall


def test_null_models_meet_speeds_that_are_made_like_them(study):
    def made(speed):
        rows = [
            (case, replace(case.measured, forward_velocity=speed(case))) for case in study.cases
        ]
        return replace(study, cases=tuple(replace(case, measured=row) for case, row in rows))

    errors = {
        score.name: score
        for score in score_study(made(lambda case: 0.1 * (1.5 if case.group.has_fin else 1.0)))
    }
    assert errors["constant + fin + eel"].overall == pytest.approx(0.0, abs=1e-9)
    assert errors["constant per group"].leave_one_out == pytest.approx(0.0, abs=1e-9)
    errors = {
        score.name: score
        for score in score_study(made(lambda case: 0.07 * case.measured.gait.frequency))
    }
    assert errors["constant stride per group"].leave_one_out == pytest.approx(0.0, abs=1e-9)


def test_the_papers_coefficients_are_15_to_16_percent_off(study):
    assert 15.0 < score_study(study)[0].overall < 16.0


def test_models_of_our_own_stand_beside_the_papers_with_the_numbers_that_they_were_fitted_with(
    beside,
):
    efficiency, following = (score_study(one) for one in beside)
    assert [score.n_fitted for score in efficiency[:2]] == [None, 2]
    assert [score.is_null for score in efficiency] == [False, False, *4 * [True]]
    assert efficiency[1].overall == pytest.approx(5.0, abs=0.05)
    own = [score for score in following if score.n_fitted and not score.is_null]
    assert [score.title for score in own] == ["mamba-identified, no filter, delay 0.12 s"]
