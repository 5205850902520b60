"""Recorder of messages to an MCAP file that stays readable when its program is killed.

Everything is a ROS 2 message in CDR (profile "ros2"), so that Foxglove and the ros2 bag tools open
the file. The latter reject files with mixed encodings, so data without a ROS type of their own use
an existing one: an event is a ROS log message with its data as JSON. Units are in the metadata of
each channel, under "unit". `recording` reads such files.
"""

import json
import math
import struct
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, Self, TypeAlias

from laticauda.trials.logs import ros2
from laticauda.values import (
    BadArgument,
    StorageFailed,
    check_finite,
    check_positive,
    check_whole_number,
    optional_import,
)

LEVELS = {"debug": 10, "info": 20, "warning": 30, "error": 40, "fatal": 50}
"""Levels of events and their numbers in rcl_interfaces/Log."""
_CAN_FRAME = struct.Struct("<4s iI I4s I3x B8s")
"""Message can_msgs/Frame: encapsulation; stamp, length and text of frame_id ""; identifier, length, data."""
CHUNK_BYTES = 1 << 20
"""Size of the messages at which a chunk is complete [bytes]."""
WORLD = "world"
"""The frame of the world axes."""
CLOCK = "laticauda_clock"
"""Metadata record that states the wall-clock time of time 0, as `epoch`."""
DESCRIPTION = "/robot_description"
"""Topic with the robot's URDF, recorded once."""
STATIC = "/tf_static"
"""Topic with the frames that never move, recorded once."""
_UNLIMITED = {"sec": 0, "nsec": 0}
_LATCHED_PROFILE = {
    "history": 1,
    "depth": 1,
    "reliability": 1,
    "durability": 1,
    "liveliness": 1,
    "deadline": _UNLIMITED,
    "lifespan": _UNLIMITED,
    "liveliness_lease_duration": _UNLIMITED,
    "avoid_ros_namespace_conventions": False,
}
_LATCHED = json.dumps([_LATCHED_PROFILE])
QUALITY = {DESCRIPTION: _LATCHED, STATIC: _LATCHED}
"""Quality of service with which a topic is replayed: late subscribers still receive the last message of these. It is
YAML (JSON is valid YAML) with the numbers of ROS, as every rosbag2 reads them; "", the default, for
all others."""
Frame: TypeAlias = tuple[str, Sequence[float], Sequence[float]]
"""Name of the parent frame, position x, y, z in its axes [m], and orientation w, x, y, z [-]."""


def need_mcap() -> None:
    """Check that the package `mcap` is installed.

    Raises:
        MissingExtra: If it is not installed.
    """
    optional_import("Reading and writing MCAP", "mcap", "logs")


class _Channel(NamedTuple):
    """A topic in the file."""

    number: int
    """Its number in the file."""
    kind: str
    """Type of its messages."""


