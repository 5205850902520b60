"""The loop of an operation: takes what the devices have, ticks, and sends what comes out, at a fixed rate.

What the time is, its clock says, and what the devices are, is theirs: the same loop operates a robot over wires and
something that is stepped, such as `laticauda.lab.Tank`, without threads and as fast as it goes.
"""

import math
from collections.abc import Callable, Generator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace

from laticauda import lab, protocol
from laticauda.operate.course.operator import Operator
from laticauda.operate.course.state import Inputs, OperatorState, Outputs
from laticauda.operate.drivers import CanDriver, Clock, MeterDriver, MocapDriver
from laticauda.operate.drivers.can import Frame
from laticauda.operate.drivers.mocap import pose_sample
from laticauda.operate.recording import entries, log
from laticauda.operate.settings import Connection
from laticauda.protocol.meter import DISPLAYED, LineReader, decode_displayed

MOST_ERRORS = 3  # errors of the tick in a row, after which it is given up
Show = Callable[[OperatorState, Outputs], None]
"""Called with every tick; must be quick."""


class Devices:
    """What the loop takes from and sends to."""

    clock: Clock
    """What stamps what comes in."""

    def receive(self, now: float) -> tuple[Inputs, tuple[Frame, ...]]:
        """Everything that came in since the last call, and the raw frames of the bus; `now` in s."""
        raise NotImplementedError

    def send(self, messages: tuple[protocol.CanMessage, ...], now: float) -> tuple[Frame, ...]:
        """Send `messages` over the bus, in this order, at `now` [s]: the frames that went out."""
        raise NotImplementedError

    def begin_run(self) -> None:
        """The run begins: what averages begins anew."""


@dataclass(kw_only=True)
class Wired(Devices):
    """The drivers that are connected."""

    clock: Clock
    """Theirs."""
    can: CanDriver
    """The modules' bus."""
    mocap: MocapDriver
    """The cameras."""
    meter: MeterDriver | None
    """The power meter; None without one."""

    def receive(self, now: float) -> tuple[Inputs, tuple[Frame, ...]]:
        """See `Devices.receive`."""
        frames = self.can.receive()
        inputs = Inputs(
            messages=tuple((frame.time, frame.message) for frame in frames if frame.message is not None),
            frames=self.mocap.receive(),
            readings=() if self.meter is None else self.meter.receive(),
            events={"bus_off": self.can.bus_off} if self.can.bus_off else {},
        )
        return inputs, frames

    def send(self, messages: tuple[protocol.CanMessage, ...], now: float) -> tuple[Frame, ...]:
        """See `Devices.send`."""
        return self.can.send(messages)

    def begin_run(self) -> None:
        """The meter's average is that of the run."""
        if self.meter is not None:
            self.meter.restart()


@contextmanager
def connected(connection: Connection, clock: Clock) -> Generator[Wired]:
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
        address = protocol.BusAddress(interface=connection.can_interface, channel=connection.can_channel, **port)
        can = stack.enter_context(CanDriver(address, clock))
        cameras = connection.mocap_host, connection.mocap_port, connection.mocap_body
        mocap = stack.enter_context(MocapDriver(*cameras, clock))
        meter = stack.enter_context(MeterDriver(connection.meter_port, clock)) if connection.meter_port else None
        yield Wired(clock=clock, can=can, mocap=mocap, meter=meter)


