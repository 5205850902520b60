"""Motion capture from a topic of `geometry_msgs/msg/PoseStamped`: a thread that listens."""

from typing import Any

import numpy as np

from laticauda.control.estimation import PoseSample
from laticauda.robot import from_quaternion
from laticauda.tank.operate.drivers import Clock, DeviceFailed, MotionCapture
from laticauda.values import BadArgument
from laticauda_ros2.messages import PoseStamped
from laticauda_ros2.node import PATIENCE, TOPIC, Node, name_and_domain, wait_until

LISTENS = 0.1
"""Time after which it looks whether it is to end [s]."""
RESTARTED = 1.0
"""A frame that is older than the last by so much is of a clock that began anew [s]."""
LARGEST_DEVIATION = 0.01
"""By how much the length of a quaternion may differ from 1."""
LOST = np.full(3, np.nan)
"""Position of a body that the cameras do not see [m]."""


class NoPose(ValueError):
    """Raised if a message makes no sense; its message says why."""


def sample(message: Any) -> PoseSample:
    """Return where a message says that its body is; nan in its position says that it was not seen.

    Args:
        message: A `PoseStamped`; None: bytes that are none.

    Raises:
        NoPose: If there is no sense in it.
    """
    if message is None:
        raise NoPose("its bytes are not those of its type")
    stamp = message.header.stamp
    point = message.pose.position
    orientation = message.pose.orientation
    is_set = stamp.sec != 0 or stamp.nanosec != 0
    if not is_set or stamp.sec < 0 or stamp.nanosec >= 10**9:
        raise NoPose(f"its stamp must be a time, got {stamp.sec} s and {stamp.nanosec} ns")
    time = stamp.sec + 1e-9 * stamp.nanosec
    position = np.array([point.x, point.y, point.z])
    if np.isnan(position).any():
        return PoseSample(time=time, position=LOST)
    quaternion = np.array([orientation.w, orientation.x, orientation.y, orientation.z])
    length = float(np.linalg.norm(quaternion))
    has_unit_length = abs(length - 1.0) <= LARGEST_DEVIATION  # not if it is nan
    if not np.isfinite(position).all() or not has_unit_length:
        raise NoPose(
            f"its position must be finite and its quaternion have length 1, got {position} and {length:g}"
        )
    rotation = from_quaternion(*(quaternion / length).tolist())
    return PoseSample(time=time, position=position, rotation=rotation)


class Ros2Poses(MotionCapture):
    """The body whose poses come by a topic; the address is TOPIC or TOPIC:DOMAIN."""

    called = "ros2"

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock, body)
        self._topic, domain = name_and_domain(address)
        part_of_topic = body.replace("-", "_")  # a topic has no hyphens
        if part_of_topic and part_of_topic not in self._topic.split("/"):
            raise DeviceFailed(
                f"The poses at {address} do not name their body: leave `mocap_body` empty, or use a topic "
                f"that is named after {body!r}, such as /{part_of_topic}/pose."
            )
        self._last_frame_time = -np.inf
        self._node = Node(domain)
        self._node.read(self._topic, PoseStamped)
        if not wait_until(self._hear, PATIENCE):
            self._node.close()
            reason = ""
            if self._trouble:
                reason = f": {self._trouble}"
            advice = f"Check its domain, here {domain}, and `ros2 topic info -v`."
            raise DeviceFailed(f"No PoseStamped arrives on {address}{reason}. {advice}")
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `laticauda.tank.operate.drivers.base.Driver.check`."""
        topic, _ = name_and_domain(address)
        if not TOPIC.fullmatch(topic):
            raise BadArgument(
                "address", f"must be TOPIC or TOPIC:DOMAIN, such as /tail/pose:0, got {address!r}"
            )

    def _hear(self) -> bool:
        """Take what has come, and return whether a new pose was there."""
        is_new = False
        for message in self._node.taken(self._topic):
            try:
                pose = sample(message)
            except NoPose as error:
                self._trouble = f"invalid message: {error}"
                continue
            self._trouble = ""
            lateness = self._last_frame_time - pose.time
            if lateness < 0.0 or lateness > RESTARTED:
                self._last_frame_time = pose.time
                self._received.append((self._clock.now(), pose))
                is_new = True
        return is_new

    def work(self) -> None:
        """Take poses until the end."""
        while not self._ended.is_set():
            self._node.wait(LISTENS)
            self._hear()

    def release(self) -> None:
        """Leave the network."""
        self._node.close()
