"""Tables from C3D files of motion capture, read with the package `ezc3d`."""

from pathlib import Path
from typing import Any

import numpy as np

from laticauda.trials.arrays import Samples
from laticauda.trials.logs.c3d_frames import (
    Frames,
    count_frames,
    gather_numbered,
    read_frames,
    read_layout,
)
from laticauda.trials.logs.map_sections import AXES
from laticauda.values import optional_import
from laticauda.values.tables import Table, add_column, read_unit


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
        layout = read_layout(path)
        content = library.c3d(str(path))
        parameters = content["parameters"]
        count = count_frames(path, layout, parameters)
        if content["data"]["points"].shape[2] == count.n_frames:
            frames = _frames_of_library(content["data"])
        else:  # the library ends where the header ends, or counts what fills the last block
            frames = read_frames(path, layout, count.n_frames, parameters)
        return _build_table(parameters, frames, count.remark)
    except FileNotFoundError:
        raise
    except (RuntimeError, ValueError, KeyError, IndexError, MemoryError, OSError) as error:
        raise ValueError(f"it is not an intact C3D file ({error}).") from error


def _frames_of_library(data: Any) -> Frames:
    """Return the frames that the library read."""
    points = data["points"]
    n_frames = points.shape[2]
    analog = np.asarray(data["analogs"][0], dtype=np.float64)
    n_samples_per_frame = analog.shape[1] // max(n_frames, 1)
    return Frames(
        position=points[:3],
        is_lost=data["meta_points"]["residuals"][0] < 0.0,
        analog=analog.reshape(len(analog), n_frames, n_samples_per_frame),
    )


def _build_table(parameters: Any, frames: Frames, remark: str) -> Table:
    """Return the columns of markers and analog channels, from the library's parameters and all frames."""
    point_parameters = parameters["POINT"]
    unit = _length_unit(point_parameters)
    columns: dict[str, Samples | str] = {}
    units: dict[str, str] = {}
    for i, label in enumerate(gather_numbered(point_parameters, "LABELS")):
        marker = str(label).strip()
        # A negative residual is the format's mark for a point that was not seen; some programs
        # write zeros instead.
        position = frames.position[:, i]
        is_lost = frames.is_lost[i] | np.all(position == 0.0, axis=0)
        for axis_name, coordinates in zip(AXES, position, strict=True):
            name = f"{marker} {axis_name}"
            measured = np.where(is_lost, np.nan, coordinates)
            add_column(columns, name, measured, owner=marker)
            units[name] = unit
    if "ANALOG" in parameters:
        labels = gather_numbered(parameters["ANALOG"], "LABELS")
        for i, label in enumerate(labels):
            means = frames.analog[i].mean(axis=1)
            add_column(columns, str(label).strip(), means)
    rate = float(point_parameters["RATE"]["value"][0])
    remarks: list[str] = []
    if remark:
        remarks.append(remark)
    return Table(columns=columns, units=units, rate=rate, remarks=remarks)


def _length_unit(point_parameters: Any) -> str:
    """Return the unit of all positions, mm unless the file states another one."""
    if "UNITS" in point_parameters:
        for unit in point_parameters["UNITS"]["value"]:
            return read_unit(str(unit)) or str(unit).strip()
    return "mm"
