"""Reading of MCAP files of any writer, including files that were never completed because the program was killed."""

import json
import math
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from laticauda.trials.logs import mcap_records, recorder, ros2
from laticauda.values import TrialFileError

if TYPE_CHECKING:
    from mcap.records import Channel, Message, Schema


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
        self._read_end = 0
        """Byte offset after the last complete record that was read."""
        self._reported_end = 0
        """The same when `more` last ended."""
        losses = list[str]()
        counts = Counter[str]()
        earliest = math.inf
        latest = 0
        for channel, message in self._read_messages(losses):
            counts[channel.topic] += 1
            earliest = min(earliest, message.log_time)
            latest = max(latest, message.log_time)
        self.topics = {
            channel.topic: self._describe_topic(channel, counts[channel.topic])
            for channel in self._channels.values()
        }
        """Topics by name."""
        self.start = 0.0
        """Time of the earliest message [s], 0 if there are no messages."""
        self.stop = 0.0
        """Time of the latest message [s], 0 if there are no messages."""
        if counts:
            self.start = self._seconds(earliest)
            self.stop = self._seconds(latest)
        self.lost = ""
        """What is missing from the file or damaged in it, as a sentence; "" if nothing is."""
        if losses:
            self.lost = f"{path.name} is not intact: {'; '.join(losses)}."

    @property
    def epoch(self) -> int:
        """Wall-clock time of the file's time 0 [ns since 1970]; 0 if the file does not state it."""
        clock = self.metadata.get(recorder.CLOCK, {})
        return int(clock.get("epoch", "0"))

    def _seconds(self, time: float) -> float:
        """Return the time since `epoch` [s] of a time in the file [ns]."""
        return (time - self.epoch) / 1e9

    def _describe_topic(self, channel: "Channel", n_messages: int) -> Topic:
        return Topic(
            kind=self._type_of_messages(channel),
            unit=channel.metadata.get("unit", ""),
            n_messages=n_messages,
        )

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
        ignored_losses = list[str]()
        for channel, message in self._read_messages(ignored_losses, begin):
            since_epoch = message.log_time - epoch
            is_wanted_topic = not topics or channel.topic in topics
            if is_wanted_topic and since_epoch >= 1e9 * since:
                yield Logged(
                    topic=channel.topic,
                    time=since_epoch / 1e9,
                    kind=self._type_of_messages(channel),
                    content=self._decode(channel, message.data),
                )

    def more(self, *topics: str, since: float = -math.inf) -> Iterator[Logged]:
        """Yield the messages added since the last call, in a file that is still being written; see `messages`.

        Args:
            topics: Topics to include; none for all of them.
            since: Earlier messages are left out [s].
        """
        yield from self.messages(*topics, since=since, begin=self._reported_end)
        self._reported_end = self._read_end

    def _type_of_messages(self, channel: "Channel") -> str:
        """Return the type of a channel's messages; "" if the file does not state it."""
        schema = self._schemas.get(channel.schema_id)
        if schema is None:
            return ""
        return schema.name.replace("/msg/", "/")

    def _decode(self, channel: "Channel", data: bytes) -> Any:
        """Return the fields of a message."""
        try:
            if channel.id not in self._decoders:
                self._decoders[channel.id] = self._find_decoder(channel)
            decode = self._decoders[channel.id]
            return decode(data)
        except ValueError as error:
            raise TrialFileError(
                f"Cannot load {self.path}: topic {channel.topic}: {error}"
            ) from error

    def _find_decoder(self, channel: "Channel") -> Callable[[bytes], Any]:
        """Return the function that decodes the messages of a channel; `bytes` if it is not known."""
        schema = self._schemas.get(channel.schema_id)
        if channel.message_encoding == "cdr" and schema is not None:
            if schema.encoding == "ros2msg":
                return ros2.build_decoder(schema)
            return bytes
        if channel.message_encoding == "json":
            return json.loads
        return bytes

    def _read_messages(
        self, losses: list[str], begin: int = 0
    ) -> "Iterator[tuple[Channel, Message]]":
        """Yield all complete messages after a byte, and keep schemas, channels and metadata on the way.

        A message is as it is in the file: its `data` encoded, its `log_time` in ns.

        Args:
            losses: Receives a phrase on every loss.
            begin: Byte offset in the file after which to start, 0 for all messages.
        """
        from mcap import records

        size = self.path.stat().st_size
        self._read_end = begin or len(mcap_records.MAGIC)
        last_kind = 0
        check = mcap_records.DataCheck()
        for raw_record in mcap_records.iterate_records(self.path, self._read_end):
            self._read_end = raw_record.end
            last_kind = raw_record.kind
            check.add(raw_record)
            parsed_records = list[Any]()
            try:
                parsed_records = mcap_records.parse_record(raw_record)
            # Decompressors and parser may raise anything for invalid bytes.
            except Exception as error:
                n_bytes = len(raw_record.content)
                losses.append(f"a chunk of {n_bytes} bytes is damaged ({error})")
            for record in parsed_records:
                if isinstance(record, records.Schema):
                    self._schemas[record.id] = record
                elif isinstance(record, records.Channel):
                    self._channels[record.id] = record
                elif isinstance(record, records.Metadata):
                    self.metadata[record.name] = record.metadata
                elif isinstance(record, records.Message) and record.channel_id in self._channels:
                    yield self._channels[record.channel_id], record
        if last_kind != mcap_records.FOOTER:
            n_bytes = max(size - self._read_end, 0)
            losses.append(f"it is truncated, with {n_bytes} bytes of an incomplete chunk")
        elif not losses and (check.is_damaged or not check.is_complete):
            losses.append("it is damaged: its checksum is wrong")


def open_recording(path: str | Path) -> Recording:
    """Open an MCAP file of any writer, and find out what is in it and what is lost.

    From a truncated file, all complete chunks are kept; a chunk with a wrong checksum is left out.
    A complete file has a checksum of all its data besides, so that damage between chunks is told.

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
        reason = (error.strerror or str(error)).lower()
        raise TrialFileError(f"Cannot read {path}: {reason}.") from error
    except KeyError as error:
        raise TrialFileError(f"Cannot load {path}: it has no `{error.args[0]}`.") from error
    # The content differs from what was written.
    except (ValueError, TypeError, IndexError, RecursionError) as error:
        raise TrialFileError(f"Cannot load {path}: {error}") from error
