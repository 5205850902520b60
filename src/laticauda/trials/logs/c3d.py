"""Tables from C3D files of motion capture, read with the package `ezc3d`."""

import io
import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from laticauda.trials.arrays import Samples
from laticauda.trials.logs.map_sections import AXES
from laticauda.values import optional_import
from laticauda.values.tables import Table, add_column, read_unit

BLOCK = 512
"""Length of the blocks that make up a file [bytes]."""
KEY = 0x50
"""The second byte of every C3D file."""
BIG_ENDIAN = 86
"""Number of the processors whose numbers are big-endian, in the fourth byte of the parameters."""
FRAME_RANGE_OFFSET = 6
"""Position in the header of the numbers of the first and the last frame [bytes]."""
NUMBERS_OFFSET = 2
"""Position in the header of the numbers of points, and of analog samples per frame [bytes]."""
NUMBERS_PER_POINT = 4
"""Three coordinates, and the residual."""
SCALE_OFFSET = 12
"""Position in the header of the scale, which is negative if the numbers are floating-point [bytes]."""
MOST_FRAMES_IN_HEADER = 65534
"""Frames that the header can count, or one less, as some programs count from 0."""
WORD = 1 << 16
"""Number of values of 16 bits."""
DATA_BLOCK_OFFSET = 16
"""Position in the header of the number of the first block with data [bytes]."""


def read_c3d(path: Path) -> Table:
    """Read the columns of a C3D file: X, Y and Z of every marker, such as `head X`, and the analog channels.

    Analog channels are sampled more often than markers; their values are averaged over each frame.

    Args:
        path: The file.

    Raises:
        MissingExtra: If ezc3d is not installed.
        ValueError: If the file is not a C3D file, or is damaged.
        OSError: If the file cannot be read.
    """
    library = optional_import("Reading C3D", "ezc3d", "logs")
    try:
        size = _check_complete(path)
        content = library.c3d(str(path))
        n_frames_read = content["data"]["points"].shape[2]
        if n_frames_read < size.n_frames:  # the library accepts incomplete files
            raise ValueError(
                f"it must have {size.n_frames} frames, got {n_frames_read}: it is cut off"
            )
        _check_all_frames(content["parameters"], size, n_frames_read)
        return _build_table(content["parameters"], content["data"])
    except FileNotFoundError:
        raise
    except (RuntimeError, ValueError, KeyError, IndexError, MemoryError, OSError) as error:
        raise ValueError(f"it is not an intact C3D file ({error}).") from error


class _Size(NamedTuple):
    """How much the file holds."""

    n_frames: int
    """Number of frames stated in the header, whose fields count to 65535."""
    n_frames_by_length: int
    """Number of frames that the length of the file has place for."""
    most_padding: int
    """Frames of these that may be padding, as the file ends with a whole block."""


def _check_complete(path: Path) -> _Size:
    """Reject a file that is not C3D, or is cut off in its parameters, where the library would count for minutes."""
    # Errors of the file system are raised here, with their own messages.
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
    n_parameter_blocks = parameters[2]
    byte_order = "<"
    if parameters[3] == BIG_ENDIAN:
        byte_order = ">"
    first_frame, last_frame = struct.unpack_from(byte_order + "HH", header, FRAME_RANGE_OFFSET)
    (first_data_block,) = struct.unpack_from(byte_order + "H", header, DATA_BLOCK_OFFSET)
    n_blocks_before_data = max(
        first_data_block - 1, n_blocks_before_parameters + n_parameter_blocks
    )
    if size < n_blocks_before_data * BLOCK:
        raise ValueError("it ends in its parameters")
    n_points, n_analog = struct.unpack_from(byte_order + "HH", header, NUMBERS_OFFSET)
    (scale,) = struct.unpack_from(byte_order + "f", header, SCALE_OFFSET)
    bytes_per_number = 2
    if scale < 0.0:
        bytes_per_number = 4
    bytes_per_frame = bytes_per_number * (NUMBERS_PER_POINT * n_points + n_analog)
    n_frames_by_length = 0
    most_padding = 0
    if bytes_per_frame:
        n_frames_by_length = (size - n_blocks_before_data * BLOCK) // bytes_per_frame
        most_padding = BLOCK // bytes_per_frame + 1
    return _Size(
        n_frames=last_frame - first_frame + 1,
        n_frames_by_length=n_frames_by_length,
        most_padding=most_padding,
    )


def _check_all_frames(parameters: Any, size: _Size, n_frames_read: int) -> None:
    """Reject a file that holds more frames than its header can count, of which the library reads the first ones."""
    n_more = size.n_frames_by_length - n_frames_read
    if n_more <= size.most_padding:
        return
    is_header_full = n_frames_read >= MOST_FRAMES_IN_HEADER
    has_header_overflown = n_more >= MOST_FRAMES_IN_HEADER
    if is_header_full or has_header_overflown or _stated_frames(parameters) > n_frames_read:
        raise ValueError(
            f"it holds about {size.n_frames_by_length} frames, of which only the first "
            f"{n_frames_read} can be read: export it in parts, or as TSV"
        )


def _stated_frames(parameters: Any) -> int:
    """Return the number of frames that the parameters state by two numbers of 16 bits each; 0 if they do not."""
    trial = parameters.get("TRIAL", {})
    ends: list[int] = []
    for name in ("ACTUAL_START_FIELD", "ACTUAL_END_FIELD"):
        words = [int(word) % WORD for word in trial.get(name, {}).get("value", [])]
        if len(words) != 2:
            return 0
        low, high = words
        ends.append(low + WORD * high)
    return ends[1] - ends[0] + 1


def _build_table(parameters: Any, data: Any) -> Table:
    """Return the columns of markers and analog channels, from the library's parameters and data."""
    point_parameters = parameters["POINT"]
    points = data["points"]
    unit = _length_unit(point_parameters)
    columns: dict[str, Samples | str] = {}
    units: dict[str, str] = {}
    for i, label in enumerate(_labels_of_points(point_parameters)):
        marker = str(label).strip()
        # A negative residual is the format's mark for a point that was not seen; some programs
        # write zeros instead.
        is_lost = data["meta_points"]["residuals"][0, i] < 0.0
        is_lost = is_lost | np.all(points[:3, i] == 0.0, axis=0)
        for axis, axis_name in enumerate(AXES):
            name = f"{marker} {axis_name}"
            positions = np.where(is_lost, np.nan, points[axis, i])
            add_column(columns, name, positions, owner=marker)
            units[name] = unit
    if "ANALOG" in parameters:
        n_frames = points.shape[2]
        for i, label in enumerate(parameters["ANALOG"]["LABELS"]["value"]):
            samples = np.asarray(data["analogs"][0, i], dtype=np.float64)
            name = str(label).strip()
            means = samples.reshape(n_frames, -1).mean(axis=1)
            add_column(columns, name, means)
    rate = float(point_parameters["RATE"]["value"][0])
    return Table(columns=columns, units=units, rate=rate)


def _labels_of_points(point_parameters: Any) -> list[str]:
    """Return the names of all markers; beyond 255, they go on in parameters with a number."""
    labels = list(point_parameters["LABELS"]["value"])
    number = 2
    while f"LABELS{number}" in point_parameters:
        labels += point_parameters[f"LABELS{number}"]["value"]
        number += 1
    return labels


def _length_unit(point_parameters: Any) -> str:
    """Return the unit of all positions, mm unless the file states another one."""
    if "UNITS" in point_parameters:
        for unit in point_parameters["UNITS"]["value"]:
            return read_unit(str(unit)) or str(unit).strip()
    return "mm"
