"""Records of an MCAP file, read one after the other, however the file ends.

The reader of the package `mcap` needs a complete file; here the records before the end of a
truncated one are read, too.
"""

import io
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from laticauda.values import TrialFileError

MAGIC = b"\x89MCAP0\r\n"
"""First bytes of every MCAP file."""
N_PREFIX_BYTES = 9
"""Length of what precedes the content of a record: its kind (1) and its length (8) [bytes]."""

FOOTER = 0x02
SCHEMA = 0x03
CHANNEL = 0x04
MESSAGE = 0x05
CHUNK = 0x06
METADATA = 0x0C
DATA_END = 0x0F


class RawRecord(NamedTuple):
    """A complete record as it is in the file."""

    kind: int
    """`FOOTER`, `SCHEMA` and so on."""
    content: bytes
    end: int
    """Byte offset in the file after the record."""

    @property
    def prefix(self) -> bytes:
        """What precedes the content: its kind and its length."""
        return bytes([self.kind]) + len(self.content).to_bytes(8, "little")


class DataCheck:
    """Comparison of all data of a file with the checksum that stands behind them, record by record."""

    def __init__(self) -> None:
        self.is_complete = False
        """Whether the end of the data was seen."""
        self.is_damaged = False
        """Whether the data differ from those that were written; writers need not state a checksum."""
        self._checksum = zlib.crc32(MAGIC)

    def add(self, record: RawRecord) -> None:
        """Take in the next record.

        Args:
            record: The record.
        """
        if self.is_complete:  # what follows repeats the data
            return
        if record.kind == DATA_END:
            stated = int.from_bytes(record.content[:4], "little")
            self.is_complete = True
            self.is_damaged = stated not in (0, self._checksum)
            return
        self._checksum = zlib.crc32(record.prefix, self._checksum)
        self._checksum = zlib.crc32(record.content, self._checksum)


def iterate_records(path: Path, begin: int) -> Iterator[RawRecord]:
    """Yield all complete records of a file, up to the footer.

    Args:
        path: The file.
        begin: Byte offset after which to start; `len(MAGIC)` for all records.

    Raises:
        TrialFileError: If it is not an MCAP file.
        OSError: If the file cannot be read.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise TrialFileError(f"Cannot load {path}: it is not an MCAP file.")
        file.seek(begin)
        record = _read_record(file, size)
        while record is not None:
            yield record
            if record.kind == FOOTER:
                return
            record = _read_record(file, size)


def _read_record(file: BinaryIO, size: int) -> RawRecord | None:
    """Return the next record of a file of that size [bytes]; None if it is incomplete."""
    prefix = file.read(N_PREFIX_BYTES)
    if len(prefix) < N_PREFIX_BYTES:
        return None
    length = int.from_bytes(prefix[1:], "little")
    if length > size - file.tell():
        return None
    content = file.read(length)
    return RawRecord(kind=prefix[0], content=content, end=file.tell())


def parse_record(record: RawRecord) -> list[Any]:
    """Return the records of the package `mcap` in a record: those of a chunk, or the record itself.

    Records of other kinds than those above do not matter here, and are left out.

    Args:
        record: The record.

    Raises:
        Exception: Of any kind, if the content is invalid.
    """
    from mcap import records
    from mcap.data_stream import ReadDataStream
    from mcap.stream_reader import breakup_chunk

    stream = ReadDataStream(io.BytesIO(record.content))
    if record.kind == CHUNK:
        return breakup_chunk(records.Chunk.read(stream), validate_crc=True)
    if record.kind == MESSAGE:
        return [records.Message.read(stream, len(record.content))]
    classes = {SCHEMA: records.Schema, CHANNEL: records.Channel, METADATA: records.Metadata}
    if record.kind in classes:
        return [classes[record.kind].read(stream)]
    return []
