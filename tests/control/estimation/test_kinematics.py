"""Kinematics alone: what one pose and the joint angles say, between samples, over a span, around full turns."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.estimation import (
    JointSample,
    KinematicEstimator,
    KinematicState,
    Mount,
    PoseSample,
    ReferenceSample,
)
from laticauda.robot.kinematics import Posture, module_poses, turn

ROBOT = lc.load_robot("mamba")
BUILT = lc.load_robot("mamba-modules")
USUAL = KinematicEstimator(robot=ROBOT)


def joints(time: float, *angle: float, robot: lc.Robot = ROBOT) -> JointSample:
    return JointSample(time=time, angle=np.resize(np.array(angle or (0.0,)), robot.n_joints))


def frame(time: float, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> PoseSample:
    return PoseSample(time=time, position=np.array([x, y, 0.0]), rotation=turn("yaw", yaw))


def after(*samples: object, estimator: KinematicEstimator = USUAL) -> KinematicState:
    state = estimator.init()
    for sample in samples:
        state = estimator.step(state, sample)
    return state


def test_the_pose_is_that_of_the_marked_module_on_the_bent_robot():
    mount = Mount(module=3, offset=(0.02, 0.05), angle=0.2)
    estimator = KinematicEstimator(robot=ROBOT, mount=mount)
    theta, p = 0.1 * np.arange(9.0), np.array([1.0, -2.0])
    link = Posture(ROBOT, p, theta).link_centers[3]
    c, s = math.cos(theta[3]), math.sin(theta[3])
    marker = link + np.array([c * 0.02 - s * 0.05, s * 0.02 + c * 0.05])
    state = after(
        joints(0.0, *np.diff(theta)), frame(0.0, *marker, yaw=theta[3] + 0.2), estimator=estimator
    )
    found = estimator.estimate(state)
    assert found.link_angle == pytest.approx(theta)
    assert found.center_of_mass == pytest.approx(p)
    assert found.heading == pytest.approx(theta.mean()) and found.pitch == 0.0
    assert found.center_of_mass_velocity.tolist() == [0.0, 0.0] and found.heading_rate == 0.0
    assert found.joint_rate.tolist() == [0.0] * 8
    assert (found.time, found.status, found.age) == (0.0, "tracking", 0.0)


def test_joint_angles_are_those_of_the_frames_time():
    state = after(joints(1.0, 0.0), joints(1.1, 0.2), frame(1.025))
    assert USUAL.estimate(state).joint_angle == pytest.approx([0.05] * 8)
    held = after(joints(1.0, 0.0), joints(1.1, 0.2), frame(1.2))
    assert USUAL.estimate(held).joint_angle == pytest.approx([0.2] * 8)


@pytest.mark.parametrize(("later", "on"), [(-0.025, -0.05), (0.02, 0.06), (0.1, 0.3), (5.0, 0.3)])
def test_after_the_last_sample_joints_go_on_at_their_rates_for_the_span_at_most(
    later: float, on: float
):
    rate = np.array([3.0] * 7 + [math.nan])
    last = JointSample(time=1.1, angle=np.full(8, 0.2), rate=rate)
    found = USUAL.estimate(after(joints(1.0, 0.0), last, frame(1.1 + later))).joint_angle
    assert found == pytest.approx([0.2 + on] * 7 + [0.2 + min(on, 0.0)])


def test_velocities_are_differences_over_the_span():
    times = [0.02 * k for k in range(11)]
    samples = [
        one
        for t in times
        for one in (joints(t, 3.0 * t), frame(t, 0.5 * t, -0.25 * t, yaw=2.0 * t))
    ]
    state = after(*samples)
    assert [one.time for one in state.frames] == pytest.approx(times[5:])
    found = USUAL.estimate(state)
    first, last = state.frames[0], state.frames[-1]
    assert found.center_of_mass_velocity == pytest.approx(
        (last.center_of_mass - first.center_of_mass) / 0.1
    )
    assert found.heading_rate == pytest.approx((last.heading - first.heading) / 0.1)
    assert found.joint_rate == pytest.approx([3.0] * 8)
    assert [time for time, *_ in state.joints] == pytest.approx(times[1:])  # of twice the span
    single = USUAL.estimate(after(*samples[:2]))
    assert single.heading_rate == 0.0


def test_later_than_the_last_frame_nothing_moves_and_the_status_tells_how_old_it_is():
    state = after(joints(1.0), frame(1.0))
    for time, age, status in (
        (None, 0.0, "tracking"),
        (0.5, 0.0, "tracking"),
        (1.5, 0.5, "bridging"),
        (4.0, 3.0, "lost"),
    ):
        found = USUAL.estimate(state, time)
        assert (found.time, found.age, found.status) == (1.0 + age, age, status)
    assert USUAL.estimate(USUAL.init()) is None


def test_the_heading_goes_on_beyond_half_a_turn():
    samples = [one for k in range(80) for one in (joints(0.1 * k), frame(0.1 * k, yaw=0.1 * k))]
    assert USUAL.estimate(after(*samples)).heading == pytest.approx(7.9)
    back = [one for k in range(80) for one in (joints(0.1 * k), frame(0.1 * k, yaw=-0.1 * k))]
    found = USUAL.estimate(after(*back))
    assert found.heading == pytest.approx(-7.9) and found.link_angle == pytest.approx([-7.9] * 9)


@pytest.mark.parametrize(
    "sample",
    [
        ReferenceSample(time=2.0, angle=np.zeros(8)),
        PoseSample(time=2.0, position=np.full(3, np.nan), rotation=np.eye(3)),
        PoseSample(time=2.0, position=np.zeros(3)),
        frame(1.0, x=9.0),
        frame(0.9, x=9.0),
        JointSample(time=2.0, angle=np.array([np.nan] + [0.0] * 7)),
        joints(1.0, 9.0),
        joints(0.5, 9.0),
    ],
)
def test_what_is_old_or_tells_nothing_is_left_out(sample):
    state = after(joints(1.0), frame(1.0))
    assert USUAL.step(state, sample) is state


def test_old_is_what_comes_before_the_last_sample_of_its_kind():
    state = after(joints(1.0), frame(1.0), joints(1.1), frame(1.1))
    assert USUAL.step(state, joints(1.05, 9.0)) is state
    assert USUAL.step(state, frame(1.05, x=9.0)) is state
    assert USUAL.step(state, joints(1.11)).joints[-1][0] == 1.11
    assert [(one.age, one.heading_rate) for one in state.frames] == [
        (0.0, 0.0)
    ] * 2  # kept without velocities


def test_a_robot_that_spins_is_followed_from_frame_to_frame():
    samples = [one for k in range(20) for one in (joints(0.02 * k), frame(0.02 * k, yaw=0.8 * k))]
    found = USUAL.estimate(after(*samples))
    assert found.heading == pytest.approx(0.8 * 19) and found.heading_rate == pytest.approx(40.0)


def test_a_frame_before_any_joint_sample_tells_nothing():
    assert after(frame(1.0)).frames == ()


def test_in_space_the_whole_rotation_counts_and_so_do_all_joints():
    mount = Mount(module=4, offset=(0.01, 0.02, 0.03), angle=0.4)
    estimator = KinematicEstimator(robot=BUILT, mount=mount, in_space=True)
    tail = turn("yaw", 0.5) @ turn("pitch", 0.2) @ turn("roll", 0.3)
    angle = np.linspace(-0.2, 0.3, BUILT.n_joints)
    poses = module_poses(BUILT, np.array([1.0, 2.0, -0.5]), tail, angle)
    at = poses.rotation[4]
    seen = PoseSample(
        time=0.0,
        position=poses.position[4] + at @ np.array([0.01, 0.02, 0.03]),
        rotation=at @ turn("yaw", 0.4),
    )
    found = estimator.estimate(after(JointSample(time=0.0, angle=angle), seen, estimator=estimator))
    assert found.center_of_mass == pytest.approx([1.0, 2.0, -0.5])
    forward = poses.rotation[:, :, 0]
    assert found.link_angle == pytest.approx(np.arctan2(forward[:, 1], forward[:, 0]))
    assert found.pitch == pytest.approx(float(np.mean(-np.arcsin(forward[:, 2]))))
    assert found.heading == pytest.approx(found.link_angle.mean())
    assert found.joint_angle == pytest.approx(angle)
    flat = replace(mount, offset=(0.01, 0.02))
    level = replace(estimator, mount=flat)
    marker = replace(seen, position=poses.position[4] + at @ np.array([0.01, 0.02, 0.0]))
    again = level.estimate(after(JointSample(time=0.0, angle=angle), marker, estimator=level))
    assert again.center_of_mass == pytest.approx([1.0, 2.0, -0.5])


def test_it_measures_in_the_plane_over_a_tenth_of_a_second_unless_told_otherwise():
    assert (USUAL.in_space, USUAL.span) == (False, 0.1)
    with pytest.raises(ValueError, match=r"`span` must be > 0 s, got 0"):
        KinematicEstimator(robot=ROBOT, span=0.0)
