"""Driver of an emergency-stop button on a modem line of a serial port, with pyserial.

The contact, closed while the robot may move, is wired between RTS, high while the port is open, and
the line.
"""

# pyserial has no types: this module passes texts on.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import contextlib
from typing import Any

from laticauda.tank.operate.drivers.base import StopInput
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.worker import DeviceFailed, hardware
from laticauda.values import check_choice

LOOK_INTERVAL = 0.005
"""Time between two looks [s, wall clock]."""
LINES = ("cts", "dsr", "cd", "ri")
"""Modem lines; the first is used if an address names none."""


class SerialLine(StopInput):
    """A modem line; the address is PORT or PORT:LINE, such as /dev/ttyUSB1:cts (the default line)."""

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        port, _, line = address.partition(":")
        self._line = line or LINES[0]
        self._port = None
        try:
            self._port: Any = hardware("pyserial", "serial").Serial(port)
            getattr(self._port, self._line)
        except (OSError, ValueError) as error:
            self.release()
            raise DeviceFailed(
                f"The emergency-stop input at {address} cannot be read ({error}): "
                "check the name of the port, and that it has modem lines."
            ) from error
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `Driver.check`."""
        super().check(address)
        _, _, line = address.partition(":")
        check_choice("address", line or LINES[0], LINES)

    def look(self) -> str:
        """See `StopInput.look`."""
        self._ended.wait(LOOK_INTERVAL)
        is_closed = getattr(self._port, self._line)
        if is_closed:
            return ""
        return f"its contact on {self._line.upper()} is open"

    def release(self) -> None:
        """Close the port."""
        if self._port is not None:
            with contextlib.suppress(Exception):
                self._port.close()
