"""Tables from C3D files of motion capture, read with the package `ezc3d`."""

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.trials.arrays import Samples
from laticauda.trials.logs.map_sections import AXES
from laticauda.trials.logs.tables import Table
from laticauda.values import optional_import

BLOCK = 512
"""Length of the blocks that make up a file [bytes]."""
KEY = 0x50
"""The second byte of every C3D file."""
BIG_ENDIAN = 86
"""Number of the processors whose numbers are big-endian, in the fourth byte of the parameters."""
FRAME_RANGE_OFFSET = 6
"""Position in the header of the numbers of the first and the last frame [bytes]."""
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
        n_frames = _check_complete(path)
        content = library.c3d(str(path))
        n_frames_read = content["data"]["points"].shape[2]
        if n_frames_read < n_frames:  # the library accepts incomplete files
            raise ValueError(f"it must have {n_frames} frames, got {n_frames_read}: it is cut off")
        return _build_table(content["parameters"], content["data"])
    except FileNotFoundError:
        raise
    except (RuntimeError, ValueError, KeyError, IndexError, MemoryError, OSError) as error:
        raise ValueError(f"it is not an intact C3D file ({error}).") from error


def _check_complete(path: Path) -> int:
    """Reject a file that is not C3D, or is cut off in its parameters, where the library would count for minutes.

    Returns:
        Number of frames stated in the file.
    """
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
    return last_frame - first_frame + 1


def _build_table(parameters: Any, data: Any) -> Table:
    """Return the columns of markers and analog channels, from the library's parameters and data."""
    point_parameters = parameters["POINT"]
    points = data["points"]
    unit = _length_unit(point_parameters)
    columns: dict[str, Samples | str] = {}
    units: dict[str, str] = {}
    for i, label in enumerate(point_parameters["LABELS"]["value"]):
        marker = str(label).strip()
        # A negative residual is the format's mark for a point that was not seen.
        is_lost = data["meta_points"]["residuals"][0, i] < 0.0
        for axis, axis_name in enumerate(AXES):
            columns[f"{marker} {axis_name}"] = np.where(is_lost, np.nan, points[axis, i])
            units[f"{marker} {axis_name}"] = unit
    if "ANALOG" in parameters:
        n_frames = points.shape[2]
        for i, label in enumerate(parameters["ANALOG"]["LABELS"]["value"]):
            samples = np.asarray(data["analogs"][0, i], dtype=np.float64)
            columns[str(label).strip()] = samples.reshape(n_frames, -1).mean(axis=1)
    rate = float(point_parameters["RATE"]["value"][0])
    return Table(columns=columns, units=units, rate=rate)


def _length_unit(point_parameters: Any) -> str:
    """Return the unit of all positions, mm unless the file states another one."""
    if "UNITS" in point_parameters:
        for unit in point_parameters["UNITS"]["value"]:
            return str(unit).strip()
    return "mm"
