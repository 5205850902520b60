"""Driver of the robot's own sensors, which send datagrams of JSON to whoever subscribes."""

import contextlib
import socket
import time

import numpy as np

from laticauda.tank.operate.drivers.base import Sensors, host_and_port
from laticauda.tank.operate.recording.entries import SensorSample
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.readings import (
    LARGEST_DATAGRAM,
    SUBSCRIBE,
    SUBSCRIBE_INTERVAL,
    SensorList,
    SentReading,
    decode_datagram,
)
from laticauda.tank.protocol.worker import DeviceFailed

ANSWER_TIME = 3.0
"""Longest wait for the list of sensors [s, wall clock]."""
SILENCE = 4.0
"""Time without a datagram after which it reports that nothing comes [s, wall clock]."""
LONGEST_WAIT = 0.1
"""Longest wait for a datagram [s, wall clock]."""


class ReadingsDriver(Sensors):
    """Sensors at HOST:PORT, as the virtual tank serves them (docs/lab-protocol.md)."""

    called = "udp-readings"

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        self._list: SensorList | None = None
        self._next_number: dict[str, int] = {}
        """By sensor, the number of the reading that should come next."""
        self._asked_at = self._heard_at = time.monotonic()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(LONGEST_WAIT)
        try:
            self._socket.connect(host_and_port(address))
            self._wait_for_list()
        except OSError as error:
            self.release()
            raise DeviceFailed(
                f"The sensors at {address} do not answer ({error}): "
                "check the address, and that the robot has sensors."
            ) from error
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `Driver.check`."""
        super().check(address)
        host_and_port(address)

    def work(self) -> None:
        """Subscribe again if it is time to, and take in one datagram."""
        now = time.monotonic()
        if now - self._asked_at >= SUBSCRIBE_INTERVAL:
            self._subscribe()
        self._take_in_datagram()
        if now - self._heard_at > SILENCE:
            raise DeviceFailed(f"the sensors at {self._address} send nothing")

    def release(self) -> None:
        """Close the socket."""
        with contextlib.suppress(OSError):
            self._socket.close()

    def _wait_for_list(self) -> None:
        """Wait until the list of sensors has come."""
        end = time.monotonic() + ANSWER_TIME
        self._subscribe()
        while self._list is None:
            now = time.monotonic()
            if now > end:
                raise TimeoutError(f"no list of sensors within {ANSWER_TIME:g} s")
            if now - self._asked_at >= SUBSCRIBE_INTERVAL:
                self._subscribe()
            self._take_in_datagram()

    def _subscribe(self) -> None:
        self._asked_at = time.monotonic()
        self._socket.send(SUBSCRIBE)

    def _take_in_datagram(self) -> None:
        """Wait for a datagram, and take it in; anything else than ours is dropped."""
        try:
            datagram = self._socket.recv(LARGEST_DATAGRAM)
        except TimeoutError:
            return
        content = decode_datagram(datagram)
        if content is None:
            return
        self._heard_at = time.monotonic()
        if isinstance(content, SensorList):
            self._take_in_list(content)
        else:
            self._take_in_reading(content)

    def _take_in_list(self, sensors: SensorList) -> None:
        """Take in the list of sensors; a new one announces them."""
        if sensors == self._list:
            return
        self._list = sensors
        self._next_number = {}
        now = self._clock.now()
        for name, columns in sensors.columns.items():
            announcement = SensorSample(time=now, sensor=name, columns=columns, values=np.empty(0))
            self._received.append((now, announcement))

    def _take_in_reading(self, reading: SentReading) -> None:
        """Take in a reading, unless it is late or doubled, or not of a sensor that was listed."""
        if self._list is None or reading.session != self._list.session:
            return
        columns = self._list.columns.get(reading.sensor)
        expected = self._next_number.get(reading.sensor, reading.number)
        if columns is None or len(columns) != len(reading.values) or reading.number < expected:
            return
        self._next_number[reading.sensor] = reading.number + 1
        sample = SensorSample(
            time=reading.time,
            sensor=reading.sensor,
            columns=columns,
            values=np.array(reading.values),
            n_lost=float(reading.number - expected),
        )
        self._received.append((self._clock.now(), sample))
