"""Reading MCAP files, of any writer: also those that were never completed, because the program was killed."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple, cast

from laticauda.errors import TrialFileError
from laticauda.logs import ros2
from laticauda.logs.message_file import need_mcap

if TYPE_CHECKING:
    from mcap.records import Channel, Chunk, Schema

MAGIC = b"\x89MCAP0\r\n"


class Logged(NamedTuple):
    """One message of a recording."""

    topic: str
    """Where it was published."""
    time: float
    """When [s], rounded from the file's nanoseconds."""
    kind: str
    """Its type, as "sensor_msgs/JointState"."""
    content: Any
    """Its fields by name; bytes if it is neither CDR with a ROS 2 definition nor JSON."""


@dataclass(frozen=True, kw_only=True)
class Topic:
    """One topic of a recording."""

    kind: str
    """Type of its messages."""
    unit: str
    """Unit of their numbers, "" if not stated."""
    n_messages: int
    """How many complete ones there are."""


@dataclass(frozen=True, kw_only=True)
class Recording:
    """What is in an MCAP file, also one that was never completed."""

    path: Path
    """The file."""
    topics: Mapping[str, Topic]
    """By name."""
    metadata: Mapping[str, Mapping[str, str]]
    """Texts that belong to the whole file, by name."""
    start: float
    """Time of the earliest message [s], 0 if there is none."""
    stop: float
    """Time of the latest [s], 0 if there is none."""
    lost: str
    """What is missing from the file or damaged in it: a sentence; "" if nothing is."""

    def messages(self, *topics: str) -> Iterator[Logged]:
        """The complete messages in the order in which they were recorded.

        Args:
            topics: Which topics; none for all of them.

        Raises:
            TrialFileError: If a message does not fit the definition of its type.
        """
        contents = _Contents()
        with self.path.open("rb") as file:
            for opcode, content in _records(file):
                for channel, time, data in contents.messages(opcode, content):
                    if not topics or channel.topic in topics:
                        kind = _kind(contents.schemas.get(channel.schema_id))
                        yield Logged(channel.topic, time / 1e9, kind, self._decoded(contents, channel, data))

    def _decoded(self, contents: _Contents, channel: Channel, data: bytes) -> Any:
        try:
            return contents.decoder(channel)(data)
        except ValueError as error:
            raise TrialFileError(f"Cannot load {self.path}: topic {channel.topic}: {error}") from error


def open_recording(path: str | Path) -> Recording:
    """Look through an MCAP file, of any writer: what is in it, and what is lost.

    A file that ends in the middle has all of its complete chunks; a chunk whose checksum is wrong is left out.

    Args:
        path: The file.

    Raises:
        TrialFileError: If there is no such file, or it is no MCAP file.
        MissingExtra: If the package `mcap` is not installed.
    """
    need_mcap()
    path = Path(path)
    contents, counts, moments = _Contents(), dict[int, int](), list[int]()
    end, is_complete = len(MAGIC), False
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise TrialFileError(f"Cannot load {path}: it is no MCAP file.")
            for opcode, content in _records(file):
                end = file.tell()
                is_complete = is_complete or opcode == _FOOTER
                for channel, time, _ in contents.messages(opcode, content):
                    counts[channel.id] = counts.get(channel.id, 0) + 1
                    moments[:] = [min([time, *moments]), max([time, *moments])]
    except OSError as error:
        raise TrialFileError(f"Cannot read {path}: {(error.strerror or str(error)).lower()}.") from error
    lost = list(contents.damage)
    if not is_complete:
        lost.append(f"it ends before its end, with {max(size - end, 0)} bytes of an incomplete chunk")
    return Recording(
        path=path,
        topics=contents.topics(counts),
        metadata=contents.metadata,
        start=moments[0] / 1e9 if moments else 0.0,
        stop=moments[1] / 1e9 if moments else 0.0,
        lost=f"{path.name} is not whole: {'; '.join(lost)}." if lost else "",
    )


