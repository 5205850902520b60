import time

import pytest
from patience import until

from laticauda.tank.lab.serving import SerialLine
from laticauda.tank.operate.drivers import Clock, DeviceFailed
from laticauda.tank.operate.drivers.meter import MeterDriver
from laticauda.tank.protocol import MeterReading
from laticauda.tank.protocol.meter import (
    DISPLAYED,
    IDENTITY,
    RESTART,
    displayed_text,
    encode_answer,
)


class Meter:
    """Answers like the instrument, or in one of the ways in which it may fail."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.way = "well"

    def __call__(self, line: str) -> bytes:
        self.asked.append(line)
        if self.way == "silent":
            return b""
        if self.way == "rubbish":
            return b"0\rwhat?\r"
        reading = MeterReading(live=2.5, average=2.0, minimum=1.2, maximum=3.1, duration=4.0)
        shown = encode_answer(displayed_text(reading, now=100.0))
        if line == IDENTITY:
            owed, self.way = shown if self.way == "owes" else b"", "well"
            return owed + encode_answer("FLUKE 289,V1.16,95081087")
        if line == DISPLAYED:
            return shown
        return encode_answer()


@pytest.fixture
def meter():
    meter = Meter()
    with SerialLine(meter) as line:
        meter.path = line.path  # type: ignore[attr-defined]
        yield meter


def readings(driver: MeterDriver, n: int) -> list:
    found, end = [], time.monotonic() + 20.0
    while len(found) < n and time.monotonic() < end:
        found += driver.receive()
        time.sleep(0.01)
    return found


def test_it_reads_the_current_with_average_minimum_and_maximum(meter):
    with MeterDriver(meter.path, Clock()) as driver:
        first, second = readings(driver, 2)[:2]
    assert (first.current, first.average, first.minimum, first.maximum) == (2.5, 2.0, 1.2, 3.1)
    assert first.time < second.time


def test_an_answer_that_it_owed_to_somebody_before_us_is_not_taken_for_its_name(meter):
    meter.way = "owes"
    with MeterDriver(meter.path, Clock()) as driver:
        assert meter.asked[:2] == [IDENTITY] * 2
        assert readings(driver, 1)


def test_its_record_can_be_begun_anew(meter):
    with MeterDriver(meter.path, Clock()) as driver:
        driver.restart()
        found = readings(driver, 3)
    assert RESTART in meter.asked
    assert found[-1].since is not None
    assert found[-1].since <= found[-1].time


def test_a_meter_that_falls_silent_or_talks_nonsense_is_told_and_comes_back(meter):
    with MeterDriver(meter.path, Clock()) as driver:
        assert readings(driver, 1)
        for way in ("silent", "rubbish"):
            meter.way = way
            until(lambda: driver.trouble)
            assert driver.trouble, way
            meter.way = "well"
            driver.receive()
            assert readings(driver, 1), way


def test_what_is_no_meter_is_refused_with_what_to_check(meter):
    meter.way = "silent"
    with pytest.raises(
        DeviceFailed, match=r"does not answer .*check that it is on, that it shows A DC"
    ):
        MeterDriver(meter.path, Clock())
    with pytest.raises(DeviceFailed, match="nothing-there does not answer"):
        MeterDriver("/dev/nothing-there", Clock())
