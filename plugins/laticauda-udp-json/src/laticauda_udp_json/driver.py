"""The driver: a thread that listens, and takes from every datagram what it says of one body."""

import json
import socket
import time
from typing import Any

import numpy as np

from laticauda.control.estimation import PoseSample
from laticauda.robot import from_quaternion
from laticauda.tank.operate.drivers import Clock, DeviceFailed, MotionCapture
from laticauda.tank.operate.drivers.base import host_and_port

LONGEST = 4096  # bytes of a datagram
LISTENS = 0.1  # until it looks whether it is to end [s]
PATIENCE = 3.0  # for a first datagram of the body [s]
RESTARTED = 1.0  # a frame that is older than the last by so much is of a clock that began anew [s]
LOST = np.full(3, np.nan)


class NoPose(ValueError):
    """A datagram makes no sense: it says why."""


def decoded(data: bytes) -> tuple[str, PoseSample]:
    """The body that a datagram speaks of, and where it is.

    Args:
        data: The datagram.

    Raises:
        NoPose: If it is none.
    """
    try:
        said: Any = json.loads(data.decode("utf-8"))
        position = LOST if said["position"] is None else _numbers(said, "position", 3)
        rotation = None
        if said["position"] is not None and "quaternion" in said:
            quaternion = _numbers(said, "quaternion", 4)
            if abs(np.linalg.norm(quaternion) - 1.0) > 0.01:
                raise NoPose("`quaternion` must have length 1")
            rotation = from_quaternion(*(quaternion / np.linalg.norm(quaternion)).tolist())
        when, residual = (
            float(_numbers(said, "time")),
            float(_numbers(said, "residual") if "residual" in said else 0.0),
        )
        return str(said["body"]), PoseSample(
            time=when, position=position, rotation=rotation, residual=residual
        )
    except KeyError as error:
        raise NoPose(f"{error.args[0]!r} is missing") from None
    except (TypeError, ValueError, RecursionError, OverflowError) as error:
        raise NoPose(str(error)) from None


def _numbers(said: Any, name: str, count: int | None = None) -> np.ndarray:
    """One finite number, or several."""
    found = np.array(said[name], dtype=float)
    if found.shape != (() if count is None else (count,)) or not np.isfinite(found).all():
        raise NoPose(f"`{name}` must be {count or 1} finite numbers")
    return found


class UdpJson(MotionCapture):
    """A body whose poses come by UDP; the address is HOST:PORT where this computer listens."""

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock, body)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._last = -np.inf
        try:
            self._socket.settimeout(LISTENS)
            self._socket.bind(host_and_port(address))
            self._find_body()
        except OSError as error:
            self._socket.close()
            ours = isinstance(error, DeviceFailed)
            raise (
                error if ours else DeviceFailed(f"Cannot listen at {address}: {error}.")
            ) from error
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `laticauda.tank.operate.drivers.base.Driver.check`."""
        host_and_port(address)

    def _find_body(self) -> None:
        """Wait for the body, or for the only one."""
        bodies: dict[str, None] = {}
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end and not (self._body and self._body in bodies):
            heard = self._heard()
            bodies |= {} if heard is None else {heard[0]: None}
            if bodies and not self._body:
                end = min(end, time.monotonic() + 5 * LISTENS)  # others may follow
        listed = ", ".join(bodies) or "none"
        if not bodies:
            raise DeviceFailed(
                f"No pose arrives at {self._address}: check that its sender uses this address."
            )
        if self._body and self._body not in bodies:
            raise DeviceFailed(
                f"The motion capture has no body {self._body!r}; its bodies are: {listed}."
            )
        if not self._body and len(bodies) > 1:
            raise DeviceFailed(
                f"The body must be named by `mocap_body`: the motion capture has {listed}."
            )
        self._body = next(iter(bodies)) if not self._body else self._body

    def _heard(self) -> tuple[str, PoseSample] | None:
        """What one datagram says; None: nothing came, or nothing of sense."""
        try:
            heard = decoded(self._socket.recv(LONGEST))
        except TimeoutError:
            return None
        except NoPose as error:
            self._trouble = f"invalid datagram: {error}"
            return None
        self._trouble = ""
        return heard

    def work(self) -> None:
        """Take datagrams until the end."""
        while not self._ended.is_set():
            heard = self._heard()
            if heard is None or heard[0] != self._body:
                continue
            late = self._last - heard[1].time
            if late < 0.0 or late > RESTARTED:
                self._last = heard[1].time
                self._received.append((self._clock.now(), heard[1]))

    def release(self) -> None:
        """Close the socket."""
        self._socket.close()
