"""A picture of the chain over frames of the film, so that a person sees whether it holds."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from laticauda.film.tracking.body import BodyTrack
from laticauda.film.vision import load_opencv, open_film
from laticauda.robot import kinematics

N_PANELS = 6
N_COLUMNS = 3
MARGIN = 0.12
"""Margin around the whole path in the picture, as a share of its size [-]."""
CHAIN_COLOR, PATH_COLOR, POINT_COLOR = "#e6550d", "#fdd049", "#31a354"
LEGEND = "chain, its head large (orange); what was seen (green +); path of the middle (yellow)"
PANEL_WIDTH = 4.2
"""Width of a panel [inch]."""


def draw_over_frames(track: BodyTrack, film: str | Path | None = None) -> Figure:
    """Draw the chain over frames that are spread over the film.

    Args:
        track: The body in every frame.
        film: The film; None: the chain alone.

    Raises:
        TrialFileError: If the film cannot be read.
        MissingExtra: If OpenCV is not installed, and a film is given.
    """
    chosen = _choose_frames(track)
    ends = _ends_in_picture(track)
    known_ends = ends[np.isfinite(ends).all(axis=(1, 2))]
    low, high = _window(known_ends, track)
    middle_of_panel = dict.fromkeys(chosen, 0.5 * (low + high))
    if film is None:
        # Without a film, nothing but the body is shown: each panel follows it.
        size = _size_of_body(known_ends)
        middle_of_panel = {frame: _middle(ends[frame]) for frame in chosen}
        low, high = -0.5 * size, 0.5 * size
    pictures: dict[int, np.ndarray] = {}
    if film is not None:
        pictures = read_frames(film, [int(track.frame[i]) for i in chosen])
    n_rows = -(-len(chosen) // N_COLUMNS)
    ratio = float((high[1] - low[1]) / (high[0] - low[0]))
    figure = Figure(
        figsize=(N_COLUMNS * PANEL_WIDTH, n_rows * (PANEL_WIDTH * ratio + 0.35)),
        layout="constrained",
    )
    panels = figure.subplots(n_rows, N_COLUMNS, squeeze=False).ravel()
    for panel in panels[len(chosen) :]:
        panel.axis("off")
    for panel, frame in zip(panels, chosen, strict=False):
        _draw_panel(panel, track, ends, frame, pictures.get(int(track.frame[frame])))
        middle, half = middle_of_panel[frame], 0.5 * (high - low)
        panel.set_xlim(middle[0] - half[0], middle[0] + half[0])
        panel.set_ylim(middle[1] - half[1], middle[1] + half[1])
        if track.calibration is not None:
            panel.invert_yaxis()
        panel.set_aspect("equal")
        panel.set_xticks([])
        panel.set_yticks([])
        panel.set_title(f"{track.time[frame]:.2f} s", fontsize=10.0)
    figure.supxlabel(LEGEND, fontsize=9.0)
    return figure


def read_frames(film: str | Path, frames: Sequence[int]) -> dict[int, np.ndarray]:
    """Return pictures of a film, gray, by the number of the frame.

    Args:
        film: Path of the film.
        frames: Numbers of the frames, from 0, increasing.

    Raises:
        TrialFileError: If the film cannot be read.
        MissingExtra: If OpenCV is not installed.
    """
    opencv = load_opencv("Drawing over a film")
    frame_numbers = set(frames)
    pictures: dict[int, np.ndarray] = {}
    with open_film(film) as capture:
        for frame in range(max(frames) + 1):
            if not capture.grab():
                break
            if frame in frame_numbers:
                is_read, picture = capture.retrieve()
                if is_read:
                    pictures[frame] = opencv.cvtColor(picture, opencv.COLOR_BGR2GRAY)
    return pictures


def _choose_frames(track: BodyTrack) -> list[int]:
    """Return frames in which the whole body is known, evenly spread."""
    is_known = np.isfinite(track.center_of_mass).all(axis=1)
    is_known &= np.isfinite(track.link_angle).all(axis=1)
    known_frames = np.flatnonzero(is_known)
    steps = np.linspace(0, known_frames.size - 1, min(N_PANELS, known_frames.size))
    return [int(known_frames[round(step)]) for step in steps]


def _ends_in_picture(track: BodyTrack) -> Float[np.ndarray, "n_frames n_ends 2"]:
    """Return tail end, joints and head end in every frame [px, or m without a calibration]."""
    posture = kinematics.Posture(track.robot, track.center_of_mass, track.link_angle)
    ends = np.asarray(posture.link_ends)
    if track.calibration is None:
        return ends
    places = ends.reshape(-1, 2)
    is_known = np.isfinite(places).all(axis=1)
    pixels = np.full_like(places, np.nan)
    pixels[is_known] = track.calibration.to_picture(places[is_known])
    return pixels.reshape(ends.shape)


def _window(
    ends: Float[np.ndarray, "n n_ends 2"], track: BodyTrack
) -> tuple[Float[np.ndarray, " 2"], Float[np.ndarray, " 2"]]:
    """Return the lower and upper limits of what is shown, the same in all panels."""
    lowest = ends.min(axis=(0, 1))
    highest = ends.max(axis=(0, 1))
    span = highest - lowest
    # A straight body along an axis must not make a strip of the picture.
    size = np.maximum(span, 0.5 * float(np.max(span)))
    middle = 0.5 * (lowest + highest)
    reach = (0.5 + MARGIN) * size
    low = middle - reach
    high = middle + reach
    if track.calibration is None:
        return low, high
    edge = np.array(track.calibration.image_size, dtype=float) - 1.0
    return np.clip(low, 0.0, edge), np.clip(high, 0.0, edge)


def _middle(ends: Float[np.ndarray, "n_ends 2"]) -> Float[np.ndarray, " 2"]:
    return 0.5 * (ends.min(axis=0) + ends.max(axis=0))


def _size_of_body(ends: Float[np.ndarray, "n n_ends 2"]) -> Float[np.ndarray, " 2"]:
    """Return width and height of a panel that holds the body in every frame, with a margin."""
    size = np.max(ends.max(axis=1) - ends.min(axis=1), axis=0)
    return (1.0 + 2.0 * MARGIN) * np.maximum(size, 0.4 * float(np.max(size)))


def _draw_panel(
    panel: Any,
    track: BodyTrack,
    ends: Float[np.ndarray, "n_frames n_ends 2"],
    frame: int,
    picture: np.ndarray | None,
) -> None:
    if picture is not None:
        panel.imshow(picture, cmap="gray", vmin=0, vmax=255)
    path = ends.mean(axis=1)
    panel.plot(path[:, 0], path[:, 1], color=PATH_COLOR, linewidth=1.0)
    x, y = ends[frame].T
    panel.plot(x, y, "-o", color=CHAIN_COLOR, linewidth=1.6, markersize=3.0)
    panel.plot(x[-1], y[-1], "o", color=CHAIN_COLOR, markersize=6.0)  # the head
    positions = track.points.position[frame]
    panel.plot(
        positions[:, 0],
        positions[:, 1],
        "+",
        color=POINT_COLOR,
        markersize=5.0,
        markeredgewidth=1.2,
    )
