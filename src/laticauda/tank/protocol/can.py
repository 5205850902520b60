"""The robot's CAN bus: conversion between messages and frames, and the address of a python-can bus.

Frames are those of `mamba.dbc`, which `tests/mamba_dbc.py` writes; `to_frame` and `open_bus` load
python-can.

Three thousand frames come and go every second, so they are packed here, by the layouts from which
the file is written; the tests check that cantools, given only the file, converts them to the same
bytes and numbers.

Data from a bus are not trusted: `decode` returns None for anything that is not one of our frames,
and never raises.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import contextlib
import ipaddress
import itertools
import math
import socket
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from importlib import import_module
from typing import Annotated, Any, Literal, NamedTuple, cast, get_args, get_origin, get_type_hints

from laticauda.tank.protocol import messages
from laticauda.tank.protocol.messages import N_NODES, Signal
from laticauda.values.checks import check_finite
from laticauda.values.errors import BadArgument, LaticaudaError
from laticauda.values.optional import optional_import
from laticauda.values.quantities import option, quantity, value_class

NUMBERS = {"": range(1), "node": range(1, N_NODES + 1), "group": range(messages.N_GROUPS)}
"""Numbers of the frames of one kind, by the field that identifies the frame."""


class Number(NamedTuple):
    """One number in a frame."""

    name: str
    """Name in the file."""
    kind: Any
    """Type of the field to which it belongs."""
    signal: Signal
    """Encoding on the bus."""
    scale: float
    """Value of one step."""
    start: int
    """First bit."""
    low: int
    """Smallest value on the bus; the lowest of all means that a sensor has no value."""
    high: int
    """Largest value on the bus."""
    is_word: bool
    """Whether it is symbolic: a flag, or a word."""


@dataclass(frozen=True)
class Layout:
    """One kind of frame: the fields of its message in order, each with one or several consecutive numbers."""

    kind: type[messages.CanMessage]
    identifier: int
    says: str

    @cached_property
    def number(self) -> str:
        """Field that identifies the frame; "" if there is only one."""
        return next(
            (
                name
                for name, hint in get_type_hints(self.kind, include_extras=True).items()
                if hint is int
            ),
            "",
        )

    @property
    def numbers(self) -> range:
        """Numbers of the frames."""
        return NUMBERS[self.number]

    @cached_property
    def fields(self) -> dict[str, tuple[Number, ...]]:
        """Numbers of every field that the frame carries."""
        found, start = dict[str, tuple[Number, ...]](), 0
        for field, hint in get_type_hints(self.kind, include_extras=True).items():
            if field != self.number:
                found[field] = tuple(_numbers(field, hint, start))
                start = found[field][-1].start + found[field][-1].signal.bits
        return found

    @cached_property
    def signals(self) -> tuple[Number, ...]:
        """All numbers of the frame."""
        return tuple(itertools.chain.from_iterable(self.fields.values()))

    @cached_property
    def length(self) -> int:
        """Number of data bytes."""
        return sum(one.signal.bits for one in self.signals) // 8


def _numbers(field: str, hint: Any, start: int) -> Iterator[Number]:
    """Yield the numbers of one field, starting at a given bit."""
    kind, how = (
        get_args(hint)
        if get_origin(hint) is Annotated
        else (hint, Signal(1 if hint is bool else 8))
    )
    top = 2 ** (how.bits - how.signed)
    low = -top + (type(None) not in get_args(kind)) if how.signed else 0
    is_word = isinstance(kind, type) and issubclass(kind, bool | IntEnum)
    scale = 1 if how.scale == "1" else float(how.scale)
    for i, name in enumerate(how.names or (field.title().replace("_", ""),)):
        yield Number(name, kind, how, scale, start + i * how.bits, low, top - 1, is_word)


LAYOUTS = (
    Layout(messages.EmergencyStop, 0x001, "All motors off until cleared."),
    Layout(messages.NodeCommand, 0x010, "A command to one node or to all."),
    Layout(
        messages.References,
        0x100,
        "Reference angles of four joints; in force from the next Sync on.",
    ),
    # After the references: with a higher priority, it could overtake those to which it applies.
    Layout(
        messages.Sync,
        0x180,
        "References are in force from here on; every node measures and answers.",
    ),
    Layout(messages.JointState, 0x200, "The answer to every Sync."),
    Layout(messages.Loads, 0x280, "The force/torque sensor."),
    Layout(messages.Acceleration, 0x300, "The accelerometer."),
    Layout(messages.Heartbeat, 0x700, "The state of a node."),
    Layout(messages.CommandReply, 0x780, "The answer to a NodeCommand."),
)


# ---- packing -------------------------------------------------------------------------------------

NOT_AVAILABLE = -32768
"""Lowest number of a signed word, sent for a sensor that has no value."""


LAYOUT_OF: dict[type[Any], Layout] = {layout.kind: layout for layout in LAYOUTS}
_BY_IDENTIFIER = {
    layout.identifier + number: (layout, number) for layout in LAYOUTS for number in layout.numbers
}
_FIRST_ANSWER = LAYOUT_OF[messages.JointState].identifier


def python_can() -> Any:
    """Return the module of python-can.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The CAN bus", "python-can", "hardware", "can")


