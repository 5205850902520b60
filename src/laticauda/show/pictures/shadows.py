"""Shadows of the robot in the sun, each flattened onto what is beneath it.

In software rendering, a shadow map would cost more than everything else, and its edges are ragged.
"""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Int

from laticauda.models.spatial import HULL
from laticauda.values import load_mujoco

SUN = np.array((0.14, 0.10, -1.0))
"""Direction of the light."""
STEEPEST = -0.2
"""Ground has no shadow if its normal, multiplied by the direction of the light, exceeds this [-]."""
SHADE = 0.42
"""Brightness of a shadow relative to the ground."""
THIN = 2e-3
"""Share of a shape's height that is left in its shadow [-]."""
ABOVE = 3e-3
"""Height of a shadow above the ground [m]."""
RECEIVING_GROUPS = np.array([1, 0, 0, 0, 0, 0], np.uint8)
"""Which of MuJoCo's groups of shapes receive shadows: the first one, the surroundings."""


class Flattening(NamedTuple):
    """How a body's shadow is made of its shapes."""

    matrix: np.ndarray
    """Matrix that flattens orientations and positions onto the ground."""
    shift: np.ndarray
    """Shift that is added to flattened positions [m]."""
    color: np.ndarray
    """Red, green, blue and opacity of the shadow."""


def find_shadow_casters(model: Any) -> Int[np.ndarray, " n"]:
    """Return the shapes that cast shadows: the collision shapes of moving bodies, or visual ones if they have none.

    Args:
        model: A `MjModel`.
    """
    body = model.geom_bodyid
    group = model.geom_group
    is_moving = model.body_weldid[body] > 0
    is_hull = group == HULL
    is_box = model.geom_type == load_mujoco().mjtGeom.mjGEOM_BOX
    is_simple = np.array(is_hull | is_box)
    has_hull = np.isin(body, body[is_hull])
    is_visual = group < HULL
    return np.flatnonzero(is_moving & (is_simple | ~has_hull) & (is_simple | is_visual))


def draw_shadows(scene: Any, model: Any, data: Any, casters: Int[np.ndarray, " n"]) -> None:
    """Draw the shadows of shapes in the sun.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        model: Its `MjModel`.
        data: Its `MjData`.
        casters: The shapes that cast shadows.
    """
    bodies = set(model.geom_bodyid[casters].tolist())
    flattenings = {body: _flatten_onto_ground(model, data, body) for body in bodies}
    room = scene.maxgeom - scene.ngeom
    for caster in casters[:room]:
        flattening = flattenings[model.geom_bodyid[caster]]
        if flattening is not None:
            _add_shadow(scene, model, data, caster, flattening)


def _add_shadow(scene: Any, model: Any, data: Any, caster: Any, flattening: Flattening) -> None:
    orientation = flattening.matrix @ data.geom_xmat[caster].reshape(3, 3)
    position = flattening.matrix @ data.geom_xpos[caster] + flattening.shift
    shadow = scene.geoms[scene.ngeom]
    load_mujoco().mjv_initGeom(
        shadow,
        model.geom_type[caster],
        model.geom_size[caster],
        position,
        orientation.ravel(),
        flattening.color,
    )
    shadow.dataid = 2 * model.geom_dataid[caster]  # a mesh has two display lists
    shadow.specular = 0.0
    scene.ngeom += 1


def _flatten_onto_ground(model: Any, data: Any, body: int) -> Flattening | None:
    """Return how the shadow of a body is made; None if it falls on nothing."""
    middle = data.xipos[body]
    geom = np.zeros((1, 1), np.int32)
    normal = np.zeros((3, 1))
    distance = load_mujoco().mj_ray(
        model, data, middle, SUN, RECEIVING_GROUPS, True, body, geom, normal
    )
    n = normal[:, 0]
    if distance < 0.0 or n @ SUN > STEEPEST:
        return None
    along = SUN / (n @ SUN)
    matrix = np.eye(3) - (1.0 - THIN) * np.outer(along, n)
    height = n @ (middle + distance * SUN)
    shift = (1.0 - THIN) * height * along + ABOVE * n
    ground_color = _color_of(model, int(geom.item()))
    color = np.array([*(SHADE * ground_color[:3]), 1.0], np.float32)
    return Flattening(matrix, shift, color)


def _color_of(model: Any, geom: int) -> np.ndarray:
    """Return the color of a shape: that of its material, if it has one."""
    material = model.geom_matid[geom]
    if material >= 0:
        return model.mat_rgba[material]
    return model.geom_rgba[geom]
