"""Tables that Qualisys Track Manager exports as TSV: markers (3D) or rigid bodies (6D).

Lines with a key and its values come first, then, optionally, a row of column names, then the
numbers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from laticauda.trials.arrays import Samples
from laticauda.trials.logs.map_sections import AXES
from laticauda.values.tables import Table, add_column, convert_numbers

PARTS_OF_MARKER = AXES
"""Numbers of a marker in each row, in the order of the file."""
PARTS_OF_BODY = (
    *AXES,
    "Roll",
    "Pitch",
    "Yaw",
    "Residual",
    *(f"Rot[{i}]" for i in range(9)),
)
"""Numbers of a rigid body in each row, in the order of the file."""
UNITS = {
    "X": "mm",
    "Y": "mm",
    "Z": "mm",
    "Roll": "deg",
    "Pitch": "deg",
    "Yaw": "deg",
    "Residual": "mm",
}
"""Units of these numbers; those of a rotation matrix have none."""


@dataclass(frozen=True, kw_only=True)
class _Head:
    """The lines above the rows."""

    values: Mapping[str, Sequence[str]]
    """Values of each key, without the empty ones."""
    n_lines: int
    """Number of these lines."""

    def value(self, key: str, default: str) -> str:
        """Return the first value of a key; the default if the key is absent."""
        if key not in self.values:
            return default
        return self.values[key][0]


@dataclass(frozen=True, kw_only=True)
class _Rows:
    """The rows below the lines with keys."""

    header: Sequence[str]
    """Names of the columns, empty if there is no row of names."""
    cells: Sequence[Sequence[str]]
    """Cells of each row of numbers."""
    n_lines_above: int
    """Number of lines in the file above the numbers."""


def parse_qtm(lines: Sequence[str]) -> Table:
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
    head = _parse_head(lines)
    content = head.value("DATA_INCLUDED", default="")
    if content not in ("3D", "6D"):
        raise ValueError(f"DATA_INCLUDED must be 3D or 6D, got {content!r}.")
    if content == "3D":
        object_names = head.values.get("MARKER_NAMES", [])
        parts = PARTS_OF_MARKER
    else:
        object_names = head.values.get("BODY_NAMES", [])
        parts = PARTS_OF_BODY
    rows = _parse_rows(lines, head.n_lines)
    leading_names = _leading_names(rows, n_numbers=len(object_names) * len(parts))
    number_names = list[str]()
    for object_name in object_names:
        number_names += [f"{object_name} {part}" for part in parts]
    if rows.header:
        selected_columns = rows.header[len(leading_names) :]
        if len(selected_columns) != len(number_names):
            number_names = _names_of_selection(selected_columns, object_names)
    names = [*leading_names, *number_names]
    n_frames = int(float(head.value("NO_OF_FRAMES", default="-1")))
    _check_rows(rows, width=len(names), n_frames=n_frames)
    columns: dict[str, Samples | str] = {}
    row_numbers = [rows.n_lines_above + 1 + i for i in range(len(rows.cells))]
    for i, name in enumerate(names):
        cells = [row[i] for row in rows.cells]
        numbers = convert_numbers(name, cells, row_numbers)
        add_column(columns, name, numbers)
    for object_name in object_names:
        _forget_lost_frames(columns, object_name)
    rate = None
    if "FREQUENCY" in head.values:
        rate = float(head.values["FREQUENCY"][0])
    return Table(columns=columns, units=_units_of(number_names), rate=rate, row_numbers=row_numbers)


def _parse_head(lines: Sequence[str]) -> _Head:
    """Return the lines above the rows; they end where a line does not begin with a key in capitals."""
    values: dict[str, list[str]] = {}
    for number, line in enumerate(lines):
        key, *cells = line.rstrip("\r\n").split("\t")
        is_key = key.isupper() and key.replace("_", "").isalnum() and key not in AXES
        if not is_key:
            return _Head(values=values, n_lines=number)
        values[key] = [cell for cell in cells if cell]
    return _Head(values=values, n_lines=len(lines))


def _parse_rows(lines: Sequence[str], n_lines_of_head: int) -> _Rows:
    cells: list[list[str]] = []
    for line in lines[n_lines_of_head:]:
        if line.strip():
            # Every line also ends with a tab.
            cells.append(line.rstrip("\r\n").removesuffix("\t").split("\t"))
    has_header = bool(cells) and isinstance(
        convert_numbers("", cells[0][:1], [n_lines_of_head]), str
    )
    if not has_header:
        return _Rows(header=[], cells=cells, n_lines_above=n_lines_of_head)
    return _Rows(header=cells[0], cells=cells[1:], n_lines_above=n_lines_of_head + 1)


def _leading_names(rows: _Rows, n_numbers: int) -> list[str]:
    """Return the names of the columns before those of the markers or bodies."""
    if rows.header:
        return [name.lower() for name in rows.header[:2] if name in ("Frame", "Time")]
    width = 0
    if rows.cells:
        width = len(rows.cells[0])
    return ["frame", "time"][: max(width - n_numbers, 0)]


def _names_of_selection(header: Sequence[str], object_names: Sequence[str]) -> list[str]:
    """Return the names of exported columns; the name of a body precedes only its first column in the file."""
    names: list[str] = []
    owner = ""
    for cell in header:
        part = cell
        for object_name in object_names:
            if part.startswith(f"{object_name} "):
                owner = object_name
                part = part.removeprefix(f"{object_name} ")
        names.append(f"{owner} {part}")
    return names


def _check_rows(rows: _Rows, width: int, n_frames: int) -> None:
    """Check the number of cells in each row, and that of rows unless `n_frames` is negative: not stated."""
    for number, cells in enumerate(rows.cells, start=rows.n_lines_above + 1):
        if len(cells) != width:
            raise ValueError(f"row {number} must have {width} cells, got {len(cells)}.")
    n_rows = len(rows.cells)
    if n_frames >= 0 and n_rows != n_frames:
        raise ValueError(
            f"NO_OF_FRAMES says {n_frames}, but there are {n_rows} rows: is it cut off?"
        )


def _units_of(names: Sequence[str]) -> dict[str, str]:
    units: dict[str, str] = {}
    for name in names:
        part = name.rsplit(" ", 1)[1]
        if part in UNITS:
            units[name] = UNITS[part]
    return units


def _forget_lost_frames(columns: Mapping[str, Samples | str], object_name: str) -> None:
    """Set the values of a marker or body to nan in the frames where it was lost."""
    positions = [columns.get(f"{object_name} {axis}") for axis in AXES]
    known_positions = [values for values in positions if isinstance(values, np.ndarray)]
    if not known_positions:
        return
    is_lost = np.all([values == 0.0 for values in known_positions], axis=0)
    for name, values in columns.items():
        if name.startswith(f"{object_name} ") and isinstance(values, np.ndarray):
            values[is_lost] = np.nan
