"""The frames of C3D files: how many there are, which 16 bits cannot say, and their numbers.

The header counts frames with 16 bits. What a file with more of them says there depends on the
program: 65535, or what is left of the number by multiples of 65536. The number then stands in
parameters, POINT:LONG_FRAMES or TRIAL:ACTUAL_START_FIELD and ACTUAL_END_FIELD, or only the length of
the file shows it. The package `ezc3d` reads as many frames as the header counts, so those of long
files are read here.
"""

import io
import math
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Real

BLOCK = 512
"""Length of the blocks that make up a file [bytes]."""
KEY = 0x50
"""The second byte of every C3D file."""
DEC = 85
"""Number of the processors whose floating-point numbers are those of a VAX, in the fourth byte of the parameters."""
BIG_ENDIAN = 86
"""Likewise of those whose numbers are big-endian."""
NUMBERS_OFFSET = 2
"""Position in the header of the numbers of points, and of analog samples per frame [bytes]."""
FRAME_RANGE_OFFSET = 6
"""Position in the header of the numbers of the first and the last frame [bytes]."""
SCALE_OFFSET = 12
"""Position in the header of the scale, which is negative if the numbers are floating-point [bytes]."""
DATA_BLOCK_OFFSET = 16
"""Position in the header of the number of the first block with data [bytes]."""
NUMBERS_PER_POINT = 4
"""Three coordinates, and the residual."""
WORD = 1 << 16
"""Number of values of 16 bits."""
FULL = WORD - 2
"""Number from which on a field of 16 bits may be at its end, as some programs count from 0."""
ACTUAL_FIELDS = ("ACTUAL_START_FIELD", "ACTUAL_END_FIELD")
"""Parameters with the numbers of the first and the last frame, as two words of 16 bits each."""


class Layout(NamedTuple):
    """Where the numbers of a file are, as its header says."""

    processor: int
    """Kind of the processor whose numbers they are."""
    n_points: int
    n_analog: int
    """Number of analog samples per frame, of all channels together."""
    scale: float
    """Factor of positions that are integers; negative if they are floating-point."""
    first_frame: int
    last_frame: int
    begin: int
    """Position of the first frame in the file [bytes]."""
    size: int
    """Length of the file [bytes]."""

    @property
    def is_integer(self) -> bool:
        """Whether the numbers are integers of 16 bits."""
        return self.scale >= 0.0

    @property
    def bytes_per_frame(self) -> int:
        """Length of a frame [bytes]."""
        n_numbers = NUMBERS_PER_POINT * self.n_points + self.n_analog
        if self.is_integer:
            return 2 * n_numbers
        return 4 * n_numbers

    @property
    def n_in_header(self) -> int:
        """Number of frames that the header counts; for more than 65535, what is left of it."""
        return (self.last_frame - self.first_frame + 1) % WORD

    @property
    def is_header_full(self) -> bool:
        """Whether the header may have been at its end, so that there are more frames."""
        return self.last_frame >= FULL or self.n_in_header >= FULL


class Count(NamedTuple):
    """The number of frames of a file."""

    n_frames: int
    remark: str
    """How it was found, if the header does not say it; else ""."""


class Frames(NamedTuple):
    """The numbers of all frames."""

    position: Float[np.ndarray, "3 n_points n_frames"]
    is_lost: Bool[np.ndarray, "n_points n_frames"]
    """Whether a point was not seen."""
    analog: Float[np.ndarray, "n_channels n_frames n_samples"]


def read_layout(path: Path) -> Layout:
    """Read the header; reject a file that is not C3D, or is cut off before its frames.

    Args:
        path: The file.

    Raises:
        ValueError: If it is.
        OSError: If the file cannot be read.
    """
    # Errors of the file system are raised here, with their own messages; the library would count
    # the parameters of a cut file for minutes.
    with path.open("rb") as file:
        header = file.read(BLOCK)
        if len(header) < BLOCK or header[1] != KEY:
            raise ValueError("it has no header")
        n_blocks_before_parameters = header[0] - 1
        file.seek(n_blocks_before_parameters * BLOCK)
        parameters = file.read(4)
        size = file.seek(0, io.SEEK_END)
    if len(parameters) < 4:
        raise ValueError("it ends before its parameters")
    n_parameter_blocks, processor = parameters[2:]
    byte_order = "<"
    if processor == BIG_ENDIAN:
        byte_order = ">"
    first_frame, last_frame = struct.unpack_from(byte_order + "HH", header, FRAME_RANGE_OFFSET)
    (first_data_block,) = struct.unpack_from(byte_order + "H", header, DATA_BLOCK_OFFSET)
    n_points, n_analog = struct.unpack_from(byte_order + "HH", header, NUMBERS_OFFSET)
    scale_bytes = header[SCALE_OFFSET : SCALE_OFFSET + 4]
    begin = BLOCK * max(first_data_block - 1, n_blocks_before_parameters + n_parameter_blocks)
    if size < begin:
        raise ValueError("it ends in its parameters")
    return Layout(
        processor=processor,
        n_points=n_points,
        n_analog=n_analog,
        scale=float(_decode_floats(scale_bytes, processor)[0]),
        first_frame=first_frame,
        last_frame=last_frame,
        begin=begin,
        size=size,
    )


