"""Lines in a picture of a trial: the trail of its center of mass, and the path that it followed."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.show.pictures.shapes import add_line
from laticauda.trials import Trial, nearest_points

TRAIL_STEP = 0.2
"""Time between two corners of the trail [s]."""
MOST_TRAIL_PIECES = 400
TRAIL_HEIGHT = 1.3
"""Height of the trail above the axis, in half heights of the body."""
TRAIL_COLOR = np.array((1.0, 0.85, 0.40))
"""Color of the newest piece of the trail; older pieces are darker."""
DARKEST = 0.5
"""Brightness of the oldest piece of the trail, relative to the newest [-]."""
DASH = 0.05
"""Length of a dash of the path, and of the gap after it, in robot lengths."""
MOST_DASHES = 1500
PATH_DEPTH = 1.3
"""Depth of the path below the axis, in half heights of the body."""
PATH_COLOR = np.array((0.92, 0.97, 0.98))
LEAST_PROGRESS = 1e-6
"""Progress along the path from one sample to the next that counts as such [m]."""
Points = Float[np.ndarray, "n_points n_axes"]


class Dash(NamedTuple):
    """A dash of the path."""

    begin: np.ndarray
    """[m]."""
    end: np.ndarray
    """[m]."""


# ---- the trail -----------------------------------------------------------------------------------


def draw_trail(scene: Any, trial: Trial, time: float, height: float, width: float) -> None:
    """Draw the trail in a scene, above the body, with older pieces darker.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        trial: Any trial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].
        width: Width of the line [pixels].
    """
    points = trace_center(trial, time, height)
    points[:, 2] += TRAIL_HEIGHT * _half_height(trial)
    brightness = np.linspace(DARKEST, 1.0, len(points))
    colors = brightness[:, np.newaxis] * TRAIL_COLOR
    for begin, end, color in zip(points[:-1], points[1:], colors, strict=False):
        add_line(scene, begin, end, width=width, color=color)


def trace_center(trial: Trial, time: float, height: float) -> Points:
    """Return points of the center of mass's path up to a time, the newest last [m].

    Args:
        trial: Any trial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].
    """
    # Always at the same times; otherwise the corners of the line would move along it.
    first_step = math.ceil(trial.time[0] / TRAIL_STEP)
    last_step = math.floor(time / TRAIL_STEP)
    first_step = max(first_step, last_step - MOST_TRAIL_PIECES)
    moments = [step * TRAIL_STEP for step in range(first_step, last_step + 1)]
    moments.append(time)
    n_axes = trial.center_of_mass.shape[1]
    points = np.full((len(moments), 3), height)
    points[:, :n_axes] = interpolate_centers(trial, moments)
    return points


def interpolate_centers(trial: Trial, moments: Sequence[float]) -> Points:
    """Return the center of mass at these times, in as many axes as the trial has [m]."""
    columns: list[np.ndarray] = [
        np.interp(moments, trial.time, column) for column in trial.center_of_mass.T
    ]
    return np.stack(columns, axis=1)


def _half_height(trial: Trial) -> float:
    """Return the largest half height of the robot's body [m]."""
    return max(module.section.half_height for module in trial.robot.modules)


# ---- the path ------------------------------------------------------------------------------------


def draw_path(scene: Any, dashes: Sequence[Dash], width: float) -> None:
    """Draw the path in a scene.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        dashes: The path, from `dash_path`.
        width: Width of the lines [pixels].
    """
    for dash in dashes:
        add_line(scene, dash.begin, dash.end, width=width, color=PATH_COLOR)


def dash_path(trial: Trial, height: float) -> list[Dash]:
    """Return the path that was followed as dashes below the body; empty if there was no path.

    Args:
        trial: Any trial.
        height: Height at which a planar robot swims [m].
    """
    if "cross_track_error" not in trial.signals or trial.time.size < 2:
        return []
    nearest = nearest_points(trial)
    length = DASH * trial.robot.reach
    steps = np.linalg.norm(np.diff(nearest, axis=0), axis=1)
    # Samples move back and forth along the path with every stroke: only progress counts.
    progress = np.maximum.accumulate(trial.signals["along_track_distance"])
    advances = (np.diff(progress) > LEAST_PROGRESS) & (steps < length)
    is_on_line = np.append(True, advances)
    if np.count_nonzero(is_on_line) < 2:
        return []
    distance = progress[is_on_line]
    heights = _path_heights(trial, height)[is_on_line] - PATH_DEPTH * _half_height(trial)
    line = np.column_stack((nearest[is_on_line, :2], heights))
    starts = np.arange(distance[0], distance[-1], 2.0 * length)[:MOST_DASHES]
    begins = _points_along(distance, line, starts)
    ends = _points_along(distance, line, starts + length)
    return [Dash(begin, end) for begin, end in zip(begins, ends, strict=True)]


def _points_along(distance: np.ndarray, line: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the points at some distances along a line, whose points are at other distances [m]."""
    columns: list[np.ndarray] = [np.interp(places, distance, column) for column in line.T]
    return np.stack(columns, axis=1)


def _path_heights(trial: Trial, height: float) -> Float[np.ndarray, " n_samples"]:
    """Return the height of the path at the samples [m]: its own for a path in space, else the robot's mean height."""
    center = trial.center_of_mass
    if "height_error" in trial.signals:
        above_path = trial.signals["height_error"] * np.cos(trial.signals["path_climb"])
        return center[:, 2] - above_path
    is_spatial = center.shape[1] == 3
    if is_spatial:
        height = float(np.mean(center[:, 2]))
    return np.full(trial.time.size, height)
