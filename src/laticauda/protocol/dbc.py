"""How messages lie in the frames of `mamba.dbc`: every node has its own, so `tests/mamba_dbc.py` writes the file."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from laticauda.protocol import messages
from laticauda.protocol.messages import N_NODES, Signal

NUMBERS = {"": range(1), "node": range(1, N_NODES + 1), "group": range(messages.N_GROUPS)}
"""Numbers of the frames of one kind, by the field that says which one it is."""


class Number(NamedTuple):
    """One number in a frame."""

    name: str
    """What the file calls it."""
    kind: Any
    """Type of the field that it belongs to."""
    signal: Signal
    """How it goes over the bus."""
    scale: float
    """What one step of it is worth."""
    start: int
    """Its first bit."""
    low: int
    """Its least value on the bus; the lowest of all says that a sensor has nothing to say."""
    high: int
    """Its greatest."""
    is_word: bool
    """Whether it stands for something: a flag, or a word."""


@dataclass(frozen=True)
class Layout:
    """One kind of frame: the fields of its message in their order, each one number or several in a row."""

    kind: type[messages.CanMessage]
    identifier: int
    says: str

    @cached_property
    def number(self) -> str:
        """The field that says which frame it is; "" where there is but one."""
        return next((name for name, hint in get_type_hints(self.kind, include_extras=True).items() if hint is int), "")

    @property
    def numbers(self) -> range:
        """Of the frames."""
        return NUMBERS[self.number]

    @cached_property
    def fields(self) -> dict[str, tuple[Number, ...]]:
        """The numbers of every field that the frame carries."""
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
        """Bytes of data."""
        return sum(one.signal.bits for one in self.signals) // 8


def _numbers(field: str, hint: Any, start: int) -> Iterator[Number]:
    """Those of one field, from this bit on."""
    kind, how = get_args(hint) if get_origin(hint) is Annotated else (hint, Signal(1 if hint is bool else 8))
    top = 2 ** (how.bits - how.signed)
    low = -top + (type(None) not in get_args(kind)) if how.signed else 0
    is_word = isinstance(kind, type) and issubclass(kind, bool | IntEnum)
    scale = 1 if how.scale == "1" else float(how.scale)
    for i, name in enumerate(how.names or (field.title().replace("_", ""),)):
        yield Number(name, kind, how, scale, start + i * how.bits, low, top - 1, is_word)


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
