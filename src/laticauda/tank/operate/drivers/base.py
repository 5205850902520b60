"""Drivers: the contract between the loop of an operation and a device, for each kind of device.

A driver is a subclass of `Bus`, `MotionCapture`, `Meter`, `StopInput` or `Sensors`. It is known by its name
(`called`, or the name of the class with hyphens) if it comes with the package, or if an installed
package names it in an entry point of the group ``laticauda.drivers.KIND``; nothing else is imported
for a name. Every driver obeys these rules:

- It is created with an address, a text that it parses itself, and the clock of the operation. Its
  constructor returns within 10 s, connected, or raises a `DeviceFailed` whose message says what was
  tried and what to check.
- `work` is called repeatedly in a separate thread (`Worker`), and returns within some tenths of a
  second, or when `_ended` is set. An exception in it becomes a sentence in `trouble`, and it is
  called again after half a second, so that a broken connection is restored.
- Received data are appended to `_received` with the time of arrival on the operation's clock, which is
  not wall time if that clock has a `speed`. `receive` hands them over and never waits; nor does any
  other method that the loop calls.
- Data from the wire are not trusted: invalid data are dropped, and never cause an exception in the
  loop.
- `close` ends the thread, and `release` frees what the device holds.

`laticauda.tank.operate.drivers.contract` tests a driver against these rules.
"""

import time
from collections.abc import Iterable
from typing import Any, NamedTuple

from laticauda.control.estimation import PoseSample
from laticauda.tank.operate.recording.entries import PowerReading, SensorSample
from laticauda.tank.protocol import CanMessage
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.worker import DeviceFailed, T, Worker
from laticauda.values import (
    BadArgument,
    Extensible,
    check_choice,
    check_hostname,
    check_instance,
)


class Frame(NamedTuple):
    """One frame on the modules' bus."""

    time: float
    """Time at which it was received or sent, on our clock [s]."""
    identifier: int
    """Identifier [-]."""
    data: bytes
    """Data [-]."""
    is_ours: bool
    """Whether we sent it."""
    message: CanMessage | None
    """Message in the frame; None if it is not part of our protocol."""


class Driver(Worker[T]):
    """Base of all kinds of drivers.

    Args:
        address: Address of the device, in the form that the driver's class defines.
        clock: Clock that timestamps incoming data.

    Raises:
        DeviceFailed: If the device cannot be reached; the message says what to check.
        ValueError: If the address is invalid.
        MissingExtra: If a library is not installed.
    """

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(type(self).__name__)
        self.check(address)
        self._address, self._clock = address, clock

    @classmethod
    def check(cls, address: str) -> None:
        """Reject an invalid `address` with a `ValueError`, before anything is connected."""
        check_instance("address", address, str)
        if not address.strip():
            raise BadArgument("address", "must not be empty")


class Bus(Driver[Frame], Extensible, group="drivers.bus"):
    """The modules' bus.

    `receive` returns frames, whose messages are `JointState` and `Heartbeat`, by node. A bus other
    than that of `mamba.dbc` behaves the same: node 1 is the joint nearest the tail; every `Sync` is
    answered with a `JointState` of every node, and a `Heartbeat` comes ten times a second. A joint
    without references is held for a second at most, and then limp; the device ensures this, or the
    driver if the device cannot.
    """

    @property
    def bus_off(self) -> str:
        """Why nothing can be sent now, as a sentence that stops the robot; "" if frames can."""
        raise NotImplementedError

    def send(self, messages: Iterable[CanMessage]) -> tuple[Frame, ...]:
        """Send `messages` in this order, without waiting; return the frames that went out."""
        raise NotImplementedError


class MotionCapture(Driver[tuple[float, PoseSample]], Extensible, group="drivers.mocap"):
    """The rigid body on the robot, as seen by cameras.

    `receive` returns arrival times with poses in the tank frame. A pose's own time is on the
    cameras' clock, whose offset the operation finds. A frame in which the body is not seen has nan
    in its position; at the beginning, it is an error only if there is no such body. A pose is never
    repeated.

    Args:
        address: Address of the motion capture.
        clock: Clock of the arrival times.
        body: Name of the rigid body; "": the only one there is.
    """

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock)
        self._body = body


