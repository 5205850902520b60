"""Operate something that is stepped, such as `laticauda.lab.Tank`: no threads, no wires, as fast as it goes.

The same operator, the same protocol; only the drivers are left out. The same calls give the same answers.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Protocol

import numpy as np

from laticauda.estimation import PoseSample
from laticauda.operate.course.operator import Operator
from laticauda.operate.course.state import Inputs, OperatorState, Outputs
from laticauda.operate.drivers.can import Frame
from laticauda.operate.drivers.mocap import pose_sample
from laticauda.operate.loop import NoSink, Sink
from laticauda.operate.recording.entries import PowerReading
from laticauda.protocol import MocapFrame, ProtocolError, decode, encode
from laticauda.protocol.meter import DISPLAYED, LineReader, decode_displayed

METER_INTERVAL = 0.2  # between two queries of the meter [s]


class SteppedTank(Protocol):
    """What can be operated without wires."""

    time: float

    def advance_to(self, time: float) -> None:
        """Let time go on [s]."""
        ...

    def sent(self) -> Iterable[tuple[int, bytes]]:
        """Take away the frames of the modules."""
        ...

    def captured(self) -> Iterable[MocapFrame]:
        """Take away what the cameras saw."""
        ...

    def answer(self, line: str) -> bytes:
        """What the power meter says to a line."""
        ...

    def receive(self, identifier: int, data: bytes, time: float | None = None) -> None:
        """A frame of ours."""
        ...


def run_stepped(
    operator: Operator,
    tank: SteppedTank,
    *,
    keys: Callable[[float], Mapping[str, str]] = lambda now: {},
    sink: Sink | None = None,
    show: Callable[[OperatorState, Outputs], None] | None = None,
    longest: float = 600.0,
) -> OperatorState:
    """Operate until it is done.

    Args:
        operator: What to do.
        tank: What is operated.
        keys: What the operator has pressed by a time [s].
        sink: What keeps the record; None: nothing does.
        show: Called with every tick.
        longest: After which it is given up [s].

    Returns:
        The last state.

    Raises:
        RuntimeError: If it is not done by then.
    """
    interval, sink = 1.0 / operator.operation.rate, sink or NoSink()
    state, first, queried = operator.init(), tank.time, -np.inf
    count = 0
    while not state.is_done:
        now = first + count * interval
        if now - first > longest:
            raise RuntimeError(f"the operation is not done after {longest:g} s: {state.phase}")
        tank.advance_to(now)
        received = [Frame(time=now, identifier=i, data=d, is_ours=False, message=decode(i, d)) for i, d in tank.sent()]
        readings: tuple[PowerReading, ...] = ()
        if operator.operation.connection.meter_port and now - queried >= METER_INTERVAL - 1e-9:
            readings, queried = _reading(tank, now), now
        events = dict(keys(now))
        if sink.trouble:
            events["recorder_failed"] = sink.trouble
        inputs = Inputs(
            messages=tuple((frame.time, frame.message) for frame in received if frame.message is not None),
            frames=tuple((now, _first_body(frame)) for frame in tank.captured()),
            readings=readings,
            events=events,
        )
        state, outputs = operator.tick(state, now, inputs)
        sent: list[Frame] = []
        for message in outputs.messages:
            identifier, data = encode(message)
            sent.append(Frame(time=now, identifier=identifier, data=data, is_ours=True, message=message))
            tank.receive(identifier, data, now)
        sink.tick(state, outputs, (*received, *sent), None)
        if show is not None:
            show(state, outputs)
        count += 1
    return state


def _first_body(frame: MocapFrame) -> PoseSample:
    return pose_sample(frame.timestamp, frame.bodies[0] if frame.bodies else None)


def _reading(tank: SteppedTank, now: float) -> tuple[PowerReading, ...]:
    """What the meter shows; nothing where it says nothing, or nothing of sense."""
    try:
        lines = LineReader().feed(tank.answer(DISPLAYED))
        shown = decode_displayed(lines[1])
    except (IndexError, ProtocolError):
        return ()
    return (PowerReading(time=now, current=shown.live),)
