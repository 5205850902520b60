"""What every format of tracked points is: how its files are recognized, and what one holds."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from laticauda.trials.arrays import Samples
from laticauda.values import Extensible

PIXELS = "px"
"""Unit of positions in the picture."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackedIndividual:
    """All that a file holds about one individual."""

    name: str
    """As the file names it; empty if it names none."""
    points: tuple[str, ...]
    """Names of its points."""
    position: Float[np.ndarray, "n_frames n_points 2"]
    """In the unit of the file, x right and y down if that is px; nan where one was lost."""
    likelihood: Float[np.ndarray, "n_frames n_points"]
    """From 0 to 1; nan where the file does not say [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PointsFile:
    """A file of tracked points as it is, before an individual is chosen."""

    tracker: str
    """Program that wrote it."""
    frame: Samples
    """Numbers of the frames in the film, from 0."""
    individuals: tuple[TrackedIndividual, ...]
    """Everyone who was tracked."""
    time: Samples | None = None
    """Time of every frame, if the file states it [s]."""
    frame_rate: float | None = None
    """Frames per second, if the file states it [1/s]."""
    metres_per_unit: float | None = None
    """Size of the unit of positions; None if that is px [m]."""
    has_y_down: bool = False
    """Whether y points down although the unit is a length; in px it always does."""
    body_length: float | None = None
    """Length of a body, if the file states it [unit of positions]."""
    remarks: tuple[str, ...] = ()
    """What a reader of the figures should know, a sentence each."""


class PointFormat(Extensible, group="point_formats"):
    """Base class of formats of tracked points; the class name with hyphens is the name of a format."""

    title: ClassVar[str]
    """Programs and files, for people."""
    usual_floor: ClassVar[float] = 0.6
    """Likelihood below which a point is usually taken for lost [-]."""

    @staticmethod
    def recognizes(path: Path) -> bool:
        """Return whether a file is of this format, from its ending and its beginning.

        Args:
            path: The file, which exists.
        """
        raise NotImplementedError

    @staticmethod
    def read(path: Path) -> PointsFile:
        """Read a file of this format.

        Args:
            path: The file.

        Raises:
            ValueError: If its content is invalid; the message says what.
        """
        raise NotImplementedError


def fill_frames(
    frame: Float[np.ndarray, " n_rows"],
    values: Float[np.ndarray, "n_rows ..."],
    all_frames: Float[np.ndarray, " n_frames"],
) -> Float[np.ndarray, "n_frames ..."]:
    """Return values at all frames; nan at those that a file leaves out.

    Args:
        frame: Number of the frame of every row, each once.
        values: A row for each.
        all_frames: Frames that are wanted, increasing.
    """
    filled = np.full((all_frames.size, *values.shape[1:]), np.nan)
    filled[np.searchsorted(all_frames, frame)] = values
    return filled


def span_of_frames(frame: Float[np.ndarray, " n_rows"]) -> Float[np.ndarray, " n_frames"]:
    """Return all frames from the first to the last one.

    Args:
        frame: Numbers of frames, whole.

    Raises:
        ValueError: If one is no number of a frame, or the span is absurd.
    """
    if not frame.size or not np.all(np.isfinite(frame)) or np.any(frame != np.round(frame)):
        raise ValueError("its numbers of frames must be whole numbers.")
    n_frames = frame.max() - frame.min() + 1.0
    if frame.min() < 0.0 or n_frames > LONGEST_SPAN:
        raise ValueError(
            f"its numbers of frames must count from 0, got {frame.min():g} to {frame.max():g}."
        )
    first, last = int(frame.min()), int(frame.max())
    return np.arange(first, last + 1, dtype=np.float64)


LONGEST_SPAN = 1e7
"""Frames of a film at most: 28 hours at 100 frames/s."""
