"""Motion capture from a topic of `geometry_msgs/msg/PoseStamped`: a thread that listens."""

from typing import Any

import numpy as np

from laticauda.control.estimation import PoseSample
from laticauda.robot import from_quaternion
from laticauda.tank.operate.drivers import Clock, DeviceFailed, MotionCapture
from laticauda.values import BadArgument
from laticauda_ros2.messages import PoseStamped
from laticauda_ros2.node import PATIENCE, TOPIC, Node, name_and_domain, waited

LISTENS = 0.1  # until it looks whether it is to end [s]
RESTARTED = 1.0  # a frame that is older than the last by so much is of a clock that began anew [s]
LOST = np.full(3, np.nan)


class NoPose(ValueError):
    """A message makes no sense: it says why."""


def sample(message: Any) -> PoseSample:
    """Where a message says that its body is; nan in its position says that it was not seen.

    Args:
        message: A `PoseStamped`; None: bytes that are none.

    Raises:
        NoPose: If there is no sense in it.
    """
    if message is None:
        raise NoPose("its bytes are not those of its type")
    stamp, position, quaternion = (
        message.header.stamp,
        message.pose.position,
        message.pose.orientation,
    )
    if not (stamp.sec >= 0 and stamp.nanosec < 10**9 and (stamp.sec or stamp.nanosec)):
        raise NoPose(f"its stamp must be a time, got {stamp.sec} s and {stamp.nanosec} ns")
    time = stamp.sec + 1e-9 * stamp.nanosec
    place = np.array([position.x, position.y, position.z])
    if np.isnan(place).any():
        return PoseSample(time=time, position=LOST)
    turned = np.array([quaternion.w, quaternion.x, quaternion.y, quaternion.z])
    length = float(np.linalg.norm(turned))
    if not np.isfinite(place).all() or not abs(length - 1.0) <= 0.01:
        raise NoPose(
            f"its position must be finite and its quaternion have length 1, got {place} and {length:g}"
        )
    return PoseSample(
        time=time, position=place, rotation=from_quaternion(*(turned / length).tolist())
    )


class Ros2Poses(MotionCapture):
    """The body whose poses come by a topic; the address is TOPIC or TOPIC:DOMAIN."""

    called = "ros2"

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock, body)
        self._topic, domain = name_and_domain(address)
        named = body.replace("-", "_")  # a topic has no hyphens
        if named and named not in self._topic.split("/"):
            raise DeviceFailed(
                f"The poses at {address} do not name their body: leave `mocap_body` empty, or use a topic "
                f"that is named after {body!r}, such as /{named}/pose."
            )
        self._last = -np.inf
        self._node = Node(domain)
        self._node.read(self._topic, PoseStamped)
        if not waited(self._heard, PATIENCE):
            self._node.close()
            why = f": {self._trouble}" if self._trouble else ""
            raise DeviceFailed(
                f"No PoseStamped arrives on {address}{why}. Check its domain, here {domain}, and `ros2 topic info -v`."
            )
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `laticauda.tank.operate.drivers.base.Driver.check`."""
        if not TOPIC.fullmatch(name_and_domain(address)[0]):
            raise BadArgument(
                "address", f"must be TOPIC or TOPIC:DOMAIN, such as /tail/pose:0, got {address!r}"
            )

    def _heard(self) -> bool:
        """Take what has come; whether a pose was there."""
        before = self._last
        for message in self._node.taken(self._topic):
            try:
                pose = sample(message)
            except NoPose as error:
                self._trouble = f"invalid message: {error}"
                continue
            self._trouble = ""
            late = self._last - pose.time
            if late < 0.0 or late > RESTARTED:
                self._last = pose.time
                self._received.append((self._clock.now(), pose))
        return self._last != before

    def work(self) -> None:
        """Take poses until the end."""
        while not self._ended.is_set():
            self._node.wait(LISTENS)
            self._heard()

    def release(self) -> None:
        """Leave the network."""
        self._node.close()
