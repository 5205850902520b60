"""A thread that listens to a robot that somebody else operates. It sends nothing on the bus."""

import threading
from typing import NamedTuple

from laticauda.estimation import Estimate, Mount
from laticauda.operate.drivers import Clock
from laticauda.operate.drivers.worker import hardware
from laticauda.operate.loop import Wired, connected
from laticauda.operate.observer import PassiveObserver
from laticauda.operate.settings import Connection
from laticauda.protocol.can import python_can
from laticauda.robot import Robot

LOOK = 0.04  # between two looks at what came in [s]
RETRY = 2.0  # after a connection that failed, before the next try [s]
WAITING = "Connecting ..."


class Sight(NamedTuple):
    """What a listener knows now."""

    estimate: Estimate | None
    trouble: str


class Listener:
    """Where the robot is, as far as listening tells. A tank that is not there yet, or that goes away, is waited for.

    Args:
        connection: Where bus and cameras are; the power meter is left alone, for it answers to one only.
        robot: What is operated.
        mount: Where the marker body sits.

    Raises:
        ValueError: If the robot has no module that carries the markers.
        MissingExtra: If a library is not installed.
    """

    def __init__(self, connection: Connection, robot: Robot, mount: Mount | None = None) -> None:
        python_can()
        hardware("qtm-rt", "qtm_rt")
        self.robot = robot
        self._connection = connection
        self._observer = PassiveObserver(robot=robot, mount=mount or Mount())
        self._sight = Sight(None, WAITING)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="laticauda-observer", daemon=True)
        self._thread.start()

    def look(self) -> Sight:
        """Where the robot is, or None; and what is wrong, in a sentence, or ""."""
        return self._sight

    def close(self) -> None:
        """Listen no more; a connection that is being made ends a little later."""
        self._ended.set()

    def join(self, timeout: float) -> None:
        """Wait until all is closed, for at most `timeout` [s]."""
        self._thread.join(timeout)

    def _run(self) -> None:
        clock = Clock()
        while not self._ended.is_set():
            try:
                with connected(self._connection, clock) as devices:
                    self._listen(devices, clock)
            except Exception as error:  # whatever it is, the page goes on
                self._sight = Sight(self._sight.estimate, f"{error} It is tried again and again.")
            self._ended.wait(RETRY)

    def _listen(self, devices: Wired, clock: Clock) -> None:
        observer, state = self._observer, self._observer.init(clock.now())
        while not self._ended.wait(LOOK):
            now = clock.now()
            inputs, _ = devices.receive(now)
            state = observer.step(state, now, inputs.messages, inputs.frames)
            trouble = (devices.can.bus_off or devices.mocap.trouble).removeprefix("DeviceFailed: ").rstrip(".")
            sentence = f"{trouble[:1].upper()}{trouble[1:]}." if trouble else observer.complaint(state, now)
            self._sight = Sight(observer.estimate(state, now), sentence)
