from dataclasses import replace
from itertools import combinations_with_replacement

import numpy as np
import pytest
from identify.trials import FINNED, ROBOT, WATER, gaits, within

import laticauda as lc
from laticauda.identify import Measurement, Unknown, design, fit
from laticauda.identify.candidates import coast_down, swim_candidates
from laticauda.identify.conversion import from_tow
from laticauda.identify.design import design_experiment
from laticauda.identify.identifiability import marginal
from laticauda.identify.problem import make_problem
from laticauda.identify.selection import best_of
from laticauda.identify.towing import Tow
from laticauda.identify.trial_information import (
    deviations_after,
    information_of,
    known_from,
    prior_information,
)
from laticauda.scenarios.interfaces import Start
from laticauda.trials.metrics import towing_drag

WANTED = ["water.tangential_friction", "water.normal_drag", "water.added_mass"]


def put_of(candidates, wanted=WANTED):
    return make_problem(candidates, wanted, threads=1)


@pytest.fixture(scope="module")
def choice():
    swimming = swim_candidates(ROBOT, gaits(4), WATER, {"speed": 0.005}, duration=8.0)
    straight = [from_tow(ROBOT, WATER, Tow(speed=0.4)), coast_down(ROBOT, WATER, 0.4, duration=2.0)]
    return put_of(swimming), [*swimming, *straight]


def random_information(rng, n=3, rank=1):
    rows = rng.standard_normal((rank, n))
    return rows.T @ rows


def log_volume(information):
    return float(np.linalg.slogdet(information + 1e-8 * np.eye(len(information)))[1])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"values": np.ones(2)}, "`values` must be an array of 3 numbers, got an array of shape"),
        ({"information": np.eye(2)}, "`information` must be an array of 3 x 3 numbers, got an arr"),
    ],
)
def test_arrays_of_another_shape_are_refused_before_a_trial_is_judged(
    choice, monkeypatch, arguments, message
):
    put, candidates = choice
    monkeypatch.setattr(design, "information_of", lambda *_: pytest.fail("one was judged"))
    with pytest.raises(ValueError, match=message):
        design_experiment(put, candidates, 1, **arguments)


def test_no_trial_makes_anything_less_certain(choice):
    put, candidates = choice
    found = design_experiment(put, candidates, 4)
    sigma = found.sigma
    assert np.all(sigma[1:] <= sigma[:-1] * (1.0 + 1e-9))
    assert len(found.steps) == 4
    added = information_of(put, candidates, put.start)
    totals = np.cumsum([added[candidates.index(one)] for one, _ in found.steps], axis=0)
    assert np.all(np.diff([log_volume(total) for total in totals]) >= 0.0)


@pytest.mark.parametrize("seed", range(4))
def test_the_first_choice_is_that_of_brute_force_and_no_exchange_helps(seed):
    rng = np.random.default_rng(seed)
    added = np.array([random_information(rng) for _ in range(7)])
    known = 0.01 * np.eye(3)
    (first,) = best_of(added, known, 1, log_volume)
    assert first == int(np.argmax([log_volume(known + one) for one in added]))
    chosen = best_of(added, known, 3, log_volume)
    reached = log_volume(known + added[chosen].sum(axis=0))
    best = max(
        log_volume(known + added[list(three)].sum(axis=0))
        for three in combinations_with_replacement(range(7), 3)
    )
    assert reached >= best - 0.2
    for place in range(3):
        others = [i for k, i in enumerate(chosen) if k != place]
        assert all(
            log_volume(known + added[[*others, i]].sum(axis=0)) <= reached + 1e-9 for i in range(7)
        )


def test_a_chosen_design_is_better_than_random_ones_of_as_many_trials(choice):
    put, candidates = choice
    added = information_of(put, candidates, put.start)
    found = design_experiment(put, candidates, 3)
    mine = log_volume(sum(added[candidates.index(one)] for one, _ in found.steps))
    rng = np.random.default_rng(0)
    others = [
        log_volume(added[rng.integers(len(candidates), size=3)].sum(axis=0)) for _ in range(50)
    ]
    assert mine >= max(others) - 1e-9
    assert mine > np.median(others) + 1.0


def test_swimming_does_not_see_the_common_scale_and_a_tow_does(choice):
    put, candidates = choice
    found = design_experiment(put, candidates, 4)
    assert found.swimming[0] > 1.0  # friction
    assert found.sigma[-1][0] < 0.05
    assert any(one.group != "swim" for one, _ in found.steps)
    assert found.reasons[-1].startswith(
        "After the best 4 swimming trials, `water.tangential_friction` is "
    )


