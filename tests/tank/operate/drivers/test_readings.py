"""The driver of the robot's own sensors, on a real socket."""

import socket
import threading
import time

import pytest
from patience import complaints, until

from laticauda.tank.lab.sensor_server import MeasuredReading, SensorServer
from laticauda.tank.operate.drivers import Clock, DeviceFailed
from laticauda.tank.operate.drivers.readings import ReadingsDriver
from laticauda.tank.protocol.readings import SUBSCRIBE, SentReading, encode_list, encode_reading

COLUMNS = {"compass": ("heading",), "sonar": ("range_0", "range_1")}


class Robot:
    """A robot whose compass measures fifty times a second, until it is to stop."""

    def __init__(self, port: int = 0) -> None:
        self.server = SensorServer(COLUMNS, port=port)
        self.server.start()
        self.is_silent = False
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    @property
    def address(self) -> str:
        return f"127.0.0.1:{self.server.port}"

    def _run(self) -> None:
        step = 0
        while not self._ended.wait(0.02):
            step += 1
            reading = MeasuredReading("compass", 0.02 * step, (0.1 * step,))
            self.server.publish([] if self.is_silent else [reading])

    def stop(self) -> None:
        self._ended.set()
        self._thread.join()
        self.server.stop()


@pytest.fixture
def robot():
    robot = Robot()
    yield robot
    robot.stop()


@pytest.fixture
def wire():
    """A robot that sends what a test wants; a driver that is subscribed to it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        ours.bind(("127.0.0.1", 0))
        ours.settimeout(5.0)
        server = SensorServer(COLUMNS)
        drivers: list[ReadingsDriver] = []

        def answer():
            _, address = ours.recvfrom(100)
            ours.connect(address)
            ours.send(encode_list(server._list))

        thread = threading.Thread(target=answer)
        thread.start()
        drivers.append(ReadingsDriver(f"127.0.0.1:{ours.getsockname()[1]}", Clock()))
        thread.join()
        with drivers[0] as driver:
            yield ours, driver, server._list


def collect(driver, n: int) -> list:
    samples: list = []
    end = time.monotonic() + 20.0
    while len(samples) < n and time.monotonic() < end:
        samples += [sample for _, sample in driver.receive()]
        time.sleep(0.01)
    return samples


def test_sensors_are_announced_and_then_their_readings_come_in_order(robot):
    clock = Clock()
    with ReadingsDriver(robot.address, clock) as driver:
        samples = collect(driver, 8)
    announced = [sample for sample in samples if not sample.has_values]
    assert {sample.sensor: sample.columns for sample in announced} == COLUMNS
    measured = [sample for sample in samples if sample.has_values]
    assert {sample.sensor for sample in measured} == {"compass"}
    assert [sample.values[0] for sample in measured] == pytest.approx(
        [5.0 * sample.time for sample in measured]
    )
    times = [sample.time for sample in measured]
    assert times == sorted(times)


def test_it_keeps_the_contract(robot, monkeypatch):
    device = f"udp-readings@{robot.address}"
    how = {"absent": "udp-readings@127.0.0.1:1", "duration": 0.5}
    assert complaints(monkeypatch, "sensors", device, **how) == ()


def test_lost_readings_are_counted_and_late_doubled_or_strange_ones_are_dropped(wire):
    ours, driver, sensors = wire

    def send(number: int, **changes) -> None:
        facts = {"session": sensors.session, "sensor": "compass", "time": 0.1 * number}
        facts |= {"number": number, "values": (float(number),)} | changes
        ours.send(encode_reading(SentReading(**facts)))

    send(4)
    ours.send(b"rubbish")
    send(4)
    send(7)
    send(5)
    send(8, session="other")
    send(8, sensor="depth")
    send(8, values=(1.0, 2.0))
    send(8)
    measured = [sample for sample in collect(driver, 5) if sample.has_values]
    assert [(sample.values[0], sample.n_lost) for sample in measured] == [
        (4.0, 0.0),
        (7.0, 2.0),
        (8.0, 0.0),
    ]
    assert driver.trouble == ""


def test_a_robot_that_starts_anew_is_announced_anew_and_one_that_is_silent_is_in_trouble(
    robot, monkeypatch
):
    monkeypatch.setattr("laticauda.tank.operate.drivers.readings.SILENCE", 0.3)
    with ReadingsDriver(robot.address, Clock()) as driver:
        collect(driver, 5)
        robot.stop()
        until(lambda: driver.trouble)
        again = Robot(robot.server.port)
        try:
            until(lambda: not driver.trouble)
            samples = collect(driver, 4)
        finally:
            again.stop()
    assert {sample.sensor for sample in samples if not sample.has_values} == set(COLUMNS)


def test_where_nobody_answers_the_address_is_named(monkeypatch):
    with pytest.raises(DeviceFailed, match=r"The sensors at 127\.0\.0\.1:1 do not answer"):
        ReadingsDriver("127.0.0.1:1", Clock())
    monkeypatch.setattr("laticauda.tank.operate.drivers.readings.ANSWER_TIME", 0.3)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as silent:
        silent.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(DeviceFailed, match=r"no list of sensors within 0\.3 s"):
            ReadingsDriver(address, Clock())
    with pytest.raises(ValueError, match="`address` must be HOST:PORT"):
        ReadingsDriver.check("here")


def test_only_subscribers_get_readings(robot):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        ours.connect(("127.0.0.1", robot.server.port))
        ours.settimeout(0.2)
        ours.send(b"give me something")
        with pytest.raises(TimeoutError):
            ours.recv(100)
        ours.send(SUBSCRIBE)
        ours.settimeout(10.0)
        assert ours.recv(1000).startswith(b'{"session"')
