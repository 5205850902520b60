"""Pictures of a MuJoCo model without a window: with EGL on Linux, which needs neither a screen nor a GPU."""

import os
import platform
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
from jaxtyping import UInt8

from laticauda.errors import MissingExtra, MissingProgram
from laticauda.extras import load_mujoco

PACKAGES = "libegl1 libegl-mesa0 libgl1-mesa-dri libopengl0"
MOST_SHAPES = 4000
Picture = UInt8[np.ndarray, "height width 3"]


class Offscreen:
    """What renders one model; a resource to be closed.

    `mujoco.Renderer` does without a screen only if a variable of the environment says so before MuJoCo is imported.

    Args:
        model: A `MjModel` whose off-screen buffer is as large as the pictures wanted.

    Raises:
        MissingExtra: If PyOpenGL is not installed.
        MissingProgram: If the system has no EGL.
    """

    def __init__(self, model: Any) -> None:
        mujoco = load_mujoco()
        self.model = model
        self.width, self.height = int(model.vis.global_.offwidth), int(model.vis.global_.offheight)
        self._scene, self._options = mujoco.MjvScene(model, MOST_SHAPES), mujoco.MjvOption()
        self._options.geomgroup[3] = 0  # shapes to collide with
        self._window = _window(self.width, self.height)
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)

    def picture(self, data: Any, camera: Any, decorate: Callable[[Any], None]) -> Picture:
        """What `camera` sees of the model in the state `data`.

        Args:
            data: A `MjData`.
            camera: A `MjvCamera`.
            decorate: Called with the `MjvScene` before it is drawn, to add what is in no model.
        """
        mujoco, pixels = load_mujoco(), np.empty((self.height, self.width, 3), dtype=np.uint8)
        category, whole = mujoco.mjtCatBit.mjCAT_ALL.value, mujoco.MjrRect(0, 0, self.width, self.height)
        mujoco.mjv_updateScene(self.model, data, self._options, None, camera, category, self._scene)
        decorate(self._scene)
        self._window.make_current()
        mujoco.mjr_render(whole, self._scene, self._context)
        mujoco.mjr_readPixels(pixels, None, whole, self._context)
        return pixels[::-1]

    def close(self) -> None:
        """Give back the graphics memory."""
        self._context.free()
        self._window.free()


def check_offscreen() -> None:
    """Refuse what cannot be rendered here; errors as for `Offscreen`."""
    load_mujoco()
    _window(16, 16).free()


def _window(width: int, height: int) -> Any:
    """A context of OpenGL that belongs to no screen; the variable `MUJOCO_GL` may name another kind of it."""
    on_egl = platform.system() == "Linux" and os.environ.get("MUJOCO_GL", "egl").lower() in ("", "egl")
    try:
        window = import_module("mujoco.egl" if on_egl else "mujoco.gl_context").GLContext(width, height)
        window.make_current()
        return window
    except ModuleNotFoundError as error:
        if error.name and error.name.startswith("OpenGL"):
            raise MissingExtra("Rendering", "PyOpenGL", "spatial") from error
        raise
    except Exception as error:
        # Depending on what is missing, PyOpenGL raises an AttributeError, an ImportError or an error of its own.
        raise MissingProgram("Rendering without a screen", "EGL with a driver (Mesa's will do)", PACKAGES) from error
