"""C3D files of motion capture, the door of the package `ezc3d`."""

# ezc3d has no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import struct
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import MissingExtra, TrialFileError
from laticauda.trial.contents import Samples
from laticauda.trial.tables import Table

BLOCK = 512  # bytes
KEY = 0x50  # the second byte of every such file


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
    try:
        door: Any = import_module("ezc3d")
    except ImportError as error:
        raise MissingExtra("Reading C3D", "ezc3d", "logs") from error
    with path.open("rb") as file:  # what the file system has to say, in its own words
        start = file.read(BLOCK)
    if len(start) < BLOCK or start[1] != KEY:
        raise TrialFileError(f"Cannot load {path}: it is no C3D file.")
    try:
        content = door.c3d(str(path))
        _check_whole(start, content["data"]["points"].shape[2])
        return _table(content["parameters"], content["data"])
    except (RuntimeError, ValueError, KeyError, IndexError, MemoryError, OSError) as error:
        raise TrialFileError(f"Cannot load {path}: it is no whole C3D file ({error}).") from error


def _check_whole(header: bytes, n_frames: int) -> None:
    """Refuse a file that is cut off: the library then has fewer frames than the file's first block says."""
    first, last = struct.unpack_from("<HH", header, 6)
    if header[:1] == b"\x02" and n_frames < last - first + 1:  # in another byte order the numbers mean nothing
        raise ValueError(f"it must have {last - first + 1} frames, got {n_frames}: it is cut off")


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
