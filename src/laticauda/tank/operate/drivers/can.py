"""Driver of the CAN bus, with python-can: frames in and out, and whether the bus is still on."""

# python-can is partly typed: this module passes typed messages on.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Iterable
from typing import Any

from laticauda.tank.operate.drivers.base import Bus, Frame
from laticauda.tank.protocol import (
    BusFailed,
    CanMessage,
    bus_address,
    from_frame,
    from_node,
    open_bus,
    to_frame,
)
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.worker import DeviceFailed

LONGEST_WAIT = 0.05
"""Longest wait for a frame [s, wall clock]."""
BUS_OFF = 0x40
"""Bit in the identifier of Linux's error frames."""
ADVICE = {
    "socketcan": "Check that the interface is up: `ip link set can0 up type can bitrate 1000000`.",
    "udp_multicast": "Check the address and that this computer has a network.",
    "virtual": "Check the channel's name.",
}
"""What to check where a bus cannot be opened, by its interface."""


class CanDriver(Bus):
    """The CAN bus of `mamba.dbc`.

    For addresses, such as socketcan:can0, see `laticauda.tank.protocol.bus_address`.
    """

    called = "can"

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        self._send_trouble = ""
        self._is_off = False
        parsed_address = bus_address(address)
        try:
            self._bus = open_bus(parsed_address)
        except BusFailed as error:
            raise DeviceFailed(f"{error} {ADVICE[parsed_address.interface]}") from error
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `Driver.check`."""
        super().check(address)
        bus_address(address)

    @property
    def bus_off(self) -> str:
        """Why nothing can be sent, as a sentence; "" if frames can be sent."""
        if self._send_trouble:
            return self._send_trouble
        if self._is_off:
            return self.trouble
        return ""

    def work(self) -> None:
        """Wait for a frame and keep it."""
        try:
            frame: Any = self._bus.recv(LONGEST_WAIT)
        except Exception:
            self._is_off = True
            raise
        if frame is None:
            return
        if frame.is_error_frame:
            self._is_off = bool(frame.arbitration_id & BUS_OFF)
            if self._is_off:
                raise DeviceFailed("the CAN controller is in its bus-off state")
            return
        self._is_off = False
        if not from_node(frame.arbitration_id):
            return  # our own, returned by udp_multicast
        self._received.append(
            Frame(
                time=self._clock.now(),
                identifier=frame.arbitration_id,
                data=bytes(frame.data),
                is_ours=False,
                message=from_frame(frame),
            )
        )

    def send(self, messages: Iterable[CanMessage]) -> tuple[Frame, ...]:
        """Send messages in this order.

        Args:
            messages: Messages to send.

        Returns:
            The frames that went out; if others did not, `bus_off` says so.
        """
        sent: list[Frame] = []
        trouble = ""
        for message in messages:
            try:
                frame = to_frame(message)
                self._bus.send(frame, timeout=0.0)
            except Exception as error:  # the supervisor is told, and the modules stop by themselves
                trouble = f"nothing can be sent: {error}"
                continue
            sent.append(
                Frame(
                    time=self._clock.now(),
                    identifier=frame.arbitration_id,
                    data=bytes(frame.data),
                    is_ours=True,
                    message=message,
                )
            )
        self._send_trouble = trouble
        return tuple(sent)

    def release(self) -> None:
        """Shut the bus down."""
        self._bus.shutdown()
