"""What a twin learns from samples, what it names, and what it does without."""

import math
from dataclasses import replace

import numpy as np
import pytest
from control.estimation.swims import GAIT, jammed, samples, swum

import laticauda as lc
from laticauda.control.estimation import (
    JointSample,
    Learned,
    Learner,
    Learning,
    Mount,
    PoseSample,
    ReferenceSample,
)
from laticauda.control.estimation.learning import LEAST_STRETCHES, MEDIAN_OF_SQUARE

GUESS = lc.load_water("paper-lateral")
TRUE = {"normal_drag": 2.1, "tangential_friction": 0.25, "current_x": 0.006, "current_y": -0.004}
WATER = replace(
    GUESS,
    current=(TRUE["current_x"], TRUE["current_y"]),
    **{name: TRUE[name] for name in ("normal_drag", "tangential_friction")},
)
MAMBA = lc.load_robot("mamba")


def learner(robot=MAMBA, **settings):
    return Learner(
        settings=Learning(**settings),
        robot=robot,
        plant=lc.build_plant(robot, GUESS, joints="servo"),
    )


def learnt(given, taught=None):
    taught = taught or learner()
    state, found = taught.init(), []
    for sample in given:
        state = taught.step(state, sample)
        found += [] if state.learned is None else [state.learned]
    return found


def named(found):
    return [(one.time, change) for one in found for change in one.changes]


@pytest.fixture(scope="module")
def good():
    return swum((MAMBA, WATER, 24.0))


def test_drag_friction_and_current_are_learnt_in_twenty_seconds_from_another_guess(good):
    found = learnt(samples(good))
    last = found[-1]
    assert last.time > 20.0
    for name, value in TRUE.items():
        assert last.value[name] == pytest.approx(value, rel=0.01, abs=1e-3), name
        assert abs(last.value[name] - value) < 2.0 * last.deviation[name], name
    assert named(found) == []
    assert np.diff([one.time for one in found]) == pytest.approx(math.pi / GAIT.frequency)


def test_as_long_as_there_are_few_stretches_only_changes_are_told_and_the_guess_is_what_is_known(
    good,
):
    few = jammed(good[:520], begin=6.0)
    (first,) = learnt(samples(few), learner(coefficient=0.2, current=0.03))
    assert first.changes == ("Joint 4 is stuck: it swings 0 % of what it did.",)
    assert first.value["normal_drag"] == GUESS.normal_drag
    assert first.deviation["normal_drag"] == pytest.approx(0.2 * GUESS.normal_drag)
    assert (first.value["current_y"], first.deviation["current_y"]) == (0.0, 0.03)
    assert (first.value["play"], first.deviation["play"]) == (0.0, 0.01)


def test_samples_that_say_nothing_do_not_count(good):
    taught = learner()
    state = taught.init()
    for sample in samples(good[:50]):
        state = taught.step(state, sample)
    lost = PoseSample(time=2.0, position=np.full(3, np.nan), rotation=np.eye(3))
    for nothing in (
        lost,
        PoseSample(time=2.0, position=np.zeros(3)),
        JointSample(time=2.0, angle=np.full(8, np.nan)),
    ):
        assert taught.step(state, nothing).samples == state.samples


def test_what_lies_before_a_gap_in_the_frames_is_forgotten(good):
    gap = [
        one for one in samples(good) if not (isinstance(one, PoseSample) and 18.0 < one.time < 18.5)
    ]
    found = learnt(gap, learner(unknown=()))
    before = next(one for one in reversed(found) if one.time < 18.0)
    assert before.time > 15.0
    assert found[-1].time < 18.0  # nothing new is known yet


def test_without_a_gait_nothing_is_remembered(good):
    taught = learner()
    state = taught.init()
    for sample in samples(good[:500]):
        state = taught.step(state, sample)
    assert len(state.bounds) > 3
    state = taught.step(state, ReferenceSample(time=10.1, angle=np.zeros(8)))
    assert state.bounds == ()
    assert all(rows == () for rows in state.samples.values())


def test_no_more_than_the_window_is_remembered(good):
    taught = learner(window=8.0, unknown=())
    state = taught.init()
    for sample in samples(good):
        state = taught.step(state, sample)
    assert state.bounds[-1] - state.bounds[0] < 8.0 + math.pi / GAIT.frequency
    assert all(rows[0][0] > 13.0 for rows in state.samples.values())


def test_a_joint_that_jams_is_named_within_two_cycles(good):
    (time, change), *_ = named(learnt(samples(jammed(good)), learner(unknown=())))
    assert change.startswith("Joint 4 is stuck: it swings ")
    assert time < 15.0 + 6.0


def test_a_weak_joint_is_named_in_its_third_stretch(good):
    changes = named(learnt(samples(jammed(good, 0.7)), learner(unknown=())))
    assert [change for _, change in changes if "Joint" in change] == [
        "Joint 4 is weak: it swings 70 % of what it did."
    ]
    assert 15.0 + 3.0 < changes[0][0] < 15.0 + 8.0


def test_joints_that_are_not_asked_to_move_are_not_named(good):
    assert not any(
        "Joint" in change
        for _, change in named(learnt(samples(jammed(good), asked=0.01), learner(unknown=())))
    )


FINNED = lc.load_robot("mamba-fin")


def test_a_fin_that_is_lost_is_named_within_two_cycles_and_the_twin_loses_it_too():
    bare = replace(FINNED, caudal_fin=None)
    seen = swum((FINNED, GUESS, 15.0), (bare, GUESS, 8.0))
    found = learnt(samples(seen), learner(FINNED))
    assert [change for _, change in named(found)] == ["The fin is gone."]
    assert 15.0 < named(found)[0][0] < 15.0 + 6.0


