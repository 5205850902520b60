"""Records what happens to an MCAP file that survives that its program is killed.

Everything is a ROS 2 message in CDR (profile "ros2"), so that Foxglove and the ros2 bag tools open the file. The latter
refuse files of mixed encodings, so even what has no ROS type of its own travels as one: an event as the log message of
ROS, with its data as JSON. Units stand in the metadata of each channel, under "unit". `recording` reads it again.
"""

import json
import math
import struct
import threading
from collections.abc import Callable, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any, BinaryIO, Self, TypeAlias

from laticauda.errors import BadArgument, StorageFailed, finite, optional_import, positive, whole
from laticauda.logs import ros2

LEVELS = {"debug": 10, "info": 20, "warning": 30, "error": 40, "fatal": 50}
"""Levels of events and their numbers in rcl_interfaces/Log."""
_CAN_FRAME = struct.Struct("<4s iI I4s I3x B8s")  # encapsulation; stamp, frame_id ""; identifier, length, data
CHUNK_BYTES = 1 << 20  # of the messages in a chunk, which then is complete
WORLD = "world"
"""The frame of the world axes."""
CLOCK = "laticauda_clock"
"""Metadata: what time 0 is, as `epoch`."""
DESCRIPTION, STATIC = "/robot_description", "/tf_static"
_ONCE = {"history": 1, "depth": 1, "reliability": 1, "durability": 1, "liveliness": 1}
_NEVER = {key: {"sec": 0, "nsec": 0} for key in ("deadline", "lifespan", "liveliness_lease_duration")}
_LATCHED = json.dumps([{**_ONCE, **_NEVER, "avoid_ros_namespace_conventions": False}])
QUALITY = {DESCRIPTION: _LATCHED, STATIC: _LATCHED}
"""Quality of service that a topic is played with again: who comes late gets the last message of these, too. It is YAML,
which JSON is, with the numbers of ROS, as every rosbag2 reads them; for all others "", the usual one."""
Frame: TypeAlias = tuple[str, Sequence[float], Sequence[float]]
"""Name of the parent, position x, y, z in its axes [m], and orientation w, x, y, z [-]."""


def need_mcap() -> None:
    """Refuse where the package is missing.

    Raises:
        MissingExtra: If it is not installed.
    """
    optional_import("Reading and writing MCAP", "mcap", "logs")


