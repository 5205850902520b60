"""When a fit doubts its model, where its searches begin, and a slice of campaigns/fit_doubts.py."""

from dataclasses import replace

import numpy as np
import pytest
from campaign_scripts import campaign
from identify.trials import DRAG, FRICTION, speeds, within

from laticauda.identify import Unknown, fit
from laticauda.identify.chi2 import usual_chi2
from laticauda.identify.doubt import (
    EVIDENCE,
    MARGIN,
    Doubt,
    doubt_of,
    is_usual,
    judge_residuals,
)
from laticauda.identify.local_search import LocalSearch
from laticauda.identify.method import Method
from laticauda.identify.problem import make_problem
from laticauda.identify.rival_laws import list_rival_laws
from laticauda.identify.rival_search import PRECISION, _Enough
from laticauda.identify.starts import is_settled, spread_starts
from laticauda.water.fluid.laws import PolynomialDrag, TotalSpeedDrag

doubts = campaign("fit_doubts")
N = 12
KNOWN = Method()
REFERENCE_SPEED = "water.drag.reference_speed"


def doubt_at(factor, **changes):
    """Of residuals that are all as large."""
    found = doubt_of(KNOWN, np.full(N, factor), float(N), {})
    return found and replace(found, **changes)


def test_residuals_that_noise_usually_leaves_are_not_doubted():
    assert doubt_at(1.0) is None
    assert doubt_of(KNOWN, np.full(N, 9.0), 0.0, {}) is None


def test_residuals_far_above_the_noise_say_that_the_model_is_in_doubt():
    usual = np.sqrt(usual_chi2(N, {}).high / N)
    found = doubt_at(1.01 * MARGIN * usual)
    assert found.is_of_model and found.better_law is None
    assert found.words.startswith("model in doubt: ")
    assert "the intervals do not hold" in found.words
    between = doubt_at(0.99 * MARGIN * usual)
    assert not between.is_of_model
    assert between.words.startswith("residuals beyond the stated noise: ")


def test_residuals_of_series_that_are_independent_are_noise_however_large():
    residuals = np.full(100, 3.0)
    white = doubt_of(KNOWN, residuals, 100.0, {}, is_of_series=True)
    assert not white.is_of_model and "stated too small, as" in white.words
    assert doubt_of(KNOWN, residuals, 100.0, {"heading": 0.5}, is_of_series=True).is_of_model
    assert replace(white, rivals={"other": 1.0}).is_of_model


def test_a_better_law_is_named_and_one_that_is_hardly_better_is_not():
    found = doubt_at(1.6, rivals={"total-speed-drag beta 1": 1.1, "other": 3.0})
    assert found.better_law == "total-speed-drag beta 1" and found.is_of_model
    assert "total-speed-drag beta 1 leaves 1.1 times the stated noise, this one 1.6" in found.words
    assert doubt_at(1.6, rivals={"other": 1.5}).words == ""
    two = doubt_at(3.0, rivals={"first": 1.0, "second": 1.1, "third": 2.0})
    assert two.better_laws == ("first", "second")
    assert "first leaves 1 times the stated noise, second 1.1, this one 3." in two.words
    # what is as large with the best law is taken for noise
    assert doubt_at(2.2, rivals={"other": 2.0}).better_law is None
    far_above = doubt_at(4.0, rivals={"other": 3.9}).words
    assert "No other law of 1 tried is clearly better (best: other, 3.9 times)." in far_above


def test_a_law_that_fits_a_number_more_has_to_pay_for_it():
    plain = doubt_at(1.6).after_trying("plain", 1.1, 1.0)
    evidence_left = 12 * (1.6**2 - 1.1**2) - EVIDENCE
    assert plain.better_laws == ("plain",)
    dear = doubt_at(1.6).after_trying("fitted", 1.1, 1.0, evidence_left + 0.1)
    assert dear.better_law is None and dear.rivals == {"fitted": 1.1}
    assert doubt_at(1.6).after_trying("fitted", 1.1, 1.0, evidence_left - 0.1).is_of_model
    # of two that leave as much, the one without a further number is named first
    both = plain.after_trying("fitted", 1.09, 1.0, 2.5)
    assert both.better_laws == ("plain", "fitted")