class Recorder:
    """Writes messages to an MCAP file as they occur, from any thread.

    Messages are collected in chunks; a complete chunk goes to the operating system at once. A
    program that is killed loses only the open chunk; the file then lacks its end, which
    `open_recording` tolerates. As a context manager, the recorder completes the file on exit, even
    after an error.

    Args:
        path: The file.
        chunk_seconds: A chunk is complete after this span of message time, or when it holds
            `CHUNK_BYTES` [s].
        overwrite: Whether an existing file of that name may be replaced.
        epoch: Wall-clock time of time 0 [ns since 1970].

    Raises:
        ValueError: If an argument is out of range.
        StorageFailed: If the file exists, or cannot be written; later, if the disk is full.
        MissingExtra: If the package `mcap` is not installed.

    Example:
        >>> with Recorder("/dev/null", overwrite=True) as recorder:
        ...     recorder.scalar("/power/electrical", 0.5, 92.0, unit="W")
        ...     recorder.event(0.5, "running", {"gait": "eel_like"})
    """

    def __init__(
        self,
        path: str | Path,
        *,
        chunk_seconds: float = 1.0,
        overwrite: bool = False,
        epoch: int = 0,
    ) -> None:
        need_mcap()
        from mcap.writer import Writer

        self._chunk_ns = round(check_positive("chunk_seconds", chunk_seconds, "s") * 1e9)
        self._epoch = check_whole_number("epoch", epoch, 0)
        self.path = Path(path)
        """The file."""
        mode = "xb"
        if overwrite:
            mode = "wb"
        self._file: BinaryIO = self._guard(lambda: self.path.open(mode), "name another place")
        # The writer's own limit is disabled: chunks end here, so that each is passed on as soon as
        # it is complete.
        self._writer = Writer(self._file, chunk_size=1 << 40, enable_data_crcs=True)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, _Channel] = {}
        self._lock = threading.Lock()
        self._chunk_begin: int | None = None  # time of its first message [ns]
        self._chunk_bytes = 0
        self._n_messages = 0
        self._guard(lambda: self._writer.start(profile="ros2", library="laticauda"))
        if epoch:
            self.metadata(CLOCK, {"epoch": str(epoch)})

    def message(
        self, topic: str, time: float, kind: str, content: ros2.Content, *, unit: str = ""
    ) -> None:
        """Record any message of a known type.

        Args:
            topic: Topic, such as "/joint_states"; all of its messages have one type.
            time: Time of the message [s], since `epoch`, and not before 1970.
            kind: The ROS type, one of `ros2.DEFINITIONS`, such as "std_msgs/Float64".
            content: Its fields, by name or in the order of the definition.
            unit: Unit of its numbers; stored with the first message of the topic.

        Raises:
            ValueError: If the content does not fit the type, or the topic has another type.
            StorageFailed: If the file cannot be written.
        """
        now = self._convert_time(time)
        data = ros2.encode(kind, content)
        self._add(topic, kind, unit=unit, now=now, data=data)

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
            topic: Topic, such as "/joint_states".
            time: Time of the message, since `epoch` [s].
            names: Names of the joints, tail first.
            position: Their angles [rad].
            velocity: Their rates [rad/s]; empty if unknown.
            effort: Their torques [N m]; empty if unknown.
        """
        content = (self._header(time, frame=""), names, position, velocity, effort)
        self.message(topic, time, "sensor_msgs/JointState", content, unit="rad, rad/s, N m")

    def pose(
        self,
        topic: str,
        time: float,
        position: Sequence[float],
        quaternion: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
        frame: str = WORLD,
    ) -> None:
        """Record the pose of an object (geometry_msgs/PoseStamped).

        Args:
            topic: Topic, such as "/body".
            time: Time of the message, since `epoch` [s].
            position: x, y, z [m].
            quaternion: Orientation w, x, y, z [-].
            frame: Frame in whose axes they are given.
        """
        pose = (position, _scalar_last(quaternion))
        content = (self._header(time, frame), pose)
        self.message(topic, time, "geometry_msgs/PoseStamped", content, unit="m")

    def transforms(self, time: float, frames: Mapping[str, Frame], *, topic: str = "/tf") -> None:
        """Record the poses of frames (tf2_msgs/TFMessage).

        Args:
            time: Time of the message, since `epoch` [s].
            frames: Frames by name.
            topic: Topic; `STATIC` for frames that never move.
        """
        transforms: list[tuple[Any, ...]] = []
        for name, (parent, position, quaternion) in frames.items():
            pose = (position, _scalar_last(quaternion))
            transforms.append((self._header(time, parent), name, pose))
        self.message(topic, time, "tf2_msgs/TFMessage", (transforms,), unit="m")

    def robot(self, time: float, description: str, fixed: Mapping[str, Frame]) -> None:
        """Record, once at the start, the data that viewers need to draw the robot.

        Args:
            time: Time of the message, since `epoch` [s].
            description: The robot's URDF.
            fixed: Frames of links that cannot move relative to their parent.
        """
        self.message(DESCRIPTION, time, "std_msgs/String", (description,))
        self.transforms(time, fixed, topic=STATIC)

    def scalar(self, topic: str, time: float, value: float, unit: str = "") -> None:
        """Record one number (std_msgs/Float64).

        Args:
            topic: Topic, such as "/power/electrical".
            time: Time of the message, since `epoch` [s].
            value: The number.
            unit: Its unit.
        """
        self.message(topic, time, "std_msgs/Float64", (value,), unit=unit)

    def array(
        self, topic: str, time: float, values: Any, unit: str = "", labels: Sequence[str] = ()
    ) -> None:
        """Record an array of numbers of any shape, the last index varying fastest (std_msgs/Float64MultiArray).

        Args:
            topic: Topic, such as "/link_force".
            time: Time of the message, since `epoch` [s].
            values: The numbers.
            unit: Their unit.
            labels: Names of the array's axes.
        """
        import numpy as np

        numbers = np.asarray(values, dtype=np.float64)
        dimensions: list[tuple[str, int, int]] = []
        for i, size in enumerate(numbers.shape):
            label = ""
            if i < len(labels):
                label = labels[i]
            stride = math.prod(numbers.shape[i:])
            dimensions.append((label, size, stride))
        offset = 0
        layout = (dimensions, offset)
        content = (layout, numbers.ravel())
        self.message(topic, time, "std_msgs/Float64MultiArray", content, unit=unit)

    def can_frame(self, topic: str, time: float, identifier: int, data: bytes) -> None:
        """Record a raw frame of a CAN bus (can_msgs/Frame).

        Args:
            topic: Topic, such as "/can".
            time: Time of the message, since `epoch` [s].
            identifier: Identifier of the frame.
            data: Up to 8 bytes.

        Raises:
            ValueError: If there are more than 8 bytes.
        """
        if len(data) > 8:
            raise BadArgument("data", f"must have at most 8 bytes, got {len(data)}")
        now = self._convert_time(time)
        if not 0 <= identifier < 1 << 32:
            raise BadArgument("identifier", f"must be from 0 to 2^32 - 1, got {identifier}")
        # The bytes that the codec of can_msgs/Frame writes, in one step: there are thousands of
        # these per second.
        seconds, nanoseconds = divmod(now, ros2.NANOSECONDS_PER_SECOND)
        body = _CAN_FRAME.pack(
            b"\x00\x01", seconds, nanoseconds, 1, b"", identifier, len(data), bytes(data)
        )
        self._add(topic, "can_msgs/Frame", unit="", now=now, data=body)

    def json(self, topic: str, time: float, content: object) -> None:
        """Record anything that JSON can hold, as text (std_msgs/String).

        Args:
            topic: Topic, such as "/settings".
            time: Time of the message, since `epoch` [s].
            content: The data.
        """
        self.message(topic, time, "std_msgs/String", (json.dumps(content),), unit="json")

    def event(self, time: float, name: str, data: object = None, *, level: str = "info") -> None:
        """Record an event on /events (rcl_interfaces/Log), and write the chunk out: the last events matter most.

        Args:
            time: Time of the event [s].
            name: What happened, in a word or two.
            data: Further data that JSON can hold.
            level: One of `LEVELS`.

        Raises:
            ValueError: If the level is unknown, or the data cannot be encoded as JSON.
        """
        if level not in LEVELS:
            raise BadArgument("level", f"must be one of {', '.join(LEVELS)}, got {level!r}")
        text = ""
        if data is not None:
            try:
                text = json.dumps(data)
            except TypeError as error:
                raise BadArgument("data", f"must be data that JSON can hold: {error}") from error
        content = {
            "stamp": ros2.to_ros_time(self._convert_time(time)),
            "level": LEVELS[level],
            "name": name,
            "msg": text,
            "file": "",
            "function": "",
            "line": 0,
        }
        self.message("/events", time, "rcl_interfaces/Log", content)
        self.flush()

    def metadata(self, name: str, content: Mapping[str, str]) -> None:
        """Write texts that apply to the whole file; they are written to disk at once.

        Args:
            name: Name of the record.
            content: The texts by name.
        """
        with self._lock:
            self._guard(lambda: self._writer.add_metadata(name, dict(content)))
            self._guard(self._writer.flush)

    def flush(self) -> None:
        """Complete the open chunk and pass it to the operating system."""
        with self._lock:
            self._end_chunk()

    def close(self) -> None:
        """Complete the file; further calls do nothing."""
        with self._lock:
            if self._file.closed:
                return
            try:
                self._guard(self._writer.finish)
            finally:
                self._guard(self._file.close)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _add(self, topic: str, kind: str, unit: str, now: int, data: bytes) -> None:
        """Write a message.

        Args:
            topic: Topic; all of its messages have one type.
            kind: The ROS type.
            unit: Unit of its numbers; stored with the first message of the topic.
            now: Time of the message [ns].
            data: The message in CDR.

        Raises:
            ValueError: If the topic has another type, or no name.
            StorageFailed: If the file cannot be written.
        """
        with self._lock:
            channel = self._find_channel(topic, kind, unit)
            if self._file.closed:
                raise StorageFailed(f"Cannot write {self.path}: it is closed.")
            if self._chunk_begin is None:
                self._chunk_begin = now
            self._n_messages += 1
            sequence = self._n_messages & 0xFFFFFFFF
            self._writer.add_message(channel.number, now, data, now, sequence)
            self._chunk_bytes += len(data)
            # Times from several sources need not be in order: an older message does not end a
            # chunk.
            if self._chunk_bytes >= CHUNK_BYTES or now - self._chunk_begin >= self._chunk_ns:
                self._end_chunk()

    def _find_channel(self, topic: str, kind: str, unit: str) -> _Channel:
        """Return the channel of a topic, which is created with the topic's first message."""
        channel = self._channels.get(topic)
        if channel is None:
            channel = self._create_channel(topic, kind, unit)
            self._channels[topic] = channel
        elif channel.kind != kind:
            raise BadArgument("topic", f"{topic} must keep its type {channel.kind}, got {kind}")
        return channel

    def _create_channel(self, topic: str, kind: str, unit: str) -> _Channel:
        if not topic:
            raise BadArgument("topic", "must be a name such as /joint_states, got ''")
        if kind not in self._schemas:
            name = ros2.schema_name(kind)
            text = ros2.schema_text(kind).encode()
            self._schemas[kind] = self._writer.register_schema(name, "ros2msg", text)
        # The profile requires the quality of service, which may be empty.
        metadata = {"offered_qos_profiles": QUALITY.get(topic, ""), "unit": unit}
        number = self._writer.register_channel(topic, "cdr", self._schemas[kind], metadata)
        return _Channel(number=number, kind=kind)

    def _end_chunk(self) -> None:
        self._guard(self._writer.flush)
        self._chunk_begin = None
        self._chunk_bytes = 0

    def _convert_time(self, time: float) -> int:
        """Convert a time to that of the file and of ROS [ns]; raises ValueError before 1970."""
        now = self._epoch + round(check_finite("time", time, "s") * 1e9)
        if now < 0:
            earliest = -1e-9 * self._epoch or 0.0  # 0 rather than -0
            raise BadArgument("time", f"must be >= {earliest:g} s, got {time}")
        return now

    def _header(self, time: float, frame: str) -> tuple[Any, ...]:
        """Return the fields of std_msgs/Header."""
        return ros2.to_ros_time(self._convert_time(time)), frame

    def _guard(
        self, write: Callable[[], Any], advice: str = "what was written before is kept"
    ) -> Any:
        """Call a function that may fail to write the file."""
        try:
            return write()
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise StorageFailed(f"Cannot write {self.path}: {reason}; {advice}.") from error


def _scalar_last(quaternion: Sequence[float]) -> tuple[float, ...]:
    w, x, y, z = quaternion
    return x, y, z, w
