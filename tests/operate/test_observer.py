import math
import time
from dataclasses import replace

import numpy as np
import pytest
from lab_parts import Operator, make_tank

import laticauda as lc
from laticauda.lab import Lab
from laticauda.operate.drivers.mocap import pose_sample
from laticauda.operate.observer import Listener, PassiveObserver
from laticauda.operate.settings import Connection
from laticauda.protocol import (
    Heartbeat,
    JointState,
    NodeCommand,
    Order,
    Sync,
    bus_address,
    open_bus,
    references,
    to_frame,
)
from laticauda.robot import Joint

ROBOT = lc.load_robot("mamba-modules")


def looked(observer, view, operator, angles, n):
    """After n cycles of an operator; with what was heard at the time of the tank."""
    for _ in range(n):
        messages = operator.cycle(angles) if angles is not None else idle(operator)
        now = operator.tank.time
        frames = [(now, pose_sample(frame.timestamp, frame.bodies[0])) for frame in operator.tank.captured()]
        view = observer.step(view, now, [(now, message) for message in messages if message is not None], frames)
    return view


def idle(operator):
    operator.tank.advance(0.01)
    return operator.heard()


def test_an_observer_knows_where_the_robot_is_and_how_it_is_bent():
    operator, observer = Operator(make_tank()).ready(), PassiveObserver(robot=ROBOT)
    operator.tank.captured()
    angles = [0.2 * math.sin(0.8 * k) for k in range(ROBOT.n_joints)]
    view = looked(observer, observer.init(operator.tank.time), operator, angles, 150)
    truth, found = operator.tank.truth, observer.estimate(view, operator.tank.time)
    assert observer.complaint(view, operator.tank.time) == ""
    assert found.status == "tracking"
    np.testing.assert_allclose(found.joint_angle, truth.joint_angle[[j.axis == "yaw" for j in ROBOT.joints]], atol=0.01)
    np.testing.assert_allclose(found.center_of_mass, truth.center_of_mass[:2], atol=0.005)


def test_a_robot_that_nobody_operates_is_drawn_straight_where_the_cameras_see_it():
    operator, observer = Operator(make_tank()), PassiveObserver(robot=ROBOT)
    operator.tank.carry(lc.Start(center_of_mass=(2.0, -0.5), heading=0.4))
    operator.tank.advance(0.5)
    view = looked(observer, observer.init(operator.tank.time), operator, None, 260)
    found = observer.estimate(view, operator.tank.time)
    np.testing.assert_allclose(found.center_of_mass, (2.0, -0.5), atol=0.01)
    assert found.heading == pytest.approx(0.4, abs=0.01)
    assert observer.complaint(view, operator.tank.time).startswith("Nobody operates the robot: ")


def test_what_is_missing_from_the_picture_is_said():
    observer = PassiveObserver(robot=lc.load_robot("mamba"))
    view = observer.init(0.0)
    assert observer.complaint(view, 0.1) == ""
    assert "No module is heard" in observer.complaint(view, 3.0)
    beats = [(3.0, Heartbeat(node=node, state=2)) for node in range(1, 9)]
    view = observer.step(view, 3.0, beats[:7], ())
    assert "sends no frames" in observer.complaint(view, 3.0)
    other = observer.step(view, 3.0, [(3.0, Heartbeat(node=18, state=2))], ())
    assert observer.complaint(other, 3.0).startswith("Module 18 is heard, and mamba has 8 joints: choose the robot")


def test_the_module_behind_the_last_joint_says_how_a_driven_fin_is_turned():
    own = lc.load_robot("mamba-fin")
    robot = replace(own, caudal_fin=replace(own.caudal_fin, joint=Joint()))
    observer = PassiveObserver(robot=robot)
    view = observer.init(0.0)
    assert observer.fin_angle(view) == 0.0
    said = JointState(node=robot.n_joints + 1, angle=0.4, rate=0.0, current=0.0, torque=0.0)
    assert observer.fin_angle(observer.step(view, 1.0, [(1.0, said)], ())) == 0.4
    assert PassiveObserver(robot=own).fin_angle(PassiveObserver(robot=own).init(0.0)) == 0.0


def operated(bus, seconds):
    """Operate the robot of a lab for a while; what else was heard on the bus meanwhile."""
    end, k = time.monotonic() + seconds, 0
    bus.send(to_frame(NodeCommand(order=Order.ENABLE)))
    while time.monotonic() < end:
        k += 1
        for message in (*references([0.1] * ROBOT.n_joints), Sync(counter=k % 65536)):
            bus.send(to_frame(message))
        time.sleep(0.02)


def until(condition, patience=20.0):
    end = time.monotonic() + patience
    while not condition() and time.monotonic() < end:
        time.sleep(0.05)
    return condition()


def test_a_listener_sends_nothing_and_waits_for_a_lab_that_comes_goes_and_comes_back(monkeypatch):
    from can.interfaces.virtual import VirtualBus

    senders = []
    send = VirtualBus.send
    monkeypatch.setattr(
        VirtualBus,
        "send",
        lambda bus, *args, **settings: (senders.append(bus), send(bus, *args, **settings))[1],
    )
    monkeypatch.setattr("laticauda.protocol.worker.RETRY", 0.1)
    address = bus_address("virtual:test_observer")
    lab = Lab(make_tank(), bus=address, port=0)
    port = lab.open().mocap_port
    lab.close()  # now the port is known, and nobody is there
    listener = Listener(Connection(can_interface="virtual", can_channel="test_observer", mocap_port=port), ROBOT)
    try:
        assert until(lambda: f"127.0.0.1:{port}" in listener.look().trouble)
        assert listener.look().estimate is None
        for _ in range(2):
            lab = Lab(make_tank(), bus=address, port=port)
            with lab, open_bus(address) as bus:
                assert until(lambda: listener.look().estimate is not None)
                operated(bus, 0.5)
                assert until(lambda: listener.look().estimate.status == "tracking")
                assert len({id(sender) for sender in senders}) == 2  # the lab and its operator
            senders.clear()
            assert until(lambda: listener.look().trouble != "")
    finally:
        listener.close()
        listener.join(10.0)
    assert not listener._thread.is_alive()
