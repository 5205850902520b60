"""Server of the readings of the robot's own sensors: datagrams to whoever subscribes.

It has no thread: whoever steps the tank calls `publish`, which never waits.
"""

import secrets
import socket
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from laticauda.tank.lab.qtm_server import LOOPBACK, ServerFailed
from laticauda.tank.protocol.readings import (
    PORT,
    SUBSCRIBE,
    SUBSCRIPTION_TIME,
    SensorList,
    SentReading,
    encode_list,
    encode_reading,
)
from laticauda.values import check_hostname

MOST_SUBSCRIBERS = 8
"""Subscribers at most; others get nothing until one leaves."""
MOST_ASKED = 16
"""Datagrams that are read at a time."""


class MeasuredReading(NamedTuple):
    """A reading that has arrived in the robot."""

    sensor: str
    """Name of the sensor."""
    time: float
    """When it was measured, on the lab's clock [s]."""
    values: tuple[float, ...]
    """Its values, nan where there is none."""


class SensorServer:
    """Server of readings.

    Args:
        columns: Names of the values of each sensor, by its name.
        host: Host address at which it can be reached; by default, only from this computer.
        port: Its port; 0: any free one.
    """

    def __init__(
        self, columns: Mapping[str, tuple[str, ...]], host: str = LOOPBACK, port: int = PORT
    ) -> None:
        self.host = check_hostname("host", host)
        self.port = port
        self._list = SensorList(session=secrets.token_hex(4), columns=columns)
        self._n_sent = dict.fromkeys(columns, 0)
        self._heard_at: dict[Any, float] = {}
        """By address of a subscriber, when it was last heard [s, wall clock]."""
        self._socket: socket.socket | None = None

    def start(self) -> None:
        """Open the socket.

        Raises:
            ServerFailed: If it cannot be opened.
        """
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((self.host, self.port))
        except OSError as error:
            self.stop()
            raise ServerFailed(
                f"The sensors' server cannot listen at {self.host}:{self.port}: {error}."
            ) from error
        self._socket.setblocking(False)
        self.port = self._socket.getsockname()[1]

    def stop(self) -> None:
        """Close the socket."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def publish(self, readings: Sequence[MeasuredReading]) -> None:
        """Answer new subscribers, and send readings to all.

        Args:
            readings: What has arrived since the last call.
        """
        if self._socket is None:
            return
        self._take_in_subscriptions(self._socket)
        for reading in readings:
            self._send_to_all(self._socket, encode_reading(self._numbered(reading)))

    def _numbered(self, reading: MeasuredReading) -> SentReading:
        """Return a reading with its number."""
        number = self._n_sent[reading.sensor]
        self._n_sent[reading.sensor] = number + 1
        return SentReading(
            session=self._list.session,
            sensor=reading.sensor,
            number=number,
            time=reading.time,
            values=reading.values,
        )

    def _take_in_subscriptions(self, open_socket: socket.socket) -> None:
        """Take in who wants readings, and forget who has not been heard for too long."""
        now = time.monotonic()
        for _ in range(MOST_ASKED):
            try:
                datagram, address = open_socket.recvfrom(len(SUBSCRIBE) + 1)
            except OSError:  # nothing is there, or a subscriber has gone
                break
            is_known = address in self._heard_at
            if datagram == SUBSCRIBE and (is_known or len(self._heard_at) < MOST_SUBSCRIBERS):
                self._heard_at[address] = now
                with suppress(OSError):
                    open_socket.sendto(encode_list(self._list), address)
        for address, heard_at in list(self._heard_at.items()):
            if now - heard_at > SUBSCRIPTION_TIME:
                del self._heard_at[address]

    def _send_to_all(self, open_socket: socket.socket, datagram: bytes) -> None:
        """Send a datagram; where a buffer is full it is lost, as on a busy network."""
        for address in self._heard_at:
            with suppress(OSError):
                open_socket.sendto(datagram, address)
