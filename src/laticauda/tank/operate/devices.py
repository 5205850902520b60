"""The devices of an operation: connected drivers, or their substitutes in a tank."""

from collections.abc import Generator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

from laticauda.control.estimation import PoseSample
from laticauda.tank import protocol
from laticauda.tank.operate.drivers import KINDS, Clock, Frame, StopInput
from laticauda.tank.operate.procedure.state import Inputs
from laticauda.tank.operate.recording.entries import PowerReading, SensorSample
from laticauda.tank.operate.settings import Connection


class BusDevice(Protocol):
    """The modules' bus, as the loop needs it."""

    @property
    def bus_off(self) -> str:
        """Why it can no longer send; "" while it can."""
        ...

    def receive(self) -> tuple[Frame, ...]:
        """Return the frames that arrived since the last call."""
        ...

    def send(self, messages: tuple[protocol.CanMessage, ...]) -> tuple[Frame, ...]:
        """Send messages in this order; return the frames that carry them."""
        ...


class CameraDevice(Protocol):
    """The cameras, as the loop needs them."""

    def receive(self) -> tuple[tuple[float, PoseSample], ...]:
        """Return what they saw since the last call, with the times of arrival."""
        ...


class MeterDevice(Protocol):
    """The power meter, as the loop needs it."""

    def receive(self) -> tuple[PowerReading, ...]:
        """Return the readings since the last call."""
        ...

    def restart(self) -> None:
        """Start its averages over."""
        ...


class SensorDevice(Protocol):
    """The robot's own sensors, as the loop needs them."""

    def receive(self) -> tuple[tuple[float, SensorSample], ...]:
        """Return what they sent since the last call, with the times of arrival."""
        ...


@dataclass(kw_only=True)
class Devices:
    """Devices that the loop reads from and sends to."""

    clock: Clock
    """Clock that timestamps incoming data."""
    bus: BusDevice
    """The modules' bus."""
    mocap: CameraDevice
    """The cameras."""
    meter: MeterDevice | None = None
    """The power meter; None without one."""
    stop: StopInput | None = None
    """The emergency-stop input; None without one."""
    sensors: SensorDevice | None = None
    """The robot's own sensors; None: they are not read."""

    def receive(self, own_events: Mapping[str, str]) -> tuple[Inputs, tuple[Frame, ...]]:
        """Return everything received since the last call, and the raw frames of the bus.

        Args:
            own_events: Why our own events are present, by event; "" means that one is not.
        """
        frames = self.bus.receive()
        stops: tuple[str, ...] = ()
        if self.stop is not None:
            stops = tuple(self.stop.receive())
        reasons = {
            "bus_off": self.bus.bus_off,
            "emergency_input": next((reason for reason in stops if reason), ""),
            **own_events,
        }
        messages = [(frame.time, frame.message) for frame in frames if frame.message is not None]
        inputs = Inputs(
            messages=tuple(messages),
            frames=self.mocap.receive(),
            readings=() if self.meter is None else self.meter.receive(),
            sensed=() if self.sensors is None else self.sensors.receive(),
            events={event: reason for event, reason in reasons.items() if reason},
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
        drivers: dict[str, Any] = {}
        for kind in KINDS:
            if connection.of(kind)[1]:
                drivers[kind] = stack.enter_context(connection.opened(kind, clock))
        yield Devices(clock=clock, **drivers)
