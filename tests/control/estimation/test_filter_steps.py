"""The filter, one sample at a time: what every sample does to the state, with numbers that are worked out beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.estimation import (
    Estimator,
    EstimatorState,
    FilterState,
    JointSample,
    KinematicEstimator,
    Mount,
    Noise,
    PoseSample,
    ReferenceSample,
)
from laticauda.control.estimation.filter_state import Gaussian, PastStep
from laticauda.control.estimation.state_vector import JOINTS, VX, VY, H, R, S, U, X, Y
from laticauda.robot.kinematics import turn

ROBOT = lc.load_robot("mamba")
USUAL = Estimator(robot=ROBOT)
BUILT = lc.load_robot("mamba-fin")


def joints(
    time: float, angle: float | np.ndarray = 0.0, torque: float | None = None
) -> JointSample:
    pull = None if torque is None else np.full(8, torque)
    return JointSample(time=time, angle=np.broadcast_to(angle, 8), torque=pull)


def references(time: float, angle: float = 0.0, frequency: float = 0.0) -> ReferenceSample:
    return ReferenceSample(time=time, angle=np.full(8, angle), frequency=frequency)


def frame(
    time: float, x: float = 0.0, y: float = 0.0, yaw: float | None = 0.0, residual: float = 0.0
) -> PoseSample:
    rotation = None if yaw is None else turn("yaw", yaw)
    return PoseSample(
        time=time, position=np.array([x, y, 0.0]), rotation=rotation, residual=residual
    )


def after(*samples: object, estimator: Estimator = USUAL) -> EstimatorState:
    state = estimator.init()
    for sample in samples:
        state = estimator.step(state, sample)
    return state


def started(estimator: Estimator = USUAL, angle: float | np.ndarray = 0.0) -> EstimatorState:
    """Just after the first frame, at 1 s."""
    return after(joints(1.0, angle), frame(1.0, 0.5, -0.2, 0.3), estimator=estimator)


def test_the_settings_are_what_the_documentation_says_of_them():
    assert (USUAL.swim_speed, USUAL.swim_speed_std, USUAL.plant, USUAL.coupling) == (
        None,
        0.01,
        None,
        1.0,
    )
    assert (USUAL.backlash, USUAL.gate, USUAL.largest_residual) == (0.0, 5.0, 0.005)
    assert (USUAL.patience, USUAL.joint_patience, USUAL.horizon) == (10, 3, 0.1)
    model = replace(USUAL, swim_speed=0.2, swim_speed_std=0.03, mount=Mount(module=2)).model
    assert (model.swim_speed, model.swim_speed_std, model.link, model.has_twin) == (
        0.2,
        0.03,
        2,
        False,
    )
    beside = replace(USUAL, mount=Mount(module=2)).twin_model
    assert beside.has_twin and beside.noise == Noise().beside_twin and beside.link == 2


@pytest.mark.parametrize(
    ("name", "rule"),
    [
        ("swim_speed_std", "> 0 m/s"),
        ("coupling", ">= 0"),
        ("backlash", ">= 0 rad"),
        ("gate", "> 0"),
        ("largest_residual", "> 0 m"),
        ("horizon", ">= 0 s"),
    ],
)
def test_a_setting_at_the_edge_of_its_range(name, rule):
    number = -1e-9 if rule.startswith(">=") else 0.0
    with pytest.raises(ValueError, match=rf"`{name}` must be {rule}, got {number}"):
        replace(USUAL, **{name: number})
    if rule.startswith(">="):
        assert getattr(replace(USUAL, **{name: 0.0}), name) == 0.0
    assert replace(USUAL, patience=1).patience == 1
    with pytest.raises(ValueError, match=r"`module` must be < 9, the number of modules, got 12\."):
        replace(USUAL, mount=Mount(module=12))


def test_the_first_frame_with_the_joints_before_it_gives_the_pose_that_kinematics_gives():
    mount = Mount(module=3, offset=(0.02, 0.05), angle=0.2)
    angle = np.linspace(-0.3, 0.4, 8)
    state = started(replace(USUAL, mount=mount), angle)
    plain = KinematicEstimator(robot=ROBOT, mount=mount)
    alone = plain.init()
    for sample in (joints(1.0, angle), frame(1.0, 0.5, -0.2, 0.3)):
        alone = plain.step(alone, sample)
    there, here = plain.estimate(alone), replace(USUAL, mount=mount).estimate(state)
    assert here.center_of_mass == pytest.approx(there.center_of_mass)
    assert here.heading == pytest.approx(there.heading)
    assert here.link_angle == pytest.approx(there.link_angle)
    assert here.joint_angle == pytest.approx(angle)
    assert here.joint_rate == pytest.approx(np.zeros(8))
    assert (here.time, here.age, here.status) == (1.0, 0.0, "tracking")
    straight = USUAL.estimate(started())
    assert straight.center_of_mass_std == pytest.approx(
        0.05
    ) and straight.heading_std == pytest.approx(0.05)
    assert straight.current.tolist() == [0.0, 0.0] and straight.current_std == pytest.approx(0.1)
    assert state.latest.joint_angle is None and state.latest.frame_time == 1.0


def test_deviations_are_those_from_the_references_that_the_joints_have_come_to():
    state = after(references(0.0, 0.2), references(1.0, 0.2), joints(1.02, 0.3), frame(1.02))
    now = state.latest
    lagged = 0.2 * (1.0 - (1.0 + 25.0 * 1.02) * math.exp(-25.0 * 1.02))
    assert now.lagged == pytest.approx(np.full(8, lagged))
    assert now.posterior.mean[JOINTS::2] == pytest.approx(0.3 - now.lagged)
    assert now.posterior.mean[JOINTS + 1 :: 2] == pytest.approx(-now.lagged_rate)
    early = after(references(0.0, 0.2), joints(0.05, 0.1), frame(0.05)).latest
    assert early.lagged_rate[0] == pytest.approx(0.2 * 25.0**2 * 0.05 * math.exp(-1.25))
    assert early.posterior.mean[JOINTS + 1 :: 2] == pytest.approx(-early.lagged_rate)
    found = USUAL.estimate(after(references(0.0, 0.2), joints(0.05, 0.1), frame(0.05)))
    assert found.joint_rate == pytest.approx(np.zeros(8)) and found.joint_angle == pytest.approx(
        np.full(8, 0.1)
    )


def test_before_the_first_frame_the_last_angle_of_every_module_counts():
    known = np.full(8, 0.1)
    partly = known.copy()
    partly[3] = math.nan
    none = np.full(8, math.nan)
    first = after(joints(0.0, partly)).latest
    assert first.joint_angle.tolist() == [0.1, 0.1, 0.1, 0.0, 0.1, 0.1, 0.1, 0.1]
    then = after(joints(0.0, known), joints(0.1, np.where(np.isnan(partly), math.nan, 0.2))).latest
    assert then.joint_angle.tolist() == [0.2, 0.2, 0.2, 0.1, 0.2, 0.2, 0.2, 0.2]
    assert after(joints(0.0, none)).latest.joint_angle is None
    assert (
        after(joints(0.0, known), joints(0.1, none)).latest.joint_angle.tolist() == known.tolist()
    )


@pytest.mark.parametrize(
    "seen", [frame(0.5), frame(1.5, yaw=None), frame(1.5, residual=0.0051), frame(1.5, x=math.nan)]
)
def test_what_says_no_whole_pose_begins_nothing(seen):
    samples = (seen, joints(1.0)) if seen.time < 1.0 else (joints(1.0), seen)
    assert after(*samples).latest.posterior is None
    assert USUAL.estimate(after(*samples)) is None
    rotation = np.full((3, 3), math.nan)
    assert after(joints(1.0), replace(frame(1.5), rotation=rotation)).latest.posterior is None


def test_over_time_the_model_goes_on_in_steps_of_at_most_50_ms():
    state = started()
    now, model = state.latest, USUAL.model
    for duration, steps in ((0.05, 1), (0.0501, 2), (0.2, 4), (0.21, 5)):
        known = now.posterior
        for _ in range(steps):
            mean, f, q = model.step(known.mean, now.lagged, now.frequency, duration / steps)
            known = known.predict(mean, f, q)
        found = USUAL.estimate(state, now.time + duration)
        place, heading, rows = model.pose(known.mean, now.lagged)
        spread = rows @ known.covariance @ rows.T
        assert found.center_of_mass == pytest.approx(place, abs=1e-12)
        assert found.heading == pytest.approx(heading, abs=1e-12)
        assert found.center_of_mass_std == pytest.approx(math.sqrt(np.mean(np.diag(spread)[:2])))
        assert found.heading_std == pytest.approx(math.sqrt(spread[2, 2]))
        assert found.current_std == pytest.approx(math.sqrt(known.covariance[VX, VX]))
        assert (found.time, found.age) == pytest.approx((1.0 + duration, duration))
    assert (
        USUAL.estimate(state, 0.5).time == USUAL.estimate(state).time == 1.0
    )  # it never goes back


def test_the_current_is_uncertain_along_its_less_certain_direction():
    state = started()
    covariance = state.latest.posterior.covariance.copy()
    covariance[VX, VX], covariance[VY, VY], covariance[VX, VY] = 0.04, 0.01, 0.015
    covariance[VY, VX] = 0.015
    mean = state.latest.posterior.mean.copy()
    mean[[VX, VY]] = 0.3, -0.1
    tilted = replace(state.latest, posterior=Gaussian(mean=mean, covariance=covariance))
    found = USUAL.estimate(EstimatorState(history=(PastStep(None, tilted),)))
    largest = np.linalg.eigvalsh(covariance[VX : VY + 1, VX : VY + 1]).max()
    assert found.current_std == pytest.approx(math.sqrt(largest))
    assert found.current.tolist() == [0.3, -0.1]


def test_joints_update_by_the_sensors_noise_and_silent_ones_do_not():
    state = started()
    angle = np.full(8, 0.01)
    angle[3] = math.nan
    known = state.latest.posterior
    rows = np.zeros((7, known.mean.size))
    rows[np.arange(7), JOINTS + 2 * np.delete(np.arange(8), 3)] = 1.0
    expected = known.update(np.full(7, 0.01), rows, math.radians(0.3) ** 2 * np.eye(7))
    found = USUAL.step(state, joints(1.0, angle)).latest.posterior
    np.testing.assert_allclose(found.mean, expected.mean, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(found.covariance, expected.covariance, rtol=1e-9, atol=1e-15)
    assert USUAL.step(state, joints(1.0, np.full(8, math.nan))).latest.posterior is known


def test_a_joint_at_the_gate_is_taken_in_and_beyond_it_rejected_and_counted():
    state = started()
    at = JOINTS + 4
    spread = float(np.sqrt(state.latest.posterior.covariance[at, at] + math.radians(0.3) ** 2))
    for share, n in ((0.999, 0), (1.0, 0), (1.001, 1), (-0.999, 0), (-1.0, 0), (-1.001, 1)):
        angle = np.zeros(8)
        angle[2] = share * (5.0 * spread)
        now = USUAL.step(state, joints(1.0, angle)).latest
        assert now.n_joint_rejected.tolist() == [0, 0, n, 0, 0, 0, 0, 0]
        assert (now.posterior.mean[at] == 0.0) == bool(n)


def test_a_joint_is_believed_when_it_insists_as_often_as_patience_says_and_silence_neither_counts_nor_forgets():
    estimator = replace(USUAL, joint_patience=3)
    state, off = started(estimator), np.zeros(8)
    off[2] = 0.8
    silent, back = off.copy(), np.zeros(8)
    silent[2] = math.nan
    counts = []
    for angle in (off, back, off, silent, off, off):
        state = estimator.step(state, joints(1.0, angle))
        counts.append(int(state.latest.n_joint_rejected[2]))
    assert counts == [1, 0, 1, 1, 2, 0]
    posterior, at = state.latest.posterior, JOINTS + 4
    assert posterior.mean[at] == pytest.approx(0.8) and posterior.mean[at + 1] == 0.0
    assert posterior.covariance[at, at] == pytest.approx(math.radians(0.3) ** 2)
    assert posterior.covariance[at + 1, at + 1] == pytest.approx(1.0)
    assert state.latest.n_joint_rejected.tolist() == [0] * 8


def displaced(
    estimator: Estimator, state: EstimatorState, share: float, *, with_yaw: bool
) -> PoseSample:
    """A frame whose squared distance is a share of what the gate lets pass, off in x alone."""
    now = state.latest
    expected, rows = estimator.model.marker(now.posterior.mean, now.lagged)
    n = 3 if with_yaw else 2
    noise = np.diag([1e-6, 1e-6, math.radians(0.1) ** 2][:n])
    unit = now.posterior.squared_distance(np.eye(n)[0], rows[:n], noise)
    off = math.sqrt(share * (n + 5.0 * math.sqrt(2.0 * n)) / unit)
    return frame(1.0, expected[0] + off, expected[1], expected[2] if with_yaw else None)


@pytest.mark.parametrize("with_yaw", [True, False])
def test_a_frame_at_the_gate_is_taken_in_and_beyond_it_rejected_and_counted(with_yaw):
    state = started()
    well = USUAL.step(state, displaced(USUAL, state, 0.999, with_yaw=with_yaw))
    assert (well.latest.n_rejected, well.n_outliers) == (0, 0)
    assert well.latest.posterior is not state.latest.posterior
    wrong = USUAL.step(state, displaced(USUAL, state, 1.001, with_yaw=with_yaw))
    assert (wrong.latest.n_rejected, wrong.n_outliers) == (1, 1)
    assert wrong.latest.posterior is state.latest.posterior and wrong.latest.frame_time == 1.0
    again = USUAL.step(wrong, displaced(USUAL, state, 1.001, with_yaw=with_yaw))
    assert (again.latest.n_rejected, again.n_outliers) == (2, 2)


@pytest.mark.parametrize("yaw", [None, 0.31])
def test_a_frame_updates_by_the_cameras_noise(yaw):
    state, seen = started(), frame(1.0, 0.501, -0.199, yaw)
    known = state.latest.posterior
    expected, rows = USUAL.model.marker(known.mean, state.latest.lagged)
    n = 3 if yaw else 2
    residual = (np.array([0.501, -0.199, yaw or 0.0]) - expected)[:n]
    after_it = known.update(residual, rows[:n], np.diag([1e-6, 1e-6, math.radians(0.1) ** 2][:n]))
    found = USUAL.step(state, seen).latest.posterior
    np.testing.assert_allclose(found.mean, after_it.mean, rtol=1e-9, atol=1e-14)
    np.testing.assert_allclose(found.covariance, after_it.covariance, rtol=1e-6, atol=1e-14)


def test_of_a_frame_whose_rotation_is_partly_unknown_the_place_counts():
    state, partly = started(), turn("yaw", 0.9)
    partly[2, 2] = math.nan
    found = USUAL.step(state, replace(frame(1.0, 0.501, -0.199), rotation=partly)).latest.posterior
    expected = USUAL.step(state, frame(1.0, 0.501, -0.199, None)).latest.posterior
    assert np.array_equal(found.mean, expected.mean)


def test_a_whole_turn_more_is_the_same_angle():
    state = started()
    mean = state.latest.posterior.mean.copy()
    mean[H] += 4.0 * math.pi
    turned = replace(state.latest, posterior=replace(state.latest.posterior, mean=mean))
    found = USUAL.step(
        EstimatorState(history=(PastStep(None, turned),)), frame(1.0, 0.5, -0.2, 0.3)
    )
    assert found.n_outliers == 0
    assert found.latest.posterior.mean[H] == pytest.approx(mean[H], abs=1e-6)


def test_frames_that_all_contradict_it_open_pose_and_speeds_again():
    estimator = replace(USUAL, patience=3)
    state = started(estimator)
    far = frame(1.0, 3.0, 2.0, -1.0)
    for n in (1, 2):
        state = estimator.step(state, far)
        assert state.latest.n_rejected == n
    known = state.latest.posterior
    covariance = known.covariance.copy()
    for at, variance in ((X, 1.0), (Y, 1.0), (H, 1.0), (U, 0.1), (S, 0.1), (R, 1.0)):
        covariance[at, at] += variance
    expected, rows = estimator.model.marker(known.mean, state.latest.lagged)
    residual = np.array([3.0, 2.0, -1.0]) - expected
    opened = Gaussian(mean=known.mean, covariance=covariance)
    opened = opened.update(residual, rows, np.diag([1e-6, 1e-6, math.radians(0.1) ** 2]))
    state = estimator.step(state, far)
    assert (state.latest.n_rejected, state.n_outliers) == (0, 2)
    np.testing.assert_allclose(state.latest.posterior.mean, opened.mean, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(
        state.latest.posterior.covariance, opened.covariance, rtol=1e-6, atol=1e-12
    )


def test_markers_that_do_not_fit_are_an_outlier_and_a_body_that_is_lost_is_nothing():
    state = started()
    assert USUAL.step(state, frame(1.0, 0.5, -0.2, 0.3, residual=0.005)).n_outliers == 0
    bad = USUAL.step(state, frame(1.0, 0.5, -0.2, 0.3, residual=0.0051))
    assert (bad.n_outliers, bad.latest.n_rejected) == (1, 1)
    assert bad.latest.posterior is state.latest.posterior
    lost = USUAL.step(state, frame(1.0, x=math.nan))
    assert (lost.n_outliers, lost.latest.n_rejected) == (0, 0)


def test_backlash_is_taken_off_on_the_side_to_which_the_motor_pulls():
    estimator = replace(USUAL, backlash=0.04)
    for torque, pulled in (
        (3.0, 0.02),
        (-3.0, -0.02),
        (0.3, 0.02 * math.tanh(1.0)),
        (0.0, 0.0),
        (math.nan, 0.0),
    ):
        now = after(joints(0.0, 0.1, torque), estimator=estimator).latest
        assert now.joint_angle == pytest.approx(np.full(8, 0.1 - pulled), abs=1e-9)
    wide = after(joints(0.0, 0.1, 3.0), estimator=replace(USUAL, backlash=1.0)).latest
    assert wide.joint_angle == pytest.approx(np.full(8, -0.4), abs=1e-7)
    assert after(joints(0.0, 0.1), estimator=estimator).latest.joint_angle == pytest.approx(
        np.full(8, 0.1)
    )
    assert after(joints(0.0, 0.1, 3.0)).latest.joint_angle == pytest.approx(np.full(8, 0.1))


def test_references_count_from_their_time_on_with_the_gaits_frequency_and_a_fins():
    now = after(references(0.0, 0.2, 2.0)).latest
    assert now.reference.tolist() == [0.2] * 8 and now.lagged.tolist() == [0.0] * 8
    assert (now.frequency, now.fin_reference, now.time) == (2.0, (), 0.0)
    finned = replace(ROBOT, caudal_fin=replace(BUILT.caudal_fin, joint=lc.robot.Joint()))
    both = ReferenceSample(time=0.0, angle=np.array([0.2] * 8 + [-0.4]))
    assert after(both, estimator=Estimator(robot=finned)).latest.fin_reference == (-0.4,)


def test_samples_of_one_moment_are_taken_in_as_they_come_and_late_ones_where_they_belong():
    samples = joints(1.0), frame(1.0, 0.5, -0.2, 0.3)
    later = [joints(1.02, 0.01), frame(1.03, 0.501, -0.2, 0.3), joints(1.04, 0.02)]
    straight = after(*samples, *later)
    mixed = after(*samples, later[0], later[2], later[1])
    assert np.array_equal(mixed.latest.posterior.mean, straight.latest.posterior.mean)
    assert np.array_equal(mixed.latest.posterior.covariance, straight.latest.posterior.covariance)
    assert [one.time for _, one in mixed.history] == [one.time for _, one in straight.history]
    assert mixed.n_late == mixed.n_outliers == 0
    whole = after(*samples, *later, joints(1.2))
    early = USUAL.step(whole, joints(0.5))
    assert early.n_late == 1 and early.history is whole.history
    assert USUAL.step(early, joints(0.5)).n_late == 2
    outlier = USUAL.step(straight, frame(1.035, 9.0))
    assert outlier.n_outliers == 1  # once, although what came after it is taken in again
    assert USUAL.step(outlier, joints(1.036)).n_outliers == 1


def test_samples_that_come_at_once_are_worth_the_same_one_by_one_or_in_any_parts():
    came = [
        joints(1.0),
        frame(1.0, 0.5, -0.2, 0.3),
        joints(1.02, 0.01),
        joints(1.04, 0.02),
        joints(1.06, 0.03),
    ]
    came += [
        frame(1.03, 0.501, -0.2, 0.3),
        joints(0.5),
        frame(1.05, 0.502, -0.2, 0.31),
        joints(1.2),
        joints(1.05),
    ]
    one = after(*came)
    for cuts in ([10], [5, 5], [2, 4, 4]):
        state, at = USUAL.init(), 0
        for n in cuts:
            state, at = USUAL.steps(state, came[at : at + n]), at + n
        assert np.array_equal(state.latest.posterior.mean, one.latest.posterior.mean)
        assert np.array_equal(state.latest.posterior.covariance, one.latest.posterior.covariance)
        assert [known.time for _, known in state.history] == [
            known.time for _, known in one.history
        ]
        assert state.n_late == one.n_late == 2


def test_of_the_past_the_horizon_is_kept():
    state = after(*(joints(0.01 * k) for k in range(40)))
    assert state.history[0][1].time == pytest.approx(0.29) and len(state.history) == 11
    assert USUAL.step(state, joints(0.2905)).n_late == 0
    assert USUAL.step(state, joints(0.285)).n_late == 1


def test_samples_from_before_the_begin_are_left_out():
    state = USUAL.init(5.0)
    assert USUAL.step(state, joints(4.99)).n_late == 1
    assert USUAL.step(state, joints(5.0)).latest.joint_angle is not None
    first = USUAL.init().latest
    assert isinstance(first, FilterState) and first.time == -math.inf
    assert first.n_joint_rejected.tolist() == first.reference.tolist() == [0] * 8


def test_before_the_first_frame_a_long_time_is_no_work():
    state = after(references(0.0, 0.2), references(1e12, 0.1))
    assert state.latest.lagged == pytest.approx(np.full(8, 0.2))
