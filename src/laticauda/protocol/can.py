"""Between messages and CAN frames, by `mamba.dbc`; the door of cantools and of python-can.

What a bus delivers is not to be trusted: `decode` gives None for whatever is no frame of ours, and never raises.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from importlib import import_module
from typing import Any, TypeAlias

from laticauda.errors import MissingExtra, finite
from laticauda.protocol.dbc import FILE, LAYOUTS
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

Signals: TypeAlias = Mapping[str, Any]
NOT_AVAILABLE = -32768
FORCES = ("ForceAlong", "ForceLeft", "ForceUp")
BASE = {layout.name: layout.identifier for layout in LAYOUTS}


@dataclass(frozen=True)
class _Kind:
    """How one class of message goes into a frame and comes out of it."""

    name: str
    first: int  # number of the first frame: 1 for nodes, 0 for groups
    last: int
    signals: Callable[[Any], dict[str, Any]]
    message: Callable[[int, Signals], CanMessage]
    number: Callable[[Any], int]


@cache
def library(name: str, package: str) -> Any:
    """The library `name`; it has no types that are complete, so what comes from it is `Any` here.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise MissingExtra("The CAN bus", package, "hardware") from error


@cache
def database() -> Any:
    """The cantools database of `mamba.dbc`.

    Raises:
        MissingExtra: If cantools is not installed.
    """
    return library("cantools", "cantools").database.load_file(str(FILE))


def encode(message: CanMessage) -> tuple[int, bytes]:
    """The identifier and data of the frame that carries a message. Numbers beyond a signal's range saturate.

    Args:
        message: What to send.

    Raises:
        ValueError: If there is no such node, or a number is not finite.
        MissingExtra: If cantools is not installed.
    """
    kind = _KINDS[type(message)]
    number = kind.number(message)
    if not kind.first <= number <= kind.last:
        raise ValueError(f"`node` must be a number from {kind.first} to {kind.last}, got {number}.")
    identifier = BASE[kind.name] + number
    codec, scales, limits = _codec(identifier)
    raw = {}
    for name, value in kind.signals(message).items():
        low, high = limits[name]
        scaled = NOT_AVAILABLE if value is None else round(finite(name, value) / scales[name])
        raw[name] = min(max(scaled, low), high)
    return identifier, codec.encode(raw, scaling=False, strict=False)


def decode(identifier: int, data: bytes) -> CanMessage | None:
    """The message that a frame carries, or None if it is none of ours: unknown, too short, too long, or no sense in it.

    Args:
        identifier: Of the frame, 11 bits.
        data: Its bytes.

    Raises:
        MissingExtra: If cantools is not installed.
    """
    found = _BY_IDENTIFIER.get(identifier)
    if found is None:
        return None
    kind, number = found
    codec, scales, _ = _codec(identifier)
    if len(data) != codec.length:
        return None
    raw = codec.decode(bytes(data), scaling=False, decode_choices=False)
    values = {name: value * scales[name] if scales[name] != 1.0 else value for name, value in raw.items()}
    if any(raw.get(name) == NOT_AVAILABLE for name in FORCES):
        values |= dict.fromkeys(FORCES)
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
    can = library("can", "python-can")
    return can.Message(timestamp=timestamp, arbitration_id=identifier, data=data, is_extended_id=False)


def from_frame(frame: Any) -> CanMessage | None:
    """The message in `frame`, a `can.Message`, or None if it is none of ours; error and remote frames are not."""
    if frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd:
        return None
    return decode(frame.arbitration_id, bytes(frame.data))


@cache
def _codec(identifier: int) -> tuple[Any, dict[str, float], dict[str, tuple[int, int]]]:
    """cantools' message, and the scale and the range of raw values of its signals.

    The lowest number of a signed signal is kept for "not available".
    """
    message = database().get_message_by_frame_id(identifier)
    scales = {signal.name: float(signal.scale) for signal in message.signals}
    limits = {
        signal.name: (-(2 ** (signal.length - 1)) + (signal.name not in FORCES), 2 ** (signal.length - 1) - 1)
        if signal.is_signed
        else (0, 2**signal.length - 1)
        for signal in message.signals
    }
    return message, scales, limits


def _title(name: str) -> str:
    """The signal of a field: its words run together."""
    return "".join(word.capitalize() for word in name.split("_"))


def _plain(kind: type[Any]) -> tuple[Callable[[Any], dict[str, Any]], Callable[[int, Signals], Any]]:
    """Both ways for a class whose fields are its signals."""
    names = {field.name: _title(field.name) for field in fields(kind) if field.name != "node"}
    makes = {"state": NodeState, "result": Result}
    makes |= {f.name: bool for f in fields(kind) if f.type in (bool, "bool")}
    with_node = any(field.name == "node" for field in fields(kind))

    def signals(message: Any) -> dict[str, Any]:
        return {signal: _number(getattr(message, name)) for name, signal in names.items()}

    def message(number: int, values: Signals) -> Any:
        made = {name: makes.get(name, _same)(values[signal]) for name, signal in names.items()}
        return kind(node=number, **made) if with_node else kind(**made)

    return signals, message


def _number(value: Any) -> Any:
    return int(value) if isinstance(value, bool) else value


def _same(value: Any) -> Any:
    return value


def _command(number: int, values: Signals) -> NodeCommand:
    return NodeCommand(node=values["Node"], order=Order(values["Order"]), angle=values["Angle"])


def _loads(number: int, values: Signals) -> Loads:
    force = None if values["ForceAlong"] is None else tuple(values[name] for name in FORCES)
    return Loads(node=number, force=force, torque=values["Torque"])  # pyright: ignore[reportArgumentType]


def _load_signals(message: Loads) -> dict[str, Any]:
    force = (None, None, None) if message.force is None else message.force
    return {**dict(zip(FORCES, force, strict=True)), "Torque": message.torque}


def _references(number: int, values: Signals) -> References:
    angles = tuple(values[f"Angle{k}"] for k in range(1, 5))
    return References(group=number, angles=angles)  # pyright: ignore[reportArgumentType]


def _one(message: Any) -> int:
    return 0


def _node(message: Any) -> int:
    return message.node


_KINDS: dict[type[Any], _Kind] = {
    EmergencyStop: _Kind("EmergencyStop", 0, 0, *_plain(EmergencyStop), _one),
    Sync: _Kind("Sync", 0, 0, *_plain(Sync), _one),
    NodeCommand: _Kind(
        "NodeCommand",
        0,
        0,
        lambda m: {"Node": m.node, "Order": m.order, "Angle": m.angle},
        _command,
        _one,
    ),
    References: _Kind(
        "References",
        0,
        N_GROUPS - 1,
        lambda m: {f"Angle{k}": angle for k, angle in enumerate(m.angles, start=1)},
        _references,
        lambda m: m.group,
    ),
    Loads: _Kind("Loads", 1, N_NODES, _load_signals, _loads, _node),
    **{
        kind: _Kind(kind.__name__, 1, N_NODES, *_plain(kind), _node)
        for kind in (JointState, Acceleration, Heartbeat, CommandReply)
    },
}
_BY_IDENTIFIER = {
    BASE[kind.name] + number: (kind, number) for kind in _KINDS.values() for number in range(kind.first, kind.last + 1)
}