def test_water_that_begins_to_move_is_named_and_everything_is_open_again():
    moving = replace(GUESS, current=(0.02, 0.02))
    found = learnt(samples(swum((MAMBA, GUESS, 26.0), (MAMBA, moving, 6.0))))
    changed = next(one for one in found if one.changes)
    assert changed.changes == ("The water is not what it was.",)
    assert 26.0 < changed.time < 26.0 + 6.0
    assert changed.deviation["current_x"] == 0.05
    assert changed.deviation["normal_drag"] == pytest.approx(0.3 * changed.value["normal_drag"])


def test_what_is_known_is_told_with_intervals_of_95_percent():
    value = {"normal_drag": 2.0, "play": 0.004, "current_x": -0.0123}
    learned = Learned(
        time=1.0, value=value, deviation={"normal_drag": 0.1, "play": 0.001, "current_x": 0.01}
    )
    assert (
        learned.line
        == "normal drag 2.0000 ± 0.1960, play 0.0040 ± 0.0020 rad, current x -0.0123 ± 0.0196 m/s"
    )


def test_a_cycle_is_odd_beyond_the_doubt_in_deviations_of_noise_and_opening():
    taught, n_cycles, n_rows = learner(), 2 * LEAST_STRETCHES, 12
    opening = float(taught._initial_std[0])
    size = 2.0 * n_rows * opening**2  # noise and opening count alike
    noise = np.tile([1.0, -1.0], (2 * (n_cycles + 1), n_rows // 2)) * math.sqrt(
        size * MEDIAN_OF_SQUARE
    )
    design = np.zeros((*noise.shape, taught._initial_std.size))
    design[..., 0] = 1.0
    usual = (
        LEAST_STRETCHES
        * (2.0 * size * n_rows + size**2 / opening**2)
        / (n_cycles + LEAST_STRETCHES)
    )
    limit = taught.settings.doubt * math.sqrt(usual)
    for share, is_odd in ((0.99, False), (1.01, True)):
        off = noise.copy()
        off[-2:, :2] += share * limit / 4.0  # of all rows the medians stay as they are
        assert taught._is_odd(off, design) == is_odd
    off = noise.copy()
    off[-2:, :2] += limit
    assert not taught._is_odd(
        off[-2 * LEAST_STRETCHES :], design[-2 * LEAST_STRETCHES :]
    )  # too few before it


def test_before_the_gait_begins_no_more_than_a_moment_is_remembered(good):
    taught = learner()
    state = taught.init()
    for sample in samples(good[:300]):
        state = state if isinstance(sample, ReferenceSample) else taught.step(state, sample)
    assert 5.0 < state.samples[PoseSample][0][0] < state.samples[PoseSample][-1][0] == good[299][0]


def test_what_cannot_be_learnt_is_refused():
    with pytest.raises(
        ValueError, match=r"`unknown\[0\]` must be one of `normal_drag`, .*, got 'density'"
    ):
        Learning(unknown=("density",))
    with pytest.raises(ValueError, match="`window` must be > 5 s, got 2"):
        Learning(window=2.0)
    on_ground = lc.build_plant(MAMBA, lc.load_ground("coulomb"), joints="servo")
    with pytest.raises(
        ValueError,
        match="`plant` must be in water for anything to be learned, got the ground `coulomb`",
    ):
        Learner(robot=MAMBA, plant=on_ground)
    with pytest.raises(ValueError, match="`plant` must have joints that follow references"):
        Learner(robot=MAMBA, plant=lc.build_plant(MAMBA, GUESS))
    with pytest.raises(ValueError, match="`module` must be < 9, the number of modules, got 20"):
        Learner(
            robot=MAMBA, plant=lc.build_plant(MAMBA, GUESS, joints="servo"), mount=Mount(module=20)
        )


def rough(good):
    """The same as seen by rough sensors in a lab whose axes are turned by 0.7 rad, with single wrong frames."""
    random, c, s = np.random.default_rng(5), math.cos(0.7), math.sin(0.7)
    plane = np.array([[c, -s], [s, c]])
    for time, angle, place, yaw in good:
        wrong = 0.05 * (random.random() < 0.01)
        yield (
            time,
            angle + random.normal(0.0, 2e-3, angle.size),
            plane @ place + random.normal(0.0, 1e-3, 2) + wrong,
            yaw + 0.7 + random.normal(0.0, 5e-3) + wrong,
        )


VALUE = {
    "normal_drag": 2.373281881454984,
    "tangential_friction": 0.2858634387771284,
    "play": 0.0,
    "crab": -0.0013853521867061385,
    "current_x": 0.008590244089419465,
    "current_y": 0.0017595906575339146,
}
DEVIATION = {
    "normal_drag": 0.11808639184113293,
    "tangential_friction": 0.0149630439175899,
    "play": 0.010012492197250393,
    "crab": 0.007069341131372192,
    "current_x": 0.0012457688601438294,
    "current_y": 0.0012731613822056641,
}
"""What was learnt of it on 2026-11-27, once everything else here held."""


def test_what_is_learnt_of_a_rough_run_stays_as_it_is(good):
    found = learnt(samples(rough(good)))
    assert (len(found), named(found)) == (8, [])
    assert found[-1].value == pytest.approx(VALUE, rel=1e-5)
    assert found[-1].deviation == pytest.approx(DEVIATION, rel=1e-5)
    for name in ("normal_drag", "tangential_friction"):
        assert abs(found[-1].value[name] - TRUE[name]) < 2.5 * found[-1].deviation[name], name
