"""The robot's CAN bus by python-can: frames, the address of a bus, and how it is opened.

`to_frame` and `open_bus` load python-can.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import contextlib
import ipaddress
import socket
import sys
from importlib import import_module
from typing import Any, Literal, cast

from laticauda.tank.protocol import messages
from laticauda.tank.protocol.packing import decode, encode
from laticauda.values import (
    BadArgument,
    LaticaudaError,
    option,
    optional_import,
    quantity,
    value_class,
)
from laticauda.values.packaging import renamed_names

GROUP = "239.74.163.2"
"""Multicast group of our own."""
PORT = 43113
"""Port of our own."""
IP_MULTICAST_ALL = 49
"""Option of Linux's sockets, which Python does not define."""
LOOPBACK = "127.0.0.1"
LONGEST_DATAGRAM = 512
"""Bytes of a datagram that holds a frame, at most; 8 bytes of data need 170 [bytes]."""
DEFAULT_CHANNELS = {"virtual": "mamba", "udp_multicast": GROUP, "socketcan": "can0"}
"""Default channels, by interface."""


class BusFailed(LaticaudaError, OSError):
    """Raised if a CAN bus cannot be opened; the message says which, and why."""


def python_can() -> Any:
    """Return the module of python-can.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The CAN bus", "python-can", "hardware", "can")


def to_frame(message: messages.CanMessage) -> Any:
    """Return the `can.Message` that carries a `message`.

    Args:
        message: The message to carry.
    """
    identifier, data = encode(message)
    return python_can().Message(arbitration_id=identifier, data=data, is_extended_id=False)


def from_frame(frame: Any) -> messages.CanMessage | None:
    """Return the message in `frame`, a `can.Message`, or None if it is not ours, as for error and remote frames.

    Args:
        frame: A `can.Message`, as received from a bus.
    """
    if (
        getattr(frame, "is_extended_id", True)
        or frame.is_remote_frame
        or frame.is_error_frame
        or frame.is_fd
    ):
        return None
    return decode(frame.arbitration_id, bytes(frame.data))


@value_class
class BusAddress:
    """Address of a CAN bus.

    - `virtual`: within one process; the channel is any name.
    - `udp_multicast`: between processes; the channel is an IPv4 multicast group, with a port. It is
      joined by loopback only, where no other computer can send or receive, unless `hops` allows it.
      Members also receive their own frames.
    - `socketcan`: a CAN interface of Linux; the channel is its name, such as can0, and the
      operating system has set it to 1 Mbit/s.
    """

    interface: Literal["virtual", "udp_multicast", "socketcan"] = option(
        "see above", default="udp_multicast"
    )
    channel: str = option("see above; empty: a group of our own, or `mamba`, or `can0`", default="")
    port: int = quantity("", "of udp_multicast", ge=1, le=65535, default=PORT)
    hops: int = quantity(
        "", "routers that frames of udp_multicast may pass", ge=0, le=255, default=0
    )

    def __post_init__(self) -> None:
        """Fill in the channel, and reject anything that is not a multicast group."""
        if not self.channel:
            object.__setattr__(self, "channel", DEFAULT_CHANNELS[self.interface])
        if self.interface == "udp_multicast" and not _is_multicast_group(self.channel):
            raise BadArgument(
                "channel",
                f"must be an IPv4 multicast group such as {GROUP}, got {self.channel!r}",
            )

    def __str__(self) -> str:
        """Return the form that users read and write: interface:channel, with the port for udp_multicast."""
        text = f"{self.interface}:{self.channel}"
        if self.interface == "udp_multicast":
            text += f":{self.port}"
        return text


def _is_multicast_group(channel: str) -> bool:
    try:
        return ipaddress.IPv4Address(channel).is_multicast
    except ValueError:  # it is not an address
        return False


def bus_address(text: str, *, hops: int = 0) -> BusAddress:
    """Parse an address such as `udp_multicast:239.74.163.2:43113`, `virtual:mamba` or `socketcan`.

    Args:
        text: Interface, then channel and port, which may be omitted.
        hops: Routers that frames of udp_multicast may pass [-].

    Raises:
        ValueError: If the text is not an address.
    """
    interface, _, channel_and_port = text.partition(":")
    if interface != "udp_multicast":
        return BusAddress(interface=cast("Any", interface), channel=channel_and_port)
    channel, _, port = channel_and_port.partition(":")
    if port and not (port.isascii() and port.isdigit()):
        raise BadArgument("port", f"must be a whole number, got {port!r}")
    return BusAddress(
        interface="udp_multicast", channel=channel, port=int(port) if port else PORT, hops=hops
    )


def open_bus(address: BusAddress) -> Any:
    """Open a `can.BusABC` at `address`, which must be shut down after use.

    Args:
        address: Interface, channel and port.

    Raises:
        BusFailed: If it cannot be opened.
        MissingExtra: If python-can (or msgpack, for udp_multicast) is not installed.
    """
    can = python_can()
    settings: dict[str, Any] = {"interface": address.interface, "channel": address.channel}
    if address.interface == "udp_multicast":
        optional_import("The CAN bus", "msgpack", "hardware")
    try:
        if address.interface == "udp_multicast":
            return _udp_bus(address)
        return can.Bus(**settings)
    except (can.CanError, OSError) as error:
        raise BusFailed(
            f"The CAN bus {address} cannot be opened: {error.__cause__ or error}."
        ) from error


def _udp_bus(address: BusAddress) -> Any:
    """Return python-can's bus over UDP, except for what it does with datagrams that are no frames.

    Within this computer its socket is ours too: python-can's would join a group on a network.
    """
    module = import_module("can.interfaces.udp_multicast.bus")

    class LocalWire(module.GeneralPurposeUdpMulticastBus):
        def _create_socket(self, address_family: int) -> socket.socket:
            self.timestamp_nanosecond = False
            return _local_socket(self.group, self.port)

    class Bus(module.UdpMulticastBus):
        def __init__(self) -> None:
            module.BusABC.__init__(self, address.channel)
            wire_class = LocalWire
            if address.hops:
                wire_class = module.GeneralPurposeUdpMulticastBus
            self._multicast = wire_class(address.channel, address.port, address.hops)
            self._can_protocol = module.CanProtocol.CAN_20

        def _recv_internal(self, timeout: float | None) -> tuple[Any, bool]:
            received = self._multicast.recv(timeout)
            if not received:
                return None, False
            datagram, _, timestamp = received
            return _read_datagram(datagram, timestamp), False

    return Bus()


def _read_datagram(datagram: bytes, timestamp: float) -> Any:
    """Return the `can.Message` in a datagram; None if it holds none, as anybody may send anything.

    python-can would allocate as much memory as a number in the place of the data says.
    """
    if len(datagram) > LONGEST_DATAGRAM:
        return None
    try:
        fields = import_module("msgpack").unpackb(datagram, raw=False)
        if not isinstance(fields["data"], bytes) or type(fields["arbitration_id"]) is not int:
            return None
        frame = python_can().Message(check=True, **{**fields, "timestamp": timestamp})
    except Exception:  # msgpack has a dozen kinds
        return None
    return None if frame.is_fd else frame


def _local_socket(group: str, port: int) -> socket.socket:
    """Return a socket that sends to a multicast group over loopback, and receives from it over loopback only.

    Raises:
        OSError: If the system does not support this.
    """
    local_socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    loopback = socket.inet_aton(LOOPBACK)
    try:
        for name in ("SO_REUSEADDR", "SO_REUSEPORT"):
            if hasattr(socket, name):
                local_socket.setsockopt(socket.SOL_SOCKET, getattr(socket, name), 1)
        local_socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        local_socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, loopback)
        # Data sent to one of this computer's addresses in the network are not for members of the
        # group.
        local_socket.bind((LOOPBACK if sys.platform == "win32" else group, port))
        local_socket.setsockopt(
            socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + loopback
        )
        if sys.platform == "linux":  # else it would receive what others here have joined elsewhere
            local_socket.setsockopt(socket.IPPROTO_IP, IP_MULTICAST_ALL, 0)
            with contextlib.suppress(OSError):  # an older kernel, where this requires root
                local_socket.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, b"lo\0")
    except OSError:
        local_socket.close()
        raise
    return local_socket


# Names of 0.2, for one release.
__getattr__ = renamed_names(__name__, {"LAYOUTS": "laticauda.tank.protocol.layouts:LAYOUTS"})
