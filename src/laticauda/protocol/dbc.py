"""The text of `mamba.dbc`: every node has frames of its own, so the file is written by a program.

After a change: ``python -c "from laticauda.protocol import dbc; dbc.FILE.write_text(dbc.dbc_text())"``.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from laticauda.protocol import messages
from laticauda.protocol.messages import N_NODES, Signal

FILE = Path(__file__).with_name("mamba.dbc")
OPERATOR = "Operator"
NUMBERS = {"": range(1), "node": range(1, N_NODES + 1), "group": range(messages.N_GROUPS)}
"""Numbers of the frames of one kind, by the field that says which one it is."""


@dataclass(frozen=True)
class Field:
    """A field of a message, as it goes over the bus: one number, or several in a row."""

    name: str
    kind: Any
    signal: Signal

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """What the file calls the numbers."""
        return self.signal.names or ("".join(word.capitalize() for word in self.name.split("_")),)

    @property
    def is_word(self) -> bool:
        """Whether its number stands for something: a flag, or a word."""
        return isinstance(self.kind, type) and issubclass(self.kind, bool | IntEnum)

    @property
    def may_lack(self) -> bool:
        """Whether a sensor may have nothing to say."""
        return type(None) in get_args(self.kind)

    @property
    def limits(self) -> tuple[int, int]:
        """Least and greatest number, as it is on the bus; the lowest of all says that there is none."""
        top = 2 ** (self.signal.bits - self.signal.signed)
        return (-top + (not self.may_lack) if self.signal.signed else 0), top - 1


@dataclass(frozen=True)
class Layout:
    """One kind of frame: the fields of its message, in their order."""

    kind: type[messages.CanMessage]
    identifier: int
    says: str

    @cached_property
    def _hints(self) -> dict[str, Any]:
        return get_type_hints(self.kind, include_extras=True)

    @property
    def name(self) -> str:
        """That of the message."""
        return self.kind.__name__

    @cached_property
    def number(self) -> str:
        """The field that says which frame it is; "" where there is but one."""
        return next((name for name, hint in self._hints.items() if hint is int), "")

    @property
    def numbers(self) -> range:
        """Of the frames."""
        return NUMBERS[self.number]

    @cached_property
    def fields(self) -> tuple[Field, ...]:
        """Those that the frame carries."""
        return tuple(_field(name, hint) for name, hint in self._hints.items() if name != self.number)

    @property
    def length(self) -> int:
        """Bytes of data."""
        return sum(field.signal.bits * len(field.signals) for field in self.fields) // 8


def _field(name: str, hint: Any) -> Field:
    if get_origin(hint) is Annotated:
        return Field(name, *get_args(hint))
    return Field(name, hint, Signal(1 if hint is bool else 8))


LAYOUTS = (
    Layout(messages.EmergencyStop, 0x001, "All motors off until cleared."),
    Layout(messages.NodeCommand, 0x010, "An order to one node or to all."),
    Layout(messages.References, 0x100, "Reference angles of four joints; they count from the next Sync on."),
    # Behind the references: were it of higher priority, it could overtake those that it is meant for.
    Layout(messages.Sync, 0x180, "References count from here; every node measures and answers."),
    Layout(messages.JointState, 0x200, "The answer to every Sync."),
    Layout(messages.Loads, 0x280, "The force/torque sensor."),
    Layout(messages.Acceleration, 0x300, "The accelerometer."),
    Layout(messages.Heartbeat, 0x700, "How a node is."),
    Layout(messages.CommandReply, 0x780, "The answer to a NodeCommand."),
)


def dbc_text() -> str:
    """The file's text."""
    nodes = [f"Node{number:02d}" for number in NUMBERS["node"]]
    lines = ['VERSION "1"', "", "NS_ :", "", "BS_:", "", "BU_: " + " ".join([OPERATOR, *nodes]), ""]
    remarks = [
        'CM_ "The CAN bus of the swimming snake robot Mamba: 1 Mbit/s, 11-bit identifiers, node 1 at the tail.";'
    ]
    values: list[str] = []
    for layout, number in ((one, number) for one in LAYOUTS for number in one.numbers):
        identifier, suffix = layout.identifier + number, {"": "", "node": f"{number:02d}", "group": str(number)}
        sender, hears = OPERATOR, ",".join(nodes)
        if layout.number == "node":
            sender, hears = nodes[number - 1], OPERATOR
        lines.append(f"BO_ {identifier} {layout.name}{suffix[layout.number]}: {layout.length} {sender}")
        remarks.append(f'CM_ BO_ {identifier} "{layout.says}";')
        start = 0
        for signal, field in ((signal, one) for one in layout.fields for signal in one.signals):
            how = field.signal
            sign = "-" if how.signed else "+"
            lines.append(f' SG_ {signal} : {start}|{how.bits}@1{sign} ({how.scale},0) [0|0] "{how.unit}" {hears}')
            if how.says:
                remarks.append(f'CM_ SG_ {identifier} {signal} "{how.says}";')
            if field.is_word and field.kind is not bool:
                words = " ".join(f'{word.value} "{word.name}"' for word in field.kind)
                values.append(f"VAL_ {identifier} {signal} {words} ;")
            start += how.bits
        lines.append("")
    return "\n".join([*lines, *remarks, *values, ""])
