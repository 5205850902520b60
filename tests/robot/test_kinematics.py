import dataclasses
import math
import re
from contextlib import contextmanager

import jaxtyping
import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.robot import CaudalFin, Module, Robot, Section, kinematics, load_robot
from laticauda.robot.kinematics import (
    Posture,
    from_quaternion,
    link_angles,
    module_poses,
    to_quaternion,
    turn,
)

SMALL_ANGLES = st.floats(-1.0, 1.0)


@contextmanager
def jaxtyping_disabled():
    jaxtyping.config.update("jaxtyping_disable", True)
    try:
        yield
    finally:
        jaxtyping.config.update("jaxtyping_disable", False)


SECTION = Section(half_height=0.05, half_width=0.04)
JOINT = load_robot("mamba").joints[0]
ANGLES = st.floats(-3.0, 3.0)


@st.composite
def robots(draw):
    """Robots of unequal links whose centers of mass are off their middles, some with a fin."""
    n = draw(st.integers(1, 6))
    modules = []
    for _ in range(n):
        length = draw(st.floats(0.05, 0.5))
        center = draw(st.floats(-0.4, 0.4)) * length
        modules.append(
            Module(length=length, mass=draw(st.floats(0.1, 3.0)), section=SECTION, center=center)
        )
    fin = draw(
        st.none()
        | st.builds(CaudalFin, length=st.floats(0.2, 1.0), thickness=st.floats(0.001, 0.1))
    )
    return Robot(name="any", modules=tuple(modules), joints=(JOINT,) * (n - 1), caudal_fin=fin)


@st.composite
def poses(draw, batch=(3,)):
    """A robot with a batch of poses: robot, center of mass, link angles, and their rates."""
    robot = draw(robots())
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    center_of_mass = rng.uniform(-5.0, 5.0, size=(*batch, 2))
    angles = rng.uniform(-3.0, 3.0, size=(2, *batch, robot.n_links))
    return robot, center_of_mass, *angles


def tangents(link_angle):
    return np.stack((np.cos(link_angle), np.sin(link_angle)), axis=-1)


@given(poses())
def test_masses_at_their_places_have_the_center_of_mass_that_was_given(pose):
    robot, center_of_mass, link_angle, _ = pose
    posture = Posture(robot, center_of_mass, link_angle)
    offset = np.array([module.center for module in robot.modules])
    mass = np.array([module.mass for module in robot.modules])
    place = posture.link_centers + offset[:, np.newaxis] * tangents(link_angle)
    moment, total = np.einsum("i,tij->tj", mass, place), np.sum(mass)
    if robot.caudal_fin is not None:
        moment += robot.caudal_fin.mass * 0.5 * (posture.link_ends[:, 0] + posture.trailing_edge)
        total += robot.caudal_fin.mass
    assert total == pytest.approx(robot.mass)
    np.testing.assert_allclose(moment / total, center_of_mass, atol=1e-12)


@given(poses())
def test_every_link_lies_between_its_ends_along_its_angle(pose):
    robot, center_of_mass, link_angle, _ = pose
    posture = Posture(robot, center_of_mass, link_angle)
    ends = posture.link_ends
    length = np.array([module.length for module in robot.modules])[:, np.newaxis]
    np.testing.assert_allclose(np.diff(ends, axis=1), length * tangents(link_angle), atol=1e-12)
    np.testing.assert_allclose(posture.link_centers, 0.5 * (ends[:, :-1] + ends[:, 1:]), atol=1e-12)


@given(poses())
def test_the_fin_extends_the_tail_link_backward_by_its_length(pose):
    robot, center_of_mass, link_angle, _ = pose
    posture = Posture(robot, center_of_mass, link_angle)
    length = robot.caudal_fin.length if robot.caudal_fin is not None else 0.0
    gap = posture.link_ends[:, 0] - posture.trailing_edge
    np.testing.assert_allclose(gap, length * tangents(link_angle)[:, 0], atol=1e-12)


