"""Driver of the power meter in the supply cable, with pyserial: current now, and its record."""

# pyserial has no types: this module passes typed readings on.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import contextlib
import threading
import time
from typing import Any

from laticauda.tank.operate.drivers.base import Meter
from laticauda.tank.operate.recording.entries import PowerReading
from laticauda.tank.protocol import ProtocolError, meter
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.worker import DeviceFailed, hardware

ANSWER_TIME = 1.0
"""Longest wait for an answer [s, wall clock]."""
INTERVAL = 0.1
"""Time between two queries; the meter's own interval is about as long [s]."""


class MeterDriver(Meter):
    """A Fluke multimeter; the address is its serial port, or a pseudo-terminal."""

    called = "fluke"

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        self._serial = hardware("pyserial", "serial")
        self._line: Any = None
        self._restart = threading.Event()
        self._since: float | None = None
        try:
            self._check_identity()
        except (OSError, ProtocolError, ValueError) as error:
            self.release()
            raise DeviceFailed(
                f"The power meter at {address} does not answer ({error}): check that it is on, "
                "that it shows A DC, and the name of the port."
            ) from error
        self._start()

    def restart(self) -> None:
        """Restart the meter's record of average, minimum and maximum."""
        self._restart.set()

    def work(self) -> None:
        """Send one query, and take in its answer."""
        try:
            if self._restart.is_set():
                self._query(meter.RESTART, has_data=False)
                self._since = self._clock.now()
                self._restart.clear()
            shown = meter.decode_displayed(self._query(meter.DISPLAYED))
        except Exception:
            self.release()  # it is opened again at the next try
            raise
        self._received.append(
            PowerReading(
                time=self._clock.now(),
                current=shown.live,
                average=shown.average,
                minimum=shown.minimum,
                maximum=shown.maximum,
                since=self._since,
            )
        )
        self._ended.wait(INTERVAL / self._clock.speed)

    def _check_identity(self) -> None:
        """Check that a meter answers with model, software and serial number."""
        identity = ""
        for _ in range(2):  # the first answer may be to an earlier query
            identity = self._query(meter.IDENTITY)
            if identity.count(",") == 2:
                return
        raise ProtocolError(f"the meter's answer to ID must have 3 fields, got {identity!r:.80}")

    def _query(self, query: str, *, has_data: bool = True) -> str:
        """Send a query, and return the data line of the answer."""
        if self._line is None:
            self._line = self._serial.Serial(
                self._address, meter.BAUD_RATE, timeout=0.05, write_timeout=ANSWER_TIME
            )
        self._line.reset_input_buffer()
        self._line.write(meter.encode_question(query))
        reader = meter.LineReader()
        lines: list[str] = []
        n_lines = 2 if has_data else 1
        end = time.monotonic() + ANSWER_TIME
        while len(lines) < n_lines:
            if time.monotonic() > end or self._ended.is_set():
                raise ProtocolError(f"no answer to {query}")
            lines += reader.feed(self._line.read(max(self._line.in_waiting, 1)))
            if lines and lines[0] != "0":
                raise ProtocolError(f"it refuses {query} with {lines[0]!r:.40}")
        return lines[1] if has_data else ""

    def release(self) -> None:
        """Close the port; the next query opens it again."""
        if self._line is not None:
            with contextlib.suppress(Exception):
                self._line.close()
            self._line = None
