"""C3D files of motion capture, by the package `ezc3d`."""

# ezc3d has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import TrialFileError
from laticauda.extras import optional_import
from laticauda.logs.tables import Table
from laticauda.trial.arrays import Samples

BLOCK = 512  # bytes
KEY = 0x50  # the second byte of every such file
BIG_ENDIAN = 86  # the number of the processors whose numbers begin with the large end


def read_c3d(path: Path) -> Table:
    """The columns of a C3D file: X, Y and Z of every marker, as `head X`, and the analog channels.

    Analog channels are sampled more often than markers; they are averaged over each frame.

    Args:
        path: The file.

    Raises:
        MissingExtra: If ezc3d is not installed.
        TrialFileError: If it is no C3D file, or is damaged.
        OSError: If it cannot be read.
    """
    library = optional_import("Reading C3D", "ezc3d", "logs")
    try:
        n_frames = _check_whole(path)
        content = library.c3d(str(path))
        found = content["data"]["points"].shape[2]
        if found < n_frames:  # the library takes what is there
            raise ValueError(f"it must have {n_frames} frames, got {found}: it is cut off")
        return _table(content["parameters"], content["data"])
    except FileNotFoundError:
        raise
    except (RuntimeError, ValueError, KeyError, IndexError, MemoryError, OSError) as error:
        raise TrialFileError(f"Cannot load {path}: it is no whole C3D file ({error}).") from error


def _check_whole(path: Path) -> int:
    """Refuse what is no C3D file, or is cut off in its parameters, where the library would count for minutes.

    Returns:
        How many frames the file says it has.
    """
    with path.open("rb") as file:  # what the file system has to say is said here, in its own words
        header = file.read(BLOCK)
        if len(header) < BLOCK or header[1] != KEY:
            raise ValueError("it has no header")
        file.seek((header[0] - 1) * BLOCK)
        start = file.read(4)
        size = file.seek(0, io.SEEK_END)
    if len(start) < 4:
        raise ValueError("it ends before its parameters")
    order = ">" if start[3] == BIG_ENDIAN else "<"
    first, last = struct.unpack_from(order + "HH", header, 6)
    (data_block,) = struct.unpack_from(order + "H", header, 16)
    if size < (max(data_block - 1, header[0] - 1 + start[2])) * BLOCK:
        raise ValueError("it ends in its parameters")
    return last - first + 1


def _table(parameters: Any, data: Any) -> Table:
    point = parameters["POINT"]
    labels = [str(label).strip() for label in point["LABELS"]["value"]]
    unit = next((str(one).strip() for one in point["UNITS"]["value"]), "mm") if "UNITS" in point else "mm"
    columns: dict[str, Samples | str] = {}
    units: dict[str, str] = {}
    for i, label in enumerate(labels):
        lost = data["meta_points"]["residuals"][0, i] < 0.0  # so the format marks a point that nobody saw
        for axis, name in enumerate("XYZ"):
            columns[f"{label} {name}"] = np.where(lost, np.nan, data["points"][axis, i])
            units[f"{label} {name}"] = unit
    channels = parameters["ANALOG"]["LABELS"]["value"] if "ANALOG" in parameters else []
    for i, label in enumerate(channels):
        samples = np.asarray(data["analogs"][0, i], dtype=np.float64)
        columns[str(label).strip()] = samples.reshape(data["points"].shape[2], -1).mean(axis=1)
    return Table(columns=columns, units=units, rate=float(point["RATE"]["value"][0]))