def encode(message: messages.CanMessage) -> tuple[int, bytes]:
    """Return identifier and data of the frame that carries a message; numbers beyond a signal's range saturate.

    Args:
        message: The message to send.

    Raises:
        ValueError: If there is no such node, or a number is not finite.
    """
    layout = LAYOUT_OF[type(message)]
    number, known = getattr(message, layout.number) if layout.number else 0, layout.numbers
    if number not in known:
        raise BadArgument("node", f"must be a number from {known[0]} to {known[-1]}, got {number}")
    whole = 0
    for field, numbers in layout.fields.items():
        value: Any = getattr(message, field)
        values = (
            (value,) if len(numbers) == 1 else (None,) * len(numbers) if value is None else value
        )
        for one, value in zip(numbers, values, strict=True):
            least = max(one.low, 1 + NOT_AVAILABLE)  # the lowest means that the value is unknown
            sound = (
                value if value is None or math.isfinite(value) else check_finite(one.name, value)
            )  # which rejects it
            raw = (
                NOT_AVAILABLE
                if sound is None
                else round(min(max(sound / one.scale, least), one.high))
            )
            whole |= (raw & (1 << one.signal.bits) - 1) << one.start
    return layout.identifier + number, whole.to_bytes(layout.length, "little")


def decode(identifier: int, data: bytes) -> messages.CanMessage | None:
    """Return the message that a frame carries, or None if it is not ours: unknown, too short, too long, or invalid.

    Args:
        identifier: Identifier of the frame, 11 bits.
        data: Data bytes of the frame.
    """
    layout, number = _BY_IDENTIFIER.get(identifier, (None, 0))
    if layout is None or len(data) != layout.length:
        return None
    whole = int.from_bytes(data, "little")
    known: dict[str, Any] = {layout.number: number} if layout.number else {}
    try:
        for field, numbers in layout.fields.items():
            values = tuple(_value(one, whole) for one in numbers)
            known[field] = values[0] if len(values) == 1 else None if None in values else values
    except ValueError:  # a number that does not represent a word
        return None
    return layout.kind(**known)


def _value(one: Number, whole: int) -> Any:
    """Return the value of one number in a frame's bits; None if a sensor has no value."""
    _, kind, how, scale, start, low, _, is_word = one
    raw = whole >> start & (1 << how.bits) - 1
    if how.signed and raw >> how.bits - 1:
        raw -= 1 << how.bits
    if is_word:
        return kind(raw)
    return None if raw == low == NOT_AVAILABLE else raw * scale


def from_node(identifier: int) -> bool:
    """Return whether a frame with this `identifier` comes from a node, provided that it is one of ours.

    Args:
        identifier: Identifier of the frame, 11 bits.
    """
    return identifier >= _FIRST_ANSWER


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


