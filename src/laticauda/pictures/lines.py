"""Lines in a picture: the trail of the center of mass, and the path that a run followed."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.extras import load_mujoco
from laticauda.trial import Trial
from laticauda.trial.following import nearest_points

TRAIL_STEP, TRAIL_PIECES, OVER = 0.2, 400, 1.3  # [s], [-], how far above the axis, in half heights of the body
TRAIL_COLOR = np.array((1.0, 0.85, 0.40))
DASH, MOST_DASHES = 0.05, 1500  # in lengths of the robot, [-]
PATH_COLOR = np.array((0.92, 0.97, 0.98))
Points = Float[np.ndarray, "n_points n_axes"]
Dashes = list[tuple[np.ndarray, np.ndarray]]


def centers(trial: Trial, moments: Sequence[float]) -> Points:
    """Where the center of mass is at these times, in as many axes as the trial has [m]."""
    columns: list[np.ndarray] = [np.interp(moments, trial.time, column) for column in trial.center_of_mass.T]
    return np.stack(columns, axis=1)


def trail_points(trial: Trial, time: float, height: float) -> Points:
    """Points of the center of mass's way up to a time, the newest last [m].

    Args:
        trial: Any trial.
        time: Within the trial's time [s].
        height: At which a planar robot swims [m].
    """
    first = max(math.ceil(trial.time[0] / TRAIL_STEP), math.floor(time / TRAIL_STEP) - TRAIL_PIECES)
    # Always at the same moments, or the corners of the line would move along it.
    moments = [*(k * TRAIL_STEP for k in range(first, math.floor(time / TRAIL_STEP) + 1)), time]
    points = np.full((len(moments), 3), height)
    points[:, : trial.center_of_mass.shape[1]] = centers(trial, moments)
    return points


def draw_trail(scene: Any, trial: Trial, time: float, height: float, width: float) -> None:
    """Draw the trail into a scene, above the body, older pieces darker.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        trial: As for `trail_points`.
        time: The same [s].
        height: The same [m].
        width: Of the line [pixels].
    """
    points = trail_points(trial, time, height)
    points[:, 2] += OVER * max(module.section.half_height for module in trial.robot.modules)
    bright = np.linspace(0.5, 1.0, len(points))[:, np.newaxis] * TRAIL_COLOR
    for one, other, color in zip(points[:-1], points[1:], bright, strict=False):
        add_piece(scene, one, other, width, color, "LINE")


def path_dashes(trial: Trial, height: float) -> Dashes:
    """The path that was followed as dashes below the body [m]; none if there was no path."""
    if "cross_track_error" not in trial.signals or trial.time.size < 2:
        return []
    points, dash = nearest_points(trial), DASH * trial.robot.reach
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    # Samples go back and forth along the path with every stroke: only what is new counts.
    along = np.maximum.accumulate(trial.signals["along_track_distance"])
    keep = np.append(True, (np.diff(along) > 1e-6) & (steps < dash))
    if np.count_nonzero(keep) < 2:
        return []
    distance, line = along[keep], points[keep]
    under = 1.3 * max(module.section.half_height for module in trial.robot.modules)
    columns: list[np.ndarray] = [line[:, 0], line[:, 1], _path_heights(trial, height)[keep] - under]

    def at(place: float) -> np.ndarray:
        return np.array([np.interp(place, distance, column) for column in columns])

    starts = np.arange(distance[0], distance[-1], 2.0 * dash)
    return [(at(start), at(start + dash)) for start in starts[:MOST_DASHES]]


def _path_heights(trial: Trial, height: float) -> Float[np.ndarray, " n_samples"]:
    """Height of the path at the samples [m]: its own, if it leads through space; else that of the robot, all in all."""
    if "height_error" in trial.signals:
        above = trial.signals["height_error"] * np.cos(trial.signals["path_climb"])
        return trial.center_of_mass[:, 2] - above
    planar = trial.center_of_mass.shape[1] == 2
    return np.full(trial.time.size, height if planar else float(np.mean(trial.center_of_mass[:, 2])))


def draw_path(scene: Any, dashes: Dashes, width: float) -> None:
    """Draw what `path_dashes` gave into a scene, as lines of so many pixels."""
    for one, other in dashes:
        add_piece(scene, one, other, width, PATH_COLOR, "LINE")


def add_piece(scene: Any, one: np.ndarray, other: np.ndarray, width: float, color: np.ndarray, kind: str) -> None:
    """A piece of a `LINE` [pixels], or an `ARROW` [m], into a scene that is about to be drawn."""
    if scene.ngeom < scene.maxgeom:
        mujoco, geom, zero = load_mujoco(), scene.geoms[scene.ngeom], np.zeros(3)
        shape = getattr(mujoco.mjtGeom, f"mjGEOM_{kind}")
        mujoco.mjv_initGeom(geom, shape, zero, zero, np.zeros(9), np.append(color, 1.0).astype(np.float32))
        mujoco.mjv_connector(geom, shape, width, one, other)
        scene.ngeom += 1
