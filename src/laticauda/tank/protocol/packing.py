"""Packing of messages into the bytes of CAN frames, and back.

Three thousand frames come and go every second, so they are packed here, by the layouts from which
`mamba.dbc` is written; the tests check that cantools, given only the file, converts them to the
same bytes and numbers.

Data from a bus are not trusted: `decode` returns None for anything that is not one of our frames,
and never raises.
"""

import math
from typing import Any, NamedTuple

from laticauda.tank.protocol import messages
from laticauda.tank.protocol.layouts import LAYOUT_OF, LAYOUTS, Layout, Number
from laticauda.values import BadArgument, check_finite

NOT_AVAILABLE = -32768
"""Lowest number of a signed word, sent for a sensor that has no value."""


class _Frame(NamedTuple):
    """A frame of the bus: its layout, and which of the frames of that layout it is."""

    layout: Layout
    number: int


FRAME_OF_IDENTIFIER = {
    layout.identifier + number: _Frame(layout, number)
    for layout in LAYOUTS
    for number in layout.numbers
}
FIRST_ANSWER = LAYOUT_OF[messages.JointState].identifier
"""Lowest identifier of the frames that nodes send."""


def encode(message: messages.CanMessage) -> tuple[int, bytes]:
    """Return identifier and data of the frame that carries a message; numbers beyond a signal's range saturate.

    Args:
        message: The message to send.

    Raises:
        ValueError: If there is no such node, or a number is not finite.
    """
    layout = LAYOUT_OF[type(message)]
    frame_number = getattr(message, layout.number) if layout.number else 0
    frame_numbers = layout.numbers
    if frame_number not in frame_numbers:
        raise BadArgument(
            "node",
            f"must be a number from {frame_numbers[0]} to {frame_numbers[-1]}, got {frame_number}",
        )
    bits = 0
    for field, numbers in layout.fields.items():
        value: Any = getattr(message, field)
        if len(numbers) == 1:
            bits |= _bits_of(numbers[0], value)
        elif value is None:
            for number in numbers:
                bits |= _bits_of(number, None)
        else:
            for number, component in zip(numbers, value, strict=True):
                bits |= _bits_of(number, component)
    return layout.identifier + frame_number, bits.to_bytes(layout.length, "little")


def _bits_of(number: Number, value: Any) -> int:
    """Return the bits of a frame that hold the value of one number; None: there is no value."""
    if value is None:
        raw = NOT_AVAILABLE
    else:
        if not math.isfinite(value):
            check_finite(number.name, value)  # raises the error
        least = max(number.low, NOT_AVAILABLE + 1)  # the lowest means that there is no value
        raw = round(min(max(value / number.scale, least), number.high))
    mask = (1 << number.signal.bits) - 1
    return (raw & mask) << number.start


def decode(identifier: int, data: bytes) -> messages.CanMessage | None:
    """Return the message that a frame carries, or None if it is not ours: unknown, too short, too long, or invalid.

    Args:
        identifier: Identifier of the frame, 11 bits.
        data: Data bytes of the frame.
    """
    frame = FRAME_OF_IDENTIFIER.get(identifier)
    if frame is None or len(data) != frame.layout.length:
        return None
    layout = frame.layout
    bits = int.from_bytes(data, "little")
    arguments: dict[str, Any] = {}
    if layout.number:
        arguments[layout.number] = frame.number
    try:
        for field, numbers in layout.fields.items():
            if len(numbers) == 1:
                arguments[field] = _value_of(numbers[0], bits)
            else:
                values = tuple(_value_of(number, bits) for number in numbers)
                arguments[field] = None if None in values else values
    except ValueError:  # a number that does not represent a word
        return None
    return layout.kind(**arguments)


def _value_of(number: Number, bits: int) -> Any:
    """Return the value of one number in a frame's bits; None if a sensor has no value."""
    signal = number.signal
    raw = bits >> number.start & (1 << signal.bits) - 1
    if signal.signed and raw >> signal.bits - 1:
        raw -= 1 << signal.bits
    if number.is_symbol:
        return number.kind(raw)
    if raw == number.low == NOT_AVAILABLE:
        return None
    return raw * number.scale


def from_node(identifier: int) -> bool:
    """Return whether a frame with this `identifier` comes from a node, provided that it is one of ours.

    Args:
        identifier: Identifier of the frame, 11 bits.
    """
    return identifier >= FIRST_ANSWER
