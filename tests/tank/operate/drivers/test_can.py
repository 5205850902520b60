import time

import can
import pytest
from patience import until

from laticauda.tank.operate.drivers import Clock, DeviceFailed
from laticauda.tank.operate.drivers.can import CanDriver
from laticauda.tank.protocol import Heartbeat, JointState, NodeState, References, Sync, to_frame

VIRTUAL = "virtual:test-can-driver"


def waited(driver: CanDriver, n: int) -> list:
    found, end = [], time.monotonic() + 3.0
    while len(found) < n and time.monotonic() < end:
        found += driver.receive()
        time.sleep(0.005)
    return found


@pytest.fixture
def other():
    bus = can.Bus(interface="virtual", channel="test-can-driver")
    yield bus
    bus.shutdown()


def test_frames_of_the_modules_come_in_with_their_time_and_meaning(other):
    with CanDriver(VIRTUAL, Clock()) as driver:
        state = JointState(node=3, angle=0.1, rate=0.0, current=0.5, torque=0.0)
        other.send(to_frame(state))
        other.send(to_frame(Heartbeat(node=3, state=NodeState.READY)))
        first, second = waited(driver, 2)
    assert isinstance(first.message, JointState)
    assert first.message.angle == pytest.approx(0.1)
    assert isinstance(second.message, Heartbeat)
    assert 0.0 < first.time <= second.time


def test_what_is_sent_arrives_in_its_order(other):
    with CanDriver(VIRTUAL, Clock()) as driver:
        sent = driver.send((References(group=0, angles=(0.1, 0.2, 0.3, 0.4)), Sync(counter=7)))
    assert [frame.is_ours for frame in sent] == [True, True]
    got = [other.recv(1.0).arbitration_id for _ in range(2)]
    assert got == [frame.identifier for frame in sent]


def test_foreign_and_broken_frames_are_kept_out_of_the_way(other):
    with CanDriver(VIRTUAL, Clock()) as driver:
        other.send(can.Message(arbitration_id=0x7FF, data=b"what", is_extended_id=False))
        other.send(can.Message(arbitration_id=0x203, data=b"short", is_extended_id=False))
        other.send(to_frame(Heartbeat(node=1, state=NodeState.READY)))
        found = waited(driver, 1)
        assert driver.bus_off == ""
    assert [type(frame.message) for frame in found if frame.message is not None] == [Heartbeat]


def test_a_bus_that_breaks_is_told_and_no_exception_comes_out(monkeypatch):
    with CanDriver(VIRTUAL, Clock()) as driver:

        def broken(*_, **__):
            raise can.CanOperationError("Transmit buffer full")

        monkeypatch.setattr(driver._bus, "send", broken)
        assert driver.send((Sync(counter=1),)) == ()
        assert driver.bus_off == "nothing can be sent: Transmit buffer full"
        monkeypatch.undo()
        driver.send((Sync(counter=2),))
        assert driver.bus_off == ""


def test_a_controller_that_is_off_the_bus_says_so(other):
    with CanDriver(VIRTUAL, Clock()) as driver:
        other.send(
            can.Message(
                is_error_frame=True, arbitration_id=0x40, dlc=8, data=bytes(8), is_extended_id=False
            )
        )
        until(lambda: driver.bus_off)
        assert "bus-off state" in driver.bus_off


def test_a_bus_that_is_not_there_says_what_to_check():
    with pytest.raises(
        DeviceFailed,
        match=r"socketcan:nocan9 cannot be opened.*ip link set can0 up type can bitrate",
    ):
        CanDriver("socketcan:nocan9", Clock())
