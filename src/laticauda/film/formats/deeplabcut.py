"""Files of DeepLabCut: CSV, and HDF5 as pandas writes it, of one animal or several.

Their columns have names of three or four parts: scorer, perhaps individual, body part, and x, y or
likelihood. HDF5 files have a table (`format="table"`) or arrays (`format="fixed"`) in a group, which
DeepLabCut calls `df_with_missing`.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from jaxtyping import Float

from laticauda.film.formats import contents
from laticauda.film.formats.format import (
    PointFormat,
    PointsFile,
    TrackedIndividual,
    fill_frames,
    span_of_frames,
)
from laticauda.trials.arrays import Samples
from laticauda.values import files
from laticauda.values.tables import NAME_JOINT, Sheet, convert_numbers, parse_sheet

HEADERS: dict[tuple[str, ...], int] = {
    ("scorer", "bodyparts", "coords"): 3,
    ("scorer", "individuals", "bodyparts"): 4,
}
"""Number of rows of names, by the first cells of the first three."""
COORDINATES = ("x", "y", "likelihood")
"""Last part of the name of a column."""
N_PARTS = (3, 4)
"""Parts of the name of a column: with or without individuals."""


@dataclass(frozen=True, kw_only=True)
class NamedColumn:
    """The name of a column, taken apart."""

    individual: str
    point: str
    coordinate: str
    """One of `COORDINATES`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """The table in a file, however it is stored."""

    columns: tuple[NamedColumn, ...]
    index: Samples
    """Number of the frame of every row."""
    numbers: Float[np.ndarray, "n_rows n_columns"]


class Deeplabcut(PointFormat):
    """CSV and HDF5 of DeepLabCut, and of what writes the same, such as Lightning Pose."""

    title: ClassVar[str] = "DeepLabCut CSV or HDF5"

    @staticmethod
    def recognizes(path: Path) -> bool:
        """Return whether the first cell is `scorer`, or an HDF5 file holds a frame of pandas; see `PointFormat`."""
        if contents.is_hdf(path):
            with contents.open_hdf(path) as file:
                return _find_group(file) is not None
        return _first_cells(path)[:1] == ["scorer"]

    @staticmethod
    def read(path: Path) -> PointsFile:
        """Read the points in a file; see `PointFormat.read`."""
        if contents.is_hdf(path):
            frame = read_hdf_frame(path)
        else:
            frame = read_csv_frame(path)
        all_frames = span_of_frames(frame.index)
        if np.unique(frame.index).size < frame.index.size:
            raise ValueError("it must have one row for each frame, got a number of a frame twice.")
        return PointsFile(
            tracker="DeepLabCut",
            frame=all_frames,
            individuals=_individuals(frame, all_frames),
        )


def _first_cells(path: Path) -> list[str]:
    """Return the first cells of the first three rows of a text; empty if it is none."""
    with path.open("rb") as file:
        beginning = file.read(1 << 16)
    lines = beginning.decode("utf-8-sig", errors="replace").splitlines()[:3]
    return [line.replace(";", ",").replace("\t", ",").split(",")[0].strip('" ') for line in lines]


# ---- CSV -----------------------------------------------------------------------------------------


def read_csv_frame(path: Path) -> Frame:
    """Read the table in a CSV file.

    Args:
        path: The file.

    Raises:
        ValueError: If its rows of names are not those of DeepLabCut, or a cell is no number.
    """
    first_cells = tuple(_first_cells(path))
    if first_cells not in HEADERS:
        shown = ", ".join(f"`{cell}`" for cell in first_cells)
        raise ValueError(
            "its first rows must begin with scorer, perhaps individuals, bodyparts and coords, "
            f"got {shown}."
        )
    sheet = parse_sheet(files.read_bytes(path), n_header_rows=HEADERS[first_cells])
    index_name, *names = sheet.names
    if not sheet.rows:
        raise ValueError("it has no frames.")
    return Frame(
        columns=tuple(_parse_name(tuple(name.split(NAME_JOINT))) for name in names),
        index=_read_index(sheet, index_name),
        numbers=np.stack([_read_column(sheet, name) for name in names], axis=1),
    )


def _read_index(sheet: Sheet, name: str) -> Samples:
    cells = sheet.cells_of(name)
    index = convert_numbers(name, cells, sheet.row_numbers)
    if isinstance(index, str):
        raise ValueError(
            f"its first column must count frames, got {cells[0]!r}: labels of single pictures are "
            "no film; give what `analyze_videos` wrote."
        )
    return index


def _read_column(sheet: Sheet, name: str) -> Samples:
    numbers = convert_numbers(name, sheet.cells_of(name), sheet.row_numbers)
    if isinstance(numbers, str):
        raise ValueError(numbers)
    return numbers


def _parse_name(parts: Sequence[object]) -> NamedColumn:
    """Return the name of a column by its parts, scorer first."""
    texts = [str(part) for part in parts]
    if len(texts) not in N_PARTS or texts[-1] not in COORDINATES:
        raise ValueError(
            "its columns must be named by scorer, perhaps individual, body part, and x, y or "
            f"likelihood, got {', '.join(texts)}."
        )
    individual = ""
    if len(texts) == max(N_PARTS):
        individual = texts[1]
    return NamedColumn(individual=individual, point=texts[-2], coordinate=texts[-1])


