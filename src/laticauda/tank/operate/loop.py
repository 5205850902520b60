"""The loop of an operation: reads the devices, ticks, and sends the outputs, at a fixed rate.

The loop depends neither on the kind of clock nor on the kind of devices: it operates a robot over
wires as well as something that is stepped, such as `laticauda.tank.lab.Tank`, without threads and as
fast as possible.
"""

import math
from collections.abc import Callable, Generator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.control import estimation
from laticauda.tank import lab, protocol
from laticauda.tank.operate.course.operator import Operator
from laticauda.tank.operate.course.state import Inputs, OperatorState, Outputs
from laticauda.tank.operate.drivers import KINDS, Bus, Clock, Frame, Meter, MotionCapture, StopInput
from laticauda.tank.operate.drivers.mocap import pose_sample
from laticauda.tank.operate.recording import entries, log, writer
from laticauda.tank.operate.settings import Connection
from laticauda.tank.protocol.meter import DISPLAYED, LineReader, decode_displayed

MOST_TICKS = (
    200_000  # ticks whose times are kept, half an hour at 100 Hz; then the oldest are overwritten
)
MOST_ERRORS = 3  # consecutive errors of the tick after which the operation is given up
SWITCHES_ON_WITHIN = 0.1
"""Time from the beginning of a tick within which its order to switch motors on is sent [s].

Of a later one nobody knows any more whether the motors have gone limp in the meantime.
"""
Show = Callable[[OperatorState, Outputs], None]
"""Function that is called with every tick; must be fast."""


@dataclass(kw_only=True)
class Devices:
    """Devices that the loop reads from and sends to: connected drivers, or their substitutes in a tank."""

    clock: Clock
    """Clock that timestamps incoming data."""
    bus: "Bus | TankBus"
    """The modules' bus."""
    mocap: "MotionCapture | TankCameras"
    """The cameras."""
    meter: "Meter | TankMeter | None" = None
    """The power meter; None without one."""
    stop: StopInput | None = None
    """The emergency-stop input; None without one."""

    def receive(self, ours: Mapping[str, str]) -> tuple[Inputs, tuple[Frame, ...]]:
        """Return everything received since the last call, and the raw frames of the bus.

        Args:
            ours: Why our own events are there, by event; "" means that one is not.
        """
        frames, stops = self.bus.receive(), () if self.stop is None else self.stop.receive()
        events = {
            "bus_off": self.bus.bus_off,
            "emergency_input": next(filter(None, stops), ""),
            **ours,
        }
        inputs = Inputs(
            messages=tuple(
                (frame.time, frame.message) for frame in frames if frame.message is not None
            ),
            frames=self.mocap.receive(),
            readings=() if self.meter is None else self.meter.receive(),
            events={event: why for event, why in events.items() if why},
        )
        return inputs, frames


@contextmanager
def connected(connection: Connection, clock: Clock) -> Generator[Devices]:
    """Connect the devices of an operation; they are closed at the end of the block.

    Args:
        connection: Drivers and addresses of the devices.
        clock: Clock that timestamps all incoming data.

    Raises:
        DeviceFailed: If a device cannot be reached; the message says what to check.
        MissingExtra: If a library is not installed.
    """
    with ExitStack() as stack:
        there = (kind for kind in KINDS if connection.of(kind)[1])
        yield Devices(
            clock=clock,
            **{kind: stack.enter_context(connection.opened(kind, clock)) for kind in there},
        )


def run_loop(
    operator: Operator,
    devices: Devices,
    *,
    keys: Callable[[float], Mapping[str, str]] = lambda now: {},
    sink: log.Sink | writer.Writer | None = None,
    show: Show | None = None,
    longest: float = math.inf,
) -> tuple[OperatorState, entries.Timing | None]:
    """Run the loop until the operation is done.

    Args:
        operator: Operation to run.
        devices: Connected devices.
        keys: Function that returns what the operator has pressed by a time [s].
        sink: Sink that keeps the record; None: no record is kept.
        show: Function that is called with every tick.
        longest: Time after which the operation is given up [s].

    Returns:
        The last state, and the punctuality of the loop; None if its clock is not real.

    Raises:
        RuntimeError: If the operation is not done by then, or the operator's program fails
            repeatedly.
    """
    clock, interval = devices.clock, 1.0 / operator.operation.rate
    state, errors, error = operator.init(), 0, ""
    ticks: Any = np.empty(
        (MOST_TICKS if clock.is_real else 0, 3)
    )  # allocated once: nothing grows in the loop
    n_ticks = count = 0
    with clock.undisturbed() as granted:
        begun = origin = clock.now()
        while not state.is_done:
            due = origin + count * interval
            if due - begun > longest:
                raise RuntimeError(f"the operation is not done after {longest:g} s: {state.phase}")
            clock.wait_until(due)
            now = clock.now()
            ours = {
                **keys(now),
                "recorder_failed": sink.trouble if sink else "",
                "program_error": error,
            }
            inputs, received = devices.receive(ours)
            try:
                state, outputs = operator.tick(state, now, inputs)
                errors, error = 0, ""
            except Exception as failed:  # an error of our own must not leave the robot swimming
                errors, error, outputs = errors + 1, f"{type(failed).__name__}: {failed}", Outputs()
                if errors >= MOST_ERRORS:
                    devices.bus.send((protocol.EmergencyStop(reason=2),))
                    raise RuntimeError(
                        f"The operation was aborted with an emergency stop: {error}"
                    ) from failed
            outputs = without_late_enabling(outputs, now, clock.now())
            sent = devices.bus.send(outputs.messages)
            if devices.meter is not None and any(event.kind == "start" for event in outputs.events):
                devices.meter.restart()  # its averages start over
            if clock.is_real:
                tick = entries.Tick(due, now, clock.now())
                ticks[n_ticks % MOST_TICKS] = tick.due, tick.began, tick.sent
                said = (
                    (entries.Event(time=now, kind="loop", message=granted),) if n_ticks == 0 else ()
                )
                outputs = replace(outputs, entries=(tick, *said, *outputs.entries))
                n_ticks += 1
            if sink is not None:
                sink.keep(now, (*received, *sent, *outputs.entries))
            if show is not None:
                show(state, outputs)
            count += 1
            if now > origin + (count + 1) * interval:  # missed ticks are not made up for
                origin, count = now, 1
    return state, entries.Timing(
        times=np.sort(ticks[:n_ticks], axis=0), interval=interval
    ) if clock.is_real else None


