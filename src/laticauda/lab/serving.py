"""The tank on real wires and at a real pace: a CAN bus, a server for the cameras, a serial line for the meter."""

import os
import select
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Any

from laticauda.errors import positive
from laticauda.lab.qtm_server import LOOPBACK, QtmServer, ServerFailed
from laticauda.lab.tank import Tank
from laticauda.protocol import BusAddress, open_bus, qtm, worker
from laticauda.protocol.can import python_can
from laticauda.protocol.meter import LineReader


class SerialLine(worker.Worker[None]):
    """Answers lines; its `path` is what pyserial opens.

    Args:
        answer: What to say to a line.

    Raises:
        ServerFailed: If the operating system has no pseudo-terminals.
    """

    def __init__(self, answer: Callable[[str], bytes]) -> None:
        super().__init__("meter")
        self._answer, self._reader = answer, LineReader()
        try:
            import tty

            self._ours, self._theirs = os.openpty()
        except (ImportError, OSError) as error:
            raise ServerFailed(f"The meter's line cannot be opened: {error}.") from error
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.path = os.ttyname(self._theirs)
        self._start()

    def work(self) -> None:
        """Wait for lines, and answer them."""
        if select.select([self._ours], [], [], 0.1)[0]:
            for line in self._reader.feed(os.read(self._ours, 4096)):
                with suppress(OSError):  # nobody reads, and the line is full
                    os.write(self._ours, self._answer(line))

    def release(self) -> None:
        """Hang up."""
        for end in (self._ours, self._theirs):
            os.close(end)


WORST_LAG = 0.5  # s; a lab that is further behind its clock lets the clock wait
LONGEST_WAIT = 0.1  # s; how long Ctrl-C and other threads wait at most


@dataclass(frozen=True, kw_only=True)
class LabAddresses:
    """Where the lab is to be reached."""

    bus: BusAddress | Any
    """The CAN bus, or what stands for it."""
    mocap_host: str
    """Of the cameras' server [-]."""
    mocap_port: int
    """Of the cameras' server [-]."""
    meter: str
    """The meter's serial line [-]."""


class Lab:
    """A tank that others reach over its wires.

    Args:
        tank: What is in it.
        bus: The CAN bus on which its nodes are, or what stands for one, like python-can's.
        host: Where the cameras' server listens; the default is this computer alone.
        port: Its port; 0: any free one.
        speed: Seconds of the lab for one second of ours.
    """

    def __init__(
        self, tank: Tank, *, bus: BusAddress | Any, host: str = LOOPBACK, port: int = qtm.PORT, speed: float = 1.0
    ) -> None:
        self.tank, self.speed = tank, positive("speed", speed)
        self.lag = 0.0
        """What the clock had to wait in all, because this computer could not follow [s]."""
        self._bus_address, self._wires = bus, ExitStack()
        self.server: Any = QtmServer(tank.settings.mocap.rate, host, port)
        """Of the cameras; another that starts, publishes and stops as it does may take its place before `open`."""
        self._lock = threading.Lock()
        self._stopped = threading.Event()
        self._thread: threading.Thread | None = None
        self._broken: BaseException | None = None

    def open(self) -> LabAddresses:
        """Open all wires.

        Raises:
            LaticaudaError: If one of them cannot be opened; the message says which, and why.
        """
        with ExitStack() as wires:
            bus = self._bus_address
            self._bus = wires.enter_context(open_bus(bus) if isinstance(bus, BusAddress) else bus)
            wires.callback(self.server.stop)
            self.server.start()
            line = wires.enter_context(SerialLine(self._answer))
            self._wires = wires.pop_all()
        host, port = self.server.host, self.server.port
        return LabAddresses(bus=bus, mocap_host=host, mocap_port=port, meter=line.path)

    def close(self) -> None:
        """Stop, and close all wires."""
        self._stopped.set()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(5.0)
        self._wires.close()

    def __enter__(self) -> LabAddresses:
        """Open all wires, and let time go on in a thread of its own until the end of the block; see `open`."""
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
        """As `close`; raises what went wrong in the thread meanwhile."""
        self.close()
        if self._broken is not None:
            raise self._broken

    def call(self, function: Callable[[Tank], Any]) -> Any:
        """Let a function look at the tank, or change it, while time stands still; from any thread.

        Args:
            function: Takes the tank.
        """
        with self._lock:
            return function(self.tank)

    def run(self, duration: float | None = None) -> None:
        """Let time go on.

        Args:
            duration: How long, by the lab's clock; None: until `close` [s].

        Raises:
            SimulationFailed: If the body's motion diverges.
        """
        end = float("inf") if duration is None else self.tank.time + duration
        clock, first = worker.Clock(speed=self.speed), self.tank.time
        self.lag = 0.0
        while not self._stopped.is_set() and self.tank.time < end - 1e-9:
            now = first + clock.now() - self.lag
            behind = now - self.tank.next_tick
            if behind > WORST_LAG * self.speed:
                self.lag += behind
                now -= behind
            if now >= min(self.tank.next_tick, end):
                with self._lock:
                    self.tank.advance_to(min(self.tank.next_tick, end))
                    self._send()
            wait = (self.tank.next_tick - now) / self.speed
            # With wait <= 0 there is a step to make; what has come meanwhile is heard all the same.
            frame: Any = None
            with suppress(python_can().CanError):  # what a bus cannot make sense of is as good as lost
                frame = self._bus.recv(min(max(wait, 0.0), LONGEST_WAIT))
            if frame is not None:
                self._take(frame, first + clock.now() - self.lag)

    def _take(self, frame: Any, now: float) -> None:
        if frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame or frame.is_fd:
            return
        with self._lock:
            self.tank.receive(frame.arbitration_id, bytes(frame.data), min(now, self.tank.next_tick))
            self._send()

    def _send(self) -> None:
        """What the nodes and the cameras have to say goes out."""
        can = python_can()
        with suppress(can.CanError):  # a full buffer loses frames, as a busy bus does
            for identifier, data in self.tank.sent():
                self._bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))
        for frame in self.tank.captured():
            self.server.publish(frame)

    def _answer(self, line: str) -> bytes:
        with self._lock:
            return self.tank.answer(line)
