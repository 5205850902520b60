"""A trial in MuJoCo's own window, where there is a screen."""

import os
import platform
import time
import warnings
from importlib import import_module
from typing import Any

from laticauda.errors import LaticaudaError, positive
from laticauda.extras import load_mujoco
from laticauda.pictures.camera import aim, view
from laticauda.pictures.replay import Replay
from laticauda.trial import Trial

PICTURES_PER_SECOND = 60.0
ASPECT = 1.6  # of a usual window


class NoWindow(LaticaudaError, RuntimeError):
    """A window cannot be opened here: it says why, and what to do instead."""


INSTEAD = "write a film with `--video FILE.mp4` or a picture with `--still FILE.png` instead"


def show(trial: Trial, *, speed: float = 1.0) -> None:
    """Open MuJoCo's window and repeat a trial in it until it is closed.

    Args:
        trial: Any trial, simulated or real.
        speed: 2 shows it twice as fast [-].

    Raises:
        NoWindow: If there is no screen, or MuJoCo's viewer cannot be had.
        MissingExtra: If MuJoCo is not installed.
    """
    speed = positive("speed", speed)
    load_mujoco()
    if platform.system() == "Linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise NoWindow(f"A window needs a screen, and there is none here; {INSTEAD}.")
    viewer = _viewer()
    replay = Replay(trial)
    began = time.monotonic()
    replay.go_to(float(trial.time[0]))
    with viewer.launch_passive(replay.model, replay.data, show_left_ui=False, show_right_ui=False) as window:
        with window.lock():
            window.cam.type = load_mujoco().mjtCamera.mjCAMERA_TRACKING  # from where a film begins; the mouse moves it
            window.cam.trackbodyid = replay.model.body("module_0").id
            aim(window.cam, view(trial, float(trial.time[0]), replay.height, ASPECT))
        while window.is_running():
            shown = (time.monotonic() - began) * speed % max(trial.duration, 1e-9)
            with window.lock():
                replay.go_to(float(trial.time[0]) + shown)
            window.sync()
            time.sleep(1.0 / PICTURES_PER_SECOND)


def _viewer() -> Any:
    """The module `mujoco.viewer`, if it can open a window here; otherwise it would end the program."""
    try:
        glfw: Any = import_module("glfw")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what it complains about is said below
            works = glfw.init()
        if not works:
            raise NoWindow(f"A window needs a screen, and the one that is named here cannot be used; {INSTEAD}.")
        return import_module("mujoco.viewer")
    except ImportError as error:
        raise NoWindow(f"A window needs the package glfw; run `pip install glfw`, or {INSTEAD}.") from error