@given(poses(), st.data())
def test_one_marker_and_the_joint_angles_give_the_whole_pose_back(pose, data):
    robot, center_of_mass, link_angle, link_rate = pose
    posture = Posture(robot, center_of_mass, link_angle)
    link = data.draw(st.integers(0, robot.n_links - 1))
    offset = data.draw(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)))

    # What motion capture sees of that link, and what the joints report.
    across = np.stack((-np.sin(link_angle[:, link]), np.cos(link_angle[:, link])), axis=-1)
    along = tangents(link_angle)[:, link]
    marker = posture.link_centers[:, link] + offset[0] * along + offset[1] * across
    joint_angle, joint_rate = (
        kinematics.joint_angles(link_angle),
        kinematics.joint_angles(link_rate),
    )

    theta = kinematics.link_angles(joint_angle, angle=link_angle[:, link], link=link)
    theta_rate = kinematics.link_angles(joint_rate, angle=link_rate[:, link], link=link)
    np.testing.assert_allclose(theta, link_angle, atol=1e-12)
    np.testing.assert_allclose(theta_rate, link_rate, atol=1e-12)
    p = kinematics.center_of_mass(robot, marker, theta, link=link, offset=offset)
    np.testing.assert_allclose(p, center_of_mass, atol=1e-11)


@given(poses(), ANGLES, st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)))
def test_a_pose_that_is_turned_and_moved_has_its_parts_turned_and_moved(pose, angle, shift):
    robot, center_of_mass, link_angle, _ = pose
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    here = Posture(robot, center_of_mass, link_angle)
    there = Posture(robot, center_of_mass @ rotation.T + shift, link_angle + angle)
    for part in ("link_ends", "link_centers", "trailing_edge"):
        np.testing.assert_allclose(
            getattr(there, part), getattr(here, part) @ rotation.T + shift, atol=1e-11
        )


@given(poses(batch=(2, 4)))
def test_any_leading_axes_give_what_each_pose_gives_alone(pose):
    robot, center_of_mass, link_angle, _ = pose
    every = Posture(robot, center_of_mass, link_angle)
    ends = every.link_ends
    back = kinematics.center_of_mass(robot, ends[..., 0, :], link_angle)
    assert ends.shape == (2, 4, robot.n_links + 1, 2)
    alone = Posture(robot, center_of_mass[1, 2], link_angle[1, 2])
    np.testing.assert_allclose(alone.link_ends, ends[1, 2], atol=1e-13)
    np.testing.assert_allclose(
        kinematics.center_of_mass(robot, ends[1, 2, 0], link_angle[1, 2]), back[1, 2], atol=1e-13
    )


@given(st.lists(ANGLES, min_size=0, max_size=8), ANGLES)
def test_link_angles_from_the_heading_have_that_heading_and_those_joint_angles(
    joint_angle, heading
):
    joint_angle = np.array(joint_angle, dtype=float)
    link_angle = kinematics.link_angles(joint_angle, angle=heading)
    assert kinematics.heading(link_angle) == pytest.approx(heading, abs=1e-12)
    np.testing.assert_allclose(kinematics.joint_angles(link_angle), joint_angle, atol=1e-12)


def test_a_positive_joint_angle_bends_the_head_side_to_the_left():
    robot = load_robot("chain", n_links=2)
    link_angle = kinematics.link_angles(np.array([0.5]), angle=0.0, link=0)
    ends = Posture(robot, np.zeros(2), link_angle).link_ends
    assert ends[2, 1] > ends[1, 1] == pytest.approx(ends[0, 1])


def test_the_fins_mass_moves_the_center_of_mass_of_straight_mamba_back():
    robot = load_robot("mamba-fin")
    ends = Posture(robot, np.zeros(2), np.zeros(9)).link_ends
    # 7.2 kg at mid-length, 0.81 m before the tail end, and 0.225 kg 0.25 m behind it.
    assert -ends[0, 0] == pytest.approx((7.2 * 0.81 - 0.225 * 0.25) / 7.425)
    bare = Posture(dataclasses.replace(robot, caudal_fin=None), np.zeros(2), np.zeros(9)).link_ends
    assert -bare[0, 0] == pytest.approx(0.81)


