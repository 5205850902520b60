"""Frames of viewers, against MuJoCo's kinematics of the URDF that they are about."""

import numpy as np
import pytest
from hypothesis import given, settings
from robot.strategies import robots

import laticauda as lc
from laticauda.models.spatial import mjcf
from laticauda.models.spatial.frames import Frames
from laticauda.robot.kinematics import from_quaternion
from laticauda.scenarios import Planar, Spatial

mujoco = pytest.importorskip("mujoco")
WATER = lc.load_water("paper-lateral")


@given(robots())
@settings(max_examples=15)
def test_every_frame_is_where_the_body_of_its_name_is_and_the_center_of_mass_as_asked(robot):
    model = mjcf.build_spec(robot, WATER, visuals=False, root="free", ballast_depth=0.01).compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(1)
    joints, fin = (
        rng.uniform(-0.5, 0.5, robot.n_joints),
        rng.uniform(-0.5, 0.5, len(robot.fin_joints)),
    )
    turn = rng.normal(size=4)
    data.qpos[3:7], data.qpos[7:] = turn / np.linalg.norm(turn), [*joints, *fin]
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    frames = Frames(robot, Spatial(root="free", ballast_depth=0.01))
    one = [values[np.newaxis] for values in (data.subtree_com[1], data.qpos[3:7], joints, fin)]
    moving = {
        name: (parent, place[0], turn[0])
        for name, (parent, place, turn) in frames.compute_moving_frames(*one).items()
    }
    assert not moving.keys() & frames.fixed.keys()
    tree = moving | frames.fixed  # in any order: a fin without a joint may carry hinges

    def placed(name):
        if name == "world":
            return np.zeros(3), np.eye(3)
        parent, place, turn = tree[name]
        origin, axes = placed(parent)
        return origin + axes @ place, axes @ from_quaternion(*turn)

    for name in tree:
        if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) >= 0:
            origin, axes = placed(name)
            np.testing.assert_allclose(origin, data.body(name).xpos, atol=1e-9)
            np.testing.assert_allclose(axes.ravel(), data.body(name).xmat, atol=1e-9)
    assert {f"module_{i}" for i in range(robot.n_links)} <= tree.keys()


def test_a_robot_with_pitch_joints_that_swims_in_the_plane_is_straight_about_them():
    robot = lc.load_robot("mamba-modules")
    yaw = [f"module_{i + 1}" for i, joint in enumerate(robot.joints) if joint.axis == "yaw"]
    found = Frames(robot, Planar()).compute_moving_frames(
        np.zeros((2, 2)),
        np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)),
        np.full((2, len(yaw)), 0.3),
        np.zeros((2, 0)),
    )
    bent = [name for name, (_, _, turn) in found.items() if turn[1, 0] < 1.0]
    assert bent == yaw and len(bent) < robot.n_joints
