"""What a recording holds: messages of ROS 2, by the kind of what happened.

Everything is a ROS 2 message in CDR (profile "ros2"), so that Foxglove and the ros2 bag tools open the file. The latter
refuse files of mixed encodings, so even what has no ROS type of its own travels as one: an event as the log message of
ROS, with its data as JSON. Units stand in the metadata of each channel, under "unit". `recording` reads it again.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from typing import Any

from laticauda.errors import BadArgument
from laticauda.logs import message_file, ros2

LEVELS = {"debug": 10, "info": 20, "warning": 30, "error": 40, "fatal": 50}
"""Levels of events and their numbers in rcl_interfaces/Log."""
_CAN_FRAME = struct.Struct("<4s iI I4s I3x B8s")  # encapsulation; stamp, frame_id ""; identifier, length, data
WORLD = "world"
"""The frame of the world axes."""


class Recorder(message_file.MessageFile):
    """Records what happens to an MCAP file that survives a kill: see `MessageFile` for its arguments.

    Example:
        >>> with Recorder("/dev/null", overwrite=True) as recorder:
        ...     recorder.scalar("/power/electrical", 0.5, 92.0, unit="W")
        ...     recorder.event(0.5, "running", {"gait": "eel_like"})
    """

    def message(self, topic: str, time: float, kind: str, content: ros2.Content, *, unit: str = "") -> None:
        """Record any message of a known type.

        Args:
            topic: As "/joint_states"; its messages are all of one type.
            time: When it happened [s], not negative: since the start of the run, or since 1970.
            kind: The ROS type, one of `ros2.DEFINITIONS`, as "std_msgs/Float64".
            content: Its fields, by name or in the order of the definition.
            unit: Of its numbers; kept with the first message of the topic.

        Raises:
            ValueError: If the content does not fit the type, or the topic has another type.
            StorageFailed: If it cannot be written.
        """
        self.add(topic, kind, unit, message_file.moment(time), ros2.encode(kind, content))

    def joint_state(
        self,
        topic: str,
        time: float,
        names: Sequence[str],
        position: Sequence[float],
        velocity: Sequence[float] = (),
        effort: Sequence[float] = (),
    ) -> None:
        """Record the state of joints (sensor_msgs/JointState).

        Args:
            topic: Where, as "/joint_states".
            time: When, as for `message` [s].
            names: Of the joints, tail first.
            position: Their angles [rad].
            velocity: Their rates [rad/s]; empty if not known.
            effort: Their torques [N m]; empty if not known.
        """
        content = _header(time, ""), names, position, velocity, effort
        self.message(topic, time, "sensor_msgs/JointState", content, unit="rad, rad/s, N m")

    def pose(
        self,
        topic: str,
        time: float,
        position: Sequence[float],
        quaternion: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
        frame: str = WORLD,
    ) -> None:
        """Record where something is (geometry_msgs/PoseStamped).

        Args:
            topic: Where, as "/body".
            time: When, as for `message` [s].
            position: x, y, z [m].
            quaternion: Its orientation w, x, y, z [-].
            frame: Whose axes these are.
        """
        content = _header(time, frame), (position, _scalar_last(quaternion))
        self.message(topic, time, "geometry_msgs/PoseStamped", content, unit="m")

    def transforms(
        self, time: float, frames: Mapping[str, tuple[Sequence[float], Sequence[float]]], parent: str = WORLD
    ) -> None:
        """Record where frames are, on /tf (tf2_msgs/TFMessage).

        Args:
            time: When, as for `message` [s].
            frames: By name: position x, y, z [m] and orientation w, x, y, z [-].
            parent: In whose axes.
        """
        header = _header(time, parent)
        transforms = [(header, name, (place, _scalar_last(turn))) for name, (place, turn) in frames.items()]
        self.message("/tf", time, "tf2_msgs/TFMessage", (transforms,), unit="m")

    def scalar(self, topic: str, time: float, value: float, unit: str = "") -> None:
        """Record one number (std_msgs/Float64).

        Args:
            topic: Where, as "/power/electrical".
            time: When, as for `message` [s].
            value: The number.
            unit: Its unit.
        """
        self.message(topic, time, "std_msgs/Float64", (value,), unit=unit)

    def array(self, topic: str, time: float, values: Any, unit: str = "", labels: Sequence[str] = ()) -> None:
        """Record numbers of any shape, the last index running fastest (std_msgs/Float64MultiArray).

        Args:
            topic: Where, as "/link_force".
            time: When, as for `message` [s].
            values: An array of numbers.
            unit: Their unit.
            labels: Names of its axes.
        """
        import numpy as np

        numbers = np.asarray(values, dtype=np.float64)
        axes = zip_longest(labels[: numbers.ndim], numbers.shape, fillvalue="")
        strides = (math.prod(numbers.shape[i:]) for i in range(numbers.ndim))
        dimensions = [(*axis, stride) for axis, stride in zip(axes, strides, strict=True)]
        self.message(topic, time, "std_msgs/Float64MultiArray", ((dimensions, 0), numbers.ravel()), unit=unit)

    def can_frame(self, topic: str, time: float, identifier: int, data: bytes) -> None:
        """Record a raw frame of a CAN bus (can_msgs/Frame).

        Args:
            topic: Where, as "/can".
            time: When, as for `message` [s].
            identifier: Of the frame.
            data: Up to 8 bytes.

        Raises:
            ValueError: If there are more than 8 bytes.
        """
        if len(data) > 8:
            raise BadArgument("data", f"must have at most 8 bytes, got {len(data)}")
        now = message_file.moment(time)
        if not 0 <= identifier < 1 << 32:
            raise BadArgument("identifier", f"must be from 0 to 2^32 - 1, got {identifier}")
        # What the codec of can_msgs/Frame writes, at once: there are thousands of these a second.
        seconds, rest = divmod(now, 1_000_000_000)
        body = _CAN_FRAME.pack(b"\x00\x01", seconds, rest, 1, b"", identifier, len(data), bytes(data))
        self.add(topic, "can_msgs/Frame", "", now, body)

    def json(self, topic: str, time: float, content: object) -> None:
        """Record anything that JSON can hold, as a text (std_msgs/String).

        Args:
            topic: Where, as "/settings".
            time: When, as for `message` [s].
            content: The data.
        """
        self.message(topic, time, "std_msgs/String", (json.dumps(content),), unit="json")

    def event(self, time: float, name: str, data: object = None, *, level: str = "info") -> None:
        """Record an event on /events (rcl_interfaces/Log), and hand on the chunk: what happens last matters most.

        Args:
            time: When [s].
            name: What happened, in a word or two.
            data: Anything more that JSON can hold.
            level: One of `LEVELS`.

        Raises:
            ValueError: If the level is not known, or the data are not for JSON.
        """
        if level not in LEVELS:
            raise BadArgument("level", f"must be one of {', '.join(LEVELS)}, got {level!r}")
        try:
            text = "" if data is None else json.dumps(data)
        except TypeError as error:
            raise BadArgument("data", f"must be data that JSON can hold: {error}") from error
        stamp = ros2.stamp(message_file.nanoseconds(time))
        self.message("/events", time, "rcl_interfaces/Log", (stamp, LEVELS[level], name, text, "", "", 0))
        self.flush()


def _header(time: float, frame: str) -> tuple[Any, ...]:
    return ros2.stamp(message_file.nanoseconds(time)), frame


def _scalar_last(quaternion: Sequence[float]) -> tuple[float, ...]:
    w, x, y, z = quaternion
    return x, y, z, w
