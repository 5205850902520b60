"""What is around a robot in a picture: water with its depth above a tiled floor, or dry land, and the sun."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda.extras import load_mujoco
from laticauda.robot import Environment, Ground

SAMPLES = 4  # per pixel
TILE, PIXELS = 0.5, 128  # side of a tile of the floor [m], and of its picture
SURFACE = (0.75, 0.97, 1.0, 0.10)
SUN = (0.14, 0.10, -1.0)
SHADE = 0.42  # brightness of a shadow, to that of the ground
THIN, ABOVE = 2e-3, 3e-3  # what is left of a shape's height in its shadow, and how high that lies [-], [m]
CASTS_ON = np.array([1, 0, 0, 0, 0, 0], np.uint8)  # groups of the shapes on which shadows fall: the place's
WATERY = 2  # group of what they do not fall on
CLEAR = 0.5  # the fog of `Look` is that for a robot of 2 m; it grows with longer ones [1/m]
Color = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Look:
    """Colors and light of a place; by default of one under water."""

    floor: Color = (0.36, 0.55, 0.56)
    """Red, green and blue of the floor."""
    line: float = 0.76
    """Brightness of the grid's lines, to that of the floor [-]."""
    far: Color = (0.032, 0.235, 0.310)
    """What everything far away fades to."""
    above: Color = (0.30, 0.66, 0.70)
    """The color overhead."""
    fog: tuple[float, float] = (1.2, 8.0)
    """Where it begins to fade, and where it has faded [m]."""
    ambient: Color = (0.34, 0.40, 0.42)
    """Light from everywhere."""


WATER = Look()
LAND = Look(
    floor=(0.50, 0.47, 0.42),
    line=0.90,
    far=(0.80, 0.84, 0.87),
    above=(0.55, 0.70, 0.84),
    fog=(3.0, 14.0),
    ambient=(0.42, 0.42, 0.42),
)


def add_surroundings(model: Any, environment: Environment, *, floor: float, length: float, surface: bool) -> None:
    """Floor, light and all that is far away into a `MjSpec`.

    Args:
        model: With the robot in it.
        environment: Where it is.
        floor: Height of the floor [m].
        length: Of the robot, which everything has to fit [m].
        surface: Whether the surface of the water, at 0, is to be seen.
    """
    look = LAND if isinstance(environment, Ground) else WATER
    for bare in [*model.lights, *(texture for texture in model.textures if texture.name == "sky")]:
        model.delete(bare)  # a scene's own light is for other programs
    for geom in model.worldbody.geoms:
        if geom.name == "water":
            geom.rgba, geom.material = (0.0, 0.0, 0.0, 0.0), ""
    _add_light(model, look, length)
    _add_floor(model, look, floor)
    if surface:
        _add_plane(model, "surface", 0.0).rgba = SURFACE


def _add_light(model: Any, look: Look, length: float) -> None:
    """Sun, fog and background."""
    kind = load_mujoco()
    model.stat.extent = 1.0  # so that the lengths below are in meters
    visual = model.visual
    visual.map.fogstart, visual.map.fogend = (max(1.0, CLEAR * length) * distance for distance in look.fog)
    visual.map.znear, visual.map.zfar = 0.02 * length, 30.0 * max(length, 2.0)
    visual.rgba.fog = (*look.far, 1.0)
    visual.quality.offsamples, visual.quality.shadowsize = SAMPLES, 0
    visual.headlight.ambient = look.ambient
    visual.headlight.diffuse = (0.20, 0.24, 0.24)
    visual.headlight.specular = (0.06, 0.06, 0.06)
    gradient = {"builtin": kind.mjtBuiltin.mjBUILTIN_GRADIENT, "rgb1": look.above, "rgb2": look.far}
    model.add_texture(name="far", type=kind.mjtTexture.mjTEXTURE_SKYBOX, width=256, height=256, **gradient)
    sun = model.worldbody.add_light(name="sun", type=kind.mjtLightType.mjLIGHT_DIRECTIONAL, dir=SUN)
    sun.diffuse, sun.specular = (0.80, 0.88, 0.86), (0.45, 0.50, 0.50)


def _add_floor(model: Any, look: Look, height: float) -> None:
    """A tiled plane without end; on land it is the one that the robot lies on."""
    kind = load_mujoco()
    flat = {"builtin": kind.mjtBuiltin.mjBUILTIN_FLAT, "mark": kind.mjtMark.mjMARK_EDGE}
    picture = {"type": kind.mjtTexture.mjTEXTURE_2D, "width": PIXELS, "height": PIXELS}
    model.add_texture(name="floor", rgb1=(1.0, 1.0, 1.0), markrgb=[look.line] * 3, **flat, **picture)
    material = model.add_material(name="floor", texuniform=True, texrepeat=(1.0 / TILE, 1.0 / TILE), specular=0.0)
    material.rgba, material.textures[kind.mjtTextureRole.mjTEXROLE_RGB] = (*look.floor, 1.0), "floor"
    found = [geom for geom in model.geoms if geom.name in ("ground", "floor")]
    for plane in found or [_add_plane(model, "floor", height)]:
        plane.material = "floor"


def _add_plane(model: Any, name: str, height: float) -> Any:
    return model.worldbody.add_geom(
        name=name,
        type=load_mujoco().mjtGeom.mjGEOM_PLANE,
        size=(0.0, 0.0, 1.0),
        pos=(0.0, 0.0, height),
        contype=0,
        conaffinity=0,
    )


def draw_shadows(scene: Any, model: Any, data: Any) -> None:
    """Draw what the sun's light makes of everything that moves: its shape, flattened onto what is beneath it.

    A shadow map would cost more than all else in software, and has ragged edges.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        model: Its `MjModel`.
        data: Its `MjData`.
    """
    mujoco, shapes = load_mujoco(), scene.geoms
    grounds: dict[int, Any] = {}
    kinds = mujoco.mjtObj.mjOBJ_GEOM
    for shape in shapes[: scene.ngeom]:
        body = int(model.geom_bodyid[shape.objid]) if shape.objtype == kinds else 0
        if body == 0 or scene.ngeom >= scene.maxgeom:
            continue
        if body not in grounds:
            grounds[body] = _ground_below(model, data, body)
        if grounds[body] is None:
            continue
        flat, shift, color = grounds[body]
        shadow = shapes[scene.ngeom]
        mat, pos = flat @ shape.mat, flat @ shape.pos + shift
        mujoco.mjv_initGeom(shadow, shape.type, np.zeros(3), pos, mat.ravel(), color)
        shadow.size, shadow.dataid, shadow.specular = shape.size, shape.dataid, 0.0
        scene.ngeom += 1


def _ground_below(model: Any, data: Any, body: int) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """How the shadow of a body falls: what flattens a place, what shifts it then, and its color; None: on nothing."""
    geom, normal = np.zeros((1, 1), np.int32), np.zeros((3, 1))
    sun, middle = np.array(SUN), data.xipos[body]
    distance = load_mujoco().mj_ray(model, data, middle, sun, CASTS_ON, True, body, geom, normal)
    n, k = normal[:, 0], int(geom.item())
    if distance < 0.0 or n @ sun > -0.2:
        return None
    along = sun / (n @ sun)
    flat = np.eye(3) - (1.0 - THIN) * np.outer(along, n)
    height = n @ (middle + distance * sun)
    rgba = model.mat_rgba[model.geom_matid[k]] if model.geom_matid[k] >= 0 else model.geom_rgba[k]
    color = np.array([*(SHADE * rgba[:3]), 1.0], np.float32)
    return flat, (1.0 - THIN) * height * along + ABOVE * n, color
