"""Loads of a motion that is known."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.planar import GivenMotion, evaluate_motion
from laticauda.robot import kinematics, textbook_of
from laticauda.scenarios import Command, Start

GAIT = lc.lateral_undulation(amplitude=0.3, frequency=6.0, phase_shift=0.7)
STEP = 0.002


def slope(series, log):
    return np.gradient(series, log.time, axis=0, edge_order=2)


def swum(robot):
    """Return plant, motion and log of some moments of a swim."""
    plant = lc.build_plant(robot, textbook_of(robot), dt=STEP)
    command = Command(gait=GAIT)
    log = plant.march(plant.init(Start(), command), command, 3.0, STEP, link_forces=True).log
    part = slice(200, 1200)
    motion = GivenMotion(
        time=log.time[part],
        center_of_mass=log.center_of_mass[part],
        velocity=log.center_of_mass_velocity[part],
        heading=log.heading[part],
        heading_rate=log.heading_rate[part],
        joint_angle=log.joint_angle[part],
        joint_rate=log.joint_rate[part],
        joint_acceleration=slope(log.joint_rate, log)[part],
    )
    return plant, motion, log, part


@pytest.mark.parametrize("name", ["amphibot", "mamba-fin", "tendon-fish"])
def test_the_motion_of_a_swim_has_the_loads_of_that_swim(name):
    plant, motion, log, part = swum(lc.load_robot(name))
    loads = evaluate_motion(plant, motion)
    expected = {
        "acceleration": slope(log.center_of_mass_velocity, log)[part],
        "heading_acceleration": slope(log.heading_rate, log)[part],
        "joint_torque": log.joint_torque[part],
        "link_force": sum(log.link_force.values())[part],
    }
    for field, values in expected.items():
        # What the edge remembers of the time before the motion is forgotten by then.
        miss = np.abs(getattr(loads, field) - values)[-200:].max()
        assert miss < 1e-3 * np.abs(values).max(), field


def test_a_force_that_is_not_in_the_model_is_left_over():
    robot = lc.load_robot("mamba-fin")
    plant, motion, _, _ = swum(robot)
    force = np.array([0.3, 0.2])
    pulled = replace(robot, tether=replace(robot.tether, force=tuple(force.tolist())))
    real = evaluate_motion(lc.build_plant(pulled, plant.environment, dt=STEP), motion)
    left = evaluate_motion(plant, motion).left_over(real.acceleration, real.heading_acceleration)
    np.testing.assert_allclose(left[:, 1:], np.tile(force, (len(left), 1)), atol=1e-10)
    angle = kinematics.link_angles(motion.joint_angle, angle=motion.heading)
    posture = kinematics.Posture(robot, motion.center_of_mass, angle)
    arm = posture.link_ends[:, 0] - motion.center_of_mass
    np.testing.assert_allclose(left[:, 0], arm[:, 0] * 0.2 - arm[:, 1] * 0.3, atol=1e-10)


def test_driven_joints_are_refused():
    robot = lc.load_robot("amphibot")
    _, motion, _, _ = swum(robot)
    plant = lc.build_plant(robot, textbook_of(robot), joints="pd")
    with pytest.raises(ValueError, match=r"plant.joints.*prescribed"):
        evaluate_motion(plant, motion)
