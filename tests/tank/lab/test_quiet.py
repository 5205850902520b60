"""Faults that no device tells of."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import load_ground
from laticauda.robot.kinematics import turn
from laticauda.tank.lab import Fault, LabSettings, Tank, VirtualRobot, assist


def tank(robot: str | lc.Robot = "mamba-fin", **settings) -> Tank:
    built = lc.load_robot(robot) if isinstance(robot, str) else robot
    water = lc.load_water("paper-lateral")
    return Tank(
        VirtualRobot(built, lc.build_plant(built, water, joints="servo")), LabSettings(**settings)
    )


def frames(of: Tank, duration: float):
    of.captured()
    of.advance(duration)
    return of.captured()


def test_a_weak_motor_has_a_share_of_its_torque_for_as_long_as_is_asked_for():
    weak = tank()
    sound = weak.body.plant.robot.joints[3].actuator.stall_torque
    assist(weak, "weak_servo node=4 share=0.25 duration=0.5")
    weak.advance(0.2)
    torques = [joint.actuator.stall_torque for joint in weak.body.plant.robot.joints]
    assert torques[3] == 0.25 * sound
    assert {*torques[:3], *torques[4:]} == {sound}
    weak.advance(0.5)
    assert weak.body.plant.robot.joints[3].actuator.stall_torque == sound


def test_a_horn_slips_and_the_sensor_of_its_joint_with_it():
    slipping = tank()
    before = slipping.electronics.zero_error.copy()
    assist(slipping, "slipped_zero node=2 angle_deg=10")
    slipping.advance(3.0)
    change = slipping.electronics.zero_error - before
    assert math.degrees(-change[1]) == pytest.approx(10.0, abs=0.01)
    assert np.abs(np.delete(change, 1)).max() == 0.0


def test_the_rate_of_a_joint_is_that_of_the_sensor_that_slips():
    slipping = tank()
    assist(slipping, "slipped_zero node=2 angle_deg=10")
    step, slipped = slipping.settings.step, 0.0
    while slipping.time < 1.0:
        slipping.advance(step)
        slipped += slipping.electronics.slip_rate[1] * step
    assert math.degrees(-slipped) == pytest.approx(10.0 * (1.0 - math.exp(-1.0 / 0.3)), rel=0.01)
    assert slipping.electronics.slip_rate[[0, 2]].tolist() == [0.0, 0.0]


def test_a_fin_comes_off_and_only_one_that_can():
    losing = tank()
    assist(losing, "lost_fin")
    losing.advance(0.1)
    assert losing.body.plant.robot.caudal_fin is None
    fin = losing.body.robot.caudal_fin
    assert fin is not None
    bending = replace(losing.body.robot, caudal_fin=replace(fin, n_hinges=1, flexural_rigidity=0.1))
    with pytest.raises(
        ValueError, match="`kind` must not be `lost_fin`: only a fin without hinges"
    ):
        tank(bending).inject(Fault(kind="lost_fin"))


def test_water_that_begins_to_move_takes_the_robot_along():
    moved = tank()
    assist(moved, "moving_water speed=0.1 towards_deg=90")
    moved.advance(20.0)
    x, y, _ = moved.truth.center_of_mass
    assert y > 0.3 and abs(x) < 0.05
    robot, ground = lc.load_robot("mamba"), load_ground("viscous")
    dry = Tank(VirtualRobot(robot, lc.build_plant(robot, ground, joints="servo")))
    with pytest.raises(ValueError, match="`kind` must not be `moving_water` on land"):
        dry.inject(Fault(kind="moving_water"))


def test_a_marker_body_turns_where_it_is():
    slipped = tank(seed=3)
    assist(slipped, "marker_slip angle_deg=5")
    (true, *_), (said, *_) = frames(tank(seed=3), 0.1), frames(slipped, 0.1)
    assert said.bodies[0].position == pytest.approx(true.bodies[0].position)
    assert said.bodies[0].rotation == pytest.approx(
        true.bodies[0].rotation @ turn("yaw", math.radians(5.0))
    )


def test_another_body_lies_where_the_robot_was():
    wrong = tank()
    wrong.advance(0.1)
    assist(wrong, "wrong_body")
    assist(wrong, "moving_water speed=0.2")
    seen = np.array([frame.bodies[0].position for frame in frames(wrong, 10.0) if frame.bodies[0]])
    assert wrong.truth.center_of_mass[0] > 0.3
    assert np.ptp(seen, axis=0).max() < 0.01


def test_a_clock_is_fast_by_its_share():
    fast = tank()
    assist(fast, "clock_drift share=0.01")
    last, expected = frames(fast, 5.0)[-1], frames(tank(), 5.0)[-1]
    assert last.timestamp - expected.timestamp == pytest.approx(0.05, abs=1e-3)