# ---- addresses of buses, and how they are opened -------------------------------------------------


GROUP, PORT = "239.74.163.2", 43113
IP_MULTICAST_ALL = 49  # of Linux; Python does not define it
CHANNELS = {"virtual": "mamba", "udp_multicast": GROUP, "socketcan": "can0"}
"""Default channels, by interface."""


class BusFailed(LaticaudaError, OSError):
    """Raised if a CAN bus cannot be opened; the message says which, and why."""


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
            object.__setattr__(self, "channel", CHANNELS[self.interface])
        if self.interface == "udp_multicast":
            is_group = False
            with contextlib.suppress(ValueError):  # it is not an address
                is_group = ipaddress.IPv4Address(self.channel).is_multicast
            if not is_group:
                rule = f"must be an IPv4 multicast group such as {GROUP}, got {self.channel!r}"
                raise BadArgument("channel", rule)

    def __str__(self) -> str:
        """Return the form that users read and write: interface:channel, with the port for udp_multicast."""
        port = f":{self.port}" if self.interface == "udp_multicast" else ""
        return f"{self.interface}:{self.channel}{port}"


def bus_address(text: str, *, hops: int = 0) -> BusAddress:
    """Parse an address such as `udp_multicast:239.74.163.2:43113`, `virtual:mamba` or `socketcan`.

    Args:
        text: Interface, then channel and port, which may be omitted.
        hops: Routers that frames of udp_multicast may pass [-].

    Raises:
        ValueError: If the text is not an address.
    """
    interface, _, rest = text.partition(":")
    if interface != "udp_multicast":
        return BusAddress(interface=cast("Any", interface), channel=rest)
    channel, _, port = rest.partition(":")
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
        settings |= {"port": address.port, "hop_limit": address.hops, "fd": False}
    try:
        return (
            can.Bus(**settings)
            if address.interface != "udp_multicast" or address.hops
            else _local_bus(settings)
        )
    except (can.CanError, OSError) as error:
        raise BusFailed(
            f"The CAN bus {address} cannot be opened: {error.__cause__ or error}."
        ) from error


def _local_bus(settings: Mapping[str, Any]) -> Any:
    """Return a bus within this computer: python-can's except for its socket, which would join a group on a network."""
    module = import_module("can.interfaces.udp_multicast.bus")

    class Wire(module.GeneralPurposeUdpMulticastBus):
        def _create_socket(self, address_family: int) -> socket.socket:
            self.timestamp_nanosecond = False
            return _local_socket(self.group, self.port)

    class LocalBus(module.UdpMulticastBus):
        def __init__(self, *, channel: str, port: int, hop_limit: int, fd: bool) -> None:
            module.BusABC.__init__(self, channel)
            self._multicast, self._can_protocol = (
                Wire(channel, port, hop_limit),
                module.CanProtocol.CAN_20,
            )

    return LocalBus(**{name: one for name, one in settings.items() if name != "interface"})


def _local_socket(group: str, port: int) -> socket.socket:
    """Return a socket that sends to a multicast group over loopback, and receives from it over loopback only.

    Raises:
        OSError: If the system does not support this.
    """
    found, loopback = (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM),
        socket.inet_aton("127.0.0.1"),
    )
    try:
        for name in ("SO_REUSEADDR", "SO_REUSEPORT"):
            if hasattr(socket, name):
                found.setsockopt(socket.SOL_SOCKET, getattr(socket, name), 1)
        found.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        found.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, loopback)
        # Data sent to one of this computer's addresses in the network are not for members of the
        # group.
        found.bind(("127.0.0.1" if sys.platform == "win32" else group, port))
        found.setsockopt(
            socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + loopback
        )
        if sys.platform == "linux":  # else it would receive what others here have joined elsewhere
            found.setsockopt(socket.IPPROTO_IP, IP_MULTICAST_ALL, 0)
            with contextlib.suppress(OSError):  # an older kernel, where this requires root
                found.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, b"lo\0")
    except OSError:
        found.close()
        raise
    return found
