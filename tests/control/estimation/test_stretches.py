"""A robot's way beside that of its twin, stretch by stretch."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.estimation import Mount
from laticauda.control.estimation.filter import PLAY_TORQUE
from laticauda.control.estimation.stretches import POINTS, POSITION, TICKS, Stretches
from laticauda.robot.kinematics import Posture

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7)
ROBOT, WATER = lc.load_robot("mamba"), lc.load_water("paper-lateral")
TWIN = lc.build_plant(ROBOT, WATER)
STILL = np.zeros(2)


@pytest.fixture(scope="module")
def trial():
    return lc.swim(ROBOT, GAIT, environment=WATER, duration=9.0, sample_interval=0.02)


def stretches(trial, *, torque=0.0, play=0.0, begin=0.5):
    marker = Posture(ROBOT, trial.center_of_mass, trial.link_angle).link_centers[:, 0]
    poses = np.stack((trial.time, *marker.T, trial.link_angle[:, 0]))
    side = np.full(trial.joint_angle.T.shape, torque)
    angle = trial.joint_angle.T + 0.5 * play * np.tanh(side / PLAY_TORQUE)
    joints = np.concatenate((trial.time[np.newaxis], angle, side))
    bounds = begin + math.pi / GAIT.frequency * np.arange(6)
    return Stretches(robot=ROBOT, mount=Mount(), bounds=bounds, poses=poses, joints=joints)


def settled(off):
    """Without the first stretches, in which a twin comes to swim as the robot does."""
    return off[:, 2:]


def test_a_robot_that_swims_as_its_twin_is_hardly_off_it(trial):
    off, way = stretches(trial).compare_with_twin(TWIN, 0.0, STILL)
    assert off.shape == way.shape == (3, 5, TICKS)
    assert np.abs(settled(off)).max() < 1.0  # mm, and 3 mrad
    assert np.abs(way[0]).max() > 10.0


def test_the_choice_of_world_axes_does_not_matter(trial):
    seen, turn = stretches(trial), 1.1
    time, x, y, yaw = seen.poses
    c, s = math.cos(turn), math.sin(turn)
    turned = replace(seen, poses=np.stack((time, c * x - s * y, s * x + c * y, yaw + turn)))
    current = np.array([0.01, -0.02])
    along = np.array([c * current[0] - s * current[1], s * current[0] + c * current[1]])
    for one, other in zip(
        seen.compare_with_twin(TWIN, 0.0, current),
        turned.compare_with_twin(TWIN, 0.0, along),
        strict=True,
    ):
        assert other[0] + 1j * other[1] == pytest.approx(
            (one[0] + 1j * one[1]) * np.exp(1j * turn), abs=1e-5
        )
        assert other[2] == pytest.approx(one[2], abs=1e-5)


def test_water_that_drags_more_puts_it_off(trial):
    other = replace(TWIN, environment=replace(WATER, normal_drag=1.1 * WATER.normal_drag))
    off, _ = stretches(trial).compare_with_twin(other, 0.0, STILL)
    assert np.abs(settled(off)).max() > 1.0


def test_play_is_taken_off_where_gears_touch(trial):
    seen = stretches(trial, torque=1.0, play=0.02)
    wrong, right = (
        np.abs(settled(seen.compare_with_twin(TWIN, play, STILL)[0])).max() for play in (0.0, 0.02)
    )
    assert right < 1.0
    assert wrong > 2.0 * right


def test_a_current_and_a_robot_that_points_elsewhere_enter_as_they_are_compared(trial):
    seen = stretches(trial)
    (off, way), (drifted, _) = (
        seen.compare_with_twin(TWIN, 0.0, current) for current in (STILL, np.array([0.01, -0.02]))
    )
    rows = seen.reduce_to_medians([off, drifted], way)
    assert rows.shape == (5, 3 * POINTS, 5)
    crab, x, y = np.moveaxis(rows[..., 2:], -1, 0)
    assert rows[..., 0] - rows[..., 1] == pytest.approx(0.01 * x - 0.02 * y, abs=0.05)
    angle = 1e-4
    turned = np.stack((way[0] - angle * way[1], way[1] + angle * way[0], way[2]))
    before, after = np.moveaxis(seen.reduce_to_medians([way, turned], way)[..., :2], -1, 0)
    assert np.abs(after - before - angle * crab).max() < 0.05 * np.abs(angle * crab).max()


def test_the_place_and_heading_of_each_stretch_do_not_count(trial):
    seen = stretches(trial)
    off, way = seen.compare_with_twin(TWIN, 0.0, STILL)
    moved = off + np.array([3.0, -2.0, 0.0])[:, np.newaxis, np.newaxis]
    rows = seen.reduce_to_medians([off, moved], way)
    assert rows[..., 1] == pytest.approx(rows[..., 0], abs=1e-9)


def test_single_wrong_frames_do_not_count(trial):
    seen = stretches(trial)
    poses = seen.poses.copy()
    poses[1, 200] += 0.5
    torn = replace(seen, poses=poses)
    (off, way), (wrong, _) = (one.compare_with_twin(TWIN, 0.0, STILL) for one in (seen, torn))
    assert np.abs(wrong - off).max() > 0.3 / POSITION
    rows = seen.reduce_to_medians([off, wrong], way)
    assert np.abs(rows[..., 1] - rows[..., 0]).max() < 50.0
