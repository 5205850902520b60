"""The tank on real wires and in real time: a CAN bus, servers for cameras and sensors, a serial line for the meter."""

import os
import select
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Any

from laticauda.tank.lab.qtm_server import LOOPBACK, QtmServer, ServerFailed
from laticauda.tank.lab.sensor_server import SensorServer
from laticauda.tank.lab.tank import Tank
from laticauda.tank.protocol import BusAddress, clock as clocks, open_bus, qtm, readings, worker
from laticauda.tank.protocol.can import python_can
from laticauda.tank.protocol.meter import LineReader
from laticauda.values import check_positive


class SerialLine(worker.Worker[None]):
    """Serial line that answers queries; pyserial opens its `path`.

    Args:
        respond: Function that returns the answer to a line.

    Raises:
        ServerFailed: If the operating system has no pseudo-terminals.
    """

    def __init__(self, respond: Callable[[str], bytes]) -> None:
        super().__init__("meter")
        self._respond = respond
        self._reader = LineReader()
        try:
            import tty

            self._ours, self._theirs = os.openpty()
        except (ImportError, OSError) as error:
            raise ServerFailed(f"The meter's port cannot be opened: {error}.") from error
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.path = os.ttyname(self._theirs)
        self._start()

    def work(self) -> None:
        """Wait for lines, and answer them."""
        if select.select([self._ours], [], [], 0.1)[0]:
            for line in self._reader.feed(os.read(self._ours, 4096)):
                with suppress(OSError):  # nobody reads, and the line is full
                    os.write(self._ours, self._respond(line))

    def release(self) -> None:
        """Close the line."""
        for end in (self._ours, self._theirs):
            os.close(end)


WORST_LAG = 0.5  # s; if the lab is further behind its clock, the clock waits
MOST_WAITING = 64  # frames received between two steps
LONGEST_WAIT = 0.1  # s; longest time that Ctrl-C and other threads wait


@dataclass(frozen=True, kw_only=True)
class LabAddresses:
    """Addresses of the lab."""

    bus: BusAddress | Any
    """CAN bus, or what stands for it."""
    mocap_host: str
    """Host of the cameras' server [-]."""
    mocap_port: int
    """Port of the cameras' server [-]."""
    meter: str
    """Path of the meter's serial line [-]."""
    sensors_port: int | None = None
    """Port of the sensors' server, on the same host as the cameras'; None: the robot has no sensors [-]."""


