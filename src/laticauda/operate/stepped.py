"""Operate something that is stepped, such as `laticauda.lab.Tank`: no threads, no wires, as fast as it goes.

The same operator, loop and protocol; only the drivers are left out. The same calls give the same answers.
"""

import math
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager

from laticauda.lab import Tank
from laticauda.operate.course.operator import Operator
from laticauda.operate.course.state import Inputs, OperatorState
from laticauda.operate.drivers.can import Frame, frame_of
from laticauda.operate.drivers.clock import Clock
from laticauda.operate.drivers.mocap import pose_sample
from laticauda.operate.loop import Devices, Show, run_loop
from laticauda.operate.recording.entries import PowerReading
from laticauda.operate.recording.sink import Sink
from laticauda.protocol import CanMessage, ProtocolError, decode, encode
from laticauda.protocol.meter import DISPLAYED, LineReader, decode_displayed

METER_INTERVAL = 0.2  # between two queries of the meter [s]


def run_stepped(
    operator: Operator,
    tank: Tank,
    *,
    keys: Callable[[float], Mapping[str, str]] = lambda now: {},
    sink: Sink | None = None,
    show: Show | None = None,
    longest: float = 600.0,
) -> OperatorState:
    """Operate a tank until it is done: `run_loop` with the tank's own time and devices.

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
        RuntimeError: As `run_loop`.
    """
    devices = TankDevices(tank, has_meter=bool(operator.operation.connection.meter_port))
    return run_loop(operator, devices, TankTime(tank), keys=keys, sink=sink, show=show, longest=longest)[0]


class TankTime(Clock):
    """The time up to which a tank has been stepped.

    Args:
        tank: The tank.
    """

    is_real = False

    def __init__(self, tank: Tank) -> None:
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

    def __init__(self, tank: Tank, *, has_meter: bool) -> None:
        self._tank, self._has_meter = tank, has_meter
        self._queried = -math.inf

    def receive(self, now: float) -> tuple[Inputs, tuple[Frame, ...]]:
        """See `Devices.receive`."""
        frames = tuple(frame_of(now, wire, decode(*wire), is_ours=False) for wire in self._tank.sent())
        readings: tuple[PowerReading, ...] = ()
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

    def send(self, messages: tuple[CanMessage, ...], now: float) -> tuple[Frame, ...]:
        """See `Devices.send`."""
        frames = tuple(frame_of(now, encode(message), message, is_ours=True) for message in messages)
        for frame in frames:
            self._tank.receive(frame.identifier, frame.data, now)
        return frames

    def _readings(self, now: float) -> tuple[PowerReading, ...]:
        """What the meter shows; nothing where it says nothing, or nothing of sense."""
        try:
            lines = LineReader().feed(self._tank.answer(DISPLAYED))
            shown = decode_displayed(lines[1])
        except (IndexError, ProtocolError):
            return ()
        return (PowerReading(time=now, current=shown.live),)