def test_what_swims_is_told_by_what_was_done_and_not_by_a_group_that_a_user_may_name(choice):
    problem, candidates = choice
    grouped = [replace(candidate, group="north basin") for candidate in candidates]
    expected = design_experiment(problem, candidates, 2).swimming
    assert design_experiment(problem, grouped, 2).swimming == pytest.approx(expected, rel=1e-12)


def test_the_force_of_a_tow_says_the_friction_in_closed_form():
    tow = Tow(speed=0.3)
    candidate = from_tow(FINNED, WATER, tow, sigma=0.1, share=0.0)
    put = put_of([candidate], ["water.tangential_friction"])
    (information,) = information_of(put, [candidate], put.start)
    assert information[0, 0] == pytest.approx((towing_drag(FINNED, WATER, 0.3) / 0.1) ** 2, rel=0.3)
    without_fin = from_tow(ROBOT, WATER, tow, sigma=0.1, share=0.0)
    (information,) = information_of(
        put_of([without_fin], ["water.tangential_friction"]), [without_fin], put.start
    )
    assert information[0, 0] == pytest.approx((towing_drag(ROBOT, WATER, 0.3) / 0.1) ** 2, rel=1e-6)


def test_a_robot_that_coasts_slows_down_as_the_closed_form_says():
    # m v' = -K v (U + v), K (U + v) v the towing drag; the added mass along is 0 here.
    still = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.5)
    trial = lc.swim(ROBOT, still, 2.0, environment=WATER, start=Start(velocity=0.4, heading=0.3))
    drag, mass = towing_drag(ROBOT, WATER, 0.4), sum(module.mass for module in ROBOT.modules)
    reference = WATER.drag.reference_speed
    rate = drag / (0.4 * (reference + 0.4)) * reference / mass
    time = np.linspace(0.0, 2.0, 20001)
    ratio = 0.4 / (reference + 0.4) * np.exp(-rate * time)
    speed = reference * ratio / (1.0 - ratio)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    way = np.interp(trial.time, time, way)
    np.testing.assert_allclose(trial.center_of_mass[:, 0], way * np.cos(0.3), atol=1e-6)
    np.testing.assert_allclose(trial.center_of_mass[:, 1], way * np.sin(0.3), atol=1e-6)


def test_a_coast_down_says_less_where_its_first_speed_has_to_be_found_too():
    one = coast_down(ROBOT, WATER, 0.4, duration=2.0)
    put = put_of([one], WANTED[:1])
    (unsure,) = information_of(put, [one], put.start)
    known = replace(one, free_start=False)
    (sure,) = information_of(put, [known], put.start)
    assert 0.0 < unsure[0, 0] < 0.9 * sure[0, 0]


def test_a_design_takes_starts_for_unknown_as_a_fit_does():
    (one,) = swim_candidates(ROBOT, gaits(1), WATER, {"path": 0.005}, duration=8.0)
    exact = replace(one, free_start=False)
    put = put_of([exact], WANTED[:1])
    free, known = (
        float(information[0, 0]) for information in information_of(put, [one, exact], put.start)
    )
    assert 1.5 < (known / free) ** 0.5 < 4.0


def test_the_speed_at_the_begin_can_be_identified():
    truth = coast_down(ROBOT, WATER, 0.37, duration=2.0)
    trial = lc.swim(replace(truth.scenario, sample_interval=0.1))
    path = trial.center_of_mass[1:]
    truth = within(truth, start=Start(velocity=0.3))
    measured = replace(truth, time=trial.time[1:], series={"center_of_mass": (path, 0.002)})
    found = fit([measured], parameters=["start.velocity", WANTED[0]], n_starts=1, threads=1)
    assert found["start.velocity"].value == pytest.approx(0.07, abs=1e-5)
    assert found[WANTED[0]].value == pytest.approx(WATER.tangential_friction, rel=1e-4)


