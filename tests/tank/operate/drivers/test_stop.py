"""The emergency-stop input: a contact between RTS and CTS, which pyserial's own loop-back port closes."""

import sys
import time
from dataclasses import replace

import pytest
import serial
from patience import until

from laticauda.tank.operate.devices import Devices
from laticauda.tank.operate.drivers import Clock, DeviceFailed, StopInput
from laticauda.tank.operate.drivers.stop import SerialLine


@pytest.fixture
def line(monkeypatch):
    """The port that the driver opened, with which the contact is opened."""
    opened = []

    def made(port):
        opened.append(serial.serial_for_url("loop://"))
        return opened[-1]

    monkeypatch.setattr(serial, "Serial", made)
    return opened


def waited(driver: StopInput, wanted) -> tuple[str, ...]:
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        found = driver.receive()
        if wanted(found):
            return found
        time.sleep(0.002)
    return ()


def test_a_closed_contact_is_no_reason_and_one_that_opens_however_shortly_is(line):
    with SerialLine("/dev/ttyUSB1:cts", Clock()) as driver:
        until(lambda: driver.receive() == ())
        line[0].rts = False
        until(lambda: driver._received)
        line[0].rts = True
        assert waited(driver, bool)[0] == "its contact on CTS is open"
        assert waited(driver, lambda found: not found) == ()


def test_a_line_that_is_lost_is_a_reason_and_stays_one(line):
    with SerialLine("/dev/ttyUSB1", Clock()) as driver:
        line[0].close()
        assert waited(driver, bool)[0].startswith("the input cannot be read: ")
        time.sleep(StopInput.OLDEST)
        assert waited(driver, bool)[0].startswith(("it was last read", "the input cannot be read"))


def test_a_port_without_modem_lines_or_none_at_all_is_refused():
    with pytest.raises(
        DeviceFailed, match=r"/dev/nothing cannot be read .*check the name of the port"
    ):
        SerialLine("/dev/nothing", Clock())
    if sys.platform == "linux":
        import os

        ours, theirs = os.openpty()  # a terminal of no modem
        try:
            with pytest.raises(DeviceFailed, match=r"cannot be read .*that it has modem lines"):
                SerialLine(os.ttyname(theirs), Clock())
        finally:
            os.close(ours)
            os.close(theirs)


@pytest.mark.parametrize("address", ["", "/dev/ttyS0:tx"])
def test_an_address_that_is_none_is_refused(address):
    with pytest.raises(ValueError, match=r"`address` must (not be empty|be one of `cts`)"):
        SerialLine.check(address)


class Pressed:
    """What the loop asks."""

    bus_off, trouble = "", ""

    def receive(self):
        return ("its contact on CTS is open",)


class Nothing(Pressed):
    def receive(self):
        return ()


def test_the_loop_asks_it_in_every_tick():
    devices = Devices(clock=Clock(), bus=Nothing(), mocap=Nothing())
    assert devices.receive({})[0].events == {}
    assert replace(devices, stop=Pressed()).receive({})[0].events == {
        "emergency_input": "its contact on CTS is open"
    }
