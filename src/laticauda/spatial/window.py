"""A trial in MuJoCo's own window, where there is a screen."""

import os
import platform
import time
from importlib import import_module
from typing import Any

from laticauda.errors import LaticaudaError, positive
from laticauda.spatial.door import engine
from laticauda.spatial.puppet import Puppet
from laticauda.trial import Trial

PICTURES_PER_SECOND = 60.0


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
    engine()
    if platform.system() == "Linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise NoWindow(f"A window needs a screen, and there is none here; {INSTEAD}.")
    try:
        viewer: Any = import_module("mujoco.viewer")
    except (ImportError, RuntimeError) as error:
        raise NoWindow(f"A window needs the package glfw; run `pip install glfw`, or {INSTEAD}.") from error
    puppet = Puppet(trial)
    with viewer.launch_passive(puppet.model, puppet.data) as window:
        began = time.monotonic()
        while window.is_running():
            shown = (time.monotonic() - began) * speed % max(trial.duration, 1e-9)
            with window.lock():
                puppet.take(float(trial.time[0]) + shown)
            window.sync()
            time.sleep(1.0 / PICTURES_PER_SECOND)
