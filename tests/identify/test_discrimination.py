import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from identify.trials import DRAG, FRICTION, ROBOT, gaits

import laticauda as lc
from laticauda.identify import Unknown, discrimination, fit, swim_candidates, trial_information
from laticauda.identify.conversion import from_tow
from laticauda.identify.discrimination import discriminate, misidentification_probability
from laticauda.identify.identifiability import marginal
from laticauda.identify.model import predict
from laticauda.identify.problem import make_problem
from laticauda.identify.towing import Tow
from laticauda.robot import textbook_water
from laticauda.water.fluid.laws import TotalSpeedDrag

BOOK = textbook_water(ROBOT).water
BETAS = {beta: replace(BOOK, drag=TotalSpeedDrag(beta=beta)) for beta in (0.0, 0.5, 1.0)}
PRIOR = Unknown(name=DRAG, prior=(BOOK.normal_drag, 0.2 * BOOK.normal_drag))


def rival(water, *tows, wanted=(FRICTION, PRIOR)):
    candidates = [from_tow(ROBOT, water, tow, misalignment=0.0) for tow in tows]
    return make_problem(candidates[:1], list(wanted), threads=1), candidates


STRAIGHT, OBLIQUE, STEEP = (
    Tow(speed=0.4),
    Tow(speed=0.4, angle=math.radians(15)),
    Tow(speed=0.4, angle=1.2),
)


def test_a_model_with_fewer_candidates_is_named_before_any_is_judged(monkeypatch):
    rivals = {"a": rival(BOOK, STRAIGHT, OBLIQUE), "b": rival(BOOK, STRAIGHT)}
    monkeypatch.setattr(
        discrimination, "predict_candidates", lambda *_: pytest.fail("one was judged")
    )
    with pytest.raises(
        ValueError, match=r"`rivals\[b\]` must have 2 candidates, as the first model has, got 1"
    ):
        discriminate(rivals, 1)


def test_an_oblique_tow_tells_what_a_straight_one_cannot():
    rivals = {f"beta {beta:g}": rival(water, STRAIGHT, OBLIQUE) for beta, water in BETAS.items()}
    found = discriminate(rivals, 1)
    ((best, apart),) = found.steps
    straight, nothing = found.alone[-1]
    assert [best.name, straight.name] == [
        "oblique tow, 15 deg, at 0.4 m/s",
        "straight tow at 0.4 m/s",
    ]
    assert found.pairs == (("beta 0", "beta 0.5"), ("beta 0", "beta 1"), ("beta 0.5", "beta 1"))
    assert np.all(nothing < 1e-6)
    assert np.all(apart > 1.0)


def test_a_second_tow_at_another_angle_tells_more_than_the_same_one_again_where_the_drag_is_unknown():
    free = (FRICTION, Unknown(name=DRAG))
    rivals = {
        f"beta {beta:g}": rival(water, OBLIQUE, STEEP, wanted=free) for beta, water in BETAS.items()
    }
    found = discriminate(rivals, 2)
    assert {one.tow.angle for one, _ in found.steps} == {OBLIQUE.angle, STEEP.angle}
    assert np.all(found.steps[1][1] >= found.steps[0][1] - 1e-6)


def test_the_distance_is_how_much_worse_the_rival_fits_in_the_worse_of_two_ways():
    rivals = {f"beta {beta:g}": rival(BETAS[beta], OBLIQUE) for beta in (0.5, 0.0)}
    first, second = (candidates[0] for _, candidates in rivals.values())
    squares = []
    for true, other in ((first, second), (second, first)):
        loads = {what: (pair[0], first.figures[what][1]) for what, pair in true.figures.items()}
        fitted = fit(
            [replace(other, figures=loads)], parameters=[FRICTION, PRIOR], n_starts=1, threads=1
        )
        squares.append(
            fitted.chi2 + float(np.sum(fitted.problem.prior_residuals(fitted.best) ** 2))
        )
    ((_, apart),) = discriminate(rivals, 1).steps
    assert apart.tolist() == pytest.approx([min(squares)], rel=1e-3)  # loads are linear in the drag
    assert max(squares) > 2.0 * min(squares)


