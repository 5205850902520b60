"""Heat, play and supply of the modules against their formulas, with the constants that the documentation gives."""

import math
from dataclasses import replace

import numpy as np
import pytest
from lab_parts import EXACT, make_tank

from laticauda.motion.joints import Servo
from laticauda.tank.lab import LabSettings, NodeSettings
from laticauda.tank.lab.instruments import Electronics

OFF, ON = np.zeros(18, dtype=bool), np.ones(18, dtype=bool)


@pytest.fixture(scope="module")
def tank():
    return make_tank()


def electronics(tank, settings: LabSettings = EXACT) -> Electronics:
    return Electronics(tank.body.robot, settings, np.random.default_rng(0), Servo())


def test_the_constants_are_those_that_were_chosen():
    nodes = NodeSettings()
    assert (nodes.backlash, nodes.thermal_resistance, nodes.heat_capacity) == (0.0087, 3.0, 50.0)
    assert (nodes.current_limit, nodes.current_time, nodes.temperature_limit) == (4.4, 3.0, 80.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_sensor_leads_by_half_the_play_to_the_side_to_which_the_motor_pulls(tank, sign):
    found = electronics(tank, replace(EXACT, nodes=replace(EXACT.nodes, backlash=0.01)))
    pulled = replace(tank.truth, joint_torque=np.full(18, sign * 5.0))
    for _ in range(100):
        found.advance(pulled, pulled.joint_angle, OFF, OFF, 0.01)
    np.testing.assert_allclose(found.offset(np.zeros(18)), sign * 0.005, rtol=1e-6)


def test_a_hot_motor_cools_by_its_time_constant_to_the_water(tank):
    found = electronics(tank)
    found.temperature[:] = 68.0
    for _ in range(1500):
        found.advance(tank.truth, tank.truth.joint_angle, OFF, OFF, 0.1)
    nodes = NodeSettings()
    gone = math.exp(-150.0 / (nodes.thermal_resistance * nodes.heat_capacity))
    np.testing.assert_allclose(found.temperature, 18.0 + 50.0 * gone, rtol=1e-3)


def test_a_stalled_motor_heats_until_the_water_takes_what_its_winding_gives(tank):
    found = electronics(tank)
    actuator = tank.body.robot.joints[0].actuator
    stalled = tank.truth.joint_angle + 10.0  # the reference is far away, and the joint stands
    for _ in range(4000):
        found.advance(tank.truth, stalled, ON, OFF, 0.5)
    assert found.current == pytest.approx(actuator.stall_current)
    heat = actuator.voltage * actuator.stall_current  # R I^2 with R = V / I_stall
    np.testing.assert_allclose(found.temperature, 18.0 + 3.0 * heat, rtol=1e-4)
