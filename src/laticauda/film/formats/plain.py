"""Tables of points of any origin: columns such as `nose.x` and `nose.y`, in px unless they state a unit."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from laticauda.film.formats import contents
from laticauda.film.formats.format import (
    PIXELS,
    PointFormat,
    PointsFile,
    TrackedIndividual,
    span_of_frames,
)
from laticauda.values import files
from laticauda.values.tables import (
    LENGTHS,
    Sheet,
    Table,
    build_table,
    parse_sheet,
    read_times,
    split_unit,
)

COORDINATE = re.compile(r"(?P<point>.+?)[._ -](?P<axis>x|y|likelihood|score|confidence)", re.I)
"""Name of a column without its unit."""
TIME_COLUMNS = ("time", "t", "time_s", "seconds")
FRAME_COLUMNS = ("frame", "frames", "frame_idx", "frame_number")
PIXEL_UNIT = re.compile(r"\s*[\[(]\s*(px|pixels?)\s*[\])]\s*$", re.I)
"""End of the name of a column in pixels."""
INSTANCE = re.compile(r"(inst\d+)\.(.+)")
"""Name of a point of one of several individuals, as sleap-io writes them side by side."""


class Points(PointFormat):
    """A table with a row for every frame; the last resort, so that other formats are asked first."""

    title: ClassVar[str] = "a table with columns such as nose.x and nose.y"

    @staticmethod
    def recognizes(path: Path) -> bool:
        """Return whether a column is named like `nose.x`; see `PointFormat`."""
        if contents.is_hdf(path):
            return False
        try:
            sheet = parse_sheet(files.read_bytes(path))
        except ValueError:
            return False
        return any(_take_apart(name) is not None for name in sheet.names)

    @staticmethod
    def read(path: Path) -> PointsFile:
        """Read the points in a file; see `PointFormat.read`."""
        sheet = parse_sheet(files.read_bytes(path))
        table = build_table(sheet)
        if table.n_rows < 2:
            raise ValueError("it must have a row for each of two frames at least.")
        columns = _columns_of_points(sheet)
        individuals: dict[str, list[str]] = {}
        for point in columns:
            instance = INSTANCE.fullmatch(point)
            name = ""
            if instance is not None:
                name = instance[1]
            individuals.setdefault(name, []).append(point)
        frame = np.arange(float(table.n_rows))
        frame_names = [name for name in sheet.names if name.lower() in FRAME_COLUMNS]
        if frame_names:
            frame = table[frame_names[0]]
            span_of_frames(frame)
        time = None
        time_names = [name for name in sheet.names if split_unit(name)[0].lower() in TIME_COLUMNS]
        if time_names:
            time = read_times(table, time_names[0]).seconds
        return PointsFile(
            tracker="a table",
            frame=frame,
            time=time,
            individuals=tuple(
                _build_individual(name, points, columns, table)
                for name, points in individuals.items()
            ),
            metres_per_unit=_metres_per_unit(sheet, columns),
            remarks=tuple(f"{remark[0].upper()}{remark[1:]}." for remark in table.remarks),
        )


def _take_apart(name: str) -> tuple[str, str] | None:
    """Return point and coordinate of a column; None if it is of no point."""
    match = COORDINATE.fullmatch(PIXEL_UNIT.sub("", split_unit(name)[0]))
    if match is None:
        return None
    axis = match["axis"].lower()
    if axis in ("score", "confidence"):
        axis = "likelihood"
    return match["point"], axis


def _columns_of_points(sheet: Sheet) -> dict[str, dict[str, str]]:
    """Return the names of the columns of every point, by coordinate."""
    columns: dict[str, dict[str, str]] = {}
    for name in sheet.names:
        parts = _take_apart(name)
        if parts is not None:
            point, coordinate = parts
            columns.setdefault(point, {})[coordinate] = name
    for point in [point for point, named in columns.items() if not {"x", "y"} & named.keys()]:
        del columns[point]  # such as `instance.score`
    for point, named in columns.items():
        for axis in ("x", "y"):
            if axis not in named:
                raise ValueError(
                    f"it must have x and y of every point, got no {axis} of `{point}`."
                )
    if not columns:
        raise ValueError("it must have columns such as `nose.x` and `nose.y`.")
    return columns


def _build_individual(
    name: str, points: Sequence[str], columns: dict[str, dict[str, str]], table: Table
) -> TrackedIndividual:
    likelihood: list[Float[np.ndarray, " n_rows"]] = []
    for point in points:
        column = columns[point].get("likelihood")
        if column is None:
            likelihood.append(np.full(table.n_rows, np.nan))
        else:
            likelihood.append(table[column])
    x = np.stack([table[columns[point]["x"]] for point in points], axis=1)
    y = np.stack([table[columns[point]["y"]] for point in points], axis=1)
    names: list[str] = []
    for point in points:
        names.append(point.removeprefix(f"{name}."))
    return TrackedIndividual(
        name=name,
        points=tuple(names),
        position=np.stack((x, y), axis=-1),
        likelihood=np.stack(likelihood, axis=1),
    )


def _metres_per_unit(sheet: Sheet, columns: dict[str, dict[str, str]]) -> float | None:
    """Return the size of the unit that all columns state; None if they are in px, or state none."""
    stated: set[str] = set()
    for named in columns.values():
        for axis in ("x", "y"):
            stated.add(sheet.units.get(named[axis], PIXELS))
    if len(stated) > 1:
        raise ValueError(f"its columns must have one unit, got {', '.join(sorted(stated))}.")
    unit = stated.pop()
    if unit == PIXELS:
        return None
    if unit not in LENGTHS:
        raise ValueError(f"its columns must be in px, {', '.join(LENGTHS)}, got {unit}.")
    return LENGTHS[unit]