def read_messages(path: str | Path, *topics: str) -> Iterator[Logged]:
    """The messages of an MCAP file, in the order in which they were recorded; see `open_recording` for what is lost.

    Args:
        path: The file.
        topics: Which topics; none for all of them.

    Raises:
        TrialFileError: If there is no such file, or it is no MCAP file.
        MissingExtra: If the package `mcap` is not installed.
    """
    return open_recording(path).messages(*topics)


# ---- inside --------------------------------------------------------------------------------------------------------

_FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _METADATA = 0x02, 0x03, 0x04, 0x05, 0x06, 0x0C


def _records(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Kind and content of all complete records, from the first to the footer; the file stands behind each."""
    file.seek(0, io.SEEK_END)
    size = file.tell()
    file.seek(len(MAGIC))
    while True:
        start = file.read(9)
        if len(start) < 9:
            return
        length = int.from_bytes(start[1:], "little")
        if length > size - file.tell():
            file.seek(-len(start), io.SEEK_CUR)
            return
        yield start[0], file.read(length)
        if start[0] == _FOOTER:
            return


class _Contents:
    """What the records of one file say, gathered while they are read."""

    def __init__(self) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.metadata: dict[str, Mapping[str, str]] = {}
        self.damage: list[str] = []
        self._decoders: dict[int, Callable[[bytes], Any]] = {}

    def decoder(self, channel: Channel) -> Callable[[bytes], Any]:
        """What makes contents of the bytes of a channel's messages; raises ValueError where its definition is wrong."""
        if channel.id not in self._decoders:
            schema, read = self.schemas.get(channel.schema_id), bytes
            if channel.message_encoding == "cdr" and schema is not None and schema.encoding == "ros2msg":
                read = ros2.decoder(schema)
            elif channel.message_encoding == "json":
                read = json.loads
            self._decoders[channel.id] = read
        return self._decoders[channel.id]

    def messages(self, opcode: int, content: bytes) -> Iterator[tuple[Channel, int, bytes]]:
        """The messages in one record, with their channel and time [ns]; everything else is noted."""
        from mcap import records
        from mcap.data_stream import ReadDataStream

        if opcode not in (_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _METADATA):
            return
        stream = ReadDataStream(io.BytesIO(content))
        try:
            if opcode == _CHUNK:
                found = _unpacked(records.Chunk.read(stream))
            elif opcode == _MESSAGE:
                found = [records.Message.read(stream, len(content))]
            else:
                kind = {_SCHEMA: records.Schema, _CHANNEL: records.Channel, _METADATA: records.Metadata}[opcode]
                found = [kind.read(stream)]
        except Exception as error:  # whatever the decompressors and the parser raise at bytes that make no sense
            self.damage.append(f"a chunk of {len(content)} bytes is damaged ({error})")
            return
        for record in found:
            if isinstance(record, records.Schema):
                self.schemas[record.id] = record
            elif isinstance(record, records.Channel):
                self.channels[record.id] = record
            elif isinstance(record, records.Metadata):
                self.metadata[record.name] = record.metadata
            elif isinstance(record, records.Message) and record.channel_id in self.channels:
                yield self.channels[record.channel_id], record.log_time, record.data

    def topics(self, counts: Mapping[int, int]) -> dict[str, Topic]:
        found: dict[str, Topic] = {}
        for number, channel in self.channels.items():
            before = found[channel.topic].n_messages if channel.topic in found else 0
            found[channel.topic] = Topic(
                kind=_kind(self.schemas.get(channel.schema_id)),
                unit=channel.metadata.get("unit", ""),
                n_messages=before + counts.get(number, 0),
            )
        return found


def _unpacked(chunk: Chunk) -> list[Any]:
    from mcap.stream_reader import breakup_chunk

    return cast("list[Any]", breakup_chunk(chunk, validate_crc=True))


def _kind(schema: Schema | None) -> str:
    return "" if schema is None else schema.name.replace("/msg/", "/")