def without_late_enabling(outputs: Outputs, began: float, now: float) -> Outputs:
    """Return the outputs of a tick, without orders to switch motors on if they would be sent too late.

    Args:
        outputs: Outputs of the tick.
        began: When the tick began [s].
        now: Current time [s].
    """
    enable = protocol.NodeCommand(order=protocol.Order.ENABLE)
    took = now - began
    if enable not in outputs.messages or took <= SWITCHES_ON_WITHIN:
        return outputs
    message = f"not switched on: the tick took {took:.1f} s"
    refused = entries.Event(time=now, kind="torque", message=message)
    return Outputs(
        messages=tuple(one for one in outputs.messages if one != enable),
        entries=(*outputs.entries, refused),
    )


METER_INTERVAL = 0.2  # time between two queries of the meter [s]


class TankTime(Clock):
    """Clock of a tank: the time up to which it has been stepped.

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
        """Step the tank until `moment` [s]."""
        self._tank.advance_to(moment)
        self._now = moment

    @contextmanager
    def undisturbed(self) -> Generator[str]:
        """Do nothing: a stepped tank cannot be late."""
        yield ""


class TankDriver:
    """Driver for a device of a tank without wires; its data are available at once.

    Args:
        tank: The tank.
        clock: Clock that timestamps incoming data.
    """

    def __init__(self, tank: lab.Tank, clock: Clock) -> None:
        self._tank, self._clock = tank, clock


class TankBus(TankDriver):
    """The modules' bus."""

    bus_off = ""
    """Always empty: it can always send."""

    def receive(self) -> tuple[Frame, ...]:
        """Return the frames that the modules sent since the last call."""
        now = self._clock.now()
        return tuple(
            Frame(now, *wire, is_ours=False, message=protocol.decode(*wire))
            for wire in self._tank.sent()
        )

    def send(self, messages: tuple[protocol.CanMessage, ...]) -> tuple[Frame, ...]:
        """Deliver `messages` to the modules in this order; return the frames that carry them."""
        now = self._clock.now()
        frames = tuple(
            Frame(now, *protocol.encode(message), is_ours=True, message=message)
            for message in messages
        )
        for frame in frames:
            self._tank.receive(frame.identifier, frame.data, now)
        return frames


class TankCameras(TankDriver):
    """The cameras."""

    def receive(self) -> tuple[tuple[float, estimation.PoseSample], ...]:
        """Return what the cameras saw since the last call, with the times of arrival."""
        now, captured = self._clock.now(), self._tank.captured()
        return tuple(
            (now, pose_sample(one.timestamp, one.bodies[0] if one.bodies else None))
            for one in captured
        )


class TankMeter(TankDriver):
    """The power meter; its averages are not queried."""

    _queried = -math.inf

    def receive(self) -> tuple[entries.PowerReading, ...]:
        """Return the displayed current once per `METER_INTERVAL`; nothing if there is no valid answer."""
        now = self._clock.now()
        if now - self._queried < METER_INTERVAL - 1e-9:
            return ()
        self._queried = now
        try:
            shown = decode_displayed(LineReader().feed(self._tank.answer(DISPLAYED))[1])
        except (IndexError, protocol.ProtocolError):
            return ()
        return (entries.PowerReading(time=now, current=shown.live),)

    def restart(self) -> None:
        """Do nothing."""


class TankDevices(Devices):
    """Devices of a tank without wires.

    Args:
        tank: The tank.
        has_meter: Whether its power meter is read.
        clock: Clock of the tank; None: a new one.
    """

    def __init__(
        self, tank: lab.Tank, *, has_meter: bool = True, clock: TankTime | None = None
    ) -> None:
        wires = tank, clock or TankTime(tank)
        meter = TankMeter(*wires) if has_meter else None
        super().__init__(
            clock=wires[1], bus=TankBus(*wires), mocap=TankCameras(*wires), meter=meter
        )
