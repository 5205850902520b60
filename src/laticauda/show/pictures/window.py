"""MuJoCo's own window, in which a trial is replayed without a new simulation."""

import os
import platform
import time
import warnings
from importlib import import_module
from typing import Any

from laticauda.show.pictures.camera import Film, aim_at_trial
from laticauda.show.pictures.posture import Posture, interpolate_posture
from laticauda.show.pictures.stage import Studio
from laticauda.trials import Trial
from laticauda.values import LaticaudaError, check_positive, load_mujoco

PICTURES_PER_SECOND = 60.0
"""[1/s]."""
INSTEAD = "write a film with `--video FILE.mp4` or a picture with `--still FILE.png` instead"


class NoWindow(LaticaudaError, RuntimeError):
    """A window cannot be opened here; the message says why, and what to do instead."""


def show_in_window(trial: Trial, *, speed: float = 1.0) -> None:
    """Open MuJoCo's window and replay a trial in it repeatedly until it is closed.

    Args:
        trial: Any trial, simulated or real.
        speed: Playback speed; 2 is twice as fast [-].

    Raises:
        NoWindow: If there is no screen.
        MissingExtra: If MuJoCo is not installed.
    """
    check_positive("speed", speed)
    load_mujoco()
    _check_screen()
    studio = Studio.of_trial(trial)
    opened_at = time.monotonic()
    begin = float(trial.time[0])
    studio.take(interpolate_posture(trial, begin, studio.height))
    viewer = import_module("mujoco.viewer")
    with viewer.launch_passive(
        studio.model, studio.data, show_left_ui=False, show_right_ui=False
    ) as window:
        with window.lock():
            _place_camera(window.cam, trial, studio)
        while window.is_running():
            elapsed = (time.monotonic() - opened_at) * speed
            shown = elapsed % max(float(trial.time[-1]) - begin, 1e-9)
            posture = interpolate_posture(trial, begin + shown, studio.height)
            _update_window(window, studio, posture)
            time.sleep(1.0 / PICTURES_PER_SECOND)


def _check_screen() -> None:
    """Raise an error if there is no screen, or none that can be used."""
    has_display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if platform.system() == "Linux" and not has_display:
        raise NoWindow(f"A window needs a screen, but there is none here; {INSTEAD}.")
    glfw: Any = import_module("glfw")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exception below reports it
        if not glfw.init():
            raise NoWindow(
                f"A window needs a screen, but the one that is set here cannot be used; {INSTEAD}."
            )


def _place_camera(camera: Any, trial: Trial, studio: Studio) -> None:
    """Let the window's camera follow the robot; it starts as in a film, and the mouse moves it."""
    camera.type = load_mujoco().mjtCamera.mjCAMERA_TRACKING
    camera.trackbodyid = studio.model.body("module_0").id
    first = aim_at_trial(trial, float(trial.time[0]), studio.height, Film())
    camera.lookat = first.lookat
    camera.distance = first.distance
    camera.azimuth = first.azimuth
    camera.elevation = first.elevation


def _update_window(window: Any, studio: Studio, posture: Posture) -> None:
    with window.lock():
        changed_mesh = studio.take(posture)
        window.user_scn.ngeom = 0
        studio.water.draw(window.user_scn, posture.center_of_mass, posture.time)
    if changed_mesh is not None:
        window.update_mesh(changed_mesh)
    window.sync()
