from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.paper import read_efficiency_trials, read_path_following_trials
from laticauda.trials.null_models import MEAN_STRIDE, PREDICTORS, Row, predict

KNOWN = [trial for trial in read_efficiency_trials() if trial.forward_velocity is not None]
ROWS = [Row(gait=trial.gait, has_fin=trial.has_fin) for trial in KNOWN]
SPEEDS = np.array([trial.forward_velocity for trial in KNOWN], dtype=float)
OTHERS = [Row(gait=trial.gait, has_fin=trial.has_fin) for trial in read_path_following_trials()]


@pytest.mark.parametrize("name", PREDICTORS)
@given(factor=st.floats(0.01, 100.0))
def test_speeds_in_another_unit_give_predictions_in_that_unit(name, factor):
    usual, n_fitted = predict(name, ROWS, SPEEDS, OTHERS)
    other, _ = predict(name, ROWS, factor * SPEEDS, OTHERS)
    assert other == pytest.approx(factor * usual)
    assert n_fitted == (3 if "fin + eel" in name else 4)


def made(speed):
    return np.array([speed(row) for row in ROWS]), np.array([speed(row) for row in OTHERS])


@pytest.mark.parametrize("name", PREDICTORS)
def test_a_null_model_predicts_unseen_rows_that_are_made_like_it(name):
    def speed(row):
        fin, eel = (1.5 if row.has_fin else 1.0), (0.8 if row.gait.kind == "eel_like" else 1.0)
        return 0.1 * fin * eel * (row.gait.frequency if "stride" in name else 1.0)

    known, unseen = made(speed)
    assert predict(name, ROWS, known, OTHERS)[0] == pytest.approx(unseen)


@pytest.mark.parametrize("name", PREDICTORS)
def test_a_stride_makes_speed_grow_with_the_frequency_and_a_constant_does_not(name):
    fast = [
        replace(row, gait=replace(row.gait, frequency=2.0 * row.gait.frequency)) for row in OTHERS
    ]
    usual, faster = (predict(name, ROWS, SPEEDS, rows)[0] for rows in (OTHERS, fast))
    assert faster == pytest.approx((2.0 if "stride" in name else 1.0) * usual)


def test_a_constant_stride_is_the_geometric_mean_of_a_groups_strides():
    predicted, _ = predict("constant stride per group", ROWS, SPEEDS, OTHERS)
    for row, value in zip(OTHERS, predicted, strict=True):
        strides = [
            v / r.gait.frequency for v, r in zip(SPEEDS, ROWS, strict=True) if r.group == row.group
        ]
        assert value == pytest.approx(np.exp(np.mean(np.log(strides))) * row.gait.frequency)


def test_the_mean_stride_is_the_arithmetic_mean_of_a_groups_strides():
    predicted, _ = predict(MEAN_STRIDE, ROWS, SPEEDS, OTHERS)
    for row, value in zip(OTHERS, predicted, strict=True):
        strides = [
            v / r.gait.frequency for v, r in zip(SPEEDS, ROWS, strict=True) if r.group == row.group
        ]
        assert value == pytest.approx(np.mean(strides) * row.gait.frequency)


def test_a_group_that_was_not_measured_cannot_be_predicted():
    bare = [i for i, row in enumerate(ROWS) if not row.has_fin]
    with pytest.raises(
        ValueError,
        match="`rows` must hold every group of `others`, got none of eel-like motion, with",
    ):
        predict("constant per group", [ROWS[i] for i in bare], SPEEDS[bare], OTHERS)
