"""The clocked loop: takes what the devices have, ticks, and sends what comes out, at a fixed rate."""

import gc
import sys
from collections.abc import Callable, Generator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Protocol

from laticauda.operate.course.operator import Operator
from laticauda.operate.course.state import Inputs, OperatorState, Outputs
from laticauda.operate.drivers import CanDriver, Clock, MeterDriver, MocapDriver
from laticauda.operate.drivers.can import Frame
from laticauda.operate.recording.entries import Tick
from laticauda.operate.settings import Connection
from laticauda.operate.timing import Timing, timing_of
from laticauda.protocol import BusAddress, EmergencyStop

MOST_ERRORS = 3  # errors of the tick in a row, after which it is given up
SWITCH_INTERVAL = 0.0005  # between threads of this program; Python's own 5 ms are half a period [s]


class Sink(Protocol):
    """What keeps a record of every tick."""

    @property
    def trouble(self) -> str:
        """Why nothing is recorded any more; "" as long as it is."""
        ...

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Keep one tick: the state after it, what went out, the frames of the bus, both ways, and when it was."""
        ...


class NoSink:
    """Keeps nothing."""

    trouble = ""

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Nothing is kept."""


@dataclass(frozen=True, kw_only=True)
class Devices:
    """The drivers that are connected."""

    can: CanDriver
    """The modules' bus."""
    mocap: MocapDriver
    """The cameras."""
    meter: MeterDriver | None
    """The power meter; None without one."""

    def receive(self, events: Mapping[str, str]) -> tuple[Inputs, tuple[Frame, ...]]:
        """Everything that came in since the last call, and the raw frames.

        Args:
            events: What the operator and the recorder say.
        """
        frames = self.can.receive()
        found = dict(events)
        if self.can.bus_off:
            found["bus_off"] = self.can.bus_off
        inputs = Inputs(
            messages=tuple((frame.time, frame.message) for frame in frames if frame.message is not None),
            frames=self.mocap.receive(),
            readings=() if self.meter is None else self.meter.receive(),
            events=found,
        )
        return inputs, frames


@contextmanager
def connected(connection: Connection, clock: Clock) -> Generator[Devices]:
    """The devices of an operation, connected; they are closed at the end of the block.

    Args:
        connection: Where they are.
        clock: What stamps everything that comes in.

    Raises:
        DeviceFailed: If one cannot be reached; the message says what to check.
        MissingExtra: If a library is not installed.
    """
    with ExitStack() as stack:
        port = {"port": connection.can_port} if connection.can_interface == "udp_multicast" else {}
        address = BusAddress(interface=connection.can_interface, channel=connection.can_channel, **port)
        can = stack.enter_context(CanDriver(address, clock))
        mocap = stack.enter_context(
            MocapDriver(connection.mocap_host, connection.mocap_port, connection.mocap_body, clock)
        )
        meter = None
        if connection.meter_port:
            meter = stack.enter_context(MeterDriver(connection.meter_port, clock))
        yield Devices(can=can, mocap=mocap, meter=meter)


def run_loop(
    operator: Operator,
    devices: Devices,
    clock: Clock,
    *,
    keys: Callable[[], Mapping[str, str]],
    sink: Sink | None = None,
    show: Callable[[OperatorState, Outputs], None] | None = None,
) -> tuple[OperatorState, Timing]:
    """Operate until it is done.

    Args:
        operator: What to do.
        devices: Connected.
        clock: That of the devices.
        keys: What the operator has pressed, by now.
        sink: What keeps the record; None: nothing does.
        show: Called with every tick; must be quick.

    Returns:
        The last state, and how punctual the loop was.
    """
    sink = sink or NoSink()
    interval = 1.0 / operator.operation.rate
    state, errors, error = operator.init(), 0, ""
    ticks: list[Tick] = []
    with _without_pauses():
        due = clock.now()
        while not state.is_done:
            clock.wait_until(due)
            now = clock.now()
            events = dict(keys())
            if sink.trouble:
                events["recorder_failed"] = sink.trouble
            if error:
                events["program_error"] = error
            inputs, received = devices.receive(events)
            try:
                state, outputs = operator.tick(state, now, inputs)
                errors, error = 0, ""
            except Exception as failed:  # a fault of ours must not leave the robot swimming
                errors, error, outputs = errors + 1, f"{type(failed).__name__}: {failed}", Outputs()
            if errors >= MOST_ERRORS:
                devices.can.send((EmergencyStop(reason=2),))
                raise RuntimeError(f"The operation was given up with an emergency stop: {error}")
            sent = devices.can.send(outputs.messages)
            if devices.meter is not None and any(event.kind == "start" for event in outputs.events):
                devices.meter.restart()  # its average is that of the run
            ticks.append(Tick(due, now, clock.now()))
            _keep(sink, state, outputs, (*received, *sent), ticks[-1])
            if show is not None:
                show(state, outputs)
            due += interval
            if now > due + interval:  # what was missed is not made up for
                due = now + interval
    return state, timing_of(ticks, interval)


def _keep(sink: Sink, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick) -> None:
    try:
        sink.tick(state, outputs, frames, tick)
    except Exception:
        # The sink says so itself by `trouble`; one that cannot must not stop the loop in the middle of a tick.
        if not sink.trouble:
            raise


@contextmanager
def _without_pauses() -> Generator[None]:
    """No collection of garbage within a tick, and quick changes between threads."""
    switch, was_on = sys.getswitchinterval(), gc.isenabled()
    gc.collect()
    gc.disable()
    sys.setswitchinterval(SWITCH_INTERVAL)
    try:
        yield
    finally:
        sys.setswitchinterval(switch)
        if was_on:
            gc.enable()
