"""Between messages and CAN frames, by `mamba.dbc`; what loads cantools and python-can.

Frames come and go three thousand times a second, so they are packed here by the layouts from which the file is written;
that cantools makes the same bytes and numbers of them, by the file alone, is what the tests say.

What a bus delivers is not to be trusted: `decode` gives None for whatever is no frame of ours, and never raises.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from functools import cache
from typing import Any

from laticauda.errors import BadArgument, finite
from laticauda.extras import optional_import
from laticauda.protocol.dbc import FILE, LAYOUTS, Layout
from laticauda.protocol.messages import CanMessage, JointState

NOT_AVAILABLE = -32768
"""The lowest number of a signed word: what a sensor says that has nothing to say."""


class Packer:
    """Messages of one class into the bytes of a frame and out of them; least significant bit first.

    Args:
        layout: Of the frame.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout, self._length = layout, layout.length
        self._fields = tuple((f.name, len(f.signals), f.kind if f.is_word else None) for f in layout.fields)
        self._names: list[str] = []
        self._numbers: list[
            tuple[float, int, int, int, int, int]
        ] = []  # scale, limits, place, mask, weight of the sign
        start = 0
        for field in layout.fields:
            how = field.signal
            scale = 1 if how.scale == "1" else float(how.scale)
            for name in field.signals:
                self._names.append(name)
                sign = 1 << how.bits - 1 if how.signed else 0
                self._numbers.append((scale, *field.limits, start, (1 << how.bits) - 1, sign))
                start += how.bits

    def packed(self, message: CanMessage) -> bytes:
        """The bytes of a frame. Numbers beyond their range saturate.

        Args:
            message: Of the layout's class.

        Raises:
            ValueError: If a number is not finite.
        """
        values: list[Any] = []
        for name, n, _ in self._fields:
            value = getattr(message, name)
            values += (value,) if n == 1 else (None,) * n if value is None else value
        whole = 0
        for k, (value, (scale, low, high, start, mask, _)) in enumerate(zip(values, self._numbers, strict=True)):
            try:
                number = NOT_AVAILABLE if value is None else round(value / scale)
            except (ValueError, OverflowError):
                finite(self._names[k], value)
                raise
            whole |= ((low if number < low else high if number > high else number) & mask) << start
        return whole.to_bytes(self._length, "little")

    def unpacked(self, number: int, data: bytes) -> CanMessage | None:
        """The message in a frame; None if its length is wrong.

        Args:
            number: Which one of the layout's frames.
            data: Its bytes.

        Raises:
            ValueError: If a number stands for no word.
        """
        if len(data) != self._length:
            return None
        whole, values = int.from_bytes(data, "little"), list[Any]()
        for scale, low, _, start, mask, sign in self._numbers:
            raw = ((whole >> start & mask) ^ sign) - sign
            values.append(None if raw == low == NOT_AVAILABLE else raw * scale)
        known: dict[str, Any] = {self.layout.number: number} if self.layout.number else {}
        at = 0
        for name, n, make in self._fields:
            if n == 1:
                known[name] = values[at] if make is None else make(values[at])
            else:
                several = tuple(values[at : at + n])
                known[name] = None if None in several else several
            at += n
        return self.layout.kind(**known)


PACKERS: dict[type[Any], Packer] = {layout.kind: Packer(layout) for layout in LAYOUTS}
_BY_IDENTIFIER = {
    packer.layout.identifier + number: (packer, number)
    for packer in PACKERS.values()
    for number in packer.layout.numbers
}
_FIRST_ANSWER = PACKERS[JointState].layout.identifier


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
    packer = PACKERS[type(message)]
    layout = packer.layout
    number, known = getattr(message, layout.number) if layout.number else 0, layout.numbers
    if number not in known:
        raise BadArgument("node", f"must be a number from {known[0]} to {known[-1]}, got {number}")
    return layout.identifier + number, packer.packed(message)


def decode(identifier: int, data: bytes) -> CanMessage | None:
    """The message that a frame carries, or None if it is none of ours: unknown, too short, too long, or no sense in it.

    Args:
        identifier: Of the frame, 11 bits.
        data: Its bytes.
    """
    found = _BY_IDENTIFIER.get(identifier)
    if found is None:
        return None
    packer, number = found
    try:
        return packer.unpacked(number, data)
    except ValueError:  # a number that stands for no word
        return None


def from_node(identifier: int) -> bool:
    """Whether a frame with this `identifier` comes from a node, if it is one of ours."""
    return identifier >= _FIRST_ANSWER


def to_frame(message: CanMessage) -> Any:
    """The `can.Message` that carries a `message`."""
    identifier, data = encode(message)
    return python_can().Message(arbitration_id=identifier, data=data, is_extended_id=False)


def from_frame(frame: Any) -> CanMessage | None:
    """The message in `frame`, a `can.Message`, or None if it is none of ours; error and remote frames are not."""
    if frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd:
        return None
    return decode(frame.arbitration_id, bytes(frame.data))
