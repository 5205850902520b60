"""What a driver is: the contract between the loop of an operation and a device, for each kind of device.

A driver is a class below `Bus`, `MotionCapture`, `Meter` or `StopInput`. It is known by its name (`called`, or that of
the class with hyphens) if it comes with the package, or if an installed package names it in an entry point of the group
``laticauda.drivers.KIND``; nothing else is imported for a name. What every driver keeps to:

- It is made with an address, a text that it reads by itself, and the clock of the operation. It is connected when it
  has been made, within 10 s, or raises `DeviceFailed`, whose sentence says what was tried and what to check.
- `work` runs in a thread of its own (`Worker`), again and again, and comes back within some tenths of a second, or when
  `_ended` is set. An exception in it becomes a sentence in `trouble`, and after half a second it is called again: a
  connection that broke is made anew.
- What came in is appended to `_found` with the time of its arrival by the operation's clock, which is not wall time
  where that has a `speed`. `receive` hands it over and never waits; nor does any other method that the loop calls.
- What comes over the wire is not to be trusted: what makes no sense is lost, and never an exception in the loop.
- `close` ends the thread, and `release` gives back what the device holds.

`laticauda.operate.drivers.contract` tests a driver by this.
"""

import time
from collections.abc import Iterable
from typing import Any, NamedTuple

from laticauda.errors import BadArgument, hostname
from laticauda.estimation import PoseSample
from laticauda.extensions import Extensible
from laticauda.operate.recording.entries import PowerReading
from laticauda.protocol import CanMessage
from laticauda.protocol.worker import Clock, DeviceFailed, T, Worker


class Frame(NamedTuple):
    """One frame that went over the modules' bus."""

    time: float
    """When it came or went, our clock [s]."""
    identifier: int
    """[-]."""
    data: bytes
    """[-]."""
    is_ours: bool
    """Whether we sent it."""
    message: CanMessage | None
    """What it says; None if it is none of our protocol."""


class Driver(Worker[T]):
    """What all kinds have in common.

    Args:
        address: Where the device is, as the driver's class says.
        clock: What stamps what comes in.

    Raises:
        DeviceFailed: If it cannot be reached; the message says what to check.
        ValueError: If the address is none.
        MissingExtra: If a library is not installed.
    """

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(type(self).__name__)
        self.check(address)
        self._address, self._clock = address, clock

    @classmethod
    def check(cls, address: str) -> None:
        """Refuse an `address` that is none, by a `ValueError`, before anything is connected."""
        if not address.strip():
            raise BadArgument("address", "must not be empty")


class Bus(Driver[Frame], Extensible, group="drivers.bus"):
    """The modules' bus. `receive` gives frames; what they say are `JointState` and `Heartbeat`, by node.

    A bus that is not `mamba.dbc`'s says the same: node 1 is the joint nearest the tail; every `Sync` is answered with a
    `JointState` of every node, and `Heartbeat` come ten times a second. A joint whose references stay away is held for
    a second at most, and then limp, whoever sees to that: the device, or the driver where the device cannot.
    """

    @property
    def bus_off(self) -> str:
        """Why nothing can be sent now, in a sentence; "" if it can. It stops the robot."""
        raise NotImplementedError

    def send(self, messages: Iterable[CanMessage]) -> tuple[Frame, ...]:
        """Send `messages` in this order, without waiting: the frames that went out, one per message."""
        raise NotImplementedError


class MotionCapture(Driver[tuple[float, PoseSample]], Extensible, group="drivers.mocap"):
    """The rigid body on the robot, as cameras see it. `receive` gives poses in the tank frame, each behind its arrival.

    A pose's own time is the cameras' clock, whose offset the operation finds. A frame in which the body is not seen has
    nan in its position; it is an error at the begin only if there is no such body. A pose is never repeated.

    Args:
        address: Where it is.
        clock: What stamps the arrivals.
        body: Name of the rigid body; "" takes the only one there is.
    """

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock)
        self._body = body


class Meter(Driver[PowerReading], Extensible, group="drivers.meter"):
    """The power meter in the supply cable. `receive` gives readings of the current, at least one a second."""

    def restart(self) -> None:
        """Begin the record of average, minimum and maximum anew, if it keeps one; does not wait."""


class StopInput(Driver[str], Extensible, group="drivers.stop"):
    """The emergency-stop input. `receive` gives why the robot must stop, and nothing while all is well.

    It is asked in every tick, and is safe where it fails: a contact that is open, however shortly, a line that is lost
    and a `work` that does not come back are reasons to stop.
    """

    OLDEST = 0.25
    """A contact that was looked at longer ago is as good as open [s, wall clock]."""

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        self._looked = time.monotonic()

    def look(self) -> str:
        """Why the robot must stop, "" if it need not; an exception is a reason, too."""
        raise NotImplementedError

    def work(self) -> None:
        """One look."""
        try:
            why = self.look()
        except Exception as error:
            self._found.append(f"the line is lost: {error}")
            raise
        self._looked = time.monotonic()
        if why:
            self._found.append(why)

    def receive(self) -> tuple[str, ...]:
        """Why the robot must stop, as seen since the last call."""
        age = time.monotonic() - self._looked
        return super().receive() or ((f"it was read {age:.2f} s ago",) if age > self.OLDEST else ())


KINDS: dict[str, Any] = {"bus": Bus, "mocap": MotionCapture, "meter": Meter, "stop": StopInput}
"""The bases, by the words of trial files and entry points."""


def driver_named(kind: str, name: str, address: str) -> Any:
    """The class of a driver, after a look at its address.

    Args:
        kind: One of `KINDS`.
        name: Of the driver.
        address: What it is to be made with.

    Raises:
        DeviceFailed: If its package cannot be loaded.
        ValueError: If there is none of this name, or the address is none; it names the `kind`, or ``KIND_address``.
    """
    try:
        found = KINDS[kind].named(name)
        kind = f"{kind}_address"
        found.check(address)
    except BadArgument as error:
        raise BadArgument(kind, error.rule) from None
    except (AttributeError, ImportError) as error:
        raise DeviceFailed(f"The driver `{name}` cannot be loaded: {error}.") from error
    return found


def host_and_port(address: str) -> tuple[str, int]:
    """The parts of an `address` HOST:PORT.

    Raises:
        ValueError: If it is none.
    """
    host, _, port = address.rpartition(":")
    if not host or not (port.isascii() and port.isdigit() and 0 < int(port) < 65536):
        raise BadArgument("address", f"must be HOST:PORT, with a port from 1 to 65535, got {address!r}")
    return hostname("address", host), int(port)