def run_loop(
    operator: Operator,
    devices: Devices,
    *,
    keys: Callable[[float], Mapping[str, str]] = lambda now: {},
    sink: log.Sink | None = None,
    show: Show | None = None,
    longest: float = math.inf,
) -> tuple[OperatorState, entries.Timing | None]:
    """Operate until it is done.

    Args:
        operator: What to do.
        devices: Connected.
        keys: What the operator has pressed by a time [s].
        sink: What keeps the record; None: nothing does.
        show: Called with every tick.
        longest: After which it is given up [s].

    Returns:
        The last state, and how punctual the loop was; None if its clock is not real.

    Raises:
        RuntimeError: If it is not done by then, or the operator's program fails again and again.
    """
    clock, interval = devices.clock, 1.0 / operator.operation.rate
    state, errors, error = operator.init(), 0, ""
    ticks: list[entries.Tick] = []
    with clock.undisturbed():
        begun = origin = clock.now()
        count = 0
        while not state.is_done:
            due = origin + count * interval
            if due - begun > longest:
                raise RuntimeError(f"the operation is not done after {longest:g} s: {state.phase}")
            clock.wait_until(due)
            now = clock.now()
            ours = {**keys(now), "recorder_failed": sink.trouble if sink else "", "program_error": error}
            inputs, received = devices.receive(now)
            inputs = replace(inputs, events={**inputs.events, **{event: why for event, why in ours.items() if why}})
            try:
                state, outputs = operator.tick(state, now, inputs)
                errors, error = 0, ""
            except Exception as failed:  # a fault of ours must not leave the robot swimming
                errors, error, outputs = errors + 1, f"{type(failed).__name__}: {failed}", Outputs()
                if errors >= MOST_ERRORS:
                    devices.send((protocol.EmergencyStop(reason=2),), now)
                    raise RuntimeError(f"The operation was given up with an emergency stop: {error}") from failed
            sent = devices.send(outputs.messages, now)
            if any(event.kind == "start" for event in outputs.events):
                devices.begin_run()
            if clock.is_real:
                ticks.append(entries.Tick(due, now, clock.now()))
            if sink is not None:
                sink.keep(now, (*received, *sent, *ticks[-1:], *outputs.entries))
            if show is not None:
                show(state, outputs)
            count += 1
            if now > origin + (count + 1) * interval:  # what was missed is not made up for
                origin, count = now, 1
    return state, entries.Timing(ticks=ticks, interval=interval) if clock.is_real else None


METER_INTERVAL = 0.2  # between two queries of the meter [s]


class TankTime(Clock):
    """The time up to which a tank has been stepped.

    Args:
        tank: The tank.
    """

    is_real = False

    def __init__(self, tank: lab.Tank) -> None:
        super().__init__()
        self._tank, self._now = tank, tank.time

    def now(self) -> float:
        """See `Clock.now`."""
        return self._now

    def wait_until(self, moment: float) -> None:
        """Step the tank until then, a `moment` in s."""
        self._tank.advance_to(moment)
        self._now = moment

    @contextmanager
    def undisturbed(self) -> Generator[None]:
        """Nothing to do: what is stepped cannot be late."""
        yield


class TankDevices(Devices):
    """A tank without wires, as devices.

    Args:
        tank: The tank.
        has_meter: Whether its power meter is read.
    """

    def __init__(self, tank: lab.Tank, *, has_meter: bool = True) -> None:
        self.clock = TankTime(tank)
        self._tank, self._has_meter = tank, has_meter
        self._queried = -math.inf

    def receive(self, now: float) -> tuple[Inputs, tuple[Frame, ...]]:
        """See `Devices.receive`."""
        frames = tuple(Frame(now, *wire, is_ours=False, message=protocol.decode(*wire)) for wire in self._tank.sent())
        readings: tuple[entries.PowerReading, ...] = ()
        if self._has_meter and now - self._queried >= METER_INTERVAL - 1e-9:
            readings, self._queried = self._readings(now), now
        inputs = Inputs(
            messages=tuple((now, frame.message) for frame in frames if frame.message is not None),
            frames=tuple(
                (now, pose_sample(frame.timestamp, frame.bodies[0] if frame.bodies else None))
                for frame in self._tank.captured()
            ),
            readings=readings,
        )
        return inputs, frames

    def send(self, messages: tuple[protocol.CanMessage, ...], now: float) -> tuple[Frame, ...]:
        """See `Devices.send`."""
        frames = tuple(Frame(now, *protocol.encode(message), is_ours=True, message=message) for message in messages)
        for frame in frames:
            self._tank.receive(frame.identifier, frame.data, now)
        return frames

    def _readings(self, now: float) -> tuple[entries.PowerReading, ...]:
        """What the meter shows; nothing where it says nothing, or nothing of sense."""
        try:
            lines = LineReader().feed(self._tank.answer(DISPLAYED))
            shown = decode_displayed(lines[1])
        except (IndexError, protocol.ProtocolError):
            return ()
        return (entries.PowerReading(time=now, current=shown.live),)
