"""Reading a file of tracked points: its format, one individual, its times, and what was lost."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from laticauda.film.formats.format import PIXELS, PointFormat, PointsFile, TrackedIndividual
from laticauda.film.formats.plausibility import check_plausible
from laticauda.film.points import TrackedPoints
from laticauda.trials.arrays import Samples
from laticauda.trials.logs import failures_of
from laticauda.values import (
    BadArgument,
    TrialFileError,
    check_positive,
    check_within,
    files,
    suggest_nearest,
)

LARGEST_DISAGREEMENT = 0.01
"""Share by which a frame rate may differ from that of the file [-]."""


def read_points(
    path: str | Path,
    *,
    frame_rate: float | None = None,
    individual: str | None = None,
    point_format: str | None = None,
    likelihood_floor: float | None = None,
) -> TrackedPoints:
    """Read points that a tracker found in a film.

    Args:
        path: The file.
        frame_rate: Frames per second of the film; needed unless the file states it [1/s].
        individual: Whose points; needed if the file has several individuals.
        point_format: Name of the format, such as `sleap`; None: recognized.
        likelihood_floor: A point less sure than this is lost; None: what is usual for the tracker
            [-].

    Returns:
        The points, in px, or in m if the file has a length as unit.

    Raises:
        TrialFileError: If the file cannot be read, or no body can be where its points are; the
            message gives the file and the reason.
        ValueError: If an argument is missing or wrong; the message names it.
        MissingExtra: If the format needs a package that is not installed.
    """
    path = files.local(path)
    if not path.is_file():
        raise TrialFileError(f"Cannot read {path}: there is no such file.")
    with failures_of(path):
        kind = _choose_format(path, point_format)
        file = kind.read(path)
    if likelihood_floor is None:
        likelihood_floor = kind.usual_floor
    chosen = _choose_individual(file, individual)
    times = _times_of(file, frame_rate)
    with failures_of(path):
        points = _build_points(file, chosen, times, path)
    points = lose_unlikely(points, likelihood_floor)
    with failures_of(path):
        check_plausible(points, _length_of(file))
    return points


def _choose_format(path: Path, name: str | None) -> type[PointFormat]:
    if name is not None:
        return PointFormat.named(name)
    if path.suffix.lower() == ".slp":
        raise ValueError("it is a project of SLEAP; export its analysis, and give that file.")
    for known_name in PointFormat.names():
        kind = PointFormat.named(known_name)
        if kind.recognizes(path):
            return kind
    titles = [PointFormat.named(known_name).title for known_name in PointFormat.names()]
    raise ValueError(f"it must be one of these: {', '.join(titles)}.")


def _choose_individual(file: PointsFile, name: str | None) -> TrackedIndividual:
    names = [individual.name for individual in file.individuals]
    listed = ", ".join(f"`{known_name}`" for known_name in names)
    if name is None:
        if len(names) > 1:
            raise BadArgument("individual", f"must be one of {listed}: the file has {len(names)}")
        return file.individuals[0]
    if name not in names:
        hint = suggest_nearest(name, names)
        if names == [""]:
            raise BadArgument("individual", f"must be left out: the file names none, got {name!r}")
        raise BadArgument("individual", f"must be one of {listed}, got {name!r}{hint}")
    return file.individuals[names.index(name)]


def _times_of(file: PointsFile, frame_rate: float | None) -> Samples:
    """Return the time of every frame [s]."""
    stated = file.frame_rate
    if file.time is not None and file.time.size > 1:
        stated = float(1.0 / np.median(np.diff(file.time)))
    if frame_rate is None:
        if stated is None:
            raise BadArgument(
                "frame_rate",
                f"must be given, in frames per second of the film: {file.tracker} does not state it",
            )
        if file.time is not None:
            return file.time
        return file.frame / stated
    rate = check_positive("frame_rate", frame_rate, "1/s")
    if stated is not None and abs(rate / stated - 1.0) > LARGEST_DISAGREEMENT:
        raise BadArgument(
            "frame_rate",
            f"must be that of the file, {stated:.6g} frames per second, or be left out, got {rate:g}",
        )
    return file.frame / rate


def _length_of(file: PointsFile) -> float | None:
    """Return the length of a body that the file states, in the unit of points [px or m]."""
    if file.body_length is None or file.metres_per_unit is None:
        return file.body_length
    return file.body_length * file.metres_per_unit


def _build_points(
    file: PointsFile, individual: TrackedIndividual, time: Samples, path: Path
) -> TrackedPoints:
    position = np.array(individual.position)
    position[~np.isfinite(position).all(axis=-1)] = np.nan
    unit = PIXELS
    if file.metres_per_unit is not None:
        unit = "m"
        position *= file.metres_per_unit
        if file.has_y_down:
            position[..., 1] *= -1.0
    source = f"{path.name}: {file.tracker}, {time.size} frames, {len(individual.points)} points"
    if individual.name:
        source += f" of {individual.name}"
    return TrackedPoints(
        time=np.array(time, dtype=float),
        names=individual.points,
        position=position,
        likelihood=np.array(individual.likelihood, dtype=float),
        unit=unit,
        individual=individual.name,
        source=source,
        notes=(*file.remarks, *_describe_lost(individual.points, position)),
    )


def _describe_lost(names: Sequence[str], position: np.ndarray) -> list[str]:
    """Return sentences about points that the file itself has not, and frames that are empty."""
    is_lost = np.isnan(position[..., 0])
    n_empty = int(np.count_nonzero(is_lost.all(axis=1)))
    sentences: list[str] = []
    if n_empty:
        sentences.append(f"{n_empty} of {len(position)} frames are empty.")
    never_seen = [name for name, lost in zip(names, is_lost.T, strict=True) if lost.all()]
    if never_seen:
        sentences.append(f"Never seen: {', '.join(never_seen)}.")
    return sentences


def lose_unlikely(points: TrackedPoints, floor: float) -> TrackedPoints:
    """Return the points with those lost whose likelihood is below a floor.

    Args:
        points: The points.
        floor: Smallest likelihood of a point that counts [-].
    """
    floor = check_within("likelihood_floor", floor, 0.0, 1.0)
    if np.isnan(points.likelihood).all():
        return points.with_notes("The file has no likelihoods: every point counts.")
    is_unlikely = points.is_seen & (points.likelihood < floor)
    n_unlikely = int(np.count_nonzero(is_unlikely))
    if not n_unlikely:
        return points
    position = np.where(is_unlikely[..., np.newaxis], np.nan, points.position)
    share = n_unlikely / points.is_seen.size
    note = f"{share:.1%} of all points are less likely than {floor:g} and were taken for lost."
    return replace(points, position=position, notes=(*points.notes, note))
