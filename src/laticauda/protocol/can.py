"""Between messages and CAN frames, by `mamba.dbc`; what loads cantools and python-can.

Frames come and go three thousand times a second, so they are packed here by the layouts from which the file is written;
that cantools makes the same bytes and numbers of them, by the file alone, is what the tests say.

What a bus delivers is not to be trusted: `decode` gives None for whatever is no frame of ours, and never raises.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache
from operator import attrgetter
from typing import Any

from laticauda.errors import BadArgument, finite
from laticauda.extras import optional_import
from laticauda.protocol.dbc import FILE, LAYOUTS, Layout
from laticauda.protocol.messages import (
    N_GROUPS,
    N_NODES,
    Acceleration,
    CanMessage,
    CommandReply,
    EmergencyStop,
    Heartbeat,
    JointState,
    Loads,
    NodeCommand,
    NodeState,
    Order,
    References,
    Result,
    Sync,
)

NOT_AVAILABLE = -32768
"""The lowest number of a signed word: what a sensor says that has nothing to say."""
MAY_LACK = ("ForceAlong", "ForceLeft", "ForceUp")
"""Signals that may be not available; for all others the lowest number is kept out."""
FORMS = {(8, False): "B", (16, False): "H", (16, True): "h"}


class Packer:
    """Numbers of one kind of frame into bytes and out of them; least significant byte first.

    Args:
        layout: Of the frame: words of 8 and 16 bits, and flags of 1 bit, eight of them in a row.
    """

    def __init__(self, layout: Layout) -> None:
        signals = layout.signals
        self._names = tuple(signal.name for signal in signals)
        self._scales = tuple(float(signal.scale) for signal in signals)
        self._limits = tuple(
            (-(2 ** (s.bits - 1)) + (s.name not in MAY_LACK), 2 ** (s.bits - 1) - 1) if s.signed else (0, 2**s.bits - 1)
            for s in signals
        )
        flags = [at for at, signal in enumerate(signals) if signal.bits == 1]
        assert len(flags) in (0, 8) and flags == list(range(flags[0], flags[0] + 8) if flags else ())
        self._flags = flags[0] if flags else None
        words = [FORMS[s.bits, s.signed] for s in signals if s.bits > 1]
        if self._flags is not None:
            words.insert(self._flags, "B")
        self._form = struct.Struct("<" + "".join(words))
        assert self._form.size == layout.length
        self._scaled = tuple((at, scale) for at, scale in enumerate(self._scales) if scale != 1.0)
        self._lacking = tuple(at for at, name in enumerate(self._names) if name in MAY_LACK)

    def packed(self, values: Sequence[Any]) -> bytes:
        """The bytes of a frame. Numbers beyond their range saturate.

        Args:
            values: In the order of the layout, in their units; None where it is not available.

        Raises:
            ValueError: If one is not finite.
        """
        raw: list[int] = []
        for value, scale, (low, high) in zip(values, self._scales, self._limits, strict=True):
            try:
                number = NOT_AVAILABLE if value is None else round(value / scale)
            except (ValueError, OverflowError):
                finite(self._names[len(raw)], value)
                raise
            raw.append(low if number < low else high if number > high else number)
        at = self._flags
        if at is not None:
            raw[at : at + 8] = [sum(bit << k for k, bit in enumerate(raw[at : at + 8]))]
        return self._form.pack(*raw)

    def unpacked(self, data: bytes) -> list[Any] | None:
        """The numbers of a frame in their units; None instead of those not available, and if its length is wrong.

        Args:
            data: Its bytes.
        """
        if len(data) != self._form.size:
            return None
        values: list[Any] = list(self._form.unpack(data))
        at = self._flags
        if at is not None:
            flags = values[at]
            values[at : at + 1] = [(flags >> k) & 1 for k in range(8)]
        lacking = [k for k in self._lacking if values[k] == NOT_AVAILABLE] if self._lacking else ()
        for k, scale in self._scaled:
            values[k] *= scale
        for k in lacking:
            values[k] = None
        return values


BASE = {layout.name: layout.identifier for layout in LAYOUTS}
PACKERS = {layout.name: Packer(layout) for layout in LAYOUTS}


NUMBERS = {"": range(1), "node": range(1, N_NODES + 1), "group": range(N_GROUPS)}
"""Numbers of the frames of one kind, by the field that says which one it is."""


@dataclass(frozen=True)
class _Kind:
    """How one class of message goes into a frame and comes out of it."""

    name: str
    number: str  # the field that says which frame it is; "" where there is but one
    signals: Callable[[Any], Sequence[Any]]  # in the order of the layout
    message: Callable[[int, Sequence[Any]], CanMessage]


def python_can() -> Any:
    """The module of python-can.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The CAN bus", "python-can", "hardware", "can")


