"""Solid objects in a MuJoCo model: geoms that a robot can touch, with their colors."""

from typing import Any

from laticauda.models.spatial.bodies import Three
from laticauda.models.spatial.mounts import Quaternion
from laticauda.values import load_mujoco

Color = tuple[float, float, float, float]

COLORS: dict[str, Color] = {
    "water": (0.30, 0.65, 0.75, 0.22),
    "wall": (0.80, 0.88, 0.90, 0.25),
    "peg": (0.85, 0.78, 0.35, 1.0),
}
"""Red, green, blue and opacity of a geom, by prefix of its name [-]."""
SAND: Color = (0.66, 0.60, 0.48, 1.0)
"""Color of all other geoms [-]."""


def add_solid(
    parent: Any,
    *,
    name: str,
    kind: str,
    size: Three,
    position: Three = (0.0, 0.0, 0.0),
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0),
) -> Any:
    """Add a geom that the robot can touch, and return it.

    Args:
        parent: A `mujoco.MjSpec`, or a body of one.
        name: Its name in messages and pictures.
        kind: Its type in MuJoCo, such as BOX or PLANE.
        size: Its size as defined by MuJoCo [m].
        position: Position of its center [m].
        orientation: Its orientation, as a quaternion [-].
    """
    body = getattr(parent, "worldbody", parent)
    prefix = name.partition("_")[0]
    return body.add_geom(
        name=name,
        type=getattr(load_mujoco().mjtGeom, f"mjGEOM_{kind}"),
        size=size,
        pos=position,
        quat=orientation,
        rgba=COLORS.get(prefix, SAND),
        contype=0,
        conaffinity=1,
    )
