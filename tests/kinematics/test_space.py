import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from laticauda.kinematics import (
    Posture,
    from_quaternion,
    link_angles,
    module_poses,
    to_quaternion,
    turn,
)
from laticauda.robot import load_robot

ANGLES = st.floats(-1.0, 1.0)


@given(yaw=st.lists(ANGLES, min_size=8, max_size=8), tail=ANGLES)
@pytest.mark.parametrize("name", ["mamba", "mamba-fin"])
def test_a_level_robot_is_where_the_plane_has_it(name, yaw, tail):
    robot = load_robot(name)
    poses = module_poses(robot, np.array([1.0, 2.0, -0.3]), turn("yaw", tail), np.array(yaw))
    links = link_angles(np.array(yaw), angle=tail, link=0)
    expected = Posture(robot, np.array([1.0, 2.0]), links).link_centers
    np.testing.assert_allclose(poses.position[:, :2], expected, atol=1e-12)
    np.testing.assert_allclose(poses.position[:, 2], -0.3, atol=1e-12)
    np.testing.assert_allclose(poses.rotation[:, 0, 0], np.cos(links), atol=1e-12)
    np.testing.assert_allclose(poses.rotation[:, 1, 0], np.sin(links), atol=1e-12)


@given(angles=st.lists(ANGLES, min_size=18, max_size=18))
def test_the_masses_middle_is_the_center_of_mass(angles):
    robot = load_robot("mamba-modules")
    center = np.array([0.3, -0.2, 0.1])
    poses = module_poses(robot, center, turn("yaw", 0.4), np.array(angles), ballast_depth=0.005)
    masses = np.array([module.mass for module in robot.modules])
    middles = poses.position - 0.005 * poses.rotation[:, :, 2]
    np.testing.assert_allclose(masses @ middles / masses.sum(), center, atol=1e-12)
    squares = poses.rotation @ poses.rotation.transpose(0, 2, 1)
    np.testing.assert_allclose(squares, np.tile(np.eye(3), (19, 1, 1)), atol=1e-9)


def test_positive_pitch_turns_the_head_down_and_positive_yaw_to_the_left():
    robot = load_robot("mamba-modules")
    angles = np.zeros(18)
    angles[1] = 0.5  # the tail-most pitch joint
    down = module_poses(robot, np.zeros(3), np.eye(3), angles)
    assert down.rotation[-1][2, 0] == pytest.approx(-math.sin(0.5))
    angles = np.zeros(18)
    angles[0] = 0.5
    left = module_poses(robot, np.zeros(3), np.eye(3), angles)
    assert left.rotation[-1][1, 0] == pytest.approx(math.sin(0.5))


@given(angle=st.floats(-3, 3))
def test_a_quaternion_about_the_vertical_is_that_turn(angle):
    half = 0.5 * angle
    found = from_quaternion(math.cos(half), 0.0, 0.0, math.sin(half))
    np.testing.assert_allclose(found, turn("yaw", angle), atol=1e-12)


def test_a_spatial_body_is_where_its_model_has_it():
    from laticauda.interfaces import Start
    from laticauda.lab.virtual_robot import VirtualRobot
    from laticauda.robot import load_water
    from laticauda.simulate import plant

    robot = load_robot("mamba-modules")
    body = plant(robot, load_water("paper-lateral"), model="spatial", joints="servo")
    world = VirtualRobot(robot, body, Start(center_of_mass=(0.5, 0.2), heading=0.7))
    references = 0.3 * np.sin(np.arange(18.0))
    for _ in range(50):
        world.advance(references, np.ones(18, dtype=bool), 0.01)
    data = body.data(world._state)
    modules = [body.model.body(f"module_{i}").id for i in range(19)]
    expected = np.array([data.xmat[i].reshape(3, 3) for i in modules])
    np.testing.assert_allclose(world.truth.modules.rotation, expected, atol=1e-9)
    steps = np.diff(world.truth.modules.position, axis=0)
    half = 0.045 * expected[:, :, 0]
    np.testing.assert_allclose(steps, half[:-1] + half[1:], atol=1e-9)
    np.testing.assert_allclose(data.subtree_com[modules[0]], world.truth.center_of_mass, atol=1e-9)


@given(st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_a_quaternion_gives_its_rotation_back(numbers):
    rotation = from_quaternion(*(np.array(numbers) / np.linalg.norm(numbers)).tolist())
    np.testing.assert_allclose(from_quaternion(*to_quaternion(rotation)), rotation, atol=1e-12)