def test_a_law_that_is_clearly_better_is_told_although_residuals_are_usual():
    found = judge_residuals(KNOWN, np.full(240, 1.01), 238.0, {}, is_of_series=False)
    assert is_usual(found) and found.words == ""
    told = found.after_trying("other", 0.98, 1.0)
    assert told.better_law == "other" and told.is_of_model
    assert told.words == (
        "model in doubt: residuals are 1 times the stated noise, which leaves as much, but another "
        "law of the water describes the data clearly better (chi^2 less by 16): the intervals may "
        "not hold. other leaves 0.98 times the stated noise, this one 1."
    )


def test_outliers_do_not_cast_doubt_on_a_fit_with_a_robust_loss():
    residuals = np.random.default_rng(1).standard_normal(40)
    residuals[:4] = 10.0
    assert isinstance(doubt_of(KNOWN, residuals, 39.0, {}), Doubt)
    assert doubt_of(Method(loss="cauchy"), residuals, 39.0, {}) is None


def test_noise_that_is_correlated_leaves_more():
    residuals = np.full(200, 1.2)
    assert doubt_of(KNOWN, residuals, 200.0, {}).is_of_model is False
    correlated = doubt_of(KNOWN, residuals, 200.0, {"heading": 0.95})
    assert correlated.words == ""
    assert correlated.after_trying("other", 1.0, correlated.share).better_law is None
    assert correlated.after_trying("other", 1.0, 1.0).better_law == "other"


def test_starts_are_spread_over_range_and_prior_and_are_the_same_again():
    drag = Unknown(name=DRAG, prior=(1.75, 0.2))
    problem = make_problem(speeds(2, duration=2.0), [FRICTION, drag])
    first = problem.coordinates_of(problem.start)
    starts = np.array(list(spread_starts(problem, Method(n_starts=4), first)))
    again = np.array(list(spread_starts(problem, Method(n_starts=4), first)))
    np.testing.assert_array_equal(starts, again)
    np.testing.assert_array_equal(starts[0], first)
    assert len({tuple(start) for start in starts}) == 4
    values = np.array([problem.values_of(start) for start in starts])
    assert np.all(np.abs(values[:, 1] - 1.75) <= 0.4 + 1e-9)
    lower, upper = problem.unknowns[0].lower, problem.unknowns[0].upper
    assert np.all((lower <= values[:, 0]) & (values[:, 0] <= upper))


def test_no_more_starts_than_it_takes_for_two_to_agree_or_four_if_the_fit_is_bad():
    problem = make_problem(speeds(6, duration=2.0), [FRICTION])

    def searches(*costs):
        x = np.zeros(1)
        return [
            LocalSearch(start=x, end=x, cost=cost, jacobian=np.zeros((6, 1)), converged=True)
            for cost in costs
        ]

    assert not is_settled(problem, searches(4.0))
    assert is_settled(problem, searches(4.0, 4.001))
    assert not is_settled(problem, searches(4.0, 4.001, 3.0))
    assert not is_settled(problem, searches(80.0, 80.0, 80.0))
    assert is_settled(problem, searches(80.0, 80.0, 80.0, 80.0))


def test_rival_laws_are_all_others_and_keep_what_is_not_of_the_drag_law():
    measured = speeds(2, duration=2.0)
    rivals = {
        rival.name: rival.problem for rival in list_rival_laws(make_problem(measured, [DRAG]))
    }
    assert list(rivals) == [
        "total-speed-drag beta 0",
        "total-speed-drag beta 0.5",
        "total-speed-drag beta 1",
        "polynomial-drag, kirchhoff added mass",
        "total-speed-drag beta 0, kirchhoff added mass",
        "total-speed-drag beta 0.5, kirchhoff added mass",
        "total-speed-drag beta 1, kirchhoff added mass",
    ]  # two measurements are too few to fit a reference speed in addition
    water = replace(measured[0].scenario.environment, drag=TotalSpeedDrag())
    measured = [replace(one, scenario=replace(one.scenario, environment=water)) for one in measured]
    fitted = make_problem(measured, [DRAG, "water.drag.beta"])
    rivals = {rival.name: rival.problem for rival in list_rival_laws(fitted)}
    assert list(rivals) == [
        "polynomial-drag",
        "total-speed-drag beta 0.5, kirchhoff added mass",
        "polynomial-drag, kirchhoff added mass",
    ]
    assert rivals["polynomial-drag"].names == (DRAG,)
    assert len(list(rivals.values())[1].names) == 2


