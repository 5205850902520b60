"""What is around a robot in a picture: water with its depth, a tiled floor with the net of light on it, the sun.

Or dry land in the same light, without the net.

The net of light is made by rays of the sun that a wavy surface bends, collected on the floor. The surface is a sum of
waves that fit a square tile, each with the speed that deep water gives it, so that the tile repeats without a seam; the
waves return to their beginning after `PERIOD`, so that a film needs no more pictures than that of it. A ray that enters
where the slope is (s_x, s_y) reaches the floor shifted by -F (s_x, s_y).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.extras import load_mujoco
from laticauda.robot import Environment, Ground

TILE, LINES = 1.5, 3  # side of the floor's repeating tile [m], and grid lines in it
SIZE = 240  # pixels of the tile
SURFACE, SURFACE_DARK = (0.75, 0.97, 1.0), 0.30  # color of ripples, and how bright it is between them
SURFACE_TILE, SURFACE_OPACITY = 2.3, 0.15  # [m], [-]
SUN = (0.14, 0.10, -1.0)
SHADOW = 0.65  # how far from the robot's middle there are shadows, in its lengths
CLEAR = 0.5  # the fog of `Look` is that for a robot of 2 m; it grows with longer ones [1/m]
# Of the net of light:
N_WAVES, SEED = 24, 4
SHORTEST, LONGEST = 7.5, 2.0  # waves per tile
FOCUS = 1.1  # F, in units that make neighboring rays just cross
PACE = 0.9  # radians per second and square root of waves per tile; a real tile of 2 m would have more
PERIOD, PER_SECOND = 10.0, 12  # [s], pictures
RAYS = 4  # per point of the floor, along either axis
Color = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Look:
    """Colors and light of a place; by default of one under water."""

    floor: Color = (0.36, 0.55, 0.56)
    """Red, green and blue of the floor."""
    line: float = 0.76
    """Brightness of the grid's lines, to that of the floor [-]."""
    even: float = 0.66
    """Light on the floor that is always there [-]."""
    focused: float = 0.90
    """Most light that waves focus on it [-]."""
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
    even=1.0,
    focused=0.0,
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
        geom.castshadow = False  # on itself it would only flicker
        if geom.name == "water":
            geom.rgba, geom.material = (0.0, 0.0, 0.0, 0.0), ""
    _add_light(model, look, length)
    _add_floor(model, look, floor)
    if surface:
        _add_picture(model, "surface", surface_picture(0.0), SURFACE_TILE)
        model.material("surface").rgba = (1.0, 1.0, 1.0, SURFACE_OPACITY)
        _add_plane(model, "surface", 0.0)


def pictures_of(environment: Environment) -> dict[str, Callable[[float], np.ndarray]]:
    """What the textures that change with time show then, by their names.

    Args:
        environment: Where the robot is.
    """
    if isinstance(environment, Ground):
        return {}
    return {"floor": lambda time: floor_picture(WATER, time), "surface": surface_picture}


def floor_picture(look: Look, time: float) -> np.ndarray:
    """The floor's tile: its color, its grid, and the light that falls on it at a time [s]."""
    shine = np.full((SIZE, SIZE), look.even)
    if look.focused > 0.0:
        shine += look.focused * (1.0 - np.exp(-0.4 * light(SIZE, time)))
    step = SIZE // LINES
    shine[::step] *= look.line
    shine[:, ::step] *= look.line
    color = np.array(look.floor) * shine[..., np.newaxis]
    return (255.0 * np.minimum(color, 1.0)).astype(np.uint8)


def surface_picture(time: float) -> np.ndarray:
    """The surface's tile, seen from above: ripples, of the same kind as the net of light, at another moment."""
    shine = SURFACE_DARK + (1.0 - SURFACE_DARK) * (1.0 - np.exp(-0.5 * light(SIZE, time + 0.4 * PERIOD)))
    return (255.0 * np.array(SURFACE) * shine[..., np.newaxis]).astype(np.uint8)


