"""Between messages and CAN frames, by `mamba.dbc`; what loads python-can.

Frames come and go three thousand times a second, so they are packed here by the layouts from which the file is written;
that cantools makes the same bytes and numbers of them, by the file alone, is what the tests say.

What a bus delivers is not to be trusted: `decode` gives None for whatever is no frame of ours, and never raises.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from typing import Any

from laticauda.errors import BadArgument, finite
from laticauda.extras import optional_import
from laticauda.protocol import dbc, messages

NOT_AVAILABLE = -32768
"""The lowest number of a signed word: what a sensor says that has nothing to say."""


LAYOUT_OF: dict[type[Any], dbc.Layout] = {layout.kind: layout for layout in dbc.LAYOUTS}
_BY_IDENTIFIER = {layout.identifier + number: (layout, number) for layout in dbc.LAYOUTS for number in layout.numbers}
_FIRST_ANSWER = LAYOUT_OF[messages.JointState].identifier


def python_can() -> Any:
    """The module of python-can.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The CAN bus", "python-can", "hardware", "can")


def encode(message: messages.CanMessage) -> tuple[int, bytes]:
    """The identifier and data of the frame that carries a message. Numbers beyond a signal's range saturate.

    Args:
        message: What to send.

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
        values = (value,) if len(numbers) == 1 else (None,) * len(numbers) if value is None else value
        for one, value in zip(numbers, values, strict=True):
            try:
                raw = NOT_AVAILABLE if value is None else round(value / one.scale)
            except (ValueError, OverflowError):
                finite(one.name, value)
                raise
            whole |= (min(max(raw, one.low), one.high) & (1 << one.signal.bits) - 1) << one.start
    return layout.identifier + number, whole.to_bytes(layout.length, "little")


def decode(identifier: int, data: bytes) -> messages.CanMessage | None:
    """The message that a frame carries, or None if it is none of ours: unknown, too short, too long, or no sense in it.

    Args:
        identifier: Of the frame, 11 bits.
        data: Its bytes.
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
    except ValueError:  # a number that stands for no word
        return None
    return layout.kind(**known)


def _value(one: dbc.Number, whole: int) -> Any:
    """What a frame's bits say of one number; None where a sensor has nothing to say."""
    _, kind, how, scale, start, low, _, is_word = one
    raw = whole >> start & (1 << how.bits) - 1
    if how.signed and raw >> how.bits - 1:
        raw -= 1 << how.bits
    if is_word:
        return kind(raw)
    return None if raw == low == NOT_AVAILABLE else raw * scale


def from_node(identifier: int) -> bool:
    """Whether a frame with this `identifier` comes from a node, if it is one of ours."""
    return identifier >= _FIRST_ANSWER


def to_frame(message: messages.CanMessage) -> Any:
    """The `can.Message` that carries a `message`."""
    identifier, data = encode(message)
    return python_can().Message(arbitration_id=identifier, data=data, is_extended_id=False)


def from_frame(frame: Any) -> messages.CanMessage | None:
    """The message in `frame`, a `can.Message`, or None if it is none of ours; error and remote frames are not."""
    if frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd:
        return None
    return decode(frame.arbitration_id, bytes(frame.data))