def test_a_robot_with_pitch_joints_and_its_planar_reduction_are_in_the_same_place():
    robot = load_robot("mamba-modules-fin")
    planar = robot.planar()
    link_angle = np.linspace(-0.5, 0.5, planar.n_links)
    place = np.array([0.3, -0.2])
    module_angle = np.repeat(link_angle, [round(module.length / 0.09) for module in planar.modules])
    here, there = (
        Posture(planar, place, link_angle).link_ends,
        Posture(robot, place, module_angle).link_ends,
    )
    np.testing.assert_allclose(here[0], there[0], atol=1e-12)
    np.testing.assert_allclose(here[-1], there[-1], atol=1e-12)


def test_a_lost_marker_loses_one_pose_only():
    robot = load_robot("mamba")
    marker = np.array([[0.0, 0.0], [np.nan, np.nan], [0.1, 0.0]])
    place = kinematics.center_of_mass(robot, marker, np.zeros((3, 9)))
    assert np.isnan(place[1]).all()
    assert np.isfinite(place[[0, 2]]).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda r: Posture(r, np.zeros(2), np.zeros(8)),
            "`link_angle` must have 9 columns, one per link of the robot",
        ),
        (
            lambda r: Posture(r, np.zeros((5, 2)), np.zeros((5, 1))),
            "`link_angle` must have 9 columns",
        ),
        (
            lambda r: Posture(r, np.zeros(3), np.zeros(9)),
            "`center_of_mass` must have 2 columns, x and y, got shape (3,).",
        ),
        (
            lambda r: kinematics.center_of_mass(r, np.zeros(1), np.zeros(9)),
            "`position` must have 2 columns",
        ),
    ],
)
def test_an_array_that_does_not_fit_the_robot_is_refused(call, message):
    # Without the tests' own check of shapes, which would speak first.
    with jaxtyping_disabled(), pytest.raises(ValueError, match=re.escape(message)):
        call(load_robot("mamba"))


def straight(robot):
    return Posture(robot, np.zeros(2), np.zeros(9))


def test_a_link_that_the_robot_does_not_have_is_refused():
    robot = load_robot("mamba")
    with pytest.raises(ValueError, match=r"`link` must be a whole number between 0 and 8, got 9\."):
        kinematics.center_of_mass(robot, np.zeros(2), np.zeros(9), link=9)
    with pytest.raises(ValueError, match=r"`link` must be a whole number >= 0, got -1\."):
        kinematics.link_angles(np.zeros(8), angle=0.0, link=-1)


# ---- in space ------------------------------------------------------------------------------------


@given(yaw=st.lists(SMALL_ANGLES, min_size=8, max_size=8), tail=SMALL_ANGLES)
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


@given(angles=st.lists(SMALL_ANGLES, min_size=18, max_size=18))
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
    from laticauda.models.simulate import build_plant
    from laticauda.robot import load_water
    from laticauda.scenarios.interfaces import Start
    from laticauda.tank.lab.virtual_robot import VirtualRobot

    robot = load_robot("mamba-modules")
    body = build_plant(robot, load_water("paper-lateral"), model="spatial", joints="servo")
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


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1)
)
def test_a_quaternion_gives_its_rotation_back(numbers):
    rotation = from_quaternion(*(np.array(numbers) / np.linalg.norm(numbers)).tolist())
    np.testing.assert_allclose(from_quaternion(*to_quaternion(rotation)), rotation, atol=1e-12)


def test_a_turn_about_no_axis_is_refused():
    with pytest.raises(ValueError, match=r"^`axis` must be one of `yaw`, `pitch`, `roll`, got"):
        turn("up", 0.1)
