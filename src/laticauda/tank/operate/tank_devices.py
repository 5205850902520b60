"""Devices of a tank that is stepped, without wires: what the loop reads from and sends to.

Their data are available at once, and their clock is the time up to which the tank was stepped.
"""

import math
from collections.abc import Generator
from contextlib import contextmanager

import numpy as np

from laticauda.control import estimation
from laticauda.tank import lab, protocol
from laticauda.tank.operate.devices import Devices
from laticauda.tank.operate.drivers import Clock, Frame
from laticauda.tank.operate.drivers.mocap import pose_sample
from laticauda.tank.operate.recording.entries import PowerReading, SensorSample
from laticauda.tank.protocol.meter import DISPLAYED, LineReader, decode_displayed

METER_INTERVAL = 0.2
"""Time between two queries of the meter [s]."""


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

    def receive(self) -> tuple[PowerReading, ...]:
        """Return the displayed current once per `METER_INTERVAL`; nothing if there is no valid answer."""
        now = self._clock.now()
        if now - self._queried < METER_INTERVAL - 1e-9:
            return ()
        self._queried = now
        try:
            shown = decode_displayed(LineReader().feed(self._tank.answer(DISPLAYED))[1])
        except (IndexError, protocol.ProtocolError):
            return ()
        return (PowerReading(time=now, current=shown.live),)

    def restart(self) -> None:
        """Do nothing."""


class TankSensors(TankDriver):
    """The robot's own sensors."""

    _has_announced = False

    def receive(self) -> tuple[tuple[float, SensorSample], ...]:
        """Return what the sensors measured since the last call, with the times of arrival."""
        now = self._clock.now()
        columns = self._tank.body.sensor_columns
        samples: list[tuple[float, SensorSample]] = []
        if not self._has_announced:
            self._has_announced = True
            for name, names in columns.items():
                sample = SensorSample(time=now, sensor=name, columns=names, values=np.empty(0))
                samples.append((now, sample))
        for reading in self._tank.sensed():
            sample = SensorSample(
                time=reading.time,
                sensor=reading.sensor,
                columns=columns[reading.sensor],
                values=np.array(reading.values),
            )
            samples.append((now, sample))
        return tuple(samples)


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
        sensors = TankSensors(*wires) if tank.body.sensor_columns else None
        super().__init__(
            clock=wires[1],
            bus=TankBus(*wires),
            mocap=TankCameras(*wires),
            meter=meter,
            sensors=sensors,
        )
