"""Driver of the power meter in the supply cable, with pyserial: current now, average, minimum and maximum."""

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

ANSWER_TIME = 1.0  # [s, wall clock]
INTERVAL = 0.1  # between two queries; the meter's own interval is about as long [s]


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
            answers = (
                self._query(meter.IDENTITY) for _ in range(2)
            )  # the first may answer an earlier query
            if not any(
                (identity := one).count(",") == 2 for one in answers
            ):  # model, software, serial number
                raise ProtocolError(
                    f"the meter's answer to ID must have 3 fields, got {identity!r:.80}"
                )
        except (OSError, ProtocolError, ValueError) as error:
            self.release()
            raise DeviceFailed(
                f"The power meter at {address} does not answer ({error}): check that it is on, that it shows A DC, and "
                "the name of the port."
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
        record = {name: getattr(shown, name) for name in ("average", "minimum", "maximum")}
        self._received.append(
            PowerReading(time=self._clock.now(), current=shown.live, since=self._since, **record)
        )
        self._ended.wait(INTERVAL / self._clock.speed)

    def _query(self, word: str, *, has_data: bool = True) -> str:
        """Send a query, and return the data line of the answer."""
        if self._line is None:
            self._line = self._serial.Serial(
                self._address, meter.BAUD_RATE, timeout=0.05, write_timeout=ANSWER_TIME
            )
        self._line.reset_input_buffer()
        self._line.write(meter.encode_question(word))
        reader, lines, end = meter.LineReader(), list[str](), time.monotonic() + ANSWER_TIME
        while len(lines) < 1 + has_data:
            if time.monotonic() > end or self._ended.is_set():
                raise ProtocolError(f"no answer to {word}")
            lines += reader.feed(self._line.read(max(self._line.in_waiting, 1)))
            if lines and lines[0] != "0":
                raise ProtocolError(f"it refuses {word} with {lines[0]!r:.40}")
        return lines[1] if has_data else ""

    def release(self) -> None:
        """Close the port; the next query opens it again."""
        if self._line is not None:
            with contextlib.suppress(Exception):
                self._line.close()
            self._line = None
