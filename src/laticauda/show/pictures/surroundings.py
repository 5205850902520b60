"""Surroundings of a robot in a picture: water with its depth above a tiled floor, or dry land, and the sun."""

from dataclasses import dataclass
from typing import Any

from laticauda.robot import Environment, Ground
from laticauda.show.pictures.looks import AIR, LAND, WATER, Color, Look, scale_fog
from laticauda.show.pictures.shadows import SUN
from laticauda.values import load_mujoco

SAMPLES = 4
"""Samples per pixel."""
TILE = 0.5
"""Side of a floor tile [m]."""
UNDER = 0.01
"""How far the floor is below a terrain's lowest place [m]."""
WHITE = (1.0, 1.0, 1.0)
INVISIBLE = (0.0, 0.0, 0.0, 0.0)
"""Red, green, blue and opacity of what is not shown."""
SURFACE_COLOR = (0.16, 0.45, 0.52)
"""Color of the water's surface."""
SURFACE_OPACITY = 0.32
"""Opacity of the water's surface, which is drawn twice [-]."""
WATER_GROUP = 2
"""MuJoCo's group of the shapes that receive no shadows."""


def add_surroundings(
    spec: Any,
    environment: Environment,
    *,
    floor: float,
    length: float,
    level: float | None,
    waves: str | None = None,
) -> None:
    """Add floor, light and background to a `MjSpec`.

    Args:
        spec: The `MjSpec` with the robot.
        environment: Environment of the robot.
        floor: Height of the floor [m].
        length: Length of the robot, to which the surroundings are scaled [m].
        level: Height of the water surface; None: not visible [m].
        waves: Mesh of the surface; None: it is level.
    """
    look = _choose_look(environment, level)
    _remove_bare_surroundings(spec)
    _add_light(spec, look, length)
    _add_background(spec, look)
    _add_floor(spec, look, floor)
    for material in spec.materials:
        if material.name == "sand":
            _add_texture(spec, material, SAND_FLECKS)
    if level is not None:
        _add_surface(spec, level, waves)


def _choose_look(environment: Environment, level: float | None) -> Look:
    if isinstance(environment, Ground):
        return LAND
    if level is None:
        return WATER
    return AIR


def _remove_bare_surroundings(spec: Any) -> None:
    """Remove lights, sky and water, which are in a scene for other programs."""
    skies = [texture for texture in spec.textures if texture.name == "sky"]
    for element in [*spec.lights, *skies]:
        spec.delete(element)
    for geom in spec.worldbody.geoms:
        if geom.name == "water":
            geom.rgba = INVISIBLE
            geom.material = ""


def _add_light(spec: Any, look: Look, length: float) -> None:
    """Add sun, fog and the quality of the pictures."""
    spec.stat.extent = 1.0  # so that the lengths below are in meters
    visual = spec.visual
    fog_scale = scale_fog(length)
    visual.map.fogstart = fog_scale * look.fog_begin
    visual.map.fogend = fog_scale * look.fog_end
    visual.map.znear = 0.02 * length
    visual.map.zfar = 30.0 * max(length, 2.0)
    visual.rgba.fog = (*look.far, 1.0)
    visual.quality.offsamples = SAMPLES
    visual.quality.shadowsize = 0
    visual.quality.numslices = 20
    visual.quality.numstacks = 10
    visual.headlight.ambient = look.ambient
    visual.headlight.diffuse = (0.20, 0.24, 0.24)
    visual.headlight.specular = (0.06, 0.06, 0.06)
    sun = spec.worldbody.add_light(
        name="sun", type=load_mujoco().mjtLightType.mjLIGHT_DIRECTIONAL, dir=SUN
    )
    sun.diffuse = (0.84, 0.86, 0.83)
    sun.specular = (0.45, 0.50, 0.50)


def _add_background(spec: Any, look: Look) -> None:
    """Add a background that fades from overhead to the distance."""
    mujoco = load_mujoco()
    spec.add_texture(
        name="far",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        width=256,
        height=256,
        rgb1=look.above,
        rgb2=look.far,
    )


