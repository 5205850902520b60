"""Forces of the force/torque sensors, as anybody reads them from the bus."""

import math
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import cantools
import numpy as np
import pytest
from lab_parts import EXACT, Operator, make_tank

import laticauda as lc
from laticauda.motion.gaits import Generator
from laticauda.tank import protocol
from laticauda.tank.lab import Tank, VirtualRobot

DATABASE = cantools.database.load_file(str(Path(protocol.__file__).with_name("mamba.dbc")))
GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=120, phase_shift_deg=40)
RESOLUTION = 0.01
"""Of a force on the bus [N]."""


def references():
    """Yield references of all joints, 100 times a second: the pitch joints stay straight."""
    generator = Generator(n_links=10, ramp=0.0)
    state = generator.init(GAIT)
    while True:
        angles = np.zeros(18)
        angles[::2] = generator.joints(state, GAIT)[0]
        yield angles
        state = generator.step(state, GAIT, 0.01)


def forces_on_the_bus(tank, seconds):
    """Yield what cantools reads of every force/torque sensor as it is sent: node, force (None if not available)."""
    operator = Operator(tank).ready()
    angles = references()
    for _ in range(round(seconds / 0.01)):
        for message in (*protocol.encode_references(next(angles)), protocol.Sync(counter=1)):
            tank.receive(*protocol.encode(message))
        tank.sent()
        operator.tank.advance(0.01)
        for identifier, data in tank.sent():
            message = DATABASE.get_message_by_frame_id(identifier)
            if not message.name.startswith("Loads"):
                continue
            signals = message.decode(data, decode_choices=False)
            force = np.array([signals[f"Force{name}"] for name in ("Along", "Left", "Up")])
            yield identifier - 0x280, None if force[0] < -327.0 else force


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_cantools_reads_what_the_joints_carry(model):
    tank = make_tank(model=model)
    body = tank.body
    largest = 0.0
    heard = set()
    for node, force in forces_on_the_bus(tank, 2.0):
        if (
            model == "planar" and node % 2 == 0
        ):  # a pitch joint, of which a planar world knows nothing
            assert force is None
            continue
        heard.add(node)
        joint = int(np.flatnonzero(body.driven == node - 1)[0])
        # By another way than the node's: from the log of a short march.
        march = body.plant.march(body._state, body._command, 1e-6, 1e-6, link_forces=True)
        expected = march.log.joint_force[0, joint]
        np.testing.assert_allclose(force, expected, atol=0.51 * RESOLUTION)
        largest = max(largest, np.abs(force).max())
    assert len(heard) == (9 if model == "planar" else 18)
    assert largest > 3.0


def test_a_force_sensor_has_a_zero_that_is_off_and_noise():
    nodes = replace(EXACT.nodes, force_noise=0.2, force_zero_error=1.0)
    robot = lc.load_robot("mamba-modules")
    plant = lc.build_plant(robot, "paper-lateral", joints="servo")
    tank = Tank(VirtualRobot(robot, plant), replace(EXACT, nodes=nodes))
    readings = defaultdict(list)
    tank.advance(20.0)  # limp and at rest: nothing but the sensors' errors
    for identifier, data in tank.sent():
        message = protocol.decode(identifier, data)
        if isinstance(message, protocol.Loads) and message.force is not None:
            readings[message.node].append(message.force)
    assert sorted(readings) == list(range(1, 19, 2))
    zeros = np.array([np.mean(values, axis=0) for values in readings.values()])
    noise = np.array([np.std(values, axis=0) for values in readings.values()])
    assert 0.7 < np.abs(zeros).max() < 1.1
    assert zeros.std() == pytest.approx(1.0 / math.sqrt(3.0), rel=0.3)
    np.testing.assert_allclose(noise, 0.2, rtol=0.2)


def test_the_other_readings_are_those_of_before_forces_were_known():
    """Noise of forces has a source of its own: recordings of one seed stay what they were."""
    sent = []
    for noise in (0.0, 0.3):
        nodes = replace(EXACT.nodes, angle_noise=0.01, torque_noise=0.02, force_noise=noise)
        robot = lc.load_robot("mamba-modules")
        plant = lc.build_plant(robot, "paper-lateral", joints="servo")
        tank = Tank(VirtualRobot(robot, plant), replace(EXACT, nodes=nodes))
        messages = []
        operator = Operator(tank)
        operator.ready()
        for message in operator.cycle(np.zeros(18), 20):
            if isinstance(message, protocol.Loads):
                message = replace(message, force=None)
            messages.append(message)
        sent.append(messages)
    assert sent[0] == sent[1]


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_the_node_of_a_driven_fin_tells_what_pushes_the_tail(model):
    robot = lc.load_robot("mamba-modules-fin")
    robot = replace(robot, caudal_fin=replace(robot.caudal_fin, joint=robot.joints[0]))
    plant = lc.build_plant(robot, "paper-lateral", joints="servo", model=model)
    tank = Tank(VirtualRobot(robot, plant), EXACT)
    body = tank.body
    heard = 0
    operator = Operator(tank).ready()
    angles = references()
    for _ in range(100):
        for message in operator.cycle(np.append(next(angles), 0.0)):
            if not isinstance(message, protocol.Loads) or message.node != 19:
                continue
            heard += 1
            expected = body.plant.evaluate_loads(body._state, body._command).fin_force
            np.testing.assert_allclose(message.force, expected, atol=0.51 * RESOLUTION)
    assert heard > 10
    assert np.abs(expected).max() > 0.1
