"""The driver: a thread that listens, and takes from every datagram what it says of one body."""

import json
import socket
import time
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.control.estimation import PoseSample
from laticauda.robot import from_quaternion
from laticauda.tank.operate.drivers import Clock, DeviceFailed, MotionCapture
from laticauda.tank.operate.drivers.base import host_and_port

LONGEST_DATAGRAM = 4096
"""Size of a datagram at most [B]."""
LISTENS = 0.1
"""Time after which it looks whether it is to end [s]."""
PATIENCE = 3.0
"""How long it waits for a first datagram of the body [s]."""
OTHERS_FOLLOW = 0.5
"""How long it waits for other bodies after the first, if none is named [s]."""
RESTARTED = 1.0
"""A frame that is older than the last by so much is of a clock that began anew [s]."""
LONGEST_DEVIATION = 0.01
"""By how much the length of a quaternion may differ from 1."""
LOST = np.full(3, np.nan)
"""Position of a body that the cameras do not see [m]."""


class NoPose(ValueError):
    """Raised if a datagram makes no sense; the message says why."""


class BodyPose(NamedTuple):
    """What a datagram says."""

    body: str
    """Name of the body."""
    pose: PoseSample
    """Where it is."""


def read_datagram(data: bytes) -> BodyPose:
    """Return which body a datagram speaks of, and where it is.

    Args:
        data: The datagram.

    Raises:
        NoPose: If it makes no sense.
    """
    try:
        return _read_message(json.loads(data.decode("utf-8")))
    except KeyError as error:
        raise NoPose(f"{error.args[0]!r} is missing") from None
    except (TypeError, ValueError, RecursionError, OverflowError) as error:
        raise NoPose(str(error)) from None


def _read_message(message: Any) -> BodyPose:
    position = LOST
    rotation = None
    is_seen = message["position"] is not None
    if is_seen:
        position = _read_vector(message, "position", 3)
    if is_seen and "quaternion" in message:
        rotation = _read_rotation(message)
    time = _read_number(message, "time")
    residual = 0.0
    if "residual" in message:
        residual = _read_number(message, "residual")
    pose = PoseSample(time=time, position=position, rotation=rotation, residual=residual)
    return BodyPose(body=str(message["body"]), pose=pose)


def _read_rotation(message: Any) -> Float[np.ndarray, "3 3"]:
    quaternion = _read_vector(message, "quaternion", 4)
    length = np.linalg.norm(quaternion)
    if abs(length - 1.0) > LONGEST_DEVIATION:
        raise NoPose("`quaternion` must have length 1")
    return from_quaternion(*(quaternion / length).tolist())


def _read_number(message: Any, name: str) -> float:
    number = np.array(message[name], dtype=float)
    if number.shape != () or not np.isfinite(number):
        raise NoPose(f"`{name}` must be 1 finite numbers")
    return float(number)


def _read_vector(message: Any, name: str, size: int) -> np.ndarray:
    vector = np.array(message[name], dtype=float)
    if vector.shape != (size,) or not np.isfinite(vector).all():
        raise NoPose(f"`{name}` must be {size} finite numbers")
    return vector


class UdpJson(MotionCapture):
    """A body whose poses come by UDP; the address is HOST:PORT where this computer listens."""

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock, body)
        self._last_frame_time = -np.inf
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.settimeout(LISTENS)
            self._socket.bind(host_and_port(address))
            self._body = self._find_body()
        except DeviceFailed:
            self._socket.close()
            raise
        except OSError as error:
            self._socket.close()
            raise DeviceFailed(f"Cannot listen at {address}: {error}.") from error
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `laticauda.tank.operate.drivers.base.Driver.check`."""
        host_and_port(address)

    def _find_body(self) -> str:
        """Return the name of the body: the one that was asked for, or the only one that there is."""
        bodies = self._hear_bodies()
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
        return self._body or bodies[0]

    def _hear_bodies(self) -> list[str]:
        """Listen until the body is heard of, and return the names of all that were, too."""
        bodies = list[str]()
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            sample = self._hear()
            if sample is None or sample.body in bodies:
                continue
            bodies.append(sample.body)
            if sample.body == self._body:
                break
            if not self._body:
                end = min(end, time.monotonic() + OTHERS_FOLLOW)
        return bodies

    def _hear(self) -> BodyPose | None:
        """Return what the next datagram says; None if nothing came, or nothing of sense."""
        try:
            sample = read_datagram(self._socket.recv(LONGEST_DATAGRAM))
        except TimeoutError:
            return None
        except NoPose as error:
            self._trouble = f"invalid datagram: {error}"
            return None
        self._trouble = ""
        return sample

    def work(self) -> None:
        """Take datagrams until the end."""
        while not self._ended.is_set():
            sample = self._hear()
            if sample is None or sample.body != self._body:
                continue
            lateness = self._last_frame_time - sample.pose.time
            if lateness < 0.0 or lateness > RESTARTED:
                self._last_frame_time = sample.pose.time
                self._received.append((self._clock.now(), sample.pose))

    def release(self) -> None:
        """Close the socket."""
        self._socket.close()