def test_the_noise_of_a_series_is_the_first_model_s_as_that_of_a_figure_is():
    def distance_with(noise_of_second):
        first, second = (
            swim_candidates(ROBOT, gaits(1), BETAS[beta], {"path": sigma}, duration=4.0)
            for beta, sigma in ((0.5, 0.005), (0.0, noise_of_second))
        )
        rivals = {
            name: (make_problem(trials, [FRICTION], threads=1), trials)
            for name, trials in (("first", first), ("second", second))
        }
        ((_, distance),) = discriminate(rivals, 1).steps
        assert distance > 1.0
        return distance

    assert distance_with(0.05) == pytest.approx(distance_with(0.005), rel=1e-12)


def test_a_figure_that_only_one_model_yields_tells_nothing(monkeypatch):
    rivals = {f"beta {beta:g}": rival(BETAS[beta], OBLIQUE) for beta in (0.5, 0.0)}
    without_side_force = {}
    for name, (problem, (trial,)) in rivals.items():
        figures = {figure: pair for figure, pair in trial.figures.items() if figure != "side_force"}
        without_side_force[name] = (problem, [replace(trial, figures=figures)])
    ((_, expected),) = discriminate(without_side_force, 1).steps

    def predict_without_side_force_of_second(problem, values):
        predicted = predict(problem, values)
        if problem.scenarios[0].environment == BETAS[0.0]:
            (side_force,) = [block for block in problem.data_blocks if block.name == "side_force"]
            predicted.values[side_force.numbers] = math.nan
        return predicted

    monkeypatch.setattr(trial_information, "predict", predict_without_side_force_of_second)
    ((_, distance),) = discriminate(rivals, 1).steps
    assert distance == pytest.approx(expected, rel=1e-9)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(4, 9))
def test_the_schur_complement_is_what_least_squares_leave_and_verdicts_are_wrong_as_often_as_it_says(
    seed, n
):
    rng = np.random.default_rng(seed)
    off, rows = rng.standard_normal(n), rng.standard_normal((n, 2))
    both = np.column_stack((off, rows))
    left = float(marginal(both.T @ both, [0])[0, 0])
    assert left == pytest.approx(float(np.linalg.lstsq(rows, off, rcond=None)[1][0]), rel=1e-6)
    # Truth has the mean 0 here, the rival off - rows x: whose chi^2 is less?
    best = off - rows @ np.linalg.lstsq(rows, off, rcond=None)[0]
    noise = rng.standard_normal((4000, n))
    seen = np.mean(np.sum((noise - best) ** 2, axis=1) < np.sum(noise**2, axis=1))
    assert seen == pytest.approx(misidentification_probability(left), abs=0.04)


def test_tows_identify_what_they_depend_on():
    truth = replace(BOOK, tangential_friction=0.1, drag=TotalSpeedDrag(beta=0.8))
    tows = [Tow(speed=v, angle=angle) for v in (0.2, 0.4) for angle in (0.0, 0.26, -0.26, 0.8)]
    still = lc.build_scenario(
        ROBOT,
        lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.5),
        environment=truth,
    )
    measured = [
        from_tow(ROBOT, BOOK, tow, tow.loads(still), name=str(i)) for i, tow in enumerate(tows)
    ]
    beta = Unknown(name="water.drag.beta", start=0.4, lower=0.0, upper=1.0)
    found = fit(measured, parameters=[FRICTION, DRAG, beta], n_starts=1, threads=1)
    assert found["water.drag.beta"].value == pytest.approx(0.8, abs=1e-4)
    assert found[FRICTION].value == pytest.approx(0.1, rel=1e-4)
    assert found[DRAG].value == pytest.approx(BOOK.normal_drag, rel=1e-4)


def test_bad_input_is_named():
    one = rival(BOOK, STRAIGHT)
    with pytest.raises(
        ValueError, match=r"`rivals` must be at least two models with candidates, got 1"
    ):
        discriminate({"textbook": one}, 1)
    with pytest.raises(ValueError, match=r"`n_trials` must be"):
        discriminate({"a": one, "b": one}, 0)
    with pytest.raises(ValueError, match=r"`environment` must be of class Water"):
        from_tow(ROBOT, lc.load_ground("coulomb"), STRAIGHT)
    with pytest.raises(ValueError, match=r"`figures` of `tow` must be one of `drag`"):
        replace(
            from_tow(ROBOT, BOOK, STRAIGHT), name="tow", figures={"forward_velocity": (1.0, 0.1)}
        )
