from dataclasses import replace

import numpy as np
import pytest
from identify.trials import FRICTION, speeds, within

import laticauda as lc
from laticauda.identify import (
    Unknown,
    compared_with_null_models,
    fit,
    from_table1,
    leave_out,
    linear_leave_one_out,
)
from laticauda.identify.model import predict
from laticauda.identify.problem import make_problem

MEASURED = speeds(6, noise=0.002)


@pytest.fixture(scope="module")
def found():
    return fit(MEASURED, parameters=[FRICTION], n_starts=1)


def test_leaving_one_out_is_a_fit_to_the_others(found):
    left = leave_out(found)
    for i in (0, 4):
        others = [m for k, m in enumerate(MEASURED) if k != i]
        refit = fit(others, parameters=[FRICTION], n_starts=1)
        assert left.values[i, 0] == pytest.approx(refit[FRICTION].value, rel=1e-6)
        alone = predict(make_problem(MEASURED[i : i + 1], [FRICTION]), left.values[i])
        assert left.predictions[i] == pytest.approx(alone.values[0], rel=1e-9)


def test_the_hat_matrix_predicts_what_refits_do(found):
    left, linear = leave_out(found).predictions, linear_leave_one_out(found)
    change = left - found.predictions
    np.testing.assert_allclose(linear - found.predictions, change, atol=0.1 * np.abs(change).max())
    assert np.abs(change).max() > 1e-5


def test_the_hat_matrix_keeps_the_priors_as_refits_do():
    """An offset is linear; its prior says as much as four of the eight numbers."""
    powers = speeds(8, noise=0.5, sigma=0.5, duration=1.0, figure="mean_power")
    offset = Unknown(name="measured.power_offset", prior=(1.0, 0.25), size=10.0)
    found = fit(powers, parameters=[offset], n_starts=1)
    np.testing.assert_allclose(linear_leave_one_out(found), leave_out(found).predictions, rtol=1e-8)


def test_what_was_left_out_is_described_worse(found):
    assert leave_out(found).percentage_error() > found.percentage_error()


def test_a_group_whose_own_parameter_nothing_else_knows_cannot_be_predicted():
    rows = from_table1()[::3]
    own = fit(
        rows,
        parameters=[f"lateral_undulation.{FRICTION}", f"eel_like.{FRICTION}"],
        n_starts=1,
        rivals=False,
    )
    assert np.isfinite(leave_out(own, "group").percentage_error())
    common = [
        row
        for row in rows
        if not (row.scenario.gait.kind == "eel_like" and row.scenario.robot.caudal_fin)
    ]
    alone = fit(
        common,
        parameters=[f"lateral_undulation.{FRICTION}", f"eel_like.{FRICTION}"],
        n_starts=1,
        rivals=False,
    )
    assert np.isnan(leave_out(alone, "group").percentage_error())


def test_leaving_out_everything_is_refused(found):
    with pytest.raises(ValueError, match="`by` must leave something to fit to, got `group`"):
        leave_out(found, "group")
    with pytest.raises(ValueError, match="`by` must be one of"):
        leave_out(found, "week")


def test_null_models_stand_beside_it():
    rows = from_table1(selected_from=1)
    beside = {
        null.name: null
        for null in compared_with_null_models(
            fit(rows, parameters=[FRICTION], n_starts=1, rivals=False)
        )
    }
    simple = beside["constant + fin + eel"]
    assert simple.n_parameters == 3
    assert (simple.fitted, simple.left_out, simple.group_left_out) == pytest.approx(
        (6.2, 7.3, 9.1), abs=0.05
    )
    assert np.isnan(beside["constant per group"].group_left_out)


def test_null_models_know_no_gaits_of_ones_own(found):
    assert len(compared_with_null_models(found)) == 4
    gait = lc.custom_gait(envelope=[1.0] * 8, amplitude=0.5, frequency=2.0, phase_shift=0.7)
    own = [replace(within(m, motion=gait), group="") for m in MEASURED[:2]]
    assert compared_with_null_models(fit(own, parameters=[FRICTION], n_starts=1)) == ()
