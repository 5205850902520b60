import json
import socket
import time
from pathlib import Path

import numpy as np
import pytest
from patience import complaints, until
from trials import run_trial

import laticauda as lc
from laticauda.tank import lab
from laticauda.tank.operate.drivers import Clock, DeviceFailed, driver_named
from laticauda.tank.protocol import bus_address
from laticauda_udp_json.driver import NoPose, read_datagram
from laticauda_udp_json.emulator import Sender

POSE = {
    "body": "fish",
    "time": 1.0,
    "position": [1.0, 2.0, -0.1],
    "quaternion": [0.5, 0.5, 0.5, 0.5],
}


@pytest.fixture
def address():
    """A port that is free."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return f"127.0.0.1:{probe.getsockname()[1]}"


@pytest.fixture
def sender(address):
    """Sends datagrams, of the body `fish` unless they are given, 100 times a second, in a thread of the tank's kind."""
    from laticauda.tank.protocol.worker import Worker

    class Repeated(Worker[None]):
        bodies = ("fish",)
        n_sent = 0

        def work(self):
            for body in self.bodies:
                self.n_sent += 1
                self.send_message(POSE | {"body": body, "time": 0.01 * self.n_sent})
            time.sleep(0.01)

        def send_message(self, message):
            self.send_bytes(json.dumps(message).encode())

        def send_bytes(self, data):
            host, port = address.split(":")
            self.line.sendto(data, (host, int(port)))

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line, Repeated("sender") as sender:
        sender.line = line
        sender._start()
        yield sender


def open_driver(address: str, body: str = ""):
    driver_class = driver_named("mocap", "udp-json", address)
    return driver_class(address, Clock(), body)


def receive_until(driver, are_enough) -> list:
    samples = []
    end = time.monotonic() + 20.0
    while not are_enough(samples) and time.monotonic() < end:
        samples += driver.receive()
        time.sleep(0.005)
    assert are_enough(samples)
    return samples


def test_a_datagram_says_where_a_body_is():
    body, pose = read_datagram(json.dumps(POSE | {"residual": 0.001}).encode())
    assert (body, pose.time, pose.residual) == ("fish", 1.0, 0.001)
    assert pose.position == pytest.approx([1.0, 2.0, -0.1])
    assert pose.rotation == pytest.approx(
        np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    )
    without_position = read_datagram(json.dumps(POSE | {"position": None}).encode())
    assert without_position.pose.is_lost


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"\xff\xfe", "utf-8"),
        (b"{", "Expecting property name"),
        (b"[1]", "list indices"),
        (b'{"body": "a"}', "'position' is missing"),
        (json.dumps(POSE | {"position": [1, 2]}).encode(), "`position` must be 3 finite numbers"),
        (json.dumps(POSE | {"time": float("nan")}).encode(), "`time` must be 1 finite numbers"),
        (json.dumps(POSE | {"time": 10**400}).encode(), "too large"),
        (
            json.dumps(POSE | {"quaternion": [1, 1, 1, 1]}).encode(),
            "`quaternion` must have length 1",
        ),
        (b"[" * 4000, "recursion|Expecting"),
    ],
)
def test_a_datagram_that_makes_no_sense_is_refused_with_a_reason(data, reason):
    with pytest.raises(NoPose, match=reason):
        read_datagram(data)


def test_an_unknown_body_is_refused_with_what_there_is(sender, address):
    with open_driver(address):
        pass
    with pytest.raises(DeviceFailed, match="has no body 'cat'; its bodies are: fish"):
        open_driver(address, "cat")
    sender.bodies = ("fish", "eel")
    with pytest.raises(
        DeviceFailed, match="The body must be named by `mocap_body`: the motion capture has"
    ):
        open_driver(address)
    with open_driver(address, "eel") as driver:
        receive_until(driver, lambda samples: len(samples) > 2)


def test_nonsense_is_told_and_what_is_late_or_of_others_is_lost(sender, address):
    with open_driver(address) as driver:
        sender.send_bytes(b"nonsense")
        sender.send_message(POSE | {"body": "other", "time": 1e6})
        poses = [pose for _, pose in receive_until(driver, lambda samples: len(samples) > 5)]
        assert [pose.time for pose in poses] == sorted({pose.time for pose in poses})
        sender.bodies = ()
        time.sleep(0.05)
        driver.receive()
        sender.send_message(POSE | {"time": poses[-1].time - 0.5})
        sender.send_bytes(b"nonsense")
        until(lambda: driver.trouble)
        assert "invalid datagram: Expecting value" in driver.trouble
        assert driver.receive() == ()


def test_a_clock_that_began_anew_is_followed(sender, address):
    with open_driver(address) as driver:
        sender.n_sent = 100_000
        receive_until(driver, lambda samples: any(pose.time > 900.0 for _, pose in samples))
        sender.n_sent = 0
        receive_until(driver, lambda samples: any(pose.time < 1.0 for _, pose in samples))


def test_a_whole_trial_runs_over_it_and_it_keeps_the_contract(address, tmp_path: Path, monkeypatch):
    robot = lc.load_robot("mamba")
    plant = lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    body = lab.VirtualRobot(robot, plant)
    nodes = lab.NodeSettings(hold_after=3.0, limp_after=4.0, startup_time=0.2, calibration_time=0.2)
    tank = lab.Tank(body, lab.LabSettings(nodes=nodes))
    virtual_lab = lab.Lab(tank, bus=bus_address("virtual:udp-json"))
    virtual_lab.server = Sender(address)
    result = run_trial(virtual_lab, tmp_path, bus="virtual:udp-json", mocap=f"udp-json@{address}")
    assert result.accepted, result.reason
    assert lc.load_trial(tmp_path / "whole.nc").forward_velocity > 0.0
    virtual_lab = lab.Lab(tank, bus=bus_address("virtual:udp-json"))
    virtual_lab.server = Sender(address)
    with virtual_lab:
        problems = complaints(
            monkeypatch,
            "mocap",
            f"udp-json@{address}",
            absent="udp-json@127.0.0.1:1",
            body=lab.BODY,
            duration=0.5,
        )
    assert problems == ()
