"""MuJoCo's renderer without a screen."""

import os
import platform
from importlib import import_module
from typing import Any

from laticauda.values import MissingProgram, load_mujoco, optional_import

PACKAGES = "libegl1 libegl-mesa0 libgl1-mesa-dri libopengl0"
"""Debian's packages with EGL and a driver."""
MOST_SHAPES = 4000
"""Largest number of shapes in a picture."""


def check_offscreen() -> None:
    """Check that rendering is possible here; raises the same errors as `create_renderer`."""
    empty_model = load_mujoco().MjSpec().compile()
    create_renderer(empty_model).close()


def create_renderer(model: Any) -> Any:
    """Return MuJoCo's renderer of a model, as large as its off-screen buffer.

    If the environment variable `MUJOCO_GL` is not set, it draws with EGL on Linux, which needs no
    screen; MuJoCo's own choice, made when it was imported, may need one.

    Args:
        model: A `MjModel`.

    Raises:
        MissingExtra: If MuJoCo or PyOpenGL is not installed.
        MissingProgram: If the system has no EGL.
    """
    load_mujoco()
    optional_import("Rendering", "PyOpenGL", "spatial", "OpenGL")
    try:
        return _create_with_chosen_context(model)
    except Exception as error:
        # Depending on what is missing, PyOpenGL raises an AttributeError, an ImportError or an
        # error of its own.
        raise MissingProgram(
            "Rendering without a screen", "EGL with a driver (Mesa's will do)", PACKAGES
        ) from error


def _create_with_chosen_context(model: Any) -> Any:
    renderer_class = load_mujoco().Renderer
    contexts = import_module(renderer_class.__module__).gl_context
    context_of_mujoco = contexts.GLContext
    if platform.system() == "Linux" and not os.environ.get("MUJOCO_GL"):
        contexts.GLContext = import_module("mujoco.egl").GLContext
    try:
        size = model.vis.global_
        return renderer_class(model, size.offheight, size.offwidth, MOST_SHAPES)
    finally:
        contexts.GLContext = context_of_mujoco
