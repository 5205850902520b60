"""The robot's CAN bus: which one of python-can's it is, and how it is opened."""

import ipaddress
import socket
from typing import Any, Literal, cast

from laticauda.errors import BadArgument, LaticaudaError
from laticauda.extras import optional_import
from laticauda.protocol.can import python_can
from laticauda.quantities import option, quantity, value

GROUP, PORT = "239.74.163.2", 43113
CHANNELS = {"virtual": "mamba", "udp_multicast": GROUP, "socketcan": "can0"}
"""The usual ones."""


class BusFailed(LaticaudaError, OSError):
    """A CAN bus cannot be opened: it says which, and why."""


@value
class BusAddress:
    """Which CAN bus.

    - `virtual`: within one process; the channel is any name.
    - `udp_multicast`: between processes; the channel is an IPv4 multicast group, with a port. Frames do not leave this
      computer, and those from elsewhere are not heard, unless `hops` says so. Everyone hears their own frames, too.
    - `socketcan`: a CAN interface of Linux; the channel is its name, such as can0, and the operating system has set it
      to 1 Mbit/s.
    """

    interface: Literal["virtual", "udp_multicast", "socketcan"] = option("see above", default="udp_multicast")
    channel: str = option("see above; empty: a group of our own, or `mamba`, or `can0`", default="")
    port: int = quantity("", "of udp_multicast", ge=1, le=65535, default=PORT)
    hops: int = quantity("", "routers that frames of udp_multicast may pass", ge=0, le=255, default=0)

    def __post_init__(self) -> None:
        """Fill in the channel, and refuse what is no multicast group."""
        if not self.channel:
            object.__setattr__(self, "channel", CHANNELS[self.interface])
        if self.interface == "udp_multicast":
            try:
                group = ipaddress.ip_address(self.channel)
            except ValueError:
                group = None
            if not isinstance(group, ipaddress.IPv4Address) or not group.is_multicast:
                rule = f"must be an IPv4 multicast group such as {GROUP}, got {self.channel!r}"
                raise BadArgument("channel", rule)

    def __str__(self) -> str:
        """As the user reads and writes it: interface:channel, with the port of udp_multicast."""
        port = f":{self.port}" if self.interface == "udp_multicast" else ""
        return f"{self.interface}:{self.channel}{port}"


def bus_address(text: str, *, hops: int = 0) -> BusAddress:
    """The address that a text such as `udp_multicast:239.74.163.2:43113`, `virtual:mamba` or `socketcan` says.

    Args:
        text: Interface, then channel and port, which may be left out.
        hops: As in `BusAddress`.

    Raises:
        ValueError: If it is none.
    """
    interface, _, rest = text.partition(":")
    if interface != "udp_multicast":
        return BusAddress(interface=cast("Any", interface), channel=rest)
    channel, _, port = rest.partition(":")
    if port and not (port.isascii() and port.isdigit()):
        raise BadArgument("port", f"must be a whole number, got {port!r}")
    return BusAddress(interface="udp_multicast", channel=channel, port=int(port) if port else PORT, hops=hops)


def open_bus(address: BusAddress) -> Any:
    """A `can.BusABC` at `address`, which is to be shut down after use.

    Raises:
        BusFailed: If it cannot be opened.
        MissingExtra: If python-can (or msgpack, for udp_multicast) is not installed.
    """
    can = python_can()
    settings: dict[str, Any] = {"interface": address.interface, "channel": address.channel}
    if address.interface == "udp_multicast":
        optional_import("The CAN bus", "msgpack", "hardware")
        settings |= {"port": address.port, "hop_limit": address.hops, "fd": False}
    try:
        bus = can.Bus(**settings)
    except (can.CanError, OSError) as error:
        raise BusFailed(f"The CAN bus {address} cannot be opened: {error}.") from error
    if address.interface == "udp_multicast" and address.hops == 0:
        _deafen(bus, address)
    return bus


def _deafen(bus: Any, address: BusAddress) -> None:
    """Let a bus hear this computer only: python-can's socket takes datagrams from everywhere."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((address.channel, address.port))
            ours = probe.getsockname()[0]
        except OSError:  # no network at all
            return
    listen = bus._multicast.recv

    def recv(timeout: float | None = None) -> Any:
        packet = listen(timeout)
        return packet if packet is None or packet[1][0] == ours or packet[1][0].startswith("127.") else None

    bus._multicast.recv = recv
