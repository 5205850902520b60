import json
import socket
import time
from pathlib import Path

import numpy as np
import pytest
from patience import complaints, until
from trials import swum

import laticauda as lc
from laticauda.tank import lab
from laticauda.tank.operate.drivers import Clock, DeviceFailed, driver_named
from laticauda.tank.protocol import bus_address
from laticauda_udp_json.driver import NoPose, decoded
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
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return f"127.0.0.1:{one.getsockname()[1]}"


@pytest.fixture
def sender(address):
    """Sends datagrams, of the body `fish` unless they are given, 100 times a second, in a thread of the tank's kind."""
    from laticauda.tank.protocol.worker import Worker

    class Repeated(Worker[None]):
        bodies, sent = ("fish",), 0

        def work(self):
            for body in self.bodies:
                self.sent += 1
                self.say(POSE | {"body": body, "time": 0.01 * self.sent})
            time.sleep(0.01)

        def say(self, said):
            host, port = address.split(":")
            self.line.sendto(
                said if isinstance(said, bytes) else json.dumps(said).encode(), (host, int(port))
            )

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line, Repeated("sender") as one:
        one.line = line
        one._start()
        yield one


def made(address: str, body: str = ""):
    return driver_named("mocap", "udp-json", address)(address, Clock(), body)


def received(driver, wanted) -> list:
    found, end = [], time.monotonic() + 20.0
    while not wanted(found) and time.monotonic() < end:
        found += driver.receive()
        time.sleep(0.005)
    assert wanted(found)
    return found


def test_a_datagram_says_where_a_body_is():
    body, pose = decoded(json.dumps(POSE | {"residual": 0.001}).encode())
    assert (body, pose.time, pose.residual) == ("fish", 1.0, 0.001)
    assert pose.position == pytest.approx([1.0, 2.0, -0.1])
    assert pose.rotation == pytest.approx(
        np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    )
    assert decoded(json.dumps(POSE | {"position": None}).encode())[1].is_lost


@pytest.mark.parametrize(
    ("data", "why"),
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
def test_a_datagram_that_makes_no_sense_is_refused_with_a_reason(data, why):
    with pytest.raises(NoPose, match=why):
        decoded(data)


def test_an_unknown_body_is_refused_with_what_there_is(sender, address):
    with made(address):
        pass
    with pytest.raises(DeviceFailed, match="has no body 'cat'; its bodies are: fish"):
        made(address, "cat")
    sender.bodies = ("fish", "eel")
    with pytest.raises(
        DeviceFailed, match="The body must be named by `mocap_body`: the motion capture has"
    ):
        made(address)
    with made(address, "eel") as driver:
        received(driver, lambda found: len(found) > 2)


def test_nonsense_is_told_and_what_is_late_or_of_others_is_lost(sender, address):
    with made(address) as driver:
        sender.say(b"nonsense")
        sender.say(POSE | {"body": "other", "time": 1e6})
        poses = [pose for _, pose in received(driver, lambda found: len(found) > 5)]
        assert [pose.time for pose in poses] == sorted({pose.time for pose in poses})
        sender.bodies = ()
        time.sleep(0.05)
        driver.receive()
        sender.say(POSE | {"time": poses[-1].time - 0.5})
        sender.say(b"nonsense")
        until(lambda: driver.trouble)
        assert "invalid datagram: Expecting value" in driver.trouble
        assert driver.receive() == ()


def test_a_clock_that_began_anew_is_followed(sender, address):
    with made(address) as driver:
        sender.sent = 100_000
        received(driver, lambda found: any(pose.time > 900.0 for _, pose in found))
        sender.sent = 0
        received(driver, lambda found: any(pose.time < 1.0 for _, pose in found))


def test_a_whole_trial_runs_over_it_and_it_keeps_the_contract(address, tmp_path: Path, monkeypatch):
    robot = lc.load_robot("mamba")
    body = lab.VirtualRobot(
        robot, lc.build_plant(robot, lc.load_water("paper-lateral"), joints="servo")
    )
    nodes = lab.NodeSettings(hold_after=3.0, limp_after=4.0, startup_time=0.2, calibration_time=0.2)
    tank = lab.Tank(body, lab.LabSettings(nodes=nodes))
    served = lab.Lab(tank, bus=bus_address("virtual:udp-json"))
    served.server = Sender(address)
    result = swum(served, tmp_path, bus="virtual:udp-json", mocap=f"udp-json@{address}")
    assert result.accepted, result.reason
    assert lc.load_trial(tmp_path / "whole.nc").forward_velocity > 0.0
    served = lab.Lab(tank, bus=bus_address("virtual:udp-json"))
    served.server = Sender(address)
    with served:
        absent = "udp-json@127.0.0.1:1"
        how = {"absent": absent, "body": lab.BODY, "duration": 0.5}
        assert complaints(monkeypatch, "mocap", f"udp-json@{address}", **how) == ()
