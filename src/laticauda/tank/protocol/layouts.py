"""Layouts of the frames of the robot's CAN bus: which numbers of a message stand at which bits.

Frames are those of `mamba.dbc`, which `tests/mamba_dbc.py` writes from these layouts.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from laticauda.tank.protocol import messages
from laticauda.tank.protocol.messages import N_NODES, Signal

FRAME_NUMBERS = {
    "": range(1),
    "node": range(1, N_NODES + 1),
    "group": range(messages.N_GROUPS),
}
"""Numbers of the frames of one kind, by the field that identifies the frame."""
FLAG_BITS = 1
"""Bits of a flag without a signal."""
WORD_BITS = 8
"""Bits of a symbolic word without a signal."""


@dataclass(frozen=True, slots=True)
class Number:
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
    is_symbol: bool
    """Whether it is symbolic: a flag, or a word."""


@dataclass(frozen=True)
class Layout:
    """One kind of frame: the fields of its message in order, each with one or several consecutive numbers."""

    kind: type[messages.CanMessage]
    identifier: int
    description: str

    @cached_property
    def number(self) -> str:
        """Field that identifies the frame; "" if there is only one."""
        for name, hint in get_type_hints(self.kind, include_extras=True).items():
            if hint is int:
                return name
        return ""

    @property
    def numbers(self) -> range:
        """Numbers of the frames."""
        return FRAME_NUMBERS[self.number]

    @cached_property
    def fields(self) -> dict[str, tuple[Number, ...]]:
        """Numbers of every field that the frame carries."""
        fields: dict[str, tuple[Number, ...]] = {}
        start = 0
        for field, hint in get_type_hints(self.kind, include_extras=True).items():
            if field == self.number:
                continue
            numbers = _numbers_of_field(field, hint, start)
            fields[field] = numbers
            start = numbers[-1].start + numbers[-1].signal.bits
        return fields

    @cached_property
    def signals(self) -> tuple[Number, ...]:
        """All numbers of the frame."""
        return tuple(number for numbers in self.fields.values() for number in numbers)

    @cached_property
    def length(self) -> int:
        """Number of data bytes."""
        return sum(number.signal.bits for number in self.signals) // 8


def _numbers_of_field(field: str, hint: Any, start: int) -> tuple[Number, ...]:
    """Return the numbers of one field, starting at a given bit."""
    if get_origin(hint) is Annotated:
        kind, signal = get_args(hint)
    else:
        kind = hint
        signal = Signal(FLAG_BITS if hint is bool else WORD_BITS)
    low = 0
    high = 2**signal.bits - 1
    if signal.signed:
        low = -(2 ** (signal.bits - 1))
        high = 2 ** (signal.bits - 1) - 1
        if type(None) not in get_args(kind):
            low += 1  # the lowest number is not used: it would mean that there is no value
    names = signal.names or (field.title().replace("_", ""),)
    return tuple(
        Number(
            name=name,
            kind=kind,
            signal=signal,
            scale=1 if signal.scale == "1" else float(signal.scale),
            start=start + i * signal.bits,
            low=low,
            high=high,
            is_symbol=isinstance(kind, type) and issubclass(kind, bool | IntEnum),
        )
        for i, name in enumerate(names)
    )


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

LAYOUT_OF: dict[type[Any], Layout] = {layout.kind: layout for layout in LAYOUTS}
"""Layouts by the class of the message."""