def test_the_expected_deviation_is_that_of_a_fit_to_such_trials():
    swimming = swim_candidates(ROBOT, gaits(5), WATER, {"path": 0.005}, duration=8.0)
    put = put_of(swimming, WANTED[:2])
    information = information_of(put, swimming, put.start).sum(axis=0)
    expected = deviations_after(information)
    rng = np.random.default_rng(3)
    runs = lc.swim_many(ROBOT, gaits(5), 8.0, environments=WATER)
    assert runs.succeeded.all()
    measured = []
    for one in swimming:
        trial = lc.swim(replace(one.scenario, sample_interval=0.5))
        path = trial.center_of_mass + 0.005 * rng.standard_normal(trial.center_of_mass.shape)
        start = Start(center_of_mass=tuple(path[0]))
        measured.append(
            replace(
                within(one, start=start), time=trial.time, series={"center_of_mass": (path, 0.005)}
            )
        )
    found = fit(measured, parameters=WANTED[:2], n_starts=1, threads=1)
    for k, name in enumerate(WANTED[:2]):
        estimate = found[name]
        assert estimate.sigma / estimate.value == pytest.approx(expected[k], rel=0.3)
        assert abs(np.log(estimate.value / put.start[k])) < 4.0 * expected[k]
    known = marginal(known_from(found), [0, 1])
    np.testing.assert_allclose(
        deviations_after(known), [found[e].sigma / found[e].value for e in WANTED[:2]], rtol=1e-6
    )


def test_a_prior_counts_and_what_is_left_out_of_sight_stays_unknown():
    candidate = from_tow(ROBOT, WATER, Tow(speed=0.3))
    put = put_of([candidate], [Unknown(name=WANTED[0], prior=(0.3, 0.03)), WANTED[1]])
    found = design_experiment(put, [candidate], 1)
    assert found.before[0] == pytest.approx(0.1)
    assert np.isinf(found.before[1])
    assert found.sigma[1][0] < 0.1
    assert np.isinf(found.sigma[1][1])
    np.testing.assert_allclose(np.diag(prior_information(put, put.start)), [100.0, 0.0])


def test_the_information_about_some_is_what_the_inverse_has_of_them():
    whole = random_information(np.random.default_rng(1), n=4, rank=6)
    part = marginal(whole, [0, 2])
    np.testing.assert_allclose(
        np.linalg.inv(part), np.linalg.inv(whole)[np.ix_([0, 2], [0, 2])], rtol=1e-9
    )


def test_a_single_parameter_can_be_what_counts(choice):
    put, candidates = choice
    found = design_experiment(put, candidates, 1, criterion=WANTED[0])
    assert found.criterion == f"sigma of {WANTED[0]}"
    assert found.steps[0][0].group != "swim"
    assert design_experiment(put, candidates, 2, criterion="A").criterion == "A"


def test_bad_input_is_named(choice):
    put, candidates = choice
    with pytest.raises(ValueError, match=r"`candidates` must hold at least one trial, got none"):
        design_experiment(put, [], 1)
    with pytest.raises(ValueError, match=r"`n_trials` must be"):
        design_experiment(put, candidates, 0)
    with pytest.raises(ValueError, match=r"`criterion` must be"):
        design_experiment(put, candidates, 1, criterion="E")
    with pytest.raises(ValueError, match=r"`speed` must be > 0 m/s, got 0"):
        Tow(speed=0.0)


def test_what_is_tied_keeps_the_product_in_the_fit_and_in_the_file(tmp_path):
    # A lossless gear: half the speed, twice the torque.
    geared = "robot.joint.actuator.no_load_speed"
    torque = "robot.joint.actuator.stall_torque"
    unknown = Unknown(name=geared, start=1.0, lower=0.5, upper=7.0, tied={torque: -1.0})
    actuator = ROBOT.joints[0].actuator
    product = actuator.no_load_speed * actuator.stall_torque
    asked = gaits(3)
    truth = replace(actuator, no_load_speed=1.2, stall_torque=product / 1.2)
    robot = replace(ROBOT, joints=tuple(replace(joint, actuator=truth) for joint in ROBOT.joints))
    speeds = lc.swim_many(robot, asked, 6.0, environments=WATER, joints="servo").forward_velocity
    measured = [
        Measurement(
            name=str(i),
            scenario=lc.build_scenario(ROBOT, gait, 6.0, environment=WATER),
            figures={"forward_velocity": (float(speed), 0.002)},
        )
        for i, (gait, speed) in enumerate(zip(asked, speeds, strict=True))
    ]
    found = fit(measured, parameters=[unknown], joints="servo", n_starts=1, threads=1)
    assert found[geared].value == pytest.approx(1.2, rel=1e-4)
    changes = found.parameters("geared", "geared").changes["actuator"]
    assert changes["no_load_speed"] * changes["stall_torque"] == pytest.approx(product)
    with pytest.raises(
        ValueError, match=r"`tied` of `robot.joint.actuator.no_load_speed` must name other numbers"
    ):
        fit(measured, parameters=[replace(unknown, tied={"water.stickiness": 1.0})], threads=1)
