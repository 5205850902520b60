"""Files of TRex: one for every individual, as CSV or NPZ, and its midlines (`_posture_`) as NPZ.

Centers are in cm, of which TRex knows the size only if `cm_per_pixel` was set; points of a pose and
midlines are in px.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

import numpy as np
from jaxtyping import Bool, Float

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
from laticauda.values.tables import build_table, parse_sheet, split_unit

CENTERS = {
    "": "head",
    "#wcentroid": "wcentroid",
    "#centroid": "centroid",
    "#pcentroid": "pcentroid",
}
"""Names of points, by what follows X and Y in the names of TRex."""
CENTIMETRE = 0.01
POSE_X = re.compile(r"poseX(\d+)")
SCALE_REMARK = (
    "Its cm are those of TRex: unless `cm_per_pixel` was set, it takes the picture for 30 cm wide."
)
Fields = Mapping[str, np.ndarray]


class Trex(PointFormat):
    """What TRex exports of an individual; poses and midlines are taken before centers, if they are there."""

    called: ClassVar[str] = "trex"
    title: ClassVar[str] = "TRex CSV or NPZ"
    usual_floor: ClassVar[float] = 0.3

    @staticmethod
    def recognizes(path: Path) -> bool:
        """Return whether names are those of TRex; see `PointFormat`."""
        if path.suffix.lower() == ".npz":
            names = contents.read_archive(path).keys()
            return "midline_points" in names or any(_is_own(name) for name in names)
        if contents.is_hdf(path):
            return False
        with path.open("rb") as file:
            line = file.readline(1 << 16).decode("utf-8-sig", errors="replace")
        return any(_is_own(name.strip('" ')) for name in re.split("[,;\t]", line))

    @staticmethod
    def read(path: Path) -> PointsFile:
        """Read the points in a file; see `PointFormat.read`."""
        fields = _read_fields(path)
        if "midline_points" in fields:
            return _read_midlines(fields, path)
        return _read_points(fields, path)


def _is_own(name: str) -> bool:
    return "#wcentroid" in name or "#pcentroid" in name or POSE_X.fullmatch(name) is not None


def _read_fields(path: Path) -> Fields:
    """Return all columns by their names without units; infinity, which stands for a lost one, is nan."""
    if path.suffix.lower() == ".npz":
        archive = contents.read_archive(path)
        return {
            name: _finite(array) for name, array in archive.items() if array.dtype.kind in "biuf"
        }
    table = build_table(parse_sheet(files.read_bytes(path)))
    return {
        split_unit(name)[0]: _finite(column)
        for name, column in table.columns.items()
        if not isinstance(column, str)
    }


def _finite(array: np.ndarray) -> np.ndarray:
    numbers = np.asarray(array, dtype=float)
    return np.where(np.isfinite(numbers), numbers, np.nan)


def _name_of(path: Path) -> str:
    """Return the name of the individual: the last part of the name of its file."""
    return path.stem.rpartition("_")[2]


# ---- centers and poses ---------------------------------------------------------------------------


def _read_points(fields: Fields, path: Path) -> PointsFile:
    frame = _frames_of(fields, "frame")
    n_rows = frame.size
    pose = sorted(int(match[1]) for name in fields if (match := POSE_X.fullmatch(name)))
    likelihood = np.full((n_rows, len(pose)), np.nan)
    metres_per_unit = None
    remarks: tuple[str, ...] = ()
    if pose:
        names = tuple(f"pose{i}" for i in pose)
        position = _stack(fields, [(f"poseX{i}", f"poseY{i}") for i in pose], n_rows)
        for column, i in enumerate(pose):
            if f"poseP{i}" in fields:
                likelihood[:, column] = fields[f"poseP{i}"]
    else:
        sources = [source for source in CENTERS if f"X{source}" in fields]
        if not sources:
            raise ValueError("it must have positions, such as `X#wcentroid` and `Y#wcentroid`.")
        names = tuple(CENTERS[source] for source in sources)
        position = _stack(fields, [(f"X{source}", f"Y{source}") for source in sources], n_rows)
        likelihood = np.full((n_rows, len(names)), np.nan)
        metres_per_unit = CENTIMETRE
        remarks = (SCALE_REMARK,)
    position[_is_missing(fields, n_rows)] = np.nan
    all_frames = span_of_frames(frame)
    time = None
    if "time" in fields and fields["time"].size == n_rows:
        time = _time_of(frame, fields["time"], all_frames)
    individual = TrackedIndividual(
        name=_name_of(path),
        points=names,
        position=fill_frames(frame, position, all_frames),
        likelihood=fill_frames(frame, likelihood, all_frames),
    )
    return PointsFile(
        tracker="TRex",
        frame=all_frames,
        individuals=(individual,),
        time=time,
        metres_per_unit=metres_per_unit,
        has_y_down=True,
        remarks=remarks,
    )


def _frames_of(fields: Fields, name: str) -> Samples:
    if name not in fields:
        raise ValueError(f"it must have `{name}`, the numbers of the frames.")
    frame = np.ravel(fields[name])
    if np.unique(frame).size < frame.size:
        raise ValueError(f"its `{name}` must hold every frame once.")
    return frame


def _stack(
    fields: Fields, pairs: list[tuple[str, str]], n_rows: int
) -> Float[np.ndarray, "n_rows n_points 2"]:
    """Return positions from the fields of their axes."""
    position = np.empty((n_rows, len(pairs), 2))
    for i, pair in enumerate(pairs):
        for axis, name in enumerate(pair):
            if name not in fields:
                raise ValueError(f"it must have `{name}` beside `{pair[1 - axis]}`.")
            if fields[name].shape != (n_rows,):
                raise ValueError(f"its `{name}` must have a number for each of {n_rows} frames.")
            position[:, i, axis] = fields[name]
    position[np.isnan(position).any(axis=-1)] = np.nan
    return position


def _is_missing(fields: Fields, n_rows: int) -> Bool[np.ndarray, " n_rows"]:
    """Return where TRex did not see the individual, and perhaps interpolated."""
    if "missing" not in fields or fields["missing"].shape != (n_rows,):
        return np.zeros(n_rows, dtype=np.bool_)
    return fields["missing"] != 0.0


def _time_of(
    frame: Float[np.ndarray, " n_rows"],
    time: Float[np.ndarray, " n_rows"],
    all_frames: Float[np.ndarray, " n_frames"],
) -> Float[np.ndarray, " n_frames"] | None:
    """Return the time of all frames, straight between those that are in the file."""
    is_known = np.isfinite(time)
    if np.count_nonzero(is_known) < 2:
        return None
    return np.interp(all_frames, frame[is_known], time[is_known])


# ---- midlines ------------------------------------------------------------------------------------


def _read_midlines(fields: Fields, path: Path) -> PointsFile:
    """Read midlines: as many points in every frame, equally far from each other, head first."""
    frame = _frames_of(fields, "frames")
    for name in ("offset", "midline_lengths"):
        if name not in fields:
            raise ValueError(f"it must have `{name}` beside `midline_points`.")
    lengths = np.ravel(fields["midline_lengths"])
    if lengths.size != frame.size or np.any(np.isnan(lengths)) or np.any(lengths < 0.0):
        raise ValueError("its `midline_lengths` must have a number for every frame.")
    n_points = int(np.median(lengths))
    midlines = np.reshape(fields["midline_points"], (-1, 2))
    if midlines.shape[0] != int(lengths.sum()) or n_points < 2:
        raise ValueError("its `midline_points` must have as many points as `midline_lengths` says.")
    ends = np.cumsum(lengths).astype(int)
    position = np.full((frame.size, n_points, 2), np.nan)
    for i, (length, end) in enumerate(zip(lengths.astype(int), ends, strict=True)):
        midline = midlines[end - length : end]
        if length >= 2 and not np.any(np.isnan(midline)):
            position[i] = resample_line(midline, n_points)
    position += np.reshape(fields["offset"], (frame.size, 1, 2))
    all_frames = span_of_frames(frame)
    individual = TrackedIndividual(
        name=_name_of(path),
        points=tuple(f"midline{i}" for i in range(n_points)),
        position=fill_frames(frame, position, all_frames),
        likelihood=np.full((all_frames.size, n_points), np.nan),
    )
    return PointsFile(tracker="TRex", frame=all_frames, individuals=(individual,))


def resample_line(line: Float[np.ndarray, "n 2"], n_points: int) -> Float[np.ndarray, "n_points 2"]:
    """Return points at equal distances along a line.

    Args:
        line: Its points.
        n_points: Number of points, with both ends.
    """
    along = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))))
    distances = np.linspace(0.0, float(along[-1]), n_points, dtype=np.float64)
    return np.stack([np.interp(distances, along, line[:, axis]) for axis in (0, 1)], axis=1)
