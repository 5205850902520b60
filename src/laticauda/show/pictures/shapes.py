"""Lines and arrows that are added to a scene of MuJoCo's renderer."""

from typing import Any

import numpy as np

from laticauda.values import load_mujoco


def add_line(
    scene: Any, begin: np.ndarray, end: np.ndarray, *, width: float, color: np.ndarray
) -> None:
    """Add a piece of a line, if there is room for it.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        begin: Where it begins [m].
        end: Where it ends [m].
        width: Its width [pixels].
        color: Red, green and blue.
    """
    if scene.ngeom < scene.maxgeom:
        line = load_mujoco().mjtGeom.mjGEOM_LINE
        _add_connector(scene, line, begin, end, width=width, color=color)


def add_arrow(
    scene: Any, tail: np.ndarray, tip: np.ndarray, *, width: float, color: np.ndarray
) -> None:
    """Add an arrow, if there is room for it.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        tail: Where it begins [m].
        tip: Where it ends [m].
        width: Its width [m].
        color: Red, green and blue.
    """
    if scene.ngeom < scene.maxgeom:
        arrow = load_mujoco().mjtGeom.mjGEOM_ARROW
        _add_connector(scene, arrow, tail, tip, width=width, color=color)


def _add_connector(
    scene: Any,
    geom_type: Any,
    begin: np.ndarray,
    end: np.ndarray,
    *,
    width: float,
    color: np.ndarray,
) -> None:
    mujoco = load_mujoco()
    geom = scene.geoms[scene.ngeom]
    rgba = np.append(color, 1.0).astype(np.float32)
    # Size and pose come from the two ends.
    mujoco.mjv_initGeom(geom, geom_type, np.zeros(3), np.zeros(3), np.zeros(9), rgba)
    mujoco.mjv_connector(geom, geom_type, width, begin, end)
    scene.ngeom += 1
