"""A slice of campaigns/learning_twin.py: what a twin learns from samples, and what it names."""

import math
from dataclasses import replace

import campaign_scripts
import numpy as np
import pytest

import laticauda as lc
from laticauda.estimation import JointSample, PoseSample, ReferenceSample
from laticauda.kinematics import Posture, turn

GAIT = lc.lateral_undulation(amplitude=math.radians(30), frequency=math.radians(120), phase_shift=math.radians(40))
TRUE = {"normal_drag": 2.1, "tangential_friction": 0.25, "current_x": 0.006, "current_y": -0.004}


@pytest.fixture(scope="module")
def twin():
    campaign_scripts.campaign("learning_twin")
    import _learning_twin

    return _learning_twin


@pytest.fixture(scope="module")
def swum():
    current = (TRUE["current_x"], TRUE["current_y"])
    coefficients = {name: TRUE[name] for name in ("normal_drag", "tangential_friction")}
    water = replace(lc.load_water("paper-lateral"), current=current, **coefficients)
    return lc.swim(lc.load_robot("mamba"), GAIT, environment=water, duration=24.0, sample_interval=0.02)


def learnt(twin, trial, joint_angle=None):
    robot = trial.robot
    learning = twin.Learning(twin.Learner(), robot, lc.plant(robot, lc.load_water("paper-lateral"), joints="servo"))
    marker = Posture(robot, trial.center_of_mass, trial.link_angle).link_centers[:, 0]
    angle = trial.joint_angle if joint_angle is None else joint_angle
    found = []
    for k, time in enumerate(trial.time.tolist()):
        rotation = turn("yaw", float(trial.link_angle[k, 0]))
        learning.step(JointSample(time=time, angle=angle[k]))
        learning.step(PoseSample(time=time, position=np.append(marker[k], 0.0), rotation=rotation))
        sent = ReferenceSample(time=time, angle=trial.joint_angle_ref[k], frequency=GAIT.frequency)
        found += [one for one in [learning.step(sent)] if one is not None]
    return found


def test_drag_friction_and_current_are_learnt_in_twenty_seconds_from_another_guess(twin, swum):
    *_, last = learnt(twin, swum)
    assert last.time > 20.0
    for name, value in TRUE.items():
        assert last.known[name][0] == pytest.approx(value, rel=0.01, abs=1e-3), name
        assert abs(last.known[name][0] - value) < 2.0 * last.known[name][1], name
    assert not any(one.changes for one in learnt(twin, swum))


def test_a_joint_that_jams_is_named_within_two_cycles(twin, swum):
    angle = swum.joint_angle.copy()
    jam = np.searchsorted(swum.time, 15.0)
    angle[jam:, 3] = angle[jam, 3]
    named = [(one.time, one.changes[0]) for one in learnt(twin, swum, angle) if one.changes]
    assert named[0][1].startswith("Joint 4 is stuck: it swings ")
    assert named[0][0] < 15.0 + 6.0


def test_ground_teaches_nothing(twin):
    robot, ground = lc.load_robot("mamba"), lc.load_ground("coulomb")
    with pytest.raises(
        ValueError, match="`plant` must be in water for anything to be learnt, got the ground `coulomb`"
    ):
        twin.Learning(twin.Learner(), robot, lc.plant(robot, ground, joints="servo"))
