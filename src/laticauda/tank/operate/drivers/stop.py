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
from laticauda.values.checks import check_choice

LOOKS = 0.005  # time between two looks [s, wall clock]
LINES = ("cts", "dsr", "cd", "ri")


class SerialLine(StopInput):
    """A modem line; the address is PORT or PORT:LINE, such as /dev/ttyUSB1:cts (the default line)."""

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        port, _, line = address.partition(":")
        self._name, self._port = line or LINES[0], None
        try:
            self._port: Any = hardware("pyserial", "serial").Serial(port)
            getattr(self._port, self._name)
        except (OSError, ValueError) as error:
            self.release()
            raise DeviceFailed(
                f"The emergency-stop input at {address} cannot be read ({error}): check the name of the port, and that "
                "it has modem lines."
            ) from error
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `Driver.check`."""
        super().check(address)
        check_choice("address", address.partition(":")[2] or LINES[0], LINES)

    def look(self) -> str:
        """See `StopInput.look`."""
        self._ended.wait(LOOKS)
        return (
            ""
            if getattr(self._port, self._name)
            else f"its contact on {self._name.upper()} is open"
        )

    def release(self) -> None:
        """Close the port."""
        if self._port is not None:
            with contextlib.suppress(Exception):
                self._port.close()
