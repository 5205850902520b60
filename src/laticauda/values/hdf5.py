"""Look over HDF5 files (netCDF 4 is one) before their library does, which never returns from some of them.

The library walks through the objects of a global heap, one after the other. Where a damaged size leads
it to a place without an object, it goes on at the same place forever, and neither Ctrl-C nor a time
limit within the process reaches it. So the same walk is done here first.

A global heap collection (HDF5 File Format Specification, version 3, section III.E) is

    signature "GCOL", version (1 byte), 3 bytes of 0, size of the collection (8 bytes)

and then objects, each of which starts at a multiple of 8 bytes from the first:

    index (2 bytes), references (2 bytes), 4 bytes of 0, size (8 bytes), content

The object of index 0 is what is free; its size includes its own head, and it is the last one.
"""

import mmap
import struct
from collections.abc import Iterator
from pathlib import Path

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
HEAP_SIGNATURE = b"GCOL\x01\x00\x00\x00"
HEAP_HEAD = struct.Struct("<8sQ")
OBJECT_HEAD = struct.Struct("<HHIQ")
ALIGNMENT = 8
"""Objects start at multiples of it [bytes]."""


def check_heaps(file: str | Path) -> None:
    """Refuse an HDF5 file with a global heap that its library would never finish to read.

    Args:
        file: Path of any file; one that is no HDF5 file is left to its reader.

    Raises:
        ValueError: If a global heap is damaged; the message names the byte.
        OSError: If the file cannot be read.
    """
    with Path(file).open("rb") as stream:
        if stream.read(len(HDF5_SIGNATURE)) != HDF5_SIGNATURE:
            return
        with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
            for heap in _starts_of_heaps(content):
                damaged_byte = _find_damage(content, heap)
                if damaged_byte is not None:
                    raise ValueError(f"it is damaged at or before byte {damaged_byte}")


def _starts_of_heaps(content: mmap.mmap) -> Iterator[int]:
    """Yield where global heaps start."""
    start = content.find(HEAP_SIGNATURE)
    while start >= 0:
        yield start
        start = content.find(HEAP_SIGNATURE, start + len(HEAP_SIGNATURE))


def _find_damage(content: mmap.mmap, heap: int) -> int | None:
    """Return the byte at which the walk through a heap cannot go on, None if it comes to the end."""
    if heap + HEAP_HEAD.size > len(content):
        return heap
    _, heap_size = HEAP_HEAD.unpack_from(content, heap)
    end = heap + heap_size
    if end > len(content):
        return heap
    place = heap + HEAP_HEAD.size
    # Less than a head at the end is free, too.
    while place + OBJECT_HEAD.size <= end:
        index, _, zeros, size = OBJECT_HEAD.unpack_from(content, place)
        is_free = index == 0
        whole_size = size if is_free else OBJECT_HEAD.size + _rounded_up(size)
        if zeros or whole_size < OBJECT_HEAD.size or place + whole_size > end:
            return place
        if is_free:
            return None
        place += whole_size
    return None


def _rounded_up(size: int) -> int:
    """Return the next multiple of the alignment."""
    return -(-size // ALIGNMENT) * ALIGNMENT
