"""The 3D robot of a trial in its water, moved through the trial's postures: nothing is simulated anew."""

import os
import platform
import time
import warnings
from importlib import import_module
from typing import Any

import numpy as np

from laticauda.errors import LaticaudaError, instance, positive
from laticauda.extras import load_mujoco
from laticauda.interfaces import ORIENTATION
from laticauda.kinematics import link_angles
from laticauda.pictures.camera import Film, view
from laticauda.pictures.stage import Posture, Studio, flat_posture
from laticauda.trial import Trial
from laticauda.trial.cycles import hermite

PICTURES_PER_SECOND, MOMENTS = 60.0, 12  # MOMENTS: in which moving water is looked at, to see how fast it is
INSTEAD = "write a film with `--video FILE.mp4` or a picture with `--still FILE.png` instead"


def studio_of(trial: Trial, **options: Any) -> Studio:
    """The place of a trial, as it is shown.

    Args:
        trial: Any trial, simulated or real.
        options: Of the studio.
    """
    instance("trial", trial, Trial)
    place, times = trial.center_of_mass, trial.time[:: max(trial.time.size // MOMENTS, 1)].tolist()
    way = np.array((place.min(axis=0), place.max(axis=0)))
    return Studio(trial.robot, trial.environment, trial.scenario.model, way=way, times=times, **options)


def posture_at(trial: Trial, time: float, height: float) -> Posture:
    """Where the robot is: between samples, smoothly.

    Args:
        trial: Any trial, planar or spatial.
        time: Within the trial's time [s].
        height: At which a planar robot swims [m].

    Raises:
        ValueError: If a measured trial does not say how the robot was bent.
    """
    trial.need("a picture of the robot", "joint_angle", "heading")
    before = int(np.clip(np.searchsorted(trial.time, time, side="right") - 1, 0, max(trial.time.size - 2, 0)))
    after = min(before + 1, trial.time.size - 1)
    step = float(trial.time[after] - trial.time[before])
    share = float(np.clip((time - trial.time[before]) / step, 0.0, 1.0)) if step > 0.0 else 0.0

    def cubic(values: np.ndarray, rates: np.ndarray) -> np.ndarray:
        pairs = [(np.atleast_1d(one[before]), np.atleast_1d(one[after])) for one in (values, rates)]
        return hermite(share, step, pairs[0], pairs[1])

    center = cubic(trial.center_of_mass, trial.center_of_mass_velocity)
    joint_angle = cubic(trial.joint_angle, trial.joint_rate)
    fin_angle = cubic(trial.fin_angle, trial.fin_rate)
    if center.size == 3 and all(name in trial.signals for name in ORIENTATION):
        first, second = (np.array([trial.signals[name][k] for name in ORIENTATION]) for k in (before, after))
        mixed = (1.0 - share) * first + share * (second if first @ second >= 0.0 else -second)
        return Posture(center, mixed / np.linalg.norm(mixed), joint_angle, fin_angle, time)
    if center.size == 3:
        tail = (1.0 - share) * trial.link_angle[before, 0] + share * trial.link_angle[after, 0]
    else:
        tail = link_angles(joint_angle, angle=float(cubic(trial.heading, trial.heading_rate)[0]))[0]
    return flat_posture(trial.robot, center, tail, joint_angle, fin_angle, height)._replace(time=time)


# ---- in MuJoCo's own window ----------------------------------------------------------------------------------------


class NoWindow(LaticaudaError, RuntimeError):
    """A window cannot be opened here: it says why, and what to do instead."""


def show(trial: Trial, *, speed: float = 1.0) -> None:
    """Open MuJoCo's window and repeat a trial in it until it is closed.

    Args:
        trial: Any trial, simulated or real.
        speed: 2 shows it twice as fast [-].

    Raises:
        NoWindow: If there is no screen.
        MissingExtra: If MuJoCo is not installed.
    """
    speed = positive("speed", speed)
    load_mujoco()
    if platform.system() == "Linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise NoWindow(f"A window needs a screen, and there is none here; {INSTEAD}.")
    glfw: Any = import_module("glfw")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what it complains about is said below
        if not glfw.init():
            raise NoWindow(f"A window needs a screen, and the one that is named here cannot be used; {INSTEAD}.")
    stage = studio_of(trial)
    began = time.monotonic()
    stage.take(posture_at(trial, float(trial.time[0]), stage.height))
    with import_module("mujoco.viewer").launch_passive(
        stage.model, stage.data, show_left_ui=False, show_right_ui=False
    ) as window:
        with window.lock():
            window.cam.type = load_mujoco().mjtCamera.mjCAMERA_TRACKING  # from where a film begins; the mouse moves it
            window.cam.trackbodyid = stage.model.body("module_0").id
            first = view(trial, float(trial.time[0]), stage.height, Film())
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
