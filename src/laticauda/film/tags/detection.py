"""Tags in a film: their corners in every frame."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.film.calibration.fitting import Marks
from laticauda.film.tags.layout import DICTIONARIES, TagLayout, corners_of
from laticauda.film.vision import load_opencv, open_film
from laticauda.trials.arrays import Samples
from laticauda.values import BadArgument, TrialFileError, check_positive

FASTEST_CAMERA = 10_000.0
"""Frames per second that a film may state at most [1/s]."""
FARTHEST_MOVE = 0.005
"""Share of the width of the picture by which a tag on the floor may move during a film [-]."""
SMALLEST_PERIMETER = 0.015
"""Perimeter of a tag that is looked for, as a share of the larger side of the picture, at least [-]."""
FEWEST_FLOOR_TAGS = 3
"""Tags on the floor that tell where the camera is, at least."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TagFilm:
    """Tags that were found in a film."""

    source: str
    """Name of the film."""
    image_size: tuple[int, int]
    """Width and height of the picture [px]."""
    time: Samples
    """Time of every frame [s]."""
    numbers: tuple[int, ...]
    """Numbers of the tags that were looked for."""
    corners: Float[np.ndarray, "n_frames n_tags 4 2"]
    """Corners of every tag, in OpenCV's order; nan where it was not found [px]."""

    def corners_of(self, number: int) -> Float[np.ndarray, "n_frames 4 2"]:
        """Return the corners of one tag in every frame.

        Args:
            number: Its number.
        """
        return self.corners[:, self.numbers.index(number)]

    def share_lost(self, numbers: Sequence[int]) -> float:
        """Return the share of frames in which a tag was not found, over some tags [-].

        Args:
            numbers: Their numbers.
        """
        columns = [self.numbers.index(number) for number in numbers]
        return float(np.mean(np.isnan(self.corners[:, columns, 0, 0])))


def find_tags(
    path: str | Path,
    layout: TagLayout,
    *,
    frame_rate: float | None = None,
    on_progress: Callable[[float], object] | None = None,
) -> TagFilm:
    """Find tags in all frames of a film.

    Args:
        path: Path of the film.
        layout: The tags.
        frame_rate: Frames per second at which it was taken, such as 240 for slow motion that plays
            at 30; None: as the film states [1/s].
        on_progress: Called with the share of frames that are done.

    Raises:
        TrialFileError: If the film cannot be read, or states no frame rate.
        ValueError: If no frame rate that is possible is given.
        MissingExtra: If OpenCV is not installed.
    """
    if frame_rate is not None:
        check_positive("frame_rate", frame_rate, "1/s")
    opencv = load_opencv("Finding tags in a film")
    detector = _make_detector(opencv, layout)
    column_of = {number: i for i, number in enumerate(layout.numbers)}
    stated_times: list[float] = []
    found_corners: list[np.ndarray] = []
    with open_film(path) as capture:
        stated_rate = float(capture.get(opencv.CAP_PROP_FPS))
        n_expected = max(float(capture.get(opencv.CAP_PROP_FRAME_COUNT)), 1.0)
        size = (0, 0)
        while True:
            is_read, picture = capture.read()
            if not is_read:
                break
            stated_times.append(1e-3 * float(capture.get(opencv.CAP_PROP_POS_MSEC)))
            size = (int(picture.shape[1]), int(picture.shape[0]))
            corners = np.full((len(column_of), 4, 2), np.nan)
            quads, numbers, _ = detector.detectMarkers(
                opencv.cvtColor(picture, opencv.COLOR_BGR2GRAY)
            )
            if numbers is not None:
                for quad, number in zip(quads, np.ravel(numbers), strict=True):
                    if int(number) in column_of:
                        corners[column_of[int(number)]] = np.reshape(quad, (4, 2))
            found_corners.append(corners)
            if on_progress is not None:
                on_progress(min(len(found_corners) / n_expected, 1.0))
    if len(found_corners) < 2:
        raise TrialFileError(
            f"Cannot read {path}: it has {len(found_corners)} frames, too few for a film."
        )
    return TagFilm(
        source=Path(path).name,
        image_size=size,
        time=_times_of_frames(path, np.array(stated_times), stated_rate, frame_rate),
        numbers=layout.numbers,
        corners=np.stack(found_corners),
    )


def _make_detector(opencv: Any, layout: TagLayout) -> Any:
    aruco = opencv.aruco
    settings = aruco.DetectorParameters()
    settings.cornerRefinementMethod = aruco.CORNER_REFINE_SUBPIX
    settings.minMarkerPerimeterRate = SMALLEST_PERIMETER
    dictionary = aruco.getPredefinedDictionary(getattr(aruco, DICTIONARIES[layout.dictionary]))
    return aruco.ArucoDetector(dictionary, settings)


def _times_of_frames(
    path: str | Path, stated_times: Samples, stated_rate: float, frame_rate: float | None
) -> Samples:
    """Return the times of frames: from the rate that is given, those that the film states, or its rate [s]."""
    counted = np.arange(float(stated_times.size))
    if frame_rate is not None:
        return counted / frame_rate
    if np.all(np.diff(stated_times) > 0.0):  # phones take frames at uneven times
        return stated_times - stated_times[0]
    if not 0.0 < stated_rate <= FASTEST_CAMERA:
        raise BadArgument(
            "frame_rate",
            f"must be given: {Path(path).name} states {stated_rate:g} frames per second",
        )
    return counted / stated_rate


def marks_of_floor(film: TagFilm, layout: TagLayout) -> Marks:
    """Return the corners of the tags on the floor, each the median of all frames, as marks of known places.

    Args:
        film: The film.
        layout: The tags.

    Raises:
        ValueError: If fewer than 3 of them were found, or the camera moved.
    """
    pixels: list[np.ndarray] = []
    places: list[np.ndarray] = []
    groups: list[str] = []
    for tag in layout.floor:
        corners = film.corners_of(tag.number)
        seen_corners = corners[np.isfinite(corners[:, 0, 0])]
        if not len(seen_corners):
            continue
        _check_still(tag.number, seen_corners, film.image_size[0])
        pixels.append(np.median(seen_corners, axis=0))
        places.append(corners_of((tag.x, tag.y), tag.angle, layout.floor_size))
        groups += [f"tag {tag.number}"] * 4
    if len(pixels) < FEWEST_FLOOR_TAGS:
        numbers = ", ".join(str(tag.number) for tag in layout.floor)
        rule = f"must show at least {FEWEST_FLOOR_TAGS} of the tags {numbers} on the floor"
        raise BadArgument("film", f"{rule}, got {len(pixels)}")
    return Marks(
        pixels=np.concatenate(pixels),
        places=np.concatenate(places),
        groups=groups,
        place_deviation=layout.place_deviation,
    )


def _check_still(number: int, seen_corners: Float[np.ndarray, "n_seen 4 2"], width: int) -> None:
    third = max(len(seen_corners) // 3, 1)
    moved = np.median(seen_corners[-third:], axis=0) - np.median(seen_corners[:third], axis=0)
    distance = float(np.max(np.linalg.norm(moved, axis=-1)))
    if distance > FARTHEST_MOVE * width:
        rule = f"must be of a camera that stands still, but tag {number} on the floor moved"
        raise BadArgument("film", f"{rule} by {distance:.0f} px")