@cache
def database() -> Any:
    """The cantools database of `mamba.dbc`.

    Raises:
        MissingExtra: If cantools is not installed.
    """
    return optional_import("The CAN bus", "cantools", "hardware").database.load_file(str(FILE))


def encode(message: CanMessage) -> tuple[int, bytes]:
    """The identifier and data of the frame that carries a message. Numbers beyond a signal's range saturate.

    Args:
        message: What to send.

    Raises:
        ValueError: If there is no such node, or a number is not finite.
    """
    kind = _KINDS[type(message)]
    number, known = getattr(message, kind.number) if kind.number else 0, NUMBERS[kind.number]
    if number not in known:
        raise BadArgument("node", f"must be a number from {known[0]} to {known[-1]}, got {number}")
    return BASE[kind.name] + number, PACKERS[kind.name].packed(kind.signals(message))


def decode(identifier: int, data: bytes) -> CanMessage | None:
    """The message that a frame carries, or None if it is none of ours: unknown, too short, too long, or no sense in it.

    Args:
        identifier: Of the frame, 11 bits.
        data: Its bytes.
    """
    found = _BY_IDENTIFIER.get(identifier)
    if found is None:
        return None
    kind, number = found
    values = PACKERS[kind.name].unpacked(data)
    if values is None:
        return None
    try:
        return kind.message(number, values)
    except ValueError:  # a number that stands for no word
        return None


def from_node(identifier: int) -> bool:
    """Whether a frame with this `identifier` comes from a node, if it is one of ours."""
    return identifier >= BASE["JointState"]


def to_frame(message: CanMessage, timestamp: float = 0.0) -> Any:
    """The `can.Message` that carries a message.

    Args:
        message: What to send.
        timestamp: Of the frame [s].
    """
    identifier, data = encode(message)
    can = python_can()
    return can.Message(timestamp=timestamp, arbitration_id=identifier, data=data, is_extended_id=False)


def from_frame(frame: Any) -> CanMessage | None:
    """The message in `frame`, a `can.Message`, or None if it is none of ours; error and remote frames are not."""
    if frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd:
        return None
    return decode(frame.arbitration_id, bytes(frame.data))


def _plain(kind: type[Any], number: str = "") -> _Kind:
    """For a class whose fields are its signals, in the same order, but for its `number`."""
    signals = [field for field in fields(kind) if field.name != number]
    names = [field.name for field in signals]
    made: list[tuple[str, Any]] = [(f.name, f.type) for f in signals if f.type in (NodeState, Order, Result, bool)]

    def message(at: int, values: Sequence[Any]) -> Any:
        known = dict(zip(names, values, strict=True))
        for name, make in made:
            known[name] = make(known[name])
        return kind(**{number: at}, **known) if number else kind(**known)

    # Of one name, the getter gives no tuple.
    get = attrgetter(*names)
    return _Kind(kind.__name__, number, get if len(names) > 1 else lambda m: (get(m),), message)


def _loads(number: int, values: Sequence[Any]) -> Loads:
    along, left, up, torque = values
    return Loads(node=number, force=None if None in (along, left, up) else (along, left, up), torque=torque)


def _load_signals(message: Loads) -> Sequence[Any]:
    return (*((None, None, None) if message.force is None else message.force), message.torque)


def _references(number: int, values: Sequence[Any]) -> References:
    one, two, three, four = values
    return References(group=number, angles=(one, two, three, four))


_KINDS: dict[type[Any], _Kind] = {
    **{kind: _plain(kind) for kind in (EmergencyStop, Sync, NodeCommand)},
    **{kind: _plain(kind, "node") for kind in (JointState, Acceleration, Heartbeat, CommandReply)},
    References: _Kind("References", "group", attrgetter("angles"), _references),
    Loads: _Kind("Loads", "node", _load_signals, _loads),
}
_BY_IDENTIFIER = {
    BASE[kind.name] + number: (kind, number) for kind in _KINDS.values() for number in NUMBERS[kind.number]
}