class Recorder:
    """Writes messages to an MCAP file while they happen; any thread may.

    Messages are gathered in chunks; a complete chunk is handed to the operating system at once. A program that is
    killed loses the open chunk and nothing else; the file then lacks its end, which `open_recording` does not mind. A
    context manager: leaving it, also by an error, completes the file.

    Args:
        path: The file.
        chunk_seconds: A chunk is complete after this much time of the messages, or when it holds `CHUNK_BYTES` [s].
        overwrite: Whether an older file of that name may be replaced.
        epoch: What time 0 is by the clock on the wall [ns since 1970].

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
        self, path: str | Path, *, chunk_seconds: float = 1.0, overwrite: bool = False, epoch: int = 0
    ) -> None:
        need_mcap()
        from mcap.writer import Writer

        self._chunk_ns = round(positive("chunk_seconds", chunk_seconds, "s") * 1e9)
        self._epoch = whole("epoch", epoch, 0)
        self.path = Path(path)
        """The file."""
        mode = "wb" if overwrite else "xb"
        self._file: BinaryIO = self._guarded(lambda: self.path.open(mode), "name another place")
        # The writer's own limit is out of the way: chunks end here, so that each is handed on when it ends.
        self._writer = Writer(self._file, chunk_size=1 << 40)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, tuple[int, str]] = {}
        self._lock = threading.Lock()
        self._open_since: int | None = None
        self._open_bytes = 0
        self._sequence = 0
        self._guarded(lambda: self._writer.start(profile="ros2", library="laticauda"))
        if epoch:
            self.metadata(CLOCK, {"epoch": str(epoch)})

    def message(self, topic: str, time: float, kind: str, content: ros2.Content, *, unit: str = "") -> None:
        """Record any message of a known type.

        Args:
            topic: As "/joint_states"; its messages are all of one type.
            time: When it happened [s], since `epoch`, and not before 1970.
            kind: The ROS type, one of `ros2.DEFINITIONS`, as "std_msgs/Float64".
            content: Its fields, by name or in the order of the definition.
            unit: Of its numbers; kept with the first message of the topic.

        Raises:
            ValueError: If the content does not fit the type, or the topic has another type.
            StorageFailed: If it cannot be written.
        """
        self._add(topic, kind, unit, self._moment(time), ros2.encode(kind, content))

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
            time: When it happened, since `epoch` [s].
            names: Of the joints, tail first.
            position: Their angles [rad].
            velocity: Their rates [rad/s]; empty if not known.
            effort: Their torques [N m]; empty if not known.
        """
        content = self._header(time, ""), names, position, velocity, effort
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
            time: When it happened, since `epoch` [s].
            position: x, y, z [m].
            quaternion: Its orientation w, x, y, z [-].
            frame: Whose axes these are.
        """
        content = self._header(time, frame), (position, _scalar_last(quaternion))
        self.message(topic, time, "geometry_msgs/PoseStamped", content, unit="m")

    def transforms(self, time: float, frames: Mapping[str, Frame], *, topic: str = "/tf") -> None:
        """Record where frames are (tf2_msgs/TFMessage).

        Args:
            time: When it happened, since `epoch` [s].
            frames: By name.
            topic: Where; `STATIC` for what never moves.
        """
        transforms = [
            (self._header(time, parent), name, (place, _scalar_last(turn)))
            for name, (parent, place, turn) in frames.items()
        ]
        self.message(topic, time, "tf2_msgs/TFMessage", (transforms,), unit="m")

    def robot(self, time: float, description: str, fixed: Mapping[str, Frame]) -> None:
        """Record, once at the start, what viewers draw the robot by.

        Args:
            time: When it happened, since `epoch` [s].
            description: Its URDF.
            fixed: Frames of links that cannot move against what carries them.
        """
        self.message(DESCRIPTION, time, "std_msgs/String", (description,))
        self.transforms(time, fixed, topic=STATIC)

    def scalar(self, topic: str, time: float, value: float, unit: str = "") -> None:
        """Record one number (std_msgs/Float64).

        Args:
            topic: Where, as "/power/electrical".
            time: When it happened, since `epoch` [s].
            value: The number.
            unit: Its unit.
        """
        self.message(topic, time, "std_msgs/Float64", (value,), unit=unit)

    def array(self, topic: str, time: float, values: Any, unit: str = "", labels: Sequence[str] = ()) -> None:
        """Record numbers of any shape, the last index running fastest (std_msgs/Float64MultiArray).

        Args:
            topic: Where, as "/link_force".
            time: When it happened, since `epoch` [s].
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
            time: When it happened, since `epoch` [s].
            identifier: Of the frame.
            data: Up to 8 bytes.

        Raises:
            ValueError: If there are more than 8 bytes.
        """
        if len(data) > 8:
            raise BadArgument("data", f"must have at most 8 bytes, got {len(data)}")
        now = self._moment(time)
        if not 0 <= identifier < 1 << 32:
            raise BadArgument("identifier", f"must be from 0 to 2^32 - 1, got {identifier}")
        # What the codec of can_msgs/Frame writes, at once: there are thousands of these a second.
        seconds, rest = divmod(now, 1_000_000_000)
        body = _CAN_FRAME.pack(b"\x00\x01", seconds, rest, 1, b"", identifier, len(data), bytes(data))
        self._add(topic, "can_msgs/Frame", "", now, body)

    def json(self, topic: str, time: float, content: object) -> None:
        """Record anything that JSON can hold, as a text (std_msgs/String).

        Args:
            topic: Where, as "/settings".
            time: When it happened, since `epoch` [s].
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
        stamp = ros2.stamp(self._moment(time))
        self.message("/events", time, "rcl_interfaces/Log", (stamp, LEVELS[level], name, text, "", "", 0))
        self.flush()

    def metadata(self, name: str, content: Mapping[str, str]) -> None:
        """Write texts that belong to the whole file; they are on disk at once.

        Args:
            name: What they are about.
            content: The texts by name.
        """
        with self._lock:
            self._guarded(lambda: self._writer.add_metadata(name, dict(content)))
            self._guarded(self._writer.flush)

    def flush(self) -> None:
        """Complete the open chunk and hand it to the operating system."""
        with self._lock:
            self._end_chunk()

    def close(self) -> None:
        """Complete the file; a second time it does nothing."""
        with self._lock:
            if self._file.closed:
                return
            try:
                self._guarded(self._writer.finish)
            finally:
                self._guarded(self._file.close)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _add(self, topic: str, kind: str, unit: str, now: int, data: bytes) -> None:
        """Write a message.

        Args:
            topic: Its messages are all of one type.
            kind: The ROS type.
            unit: Of its numbers; kept with the first message of the topic.
            now: When it happened [ns].
            data: In CDR.

        Raises:
            ValueError: If the topic has another type, or no name.
            StorageFailed: If it cannot be written.
        """
        with self._lock:
            channel = self._channel(topic, kind, unit)
            if self._file.closed:
                raise StorageFailed(f"Cannot write {self.path}: it is closed.")
            if self._open_since is None:
                self._open_since = now
            self._sequence += 1
            self._writer.add_message(channel, now, data, now, self._sequence & 0xFFFFFFFF)
            self._open_bytes += len(data)
            # Moments of several sources need not be in order: an older one does not end a chunk.
            if self._open_bytes >= CHUNK_BYTES or now - self._open_since >= self._chunk_ns:
                self._end_chunk()

    def _channel(self, topic: str, kind: str, unit: str) -> int:
        found = self._channels.get(topic)
        if found is not None:
            if found[1] != kind:
                raise BadArgument("topic", f"{topic} must keep its type {found[1]}, got {kind}")
            return found[0]
        if not topic:
            raise BadArgument("topic", "must be a name such as /joint_states, got ''")
        if kind not in self._schemas:
            text = ros2.schema_text(kind).encode()
            self._schemas[kind] = self._writer.register_schema(ros2.schema_name(kind), "ros2msg", text)
        # The profile asks for the quality of service, and may have it empty.
        metadata = {"offered_qos_profiles": QUALITY.get(topic, ""), "unit": unit}
        number = self._writer.register_channel(topic, "cdr", self._schemas[kind], metadata)
        self._channels[topic] = number, kind
        return number

    def _end_chunk(self) -> None:
        self._guarded(self._writer.flush)
        self._open_since, self._open_bytes = None, 0

    def _moment(self, time: float) -> int:
        """When something was recorded, as the file and ROS count time [ns]; raises ValueError before 1970."""
        now = self._epoch + round(finite("time", time, "s") * 1e9)
        if now < 0:
            raise BadArgument("time", f"must be >= {-1e-9 * self._epoch or 0.0:g} s, got {time}")
        return now

    def _header(self, time: float, frame: str) -> tuple[Any, ...]:
        return ros2.stamp(self._moment(time)), frame

    def _guarded(self, act: Callable[[], Any], advice: str = "what came before is kept") -> Any:
        try:
            return act()
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise StorageFailed(f"Cannot write {self.path}: {reason}; {advice}.") from error


def _scalar_last(quaternion: Sequence[float]) -> tuple[float, ...]:
    w, x, y, z = quaternion
    return x, y, z, w