# ---- HDF5 ----------------------------------------------------------------------------------------


def _find_group(file: Any) -> Any:
    """Return the first group that pandas wrote; None if there is none."""
    for group in file.values():
        if "pandas_type" in group.attrs:
            return group
    return None


def read_hdf_frame(path: Path) -> Frame:
    """Read the table in an HDF5 file that pandas wrote.

    Args:
        path: The file.

    Raises:
        ValueError: If it is no table of numbers whose columns are named as DeepLabCut does.
    """
    with contents.open_hdf(path) as file:
        group = _find_group(file)
        if group is None:
            raise ValueError("it has no group that pandas wrote, such as `df_with_missing`.")
        kind = _text_of(group.attrs["pandas_type"])
        if kind == "frame_table":
            return _read_table(group)
        if kind == "frame":
            return _read_arrays(group)
    raise ValueError(f"it must hold a table of pandas, got {kind!r}.")


def _read_table(group: Any) -> Frame:
    """Read a table: rows with an index and blocks of values; each block says its columns."""
    table = group["table"]
    rows = table[()]
    columns: list[NamedColumn] = []
    blocks: list[np.ndarray] = []
    for field in rows.dtype.names:
        if not field.startswith("values_block_"):
            continue
        named = contents.unpickle(bytes(table.attrs[f"{field}_kind"]))
        columns += [_parse_name(parts) for parts in named]
        blocks.append(np.reshape(rows[field], (rows.size, len(named))))
    return _build_frame(columns, rows["index"], blocks)


def _read_arrays(group: Any) -> Frame:
    """Read arrays: blocks of values, the columns of each, and the index, which is the second axis."""
    columns: list[NamedColumn] = []
    blocks: list[np.ndarray] = []
    for i in range(int(group.attrs.get("nblocks", 0))):
        values = group[f"block{i}_values"][()]
        columns += [_parse_name(parts) for parts in _read_labels(group, f"block{i}_items")]
        blocks.append(values)
    if "axis1" not in group:
        raise ValueError("labels of single pictures are no film; give what `analyze_videos` wrote.")
    return _build_frame(columns, group["axis1"][()], blocks)


def _read_labels(group: Any, key: str) -> list[tuple[str, ...]]:
    """Return the labels of an axis of several levels, each a tuple with a part for every level."""
    n_levels = int(group.attrs.get(f"{key}_nlevels", 0))
    if n_levels not in N_PARTS:
        raise ValueError(f"its columns must have names of 3 or 4 parts, got {n_levels}.")
    parts: list[list[str]] = []
    for level in range(n_levels):
        texts = contents.read_strings(group[f"{key}_level{level}"])
        codes = group[f"{key}_label{level}"][()]
        parts.append([texts[code] for code in codes])
    return list(zip(*parts, strict=True))


def _build_frame(
    columns: Sequence[NamedColumn], index: np.ndarray, blocks: Sequence[np.ndarray]
) -> Frame:
    is_number = np.issubdtype(np.asarray(index).dtype, np.number)
    if not is_number:
        raise ValueError("labels of single pictures are no film; give what `analyze_videos` wrote.")
    if not blocks or not len(index):
        raise ValueError("it has no frames.")
    return Frame(
        columns=tuple(columns),
        index=np.asarray(index, dtype=float),
        numbers=np.concatenate(blocks, axis=1).astype(float),
    )


def _text_of(attribute: object) -> str:
    if isinstance(attribute, bytes):
        return attribute.decode()
    return str(attribute)


# ---- individuals ---------------------------------------------------------------------------------


def _individuals(frame: Frame, all_frames: Samples) -> tuple[TrackedIndividual, ...]:
    """Return everyone in a table, in the order of their columns."""
    filled = fill_frames(frame.index, frame.numbers, all_frames)
    column_of = {
        (column.individual, column.point, column.coordinate): filled[:, i]
        for i, column in enumerate(frame.columns)
    }
    if len(column_of) < len(frame.columns):
        raise ValueError("it must name every point once: a name of a column occurs twice.")
    unknown = np.full(all_frames.size, np.nan)
    individuals: list[TrackedIndividual] = []
    for name in dict.fromkeys(column.individual for column in frame.columns):
        points = tuple(
            dict.fromkeys(column.point for column in frame.columns if column.individual == name)
        )
        for point in points:
            for axis in ("x", "y"):
                if (name, point, axis) not in column_of:
                    raise ValueError(
                        f"it must have x and y of every point, got no {axis} of `{point}`."
                    )
        x = np.array([column_of[name, point, "x"] for point in points])
        y = np.array([column_of[name, point, "y"] for point in points])
        likelihood = [column_of.get((name, point, "likelihood"), unknown) for point in points]
        individuals.append(
            TrackedIndividual(
                name=name,
                points=points,
                position=np.stack((x.T, y.T), axis=-1),
                likelihood=np.array(likelihood).T,
            )
        )
    return tuple(individuals)
