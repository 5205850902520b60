"""An MCAP file that survives that its program is killed."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from laticauda.errors import BadArgument, StorageFailed, finite, positive, whole
from laticauda.extras import optional_import
from laticauda.logs import ros2


def need_mcap() -> None:
    """Refuse where the package is missing.

    Raises:
        MissingExtra: If it is not installed.
    """
    optional_import("Reading and writing MCAP", "mcap", "logs")


def nanoseconds(time: float) -> int:
    """As the file and ROS count time.

    Args:
        time: Any [s].
    """
    return round(time * 1e9)


def moment(time: float) -> int:
    """When something was recorded [ns].

    Args:
        time: Since the start of the run, or since 1970 [s].

    Raises:
        ValueError: If it is negative or not finite.
    """
    now = nanoseconds(finite("time", time, "s"))
    if now < 0:
        raise BadArgument("time", f"must be >= 0 s, got {time}")
    return now


class MessageFile:
    """Writes messages to an MCAP file while they happen; any thread may.

    Messages are gathered in chunks; a complete chunk is handed to the operating system at once. A program that is
    killed loses the open chunk and nothing else; the file then lacks its end, which `open_recording` does not mind. A
    context manager: leaving it, also by an error, completes the file.

    Args:
        path: The file.
        chunk_seconds: A chunk is complete after this much time of the messages [s].
        chunk_bytes: And when it holds this much [bytes].
        overwrite: Whether an older file of that name may be replaced.

    Raises:
        ValueError: If an argument is out of range.
        StorageFailed: If the file exists, or cannot be written; later, if the disk is full.
        MissingExtra: If the package `mcap` is not installed.
    """

    def __init__(
        self, path: str | Path, *, chunk_seconds: float = 1.0, chunk_bytes: int = 1 << 20, overwrite: bool = False
    ) -> None:
        need_mcap()
        from mcap.writer import Writer

        self._chunk_ns = nanoseconds(positive("chunk_seconds", chunk_seconds, "s"))
        self._chunk_bytes = whole("chunk_bytes", chunk_bytes, 1)
        self.path = Path(path)
        """The file."""
        try:
            self._file: BinaryIO = self.path.open("wb" if overwrite else "xb")
        except OSError as error:
            raise StorageFailed(f"Cannot write {path}: {(error.strerror or str(error)).lower()}.") from error
        # The writer's own limit is out of the way: chunks end here, so that each is handed on when it ends.
        self._writer = Writer(self._file, chunk_size=1 << 40)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, tuple[int, str]] = {}
        self._lock = threading.Lock()
        self._open_since: int | None = None
        self._open_bytes = 0
        self._sequence = 0
        self._is_open = True
        self._guarded(lambda: self._writer.start(profile="ros2", library="laticauda"))

    def add(self, topic: str, kind: str, unit: str, now: int, data: bytes) -> None:
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
            if not self._is_open:
                raise StorageFailed(f"Cannot write {self.path}: it is closed.")
            if self._open_since is None:
                self._open_since = now
            self._sequence += 1
            self._writer.add_message(channel, now, data, now, self._sequence & 0xFFFFFFFF)
            self._open_bytes += len(data)
            # Moments of several sources need not be in order: an older one does not end a chunk.
            if self._open_bytes >= self._chunk_bytes or now - self._open_since >= self._chunk_ns:
                self._end_chunk()

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
            if not self._is_open:
                return
            self._is_open = False
            try:
                self._guarded(self._writer.finish)
            finally:
                self._guarded(self._file.close)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

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
        metadata = {"offered_qos_profiles": "", "unit": unit}
        number = self._writer.register_channel(topic, "cdr", self._schemas[kind], metadata)
        self._channels[topic] = number, kind
        return number

    def _end_chunk(self) -> None:
        self._guarded(self._writer.flush)
        self._open_since, self._open_bytes = None, 0

    def _guarded(self, act: Callable[[], object]) -> None:
        try:
            act()
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise StorageFailed(f"Cannot write {self.path}: {reason}; what came before is kept.") from error