def _add_light(model: Any, look: Look, length: float) -> None:
    """Sun, fog and background."""
    kind = load_mujoco()
    model.stat.extent = 1.0  # so that the lengths below are in meters
    visual = model.visual
    visual.map.fogstart, visual.map.fogend = (max(1.0, CLEAR * length) * distance for distance in look.fog)
    visual.map.znear, visual.map.zfar = 0.02 * length, 30.0 * max(length, 2.0)
    visual.map.shadowclip = SHADOW * length
    visual.rgba.fog = (*look.far, 1.0)
    visual.quality.offsamples, visual.quality.shadowsize = 4, 2048
    visual.headlight.ambient = look.ambient
    visual.headlight.diffuse = (0.20, 0.24, 0.24)
    visual.headlight.specular = (0.06, 0.06, 0.06)
    gradient = {"builtin": kind.mjtBuiltin.mjBUILTIN_GRADIENT, "rgb1": look.above, "rgb2": look.far}
    model.add_texture(name="far", type=kind.mjtTexture.mjTEXTURE_SKYBOX, width=256, height=256, **gradient)
    sun = model.worldbody.add_light(name="sun", type=kind.mjtLightType.mjLIGHT_DIRECTIONAL, dir=SUN, castshadow=True)
    sun.diffuse, sun.specular = (0.80, 0.88, 0.86), (0.45, 0.50, 0.50)


def _add_floor(model: Any, look: Look, height: float) -> None:
    """A plane without end; on land it is the one that the robot lies on."""
    _add_picture(model, "floor", floor_picture(look, 0.0), TILE)
    found = [geom for geom in model.geoms if geom.name in ("ground", "floor")]
    for plane in found or [_add_plane(model, "floor", height)]:
        plane.material, plane.castshadow = "floor", False


def _add_picture(model: Any, name: str, pixels: np.ndarray, tile: float) -> None:
    """A material that repeats a picture every `tile` meters."""
    kind = load_mujoco()
    height, width, channels = pixels.shape
    texture = model.add_texture(name=name, type=kind.mjtTexture.mjTEXTURE_2D)
    texture.width, texture.height, texture.nchannel, texture.data = width, height, channels, pixels.tobytes()
    material = model.add_material(name=name, texuniform=True, texrepeat=(1.0 / tile, 1.0 / tile), specular=0.0)
    material.textures[kind.mjtTextureRole.mjTEXROLE_RGB] = name


def _add_plane(model: Any, material: str, height: float) -> Any:
    return model.worldbody.add_geom(
        name=material,
        type=load_mujoco().mjtGeom.mjGEOM_PLANE,
        size=(0.0, 0.0, 1.0),
        pos=(0.0, 0.0, height),
        material=material,
        contype=0,
        conaffinity=0,
        castshadow=False,
    )


# ---- the net of light ------------------------------------------------------------------------------------------------


def light(size: int, time: float) -> Float[np.ndarray, "size size"]:
    """How much light falls on each point of a tile of the floor, 1 on average [-].

    Args:
        size: Points along a side.
        time: [s]; the picture changes `PER_SECOND` times per second.
    """
    return _light(size, int(time * PER_SECOND) % int(PERIOD * PER_SECOND))


@lru_cache(maxsize=int(PERIOD * PER_SECOND))
def _light(size: int, picture: int) -> np.ndarray:
    rng = np.random.default_rng(SEED)
    many, direction = rng.uniform(LONGEST, SHORTEST, N_WAVES), rng.uniform(0.0, 2.0 * np.pi, N_WAVES)
    number = np.round(many * np.array([np.cos(direction), np.sin(direction)]))  # waves across the tile, along x and y
    length: Float[np.ndarray, " n"] = np.hypot(number[0], number[1])
    steepness = 1.0 / (np.maximum(length, 1.0) ** 2 * np.sqrt(N_WAVES))
    turns = np.round(PERIOD * PACE / (2.0 * np.pi) * np.sqrt(length))
    phase = rng.uniform(0.0, 2.0 * np.pi, N_WAVES) + 2.0 * np.pi * turns * picture / (PER_SECOND * PERIOD)
    place = 2.0 * np.pi * np.arange(RAYS * size) / (RAYS * size)
    along, across = np.exp(1j * (np.outer(place, number[0]) + phase)), np.exp(1j * np.outer(number[1], place))
    slope_x, slope_y = (np.imag((along * (steepness * one)) @ across) for one in number)
    column, row = (
        (x * size / (2.0 * np.pi)).astype(np.int64) % size
        for x in (place[:, np.newaxis] - FOCUS * slope_x + 2.0 * np.pi, place - FOCUS * slope_y + 2.0 * np.pi)
    )
    floor = np.bincount((row * size + column).ravel(), minlength=size * size).reshape(size, size) / RAYS**2
    for axis in (0, 1):  # the sun is no point
        floor = 0.5 * floor + 0.25 * (np.roll(floor, 1, axis) + np.roll(floor, -1, axis))
    return floor
