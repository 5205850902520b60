"""Files of SLEAP: analysis HDF5 and analysis CSV."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import json
from collections import Counter
from collections.abc import Sequence
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
from laticauda.values import files
from laticauda.values.tables import Table, build_table, parse_sheet

DIMENSIONS = ("track", "xy", "node", "frame")
"""Axes of `tracks` where the file does not name them: as SLEAP has always written them."""
FRAME_COLUMN = "frame_idx"
"""Column of the number of the frame."""
LARGEST_SCORE = 2.0
"""Scores are peaks of maps that reach 1 or a little more; beyond this they are something else [-]."""


class Sleap(PointFormat):
    """Analysis files, not projects (.slp): SLEAP writes them by File, Export Analysis."""

    title: ClassVar[str] = "SLEAP analysis HDF5 or CSV"
    usual_floor: ClassVar[float] = 0.2

    @staticmethod
    def recognizes(path: Path) -> bool:
        """Return whether there are `tracks` and names of nodes, or a column `frame_idx`; see `PointFormat`."""
        if contents.is_hdf(path):
            with contents.open_hdf(path) as file:
                return "tracks" in file or "pred_points" in file
        with path.open("rb") as file:
            names = file.readline(1 << 16).decode("utf-8-sig", errors="replace")
        return FRAME_COLUMN in names

    @staticmethod
    def read(path: Path) -> PointsFile:
        """Read the points in a file; see `PointFormat.read`."""
        if contents.is_hdf(path):
            return read_hdf(path)
        return read_csv(path)


# ---- HDF5 ----------------------------------------------------------------------------------------


def read_hdf(path: Path) -> PointsFile:
    """Read an analysis file of HDF5.

    Args:
        path: The file.

    Raises:
        ValueError: If it is a project, or its arrays do not fit together.
    """
    with contents.open_hdf(path) as file:
        if "tracks" not in file:
            raise ValueError("it is a project of SLEAP; export its analysis, and give that file.")
        tracks = _in_order(file["tracks"], ("frame", "track", "node", "xy"), DIMENSIONS)
        n_frames, n_tracks, n_points, n_axes = tracks.shape
        if n_axes != 2:
            raise ValueError(f"its `tracks` must have 2 axes of positions, got {n_axes}.")
        points = contents.read_strings(file["node_names"])
        names = _track_names(file, n_tracks)
        if len(points) != n_points:
            raise ValueError(f"it must name {n_points} points, got {len(points)} names.")
        scores = np.full(tracks.shape[:3], np.nan)
        if "point_scores" in file:
            dimensions = tuple(name for name in DIMENSIONS if name != "xy")
            scores = _in_order(file["point_scores"], ("frame", "track", "node"), dimensions)
    individuals = [
        TrackedIndividual(
            name=name,
            points=points,
            position=tracks[:, i],
            likelihood=_checked_scores(scores[:, i]),
        )
        for i, name in enumerate(names)
    ]
    return PointsFile(
        tracker="SLEAP", frame=np.arange(float(n_frames)), individuals=tuple(individuals)
    )


def _in_order(dataset: Any, order: Sequence[str], usual: Sequence[str]) -> Float[np.ndarray, "..."]:
    """Return an array whose axes are in an order."""
    dimensions = tuple(usual)
    stated = dataset.attrs.get("dims")
    if stated is not None:
        try:
            dimensions = tuple(json.loads(stated))
        except ValueError:
            raise ValueError(f"the axes of its arrays must be a list, got {stated!r}.") from None
    values = np.asarray(dataset[()], dtype=float)
    if sorted(dimensions) != sorted(order) or values.ndim != len(order):
        raise ValueError(
            f"its arrays must have the axes {', '.join(order)}, got {', '.join(dimensions)}."
        )
    return np.transpose(values, [dimensions.index(name) for name in order])


def _track_names(file: Any, n_tracks: int) -> tuple[str, ...]:
    """Return a name for every track; none if there is but one that has none."""
    names: tuple[str, ...] = ()
    if "track_names" in file:
        names = contents.read_strings(file["track_names"])
    if len(names) == n_tracks:
        return names
    if n_tracks == 1:
        return ("",)
    return tuple(f"track_{i}" for i in range(n_tracks))


def _checked_scores(
    scores: Float[np.ndarray, "n_frames n_points"],
) -> Float[np.ndarray, "n_frames n_points"]:
    if np.any(scores > LARGEST_SCORE):
        raise ValueError(f"its scores must lie between 0 and 1, got {np.nanmax(scores):g}.")
    return np.clip(scores, 0.0, 1.0)


# ---- CSV -----------------------------------------------------------------------------------------


def read_csv(path: Path) -> PointsFile:
    """Read an analysis file of CSV: a row for every individual in every frame.

    Args:
        path: The file.

    Raises:
        ValueError: If rows of different individuals cannot be told apart, or a column is missing.
    """
    sheet = parse_sheet(files.read_bytes(path))
    table = build_table(sheet)
    frame = table[FRAME_COLUMN]
    points = tuple(name.removesuffix(".x") for name in sheet.names if name.endswith(".x"))
    if not points:
        raise ValueError(
            "it must have columns such as `nose.x` and `nose.y`: export it as SLEAP's analysis CSV."
        )
    tracks = [""] * frame.size
    if "track" in sheet.names:
        tracks = sheet.cells_of("track")
    all_frames = span_of_frames(frame)
    _check_once(tracks, frame.tolist())
    individuals: list[TrackedIndividual] = []
    for name in dict.fromkeys(tracks):
        is_own = np.array([track == name for track in tracks])
        position = np.stack([_columns(table, points, axis) for axis in ("x", "y")], axis=-1)
        scores = _columns(table, points, "score")
        individuals.append(
            TrackedIndividual(
                name=name,
                points=points,
                position=fill_frames(frame[is_own], position[is_own], all_frames),
                likelihood=_checked_scores(fill_frames(frame[is_own], scores[is_own], all_frames)),
            )
        )
    return PointsFile(tracker="SLEAP", frame=all_frames, individuals=tuple(individuals))


def _columns(
    table: Table, points: Sequence[str], ending: str
) -> Float[np.ndarray, "n_rows n_points"]:
    """Return a column of every point; nan if the file has no scores."""
    columns: list[np.ndarray] = []
    for point in points:
        name = f"{point}.{ending}"
        if ending == "score" and name not in table.columns:
            columns.append(np.full(table.n_rows, np.nan))
        else:
            columns.append(table[name])
    return np.stack(columns, axis=1)


def _check_once(tracks: Sequence[str], frames: Sequence[float]) -> None:
    """Reject two rows of one individual in one frame."""
    [(track, frame), count] = Counter(zip(tracks, frames, strict=True)).most_common(1)[0]
    if count == 1:
        return
    if track == "":
        raise ValueError(
            f"frame {frame:g} has {count} individuals without a track; track them in SLEAP first."
        )
    raise ValueError(f"frame {frame:g} has {count} rows of track `{track}`.")