# ---- number of frames ----------------------------------------------------------------------------


def count_frames(path: Path, layout: Layout, parameters: Any) -> Count:
    """Return the number of frames: the one that is stated and fits the length of the file.

    Args:
        path: The file.
        layout: Where its numbers are.
        parameters: Its parameters, as the library reads them.

    Raises:
        ValueError: If the file is cut off, or holds another number of frames than it states.
    """
    if not layout.bytes_per_frame:
        raise ValueError("it has neither points nor analog channels")
    end_of_frames = _find_end(layout, parameters)
    most = (end_of_frames - layout.begin) // layout.bytes_per_frame
    # The file ends with a whole block, which may have room for some frames more.
    least = max(most - BLOCK // layout.bytes_per_frame - 1, 0)
    stated = dict(_stated_frames(parameters))
    if layout.is_header_full:
        return _count_long(
            path, layout, stated, least=least, most=most, end_of_frames=end_of_frames
        )
    if least <= layout.n_in_header <= most:
        return Count(layout.n_in_header, "")
    for name, n_frames in stated.items():
        if least <= n_frames <= most:
            return Count(n_frames, _describe_count(layout, n_frames, name))
    n_more = most - layout.n_in_header
    n_frames = layout.n_in_header + n_more // WORD * WORD
    if n_frames >= WORD and least <= n_frames:
        return Count(n_frames, _describe_count(layout, n_frames, "the length of the file"))
    _check_not_cut({"the header": layout.n_in_header}, most)
    end_by_header = layout.begin + layout.n_in_header * layout.bytes_per_frame
    if _read_between(path, end_by_header, end_of_frames).strip(b"\0"):
        counts = [f"{name} {n_frames}" for name, n_frames in stated.items()]
        listed = ", ".join([f"its header counts {layout.n_in_header} frames", *counts])
        raise ValueError(f"{listed}, but its length is that of {most}")
    return Count(layout.n_in_header, "")


def _find_end(layout: Layout, parameters: Any) -> int:
    """Return where the frames end_of_frames: with the file, or where it has rotations [bytes]."""
    values = parameters.get("ROTATION", {}).get("DATA_START", {}).get("value", [])
    if len(values) == 1:
        begin_of_rotations = BLOCK * (int(values[0]) % WORD - 1)
        if layout.begin < begin_of_rotations < layout.size:
            return begin_of_rotations
    return layout.size


def _stated_frames(parameters: Any) -> Iterator[tuple[str, int]]:
    """Yield the parameters that state a number of frames beyond 16 bits, and that number."""
    values = parameters["POINT"].get("LONG_FRAMES", {}).get("value", [])
    if len(values) == 1:
        yield "POINT:LONG_FRAMES", int(values[0])
    trial = parameters.get("TRIAL", {})
    ends: list[int] = []
    for name in ACTUAL_FIELDS:
        halves = trial.get(name, {}).get("value", [])
        if len(halves) != 2:
            return
        low_word, high_word = halves
        ends.append(int(low_word) % WORD + WORD * (int(high_word) % WORD))
    yield "TRIAL:ACTUAL_END_FIELD", ends[1] - ends[0] + 1


def _count_long(
    path: Path, layout: Layout, stated: dict[str, int], *, least: int, most: int, end_of_frames: int
) -> Count:
    """Return the number of frames of a file whose header is full."""
    # A parameter may have been at its end as the header is.
    long = {name: n_frames for name, n_frames in stated.items() if n_frames > WORD}
    for name, n_frames in long.items():
        if least <= n_frames <= most:
            return Count(n_frames, _describe_count(layout, n_frames, name))
    _check_not_cut({"the header": layout.n_in_header, **long}, most)
    for name, n_frames in long.items():
        raise ValueError(f"{name} counts {n_frames} frames, but its length is that of {most}")
    for n_frames in (layout.n_in_header, *stated.values()):
        if n_frames == most:
            return Count(n_frames, "")
    if end_of_frames % BLOCK:
        raise ValueError(
            "it has more frames than its header can count, and no whole blocks: it is cut off"
        )
    n_frames = _count_by_length(path, layout, least=least, end_of_frames=end_of_frames)
    n_frames = max(n_frames, layout.n_in_header)
    if n_frames == layout.n_in_header:
        return Count(n_frames, "")
    return Count(n_frames, _describe_count(layout, n_frames, "the length of the file"))


def _check_not_cut(stated: dict[str, int], most: int) -> None:
    for name, n_frames in stated.items():
        if n_frames > most:
            raise ValueError(
                f"it must have {n_frames} frames, as {name} counts, got {most}: it is cut off"
            )


def _count_by_length(path: Path, layout: Layout, *, least: int, end_of_frames: int) -> int:
    """Return the number of frames before the zeros that fill the last block."""
    length = layout.bytes_per_frame
    begin_of_last = layout.begin + least * length
    last_bytes = _read_between(path, begin_of_last, end_of_frames)
    n_bytes = len(last_bytes.rstrip(b"\0"))
    n_frames = least + math.ceil(n_bytes / length)
    if layout.begin + n_frames * length > end_of_frames:
        raise ValueError("it ends within a frame: it is cut off")
    return n_frames


def _read_between(path: Path, start: int, stop: int) -> bytes:
    with path.open("rb") as file:
        file.seek(start)
        return file.read(stop - start)


def _describe_count(layout: Layout, n_frames: int, name: str) -> str:
    return f"its header counts {layout.n_in_header} frames; it has {n_frames} by {name}"


# ---- numbers -------------------------------------------------------------------------------------


def read_frames(path: Path, layout: Layout, n_frames: int, parameters: Any) -> Frames:
    """Read the numbers of all frames.

    Args:
        path: The file.
        layout: Where its numbers are.
        n_frames: Number of frames.
        parameters: Its parameters, as the library reads them.

    Raises:
        ValueError: If the parameters contradict the header.
        OSError: If the file cannot be read.
    """
    end_of_frames = layout.begin + n_frames * layout.bytes_per_frame
    content = _read_between(path, layout.begin, end_of_frames)
    numbers = _decode_numbers(content, layout)
    by_frame = numbers.reshape(n_frames, -1)
    n_point_numbers = NUMBERS_PER_POINT * layout.n_points
    point_numbers = by_frame[:, :n_point_numbers]
    points = point_numbers.reshape(n_frames, layout.n_points, NUMBERS_PER_POINT)
    position = points[:, :, :3].T.astype(np.float64)
    if layout.is_integer:
        position *= layout.scale
    residual = points[:, :, 3].T
    analog = _scale_analog(by_frame[:, n_point_numbers:], parameters)
    return Frames(position=position, is_lost=residual < 0.0, analog=analog)


def _decode_numbers(content: bytes, layout: Layout) -> np.ndarray:
    if not layout.is_integer:
        return _decode_floats(content, layout.processor)
    if layout.processor == BIG_ENDIAN:
        return np.frombuffer(content, ">i2")
    return np.frombuffer(content, "<i2")


def _decode_floats(content: bytes, processor: int) -> np.ndarray:
    if processor == BIG_ENDIAN:
        return np.frombuffer(content, ">f4")
    if processor == DEC:
        words = np.frombuffer(content, "<u2").reshape(-1, 2)
        swapped = np.ascontiguousarray(words[:, ::-1])
        return swapped.view("<f4")[:, 0] / 4.0  # a VAX counts exponents from another number
    return np.frombuffer(content, "<f4")


def _scale_analog(
    samples: Real[np.ndarray, "n_frames n_analog"], parameters: Any
) -> Float[np.ndarray, "n_channels n_frames n_samples"]:
    """Return the values of analog channels in their units."""
    n_frames = len(samples)
    if not samples.shape[1]:
        return np.zeros((0, n_frames, 1))
    analog = parameters["ANALOG"]
    n_channels = int(analog["USED"]["value"][0]) % WORD
    if not n_channels or samples.shape[1] % n_channels:
        raise ValueError(
            f"it has {samples.shape[1]} analog samples per frame for {n_channels} channels"
        )
    values = samples.astype(np.float64)
    if samples.dtype.kind == "i" and _is_unsigned(analog):
        values %= WORD
    scale = np.array(gather_numbered(analog, "SCALE"), dtype=np.float64)
    offset = np.array(gather_numbered(analog, "OFFSET"), dtype=np.float64)
    general_scale = float(analog["GEN_SCALE"]["value"][0])
    by_channel = values.reshape(n_frames, -1, n_channels)
    scaled = (by_channel - offset[:n_channels]) * scale[:n_channels] * general_scale
    return np.moveaxis(scaled, 2, 0)


def _is_unsigned(analog: Any) -> bool:
    """Return whether integers of the analog channels have no sign."""
    formats = analog.get("FORMAT", {}).get("value", [])
    if not formats:
        return False
    return str(formats[0]).strip().upper() == "UNSIGNED"


def gather_numbered(group: Any, name: str) -> list[Any]:
    """Return a list of parameters; beyond 255 values, it goes on in parameters with a number.

    Args:
        group: Parameters of a group.
        name: Name of the first, such as LABELS, which LABELS2 follows.
    """
    values = list(group[name]["value"])
    number = 2
    while f"{name}{number}" in group:
        values += list(group[f"{name}{number}"]["value"])
        number += 1
    return values
