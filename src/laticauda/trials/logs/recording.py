"""Reading of MCAP files of any writer, including files that were never completed because the program was killed."""

import io
import json
import math
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

from laticauda.trials.logs import recorder, ros2
from laticauda.values import TrialFileError

if TYPE_CHECKING:
    from mcap.records import Channel, Schema

MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _METADATA = 0x02, 0x03, 0x04, 0x05, 0x06, 0x0C


class Logged(NamedTuple):
    """One message of a recording."""

    topic: str
    """Topic on which it was published."""
    time: float
    """Time since `Recording.epoch` [s], rounded from the file's nanoseconds."""
    kind: str
    """Message type, such as "sensor_msgs/JointState"."""
    content: Any
    """Fields by name; bytes if the message is neither CDR with a ROS 2 definition nor JSON."""


@dataclass(frozen=True, kw_only=True)
class Topic:
    """One topic of a recording."""

    kind: str
    """Type of its messages."""
    unit: str
    """Unit of their numbers, "" if not stated."""
    n_messages: int
    """Number of complete messages."""


class Recording:
    """Contents of an MCAP file, even one that was never completed; created by `open_recording`, see there for details.

    Args:
        path: The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.metadata: dict[str, Mapping[str, str]] = {}
        """Texts that apply to the whole file, by name."""
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._decoders: dict[int, Callable[[bytes], Any]] = {}
        self._end = self._told = 0
        lost, counts, times = list[str](), Counter[str](), (math.inf, 0)
        for channel, time, _ in self._contents(lost):
            counts[channel.topic] += 1
            times = min(times[0], time), max(times[1], time)
        self.topics = {
            one.topic: Topic(
                kind=self._kind(one),
                unit=one.metadata.get("unit", ""),
                n_messages=counts[one.topic],
            )
            for one in self._channels.values()
        }
        """Topics by name."""
        self.start, self.stop = ((one - self.epoch) / 1e9 if counts else 0.0 for one in times)
        """Times of the earliest and the latest message [s], 0 if there are no messages."""
        self.lost = f"{path.name} is not intact: {'; '.join(lost)}." if lost else ""
        """What is missing from the file or damaged in it, as a sentence; "" if nothing is."""

    @property
    def epoch(self) -> int:
        """Wall-clock time of the file's time 0 [ns since 1970]; 0 if the file does not state it."""
        return int(self.metadata.get(recorder.CLOCK, {}).get("epoch", "0"))

    def messages(self, *topics: str, since: float = -math.inf, begin: int = 0) -> Iterator[Logged]:
        """Yield the complete messages in the order in which they were recorded.

        Args:
            topics: Topics to include; none for all of them.
            since: Earlier messages are left out [s].
            begin: Byte offset in the file after which to start, as tracked by `more`.

        Raises:
            TrialFileError: If a message does not fit the definition of its type.
        """
        epoch = self.epoch
        for channel, time, data in self._contents([], begin):
            if time - epoch >= 1e9 * since and (not topics or channel.topic in topics):
                yield Logged(
                    channel.topic,
                    (time - epoch) / 1e9,
                    self._kind(channel),
                    self._decoded(channel, data),
                )

    def more(self, *topics: str, since: float = -math.inf) -> Iterator[Logged]:
        """Yield the messages added since the last call, in a file that is still being written; see `messages`.

        Args:
            topics: Topics to include; none for all of them.
            since: Earlier messages are left out [s].
        """
        yield from self.messages(*topics, since=since, begin=self._told)
        self._told = self._end

    def _kind(self, channel: "Channel") -> str:
        """Return the type of a channel's messages."""
        schema = self._schemas.get(channel.schema_id)
        return "" if schema is None else schema.name.replace("/msg/", "/")

    def _decoded(self, channel: "Channel", data: bytes) -> Any:
        """Return the fields of a message."""
        try:
            if channel.id not in self._decoders:
                self._decoders[channel.id] = self._decoder(channel)
            return self._decoders[channel.id](data)
        except ValueError as error:
            raise TrialFileError(
                f"Cannot load {self.path}: topic {channel.topic}: {error}"
            ) from error

    def _decoder(self, channel: "Channel") -> Callable[[bytes], Any]:
        schema = self._schemas.get(channel.schema_id)
        if (
            channel.message_encoding == "cdr"
            and schema is not None
            and schema.encoding == "ros2msg"
        ):
            return ros2.decoder(schema)
        return json.loads if channel.message_encoding == "json" else bytes

    def _contents(self, lost: list[str], begin: int = 0) -> "Iterator[tuple[Channel, int, bytes]]":
        """Yield all complete messages after a byte, with channel and time [ns]; `lost` receives sentences on losses."""
        from mcap import records

        size, opcode = self.path.stat().st_size, 0
        self._end = begin or len(MAGIC)
        with self.path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise TrialFileError(f"Cannot load {self.path}: it is not an MCAP file.")
            file.seek(self._end)
            for opcode, content in _records(file, size):
                self._end, found = file.tell(), list[Any]()
                try:
                    found = _unpacked(opcode, content)
                except (
                    Exception
                ) as error:  # decompressors and parser may raise anything for invalid bytes
                    lost.append(f"a chunk of {len(content)} bytes is damaged ({error})")
                for record in found:
                    if isinstance(record, records.Schema):
                        self._schemas[record.id] = record
                    elif isinstance(record, records.Channel):
                        self._channels[record.id] = record
                    elif isinstance(record, records.Metadata):
                        self.metadata[record.name] = record.metadata
                    elif (
                        isinstance(record, records.Message) and record.channel_id in self._channels
                    ):
                        yield self._channels[record.channel_id], record.log_time, record.data
        if opcode != _FOOTER:
            lost.append(
                f"it is truncated, with {max(size - self._end, 0)} bytes of an incomplete chunk"
            )