class Lab:
    """A tank that others can reach over its wires.

    Args:
        tank: Tank to serve.
        bus: CAN bus on which its nodes are, or what stands for one, like python-can's.
        host: Host address at which the cameras' server listens; by default, only this computer.
        port: Port of that server; 0: any free one.
        sensors_port: Port of the server of the robot's own sensors, if it has any; 0: any free one.
        speed: Seconds of the lab per second of real time.
    """

    def __init__(
        self,
        tank: Tank,
        *,
        bus: BusAddress | Any,
        host: str = LOOPBACK,
        port: int = qtm.PORT,
        sensors_port: int = readings.PORT,
        speed: float = 1.0,
    ) -> None:
        self.tank, self.speed = tank, check_positive("speed", speed)
        self.lag = 0.0
        """Total time that the clock has waited because this computer could not keep up [s]."""
        self.behind = 0.0
        """Longest time that it was behind its clock [s]."""
        self._bus_address, self._wires = bus, ExitStack()
        self.server: Any = QtmServer(tank.settings.mocap.rate, host, port)
        """Server of the cameras; before `open`, it may be replaced by one that starts, publishes and stops likewise."""
        self._sensor_server: SensorServer | None = None
        if tank.body.sensor_columns:
            self._sensor_server = SensorServer(tank.body.sensor_columns, host, sensors_port)
        self._lock = threading.Lock()
        self._stopped = threading.Event()
        self._thread: threading.Thread | None = None
        self._broken: BaseException | None = None

    def open(self) -> LabAddresses:
        """Open all wires.

        Raises:
            LaticaudaError: If a wire cannot be opened; the message says which, and why.
        """
        with ExitStack() as wires:
            bus = self._bus_address
            self._bus = wires.enter_context(open_bus(bus) if isinstance(bus, BusAddress) else bus)
            wires.callback(self.server.stop)
            self.server.start()
            sensors_port = None
            if self._sensor_server is not None:
                wires.callback(self._sensor_server.stop)
                self._sensor_server.start()
                sensors_port = self._sensor_server.port
            line = wires.enter_context(
                SerialLine(lambda line: self.call(lambda tank: tank.answer(line)))
            )
            self._wires = wires.pop_all()
        host, port = self.server.host, self.server.port
        return LabAddresses(
            bus=bus,
            mocap_host=host,
            mocap_port=port,
            meter=line.path,
            sensors_port=sensors_port,
        )

    def close(self) -> None:
        """Stop, and close all wires."""
        self._stopped.set()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(5.0)
        self._wires.close()

    def __enter__(self) -> LabAddresses:
        """Open all wires, and advance time in a separate thread until the end of the block; see `open`."""
        addresses = self.open()

        def run() -> None:
            try:
                self.run()
            except BaseException as error:
                self._broken = error

        self._thread = threading.Thread(target=run, name="lab", daemon=True)
        self._thread.start()
        return addresses

    def __exit__(self, *_: object) -> None:
        """Stop, and close all wires; raise the error of the thread, if there was one."""
        self.close()
        if self._broken is not None:
            raise self._broken

    def call(self, function: Callable[[Tank], Any]) -> Any:
        """Call a function that looks at the tank, or changes it, while time stands still; from any thread.

        Args:
            function: Function of the tank.
        """
        with self._lock:
            return function(self.tank)

    def run(self, duration: float | None = None) -> None:
        """Advance time.

        Args:
            duration: Duration on the lab's clock; None: until `close` [s].

        Raises:
            SimulationFailed: If the body's motion diverges.
        """
        end = float("inf") if duration is None else self.tank.time + duration
        clock, first = clocks.Clock(speed=self.speed), self.tank.time
        self.lag = 0.0
        while not self._stopped.is_set() and self.tank.time < end - 1e-9:
            now = first + clock.now() - self.lag
            behind = now - self.tank.next_tick
            self.behind = max(self.behind, behind)
            if behind > WORST_LAG * self.speed:
                self.lag += behind
                now -= behind
            if now >= min(self.tank.next_tick, end):
                with self._lock:
                    self.tank.advance_to(min(self.tank.next_tick, end))
                    self._send()
            wait = (self.tank.next_tick - now) / self.speed
            # With wait <= 0, a step is due. All frames that have arrived by then are still received
            # before it: one per step, and a computer that cannot keep up would let them wait longer
            # and longer.
            for patience in (min(max(wait, 0.0), LONGEST_WAIT), *[0.0] * MOST_WAITING):
                frame: Any = None
                with suppress(
                    python_can().CanError
                ):  # frames that a bus cannot decode count as lost
                    frame = self._bus.recv(patience)
                if frame is None:
                    break
                self._take(frame, first + clock.now() - self.lag)

    def _take(self, frame: Any, now: float) -> None:
        if frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd:
            return
        with self._lock:
            self.tank.receive(
                frame.arbitration_id, bytes(frame.data), min(now, self.tank.next_tick)
            )
            self._send()

    def _send(self) -> None:
        """Send the frames of the nodes and of the cameras, and the readings of the sensors."""
        can = python_can()
        with suppress(can.CanError):  # a full buffer loses frames, as a busy bus does
            for identifier, data in self.tank.sent():
                self._bus.send(
                    can.Message(arbitration_id=identifier, data=data, is_extended_id=False)
                )
        for frame in self.tank.captured():
            self.server.publish(frame)
        if self._sensor_server is not None:
            self._sensor_server.publish(self.tank.sensed())
