"""The 3D robot of a trial in its water, moved through the trial's postures without a new simulation.

Lines show the trail of the center of mass, and the path that the run followed.
"""

import math
import os
import platform
import time
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.robot import kinematics
from laticauda.scenarios import interfaces
from laticauda.show.pictures.camera import Film, aim_at_trial
from laticauda.show.pictures.stage import Posture, Studio, flat_posture
from laticauda.show.pictures.surroundings import add_piece
from laticauda.trials import Trial, hermite, nearest_points
from laticauda.values import LaticaudaError, check_positive, load_mujoco

PICTURES_PER_SECOND, MOMENTS = (
    60.0,
    12,
)  # MOMENTS: number of times at which moving water is sampled for its speed
INSTEAD = "write a film with `--video FILE.mp4` or a picture with `--still FILE.png` instead"


def studio_of(trial: Trial, **options: Any) -> Studio:
    """Return the studio that shows a trial.

    Args:
        trial: Any trial, simulated or real.
        options: Further arguments of `Studio`.
    """
    place, times = trial.center_of_mass, trial.time[:: max(trial.time.size // MOMENTS, 1)].tolist()
    way = np.array((place.min(axis=0), place.max(axis=0)))
    return Studio(
        trial.robot, trial.environment, trial.scenario.model, way=way, times=times, **options
    )


def posture_at(trial: Trial, time: float, height: float) -> Posture:
    """Return the robot's posture, smoothly interpolated between samples.

    Args:
        trial: Any trial, planar or spatial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].

    Raises:
        ValueError: If a measured trial does not contain how the robot was bent.
    """
    trial.need("a picture of the robot", "joint_angle", "heading")
    before = int(
        np.clip(np.searchsorted(trial.time, time, side="right") - 1, 0, max(trial.time.size - 2, 0))
    )
    after = min(before + 1, trial.time.size - 1)
    step = float(trial.time[after] - trial.time[before])
    share = float(np.clip((time - trial.time[before]) / step, 0.0, 1.0)) if step > 0.0 else 0.0

    def cubic(values: np.ndarray, rates: np.ndarray) -> np.ndarray:
        pairs = [(np.atleast_1d(one[before]), np.atleast_1d(one[after])) for one in (values, rates)]
        return hermite(share, step, pairs[0], pairs[1])

    center = cubic(trial.center_of_mass, trial.center_of_mass_velocity)
    joint_angle = cubic(trial.joint_angle, trial.joint_rate)
    fin_angle = cubic(trial.fin_angle, trial.fin_rate)
    if center.size == 3 and all(name in trial.signals for name in interfaces.ORIENTATION):
        first, second = (
            np.array([trial.signals[name][k] for name in interfaces.ORIENTATION])
            for k in (before, after)
        )
        mixed = (1.0 - share) * first + share * (second if first @ second >= 0.0 else -second)
        return Posture(center, mixed / np.linalg.norm(mixed), joint_angle, fin_angle, time)
    if center.size == 3:
        tail = (1.0 - share) * trial.link_angle[before, 0] + share * trial.link_angle[after, 0]
    else:
        tail = kinematics.link_angles(
            joint_angle, angle=float(cubic(trial.heading, trial.heading_rate)[0])
        )[0]
    return flat_posture(trial.robot, center, tail, joint_angle, fin_angle, height)._replace(
        time=time
    )


# ---- in MuJoCo's own window ----------------------------------------------------------------------


class NoWindow(LaticaudaError, RuntimeError):
    """A window cannot be opened here; the message says why, and what to do instead."""


def show(trial: Trial, *, speed: float = 1.0) -> None:
    """Open MuJoCo's window and replay a trial in it repeatedly until it is closed.

    Args:
        trial: Any trial, simulated or real.
        speed: Playback speed; 2 is twice as fast [-].

    Raises:
        NoWindow: If there is no screen.
        MissingExtra: If MuJoCo is not installed.
    """
    speed = check_positive("speed", speed)
    load_mujoco()
    if platform.system() == "Linux" and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        raise NoWindow(f"A window needs a screen, but there is none here; {INSTEAD}.")
    glfw: Any = import_module("glfw")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exceptions below report it
        if not glfw.init():
            raise NoWindow(
                f"A window needs a screen, but the one that is set here cannot be used; {INSTEAD}."
            )
    stage = studio_of(trial)
    began = time.monotonic()
    stage.take(posture_at(trial, float(trial.time[0]), stage.height))
    with import_module("mujoco.viewer").launch_passive(
        stage.model, stage.data, show_left_ui=False, show_right_ui=False
    ) as window:
        with window.lock():
            window.cam.type = (
                load_mujoco().mjtCamera.mjCAMERA_TRACKING
            )  # starts as in a film; the mouse moves it
            window.cam.trackbodyid = stage.model.body("module_0").id
            first = aim_at_trial(trial, float(trial.time[0]), stage.height, Film())
            for name in ("lookat", "distance", "azimuth", "elevation"):
                setattr(window.cam, name, getattr(first, name))
        while window.is_running():
            shown = (time.monotonic() - began) * speed % max(trial.duration, 1e-9)
            posture = posture_at(trial, float(trial.time[0]) + shown, stage.height)
            with window.lock():
                surface, window.user_scn.ngeom = stage.take(posture), 0
                stage.water.draw(window.user_scn, posture.center_of_mass, posture.time)
            if surface is not None:
                window.update_mesh(surface)
            window.sync()
            time.sleep(1.0 / PICTURES_PER_SECOND)


# ---- lines ---------------------------------------------------------------------------------------

TRAIL_STEP, TRAIL_PIECES, OVER = (
    0.2,
    400,
    1.3,
)  # [s], [-], height above the axis in half heights of the body
TRAIL_COLOR = np.array((1.0, 0.85, 0.40))
DASH, MOST_DASHES = 0.05, 1500  # in robot lengths, [-]
PATH_COLOR = np.array((0.92, 0.97, 0.98))
Points = Float[np.ndarray, "n_points n_axes"]
Dashes = list[tuple[np.ndarray, np.ndarray]]


def interpolate_centers(trial: Trial, moments: Sequence[float]) -> Points:
    """Return the center of mass at these times, in as many axes as the trial has [m]."""
    columns: list[np.ndarray] = [
        np.interp(moments, trial.time, column) for column in trial.center_of_mass.T
    ]
    return np.stack(columns, axis=1)


def trail_points(trial: Trial, time: float, height: float) -> Points:
    """Return points of the center of mass's path up to a time, the newest last [m].

    Args:
        trial: Any trial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].
    """
    first = max(math.ceil(trial.time[0] / TRAIL_STEP), math.floor(time / TRAIL_STEP) - TRAIL_PIECES)
    # Always at the same times; otherwise the corners of the line would move along it.
    moments = [*(k * TRAIL_STEP for k in range(first, math.floor(time / TRAIL_STEP) + 1)), time]
    points = np.full((len(moments), 3), height)
    points[:, : trial.center_of_mass.shape[1]] = interpolate_centers(trial, moments)
    return points


def draw_trail(scene: Any, trial: Trial, time: float, height: float, width: float) -> None:
    """Draw the trail in a scene, above the body, with older pieces darker.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        trial: Any trial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].
        width: Width of the line [pixels].
    """
    points = trail_points(trial, time, height)
    points[:, 2] += OVER * max(module.section.half_height for module in trial.robot.modules)
    bright = np.linspace(0.5, 1.0, len(points))[:, np.newaxis] * TRAIL_COLOR
    for one, other, color in zip(points[:-1], points[1:], bright, strict=False):
        add_piece(scene, one, other, width, color, "LINE")


def path_dashes(trial: Trial, height: float) -> Dashes:
    """Return the path that was followed as dashes below the body [m]; empty if there was no path."""
    if "cross_track_error" not in trial.signals or trial.time.size < 2:
        return []
    points, dash = nearest_points(trial), DASH * trial.robot.reach
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    # Samples move back and forth along the path with every stroke: only progress counts.
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
    """Return the height of the path at the samples [m]: its own for a path in space, else the robot's mean height."""
    if "height_error" in trial.signals:
        above = trial.signals["height_error"] * np.cos(trial.signals["path_climb"])
        return trial.center_of_mass[:, 2] - above
    planar = trial.center_of_mass.shape[1] == 2
    return np.full(
        trial.time.size, height if planar else float(np.mean(trial.center_of_mass[:, 2]))
    )


def draw_path(scene: Any, dashes: Dashes, width: float) -> None:
    """Draw the dashes from `path_dashes` in a scene, as lines `width` pixels wide."""
    for one, other in dashes:
        add_piece(scene, one, other, width, PATH_COLOR, "LINE")
