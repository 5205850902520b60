"""Tables from external logs: columns of numbers by name.

Sources are delimited text, QTM exports, and C3D files of motion capture (read with the package
`ezc3d`).
"""

import csv
import io
import re
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.trials.arrays import Samples
from laticauda.values import optional_import, suggest_nearest

MISSING = ("", "nan", "null", "none", "na", "n/a", "-")
"""Cells that stand for a missing number, in lower case."""
OF_BODY = ("X", "Y", "Z", "Roll", "Pitch", "Yaw", "Residual", *(f"Rot[{i}]" for i in range(9)))
AXES = ("X", "Y", "Z")
LARGEST = 1e30
"""A number beyond this is not a measurement, whatever its unit: nanoseconds since 1970 are 2e18."""
UNITS = {
    "X": "mm",
    "Y": "mm",
    "Z": "mm",
    "Roll": "deg",
    "Pitch": "deg",
    "Yaw": "deg",
    "Residual": "mm",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Columns of numbers by name, nan where one is missing."""

    columns: Mapping[str, Samples | str]
    """The numbers; for a column that holds anything else, a sentence that says so."""
    units: Mapping[str, str] = field(default_factory=dict[str, str])
    """Units of the columns, if stated in the file."""
    rate: float | None = None
    """Rows per second, if stated in the file [Hz]."""

    def __getitem__(self, name: str) -> Samples:
        """Return the column of that name.

        Raises:
            ValueError: If there is no such column, or it does not hold numbers, or holds absurd
                ones.
        """
        found = self.columns.get(name)
        if found is None:
            names = list(self.columns)
            shown = ", ".join(names[:20]) + (
                f" and {len(names) - 20} more" if len(names) > 20 else ""
            )
            printed = repr(name)[1:-1]
            raise ValueError(
                f"The file has no column `{printed}`{suggest_nearest(name, names).rstrip('.')}; it has {shown}."
            )
        if isinstance(found, str):
            raise ValueError(found)
        found = np.where(np.isfinite(found), found, np.nan)  # an infinite value was not measured
        if np.any(absurd := np.abs(found) > LARGEST):
            raise ValueError(
                f"Column `{name}` must hold numbers up to {LARGEST:g}, got {found[absurd][0]:g}."
            )
        return found

    @property
    def n_rows(self) -> int:
        """Number of rows."""
        return next((len(one) for one in self.columns.values() if not isinstance(one, str)), 0)


def convert_numbers(
    name: str, cells: Sequence[str], first_row: int, decimal: str = "."
) -> Samples | str:
    """Convert a column of cells to numbers; otherwise return a sentence that states which cell is not a number.

    Args:
        name: Name of the column.
        cells: Texts of the cells.
        first_row: Row number of the first cell in the file.
        decimal: Decimal separator, point or comma.
    """
    found = np.empty(len(cells))
    for i, cell in enumerate(cells):
        text = cell.strip()
        if decimal == ",":
            text = text.replace(",", ".")
        try:
            found[i] = np.nan if text.lower() in MISSING else float(text)
        except ValueError:
            hint = "; is `decimal` a comma?" if re.fullmatch(r"[-+]?\d+,\d+", text) else ""
            return f"Column `{name}` must hold numbers, got {text[:40]!r} in row {first_row + i}{hint}."
    return found


def csv_table(lines: Sequence[str], separator: str | None, decimal: str) -> Table:
    """Read the columns of a text whose first row, apart from comments, has their names.

    Args:
        lines: Lines of the text.
        separator: Separator between cells; detected if None.
        decimal: Decimal separator, point or comma.

    Raises:
        ValueError: If the text is not a valid table.
    """
    rows = [
        (i, line)
        for i, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(rows) < 2:
        raise ValueError("it must have at least a row of names and a row of numbers.")
    if separator is None:
        separator = max("\t;,", key=rows[0][1].count)
    cells = list(csv.reader([line for _, line in rows], delimiter=separator))
    header = [name.strip() for name in cells[0]]
    while header and not header[-1]:  # some programs end every line with a separator
        header.pop()
    _check_header(header, rows[0][0])
    width = len(header)
    for (number, _), row in zip(rows[1:], cells[1:], strict=True):
        if len(row) < width or any(cell.strip() for cell in row[width:]):
            raise ValueError(
                f"row {number} must have {width} cells, as row {rows[0][0]} has, got {len(row)}."
            )
    first = rows[1][0]
    columns = {
        name: convert_numbers(name, [row[i] for row in cells[1:]], first, decimal)
        for i, name in enumerate(header)
    }
    return Table(columns=columns)


def _check_header(header: Sequence[str], row: int) -> None:
    if all(re.fullmatch(r"[-+\d.eE]+", name) for name in header):
        raise ValueError(
            f"row {row} must have the names of the columns, got {', '.join(header[:3])}."
        )
    twice = next((name for name in header if header.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"row {row} must name every column once, got `{twice}` twice.")


# ---- Qualisys Track Manager ----------------------------------------------------------------------


def qtm_table(lines: Sequence[str]) -> Table:
    """Read a TSV file of Qualisys Track Manager: `time`, and the columns of every marker or body, such as `head X`.

    It holds trajectories of markers (3D) or of rigid bodies (6D). The numbers are preceded by lines
    with a key and its values, such as ``FREQUENCY 100`` and ``BODY_NAMES head tail``; the row of
    column names and the columns for frame and time are optional. Lengths are in mm, angles in deg,
    and the nine numbers of a rotation are in column-major order. Where a marker or body was lost,
    all of its numbers are 0, or a word.

    Args:
        lines: Lines of the file.

    Raises:
        ValueError: If the file is incomplete, or neither 3D nor 6D.
    """
    keys, top = _keys(lines)
    included = keys.get("DATA_INCLUDED", [""])[0]
    if included not in ("3D", "6D"):
        raise ValueError(f"DATA_INCLUDED must be 3D or 6D, got {included!r}.")
    names = keys.get("MARKER_NAMES" if included == "3D" else "BODY_NAMES", [])
    parts = AXES if included == "3D" else OF_BODY
    # Every line also ends with a tab.
    rows = [
        line.rstrip("\r\n").removesuffix("\t").split("\t") for line in lines[top:] if line.strip()
    ]
    header: list[str] = []
    if rows and isinstance(convert_numbers("", rows[0][:1], top), str):
        header, rows, top = rows[0], rows[1:], top + 1
    leading = _leading(header, len(rows[0]) if rows else 0, len(names) * len(parts))
    wanted = [f"{name} {part}" for name in names for part in parts]
    if header and len(header) - len(leading) != len(wanted):
        # A selection of columns was exported: the name of a body precedes only its first column.
        wanted = _named(header[len(leading) :], names)
    _check_rows(
        rows, len(leading) + len(wanted), top, int(float(keys.get("NO_OF_FRAMES", ["-1"])[0]))
    )
    found: dict[str, Samples | str] = {}
    for i, name in enumerate([*leading, *wanted]):
        found[name] = convert_numbers(name, [row[i] for row in rows], top + 1)
    for name in names:
        _forget_lost(found, name)
    units = {
        name: UNITS[name.rsplit(" ", 1)[1]] for name in wanted if name.rsplit(" ", 1)[1] in UNITS
    }
    return Table(
        columns=found,
        units=units,
        rate=float(keys["FREQUENCY"][0]) if "FREQUENCY" in keys else None,
    )


def _keys(lines: Sequence[str]) -> tuple[dict[str, list[str]], int]:
    """Return the lines above the numbers by key, and their count."""
    found: dict[str, list[str]] = {}
    for number, line in enumerate(lines):
        key, *values = line.rstrip("\r\n").split("\t")
        if not (key.isupper() and key.replace("_", "").isalnum()) or key in AXES:
            return found, number
        found[key] = [value for value in values if value]
    return found, len(lines)


def _leading(header: Sequence[str], width: int, n_wanted: int) -> list[str]:
    """Return the columns before those of the markers or bodies."""
    if header:
        return [name.lower() for name in header[:2] if name in ("Frame", "Time")]
    return ["frame", "time"][: max(width - n_wanted, 0)]


def _named(header: Sequence[str], names: Sequence[str]) -> list[str]:
    found: list[str] = []
    owner = ""
    for cell in header:
        for name in names:
            if cell.startswith(f"{name} "):
                owner, cell = name, cell.removeprefix(f"{name} ")
        found.append(f"{owner} {cell}")
    return found


def _check_rows(rows: Sequence[Sequence[str]], width: int, top: int, n_frames: int) -> None:
    for i, row in enumerate(rows):
        if len(row) != width:
            raise ValueError(f"row {top + 1 + i} must have {width} cells, got {len(row)}.")
    if n_frames >= 0 and len(rows) != n_frames:
        raise ValueError(
            f"NO_OF_FRAMES says {n_frames}, but there are {len(rows)} rows: is it cut off?"
        )


def _forget_lost(found: dict[str, Samples | str], name: str) -> None:
    """Set the values of a marker or body to nan in the frames where it was lost."""
    place = [found.get(f"{name} {axis}") for axis in AXES]
    known = [one for one in place if isinstance(one, np.ndarray)]
    if not known:
        return
    lost = np.all([one == 0.0 for one in known], axis=0)
    for key, values in found.items():
        if key.startswith(f"{name} ") and isinstance(values, np.ndarray):
            values[lost] = np.nan


BLOCK = 512  # bytes
KEY = 0x50  # the second byte of every C3D file
BIG_ENDIAN = 86  # identifies processors with big-endian numbers


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
        n_frames = _check_whole(path)
        content = library.c3d(str(path))
        found = content["data"]["points"].shape[2]
        if found < n_frames:  # the library accepts incomplete files
            raise ValueError(f"it must have {n_frames} frames, got {found}: it is cut off")
        return _table(content["parameters"], content["data"])
    except FileNotFoundError:
        raise
    except (RuntimeError, ValueError, KeyError, IndexError, MemoryError, OSError) as error:
        raise ValueError(f"it is not an intact C3D file ({error}).") from error


def _check_whole(path: Path) -> int:
    """Reject a file that is not C3D, or is cut off in its parameters, where the library would count for minutes.

    Returns:
        Number of frames stated in the file.
    """
    with path.open(
        "rb"
    ) as file:  # errors of the file system are raised here, with their own messages
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
    unit = (
        next((str(one).strip() for one in point["UNITS"]["value"]), "mm")
        if "UNITS" in point
        else "mm"
    )
    columns: dict[str, Samples | str] = {}
    units: dict[str, str] = {}
    for i, label in enumerate(labels):
        lost = (
            data["meta_points"]["residuals"][0, i] < 0.0
        )  # the format's mark for a point that was not seen
        for axis, name in enumerate("XYZ"):
            columns[f"{label} {name}"] = np.where(lost, np.nan, data["points"][axis, i])
            units[f"{label} {name}"] = unit
    channels: list[Any] = parameters["ANALOG"]["LABELS"]["value"] if "ANALOG" in parameters else []
    for i, label in enumerate(channels):
        samples = np.asarray(data["analogs"][0, i], dtype=np.float64)
        columns[str(label).strip()] = samples.reshape(data["points"].shape[2], -1).mean(axis=1)
    return Table(columns=columns, units=units, rate=float(point["RATE"]["value"][0]))