def test_linear_and_quadratic_drag_is_tried_with_its_reference_speed_fitted_too():
    problem = make_problem(speeds(4, duration=2.0), [DRAG])
    names = [rival.name for rival in list_rival_laws(problem)]
    assert names[3] == "polynomial-drag with fitted U_ref"
    assert names[-1] == "polynomial-drag with fitted U_ref, kirchhoff added mass"
    rival = list_rival_laws(problem)[3]
    assert rival.problem.names == (DRAG, REFERENCE_SPEED)
    assert rival.name_with({REFERENCE_SPEED: 0.312}) == (
        "polynomial-drag with fitted U_ref (linear and quadratic drag equal at 0.31 m/s)"
    )
    fitted_already = make_problem(speeds(4, duration=2.0), [DRAG, REFERENCE_SPEED])
    names = [rival.name for rival in list_rival_laws(fitted_already)]
    assert not any("fitted U_ref" in name for name in names)


def test_a_rivals_search_ends_once_it_is_clear_or_hopeless():
    enough = _Enough(cost_to_beat=20.0, precision=PRECISION)
    assert not enough(100.0, 90.0)
    assert not enough(100.0, 90.0)  # the first steps are made in any case
    assert enough(100.0, 90.0)
    assert not enough(100.0, 70.0)  # three times the promised gain would do
    assert enough(15.0, 14.99)
    assert not enough(15.0, 10.0)


def test_a_reference_speed_that_is_not_the_usual_one_is_found_and_said():
    measured = speeds(8, sigma=5e-4, duration=2.0, drag=PolynomialDrag(reference_speed=0.2))
    wrong = replace(measured[0].scenario.environment, drag=TotalSpeedDrag(beta=1.0))
    measured = [within(one, environment=wrong) for one in measured]
    found = fit(measured, parameters=[FRICTION, DRAG], n_starts=2, threads=1)
    name = "polynomial-drag with fitted U_ref (linear and quadratic drag equal at 0.2 m/s)"
    assert found.doubt.better_law == name and name in found.warnings[0]


@pytest.mark.parametrize("number", [70])
def test_a_wrong_law_is_doubted_and_a_right_one_is_not(number):
    right, wrong = doubts.rows_of(number)
    assert not right.doubted and right.n_stated
    assert right.chi2 <= right.best_chi2 + doubts.WORSE
    assert wrong.doubted and doubts.is_true_law(wrong)


def test_rows_are_kept_and_not_done_again(tmp_path, monkeypatch):
    table = tmp_path / "rows.csv"
    (kept, *_) = doubts.stored() or [None]
    assert kept is not None
    monkeypatch.setattr(doubts, "rows_of", lambda number: [replace(kept, truth=number)])
    assert doubts.go_on([0, 1], table) == doubts.stored(table)
    monkeypatch.setattr(doubts, "rows_of", None)
    assert len(doubts.go_on([0, 1], table)) == 2


def test_the_stored_answer_is_what_is_claimed():
    rows = doubts.stored()
    right = [row for row in rows if row.law == "right"]
    wrong = [row for row in rows if row.law == "wrong"]
    assert sum(row.doubted for row in wrong) >= 0.95 * len(wrong)
    assert sum(row.doubted for row in right) <= 0.02 * len(right)
    assert sum(row.chi2 > row.best_chi2 + doubts.WORSE for row in right) <= 0.01 * len(right)