class Meter(Driver[PowerReading], Extensible, group="drivers.meter"):
    """The power meter in the supply cable.

    `receive` returns readings of the current, at least one per second.
    """

    def restart(self) -> None:
        """Restart the record of average, minimum and maximum if there is one; does not wait."""


class StopInput(Driver[str], Extensible, group="drivers.stop"):
    """The emergency-stop input.

    `receive` returns why the robot must stop, and nothing while all is well. It is queried at every
    tick, and is fail-safe: a contact that is open, however briefly, a line that is lost and a
    `work` that does not return are reasons to stop.
    """

    OLDEST = 0.25
    """Age beyond which a reading of the contact counts as open [s, wall clock]."""

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        self._last_look = time.monotonic()

    def look(self) -> str:
        """Return why the robot must stop, or "" if it need not; an exception is also a reason."""
        raise NotImplementedError

    def work(self) -> None:
        """Look once."""
        try:
            reason = self.look()
        except Exception as error:
            self._received.append(f"the input cannot be read: {error}")
            raise
        self._last_look = time.monotonic()
        if reason:
            self._received.append(reason)

    def receive(self) -> tuple[str, ...]:
        """Return why the robot must stop, as seen since the last call."""
        age = time.monotonic() - self._last_look
        reasons = super().receive()
        if not reasons and age > self.OLDEST:
            return (f"it was last read {age:.2f} s ago",)
        return reasons


class Sensors(Driver[tuple[float, SensorSample]], Extensible, group="drivers.sensors"):
    """The robot's own sensors, for controllers that steer by them.

    `receive` returns arrival times with samples. A sample's own time is on the robot's clock, whose
    offset the operation finds. At the beginning, and if the robot starts anew, there is a sample
    without values for every sensor, with the time of its arrival. A sample is never repeated, those
    of one sensor come in the order of their measurement, and `n_lost` tells how many are missing.
    """


KINDS: dict[str, Any] = {
    "bus": Bus,
    "mocap": MotionCapture,
    "meter": Meter,
    "stop": StopInput,
    "sensors": Sensors,
}
"""Base classes, by the words in trial files and entry points."""


def driver_named(kind: str, name: str, address: str) -> Any:
    """Return the class of a driver, after checking the address.

    Args:
        kind: One of `KINDS`.
        name: Name of the driver.
        address: Address for the driver.

    Raises:
        DeviceFailed: If its package cannot be loaded.
        ValueError: If there is no driver of this name, or the address is invalid; it names `kind`,
            or ``KIND_address``.
    """
    check_choice("kind", kind, tuple(KINDS))
    try:
        driver_class = KINDS[kind].named(name)
    except BadArgument as error:
        raise BadArgument(kind, error.rule) from None
    except (AttributeError, ImportError) as error:
        raise DeviceFailed(f"The driver `{name}` cannot be loaded: {error}.") from error
    try:
        driver_class.check(address)
    except BadArgument as error:
        raise BadArgument(f"{kind}_address", error.rule) from None
    except (AttributeError, ImportError) as error:
        raise DeviceFailed(f"The driver `{name}` cannot be loaded: {error}.") from error
    return driver_class


def host_and_port(address: str) -> tuple[str, int]:
    """Return host and port of an `address` HOST:PORT.

    Raises:
        ValueError: If the address does not have this form.
    """
    host, _, port = address.rpartition(":")
    is_number = port.isascii() and port.isdigit()
    if not host or not is_number or not 0 < int(port) < 65536:
        raise BadArgument(
            "address", f"must be HOST:PORT, with a port from 1 to 65535, got {address!r}"
        )
    return check_hostname("address", host), int(port)