def open_recording(path: str | Path) -> Recording:
    """Open an MCAP file of any writer, and find out what is in it and what is lost.

    From a truncated file, all complete chunks are kept; a chunk with a wrong checksum is left out.

    Args:
        path: The file.

    Raises:
        TrialFileError: If there is no such file, or it is not an MCAP file.
        MissingExtra: If the package `mcap` is not installed.
    """
    recorder.need_mcap()
    with failures_of(path):
        return Recording(Path(path))


@contextmanager
def failures_of(path: object) -> Generator[None]:
    """Convert errors raised within this context to errors that name the file.

    Args:
        path: Name of the file in the messages.

    Raises:
        TrialFileError: With the name and the reason.
    """
    try:
        yield
    except TrialFileError:
        raise
    except OSError as error:
        raise TrialFileError(
            f"Cannot read {path}: {(error.strerror or str(error)).lower()}."
        ) from error
    except KeyError as error:
        raise TrialFileError(f"Cannot load {path}: it has no `{error.args[0]}`.") from error
    except (
        ValueError,
        TypeError,
        IndexError,
        RecursionError,
    ) as error:  # content differs from what was written
        raise TrialFileError(f"Cannot load {path}: {error}") from error


def _records(file: BinaryIO, size: int) -> Iterator[tuple[int, bytes]]:
    """Yield kind and content of all complete records, up to the footer; the file is positioned after each record."""
    while len(start := file.read(9)) == 9:
        length = int.from_bytes(start[1:], "little")
        if length > size - file.tell():
            return
        yield start[0], file.read(length)
        if start[0] == _FOOTER:
            return


def _unpacked(opcode: int, content: bytes) -> list[Any]:
    """Return the records in a record, as far as they matter here: those of a chunk, or the record itself."""
    from mcap import records
    from mcap.data_stream import ReadDataStream
    from mcap.stream_reader import breakup_chunk

    stream = ReadDataStream(io.BytesIO(content))
    if opcode == _CHUNK:
        return breakup_chunk(records.Chunk.read(stream), validate_crc=True)
    if opcode == _MESSAGE:
        return [records.Message.read(stream, len(content))]
    kinds = {_SCHEMA: records.Schema, _CHANNEL: records.Channel, _METADATA: records.Metadata}
    return [kinds[opcode].read(stream)] if opcode in kinds else []