def _add_floor(spec: Any, look: Look, height: float) -> None:
    """Add an infinite tiled plane beneath any terrain; on flat ground, tile the plane that the robot lies on."""
    material = spec.add_material(name="floor", specular=0.0, rgba=(*look.floor, 1.0))
    tiles = Pattern(mark=(look.line, look.line, look.line), repeat=1.0 / TILE)
    _add_texture(spec, material, tiles)
    flat_grounds = [geom for geom in spec.geoms if geom.name in ("ground", "floor")]
    if not flat_grounds:
        for geom in spec.geoms:
            if geom.name in ("shore", "terrain"):
                height = min(height, geom.pos[2] - UNDER)
        flat_grounds = [_add_plane(spec, "floor", height)]
    for plane in flat_grounds:
        plane.material = "floor"


def _add_surface(spec: Any, level: float, waves: str | None) -> None:
    """Add the surface of the water, level or with a mesh of waves."""
    material = spec.add_material(
        name="surface", specular=0.6, shininess=0.9, rgba=(*WHITE, SURFACE_OPACITY)
    )
    surface = _add_plane(spec, "surface", level)
    surface.material = "surface"
    surface.group = WATER_GROUP
    if waves is None:
        _add_texture(spec, material, GLINTS)
    else:
        _add_texture(spec, material, WAVE_LINES)
        surface.type = load_mujoco().mjtGeom.mjGEOM_MESH
        surface.meshname = waves


def _add_plane(spec: Any, name: str, height: float) -> Any:
    """Add an infinite plane that nothing collides with."""
    return spec.worldbody.add_geom(
        name=name,
        type=load_mujoco().mjtGeom.mjGEOM_PLANE,
        size=(0.0, 0.0, 1.0),
        pos=(0.0, 0.0, height),
        contype=0,
        conaffinity=0,
    )


# ---- patterns ------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """A pattern that makes a material visible: a grid, or flecks."""

    color: Color = WHITE
    """Factor on the material's own color [-]."""
    mark: Color
    """Factor on the color of the lines or the flecks [-]."""
    repeat: float
    """Repetitions of the pattern per length [1/m]."""
    flecks: float | None = None
    """Share of flecks in the material; None: a grid [-]."""


SAND_FLECKS = Pattern(mark=(0.93, 0.92, 0.91), repeat=0.7, flecks=0.25)
GLINTS = Pattern(color=SURFACE_COLOR, mark=WHITE, repeat=0.4, flecks=0.002)
"""A level surface glitters a little, so that it is visible."""
WAVE_LINES = Pattern(color=SURFACE_COLOR, mark=(0.55, 0.85, 0.9), repeat=2.0 / TILE)
"""Lines on a moving surface show its shape."""
GRID_PIXELS = 128
"""Side of the texture of a grid [pixels]."""
FLECK_PIXELS = 512
"""Side of the texture of flecks [pixels]."""


def _add_texture(spec: Any, material: Any, pattern: Pattern) -> None:
    """Add a pattern to one of the materials of a `MjSpec`."""
    mujoco = load_mujoco()
    pixels = GRID_PIXELS
    mark = mujoco.mjtMark.mjMARK_EDGE
    share = 0.0
    if pattern.flecks is not None:
        pixels = FLECK_PIXELS
        mark = mujoco.mjtMark.mjMARK_RANDOM
        share = pattern.flecks
    texture = spec.add_texture(
        name=material.name, type=mujoco.mjtTexture.mjTEXTURE_2D, width=pixels, height=pixels
    )
    texture.builtin = mujoco.mjtBuiltin.mjBUILTIN_FLAT
    texture.rgb1 = pattern.color
    texture.markrgb = pattern.mark
    texture.mark = mark
    texture.random = share
    material.texuniform = True
    material.texrepeat = (pattern.repeat, pattern.repeat)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = material.name
