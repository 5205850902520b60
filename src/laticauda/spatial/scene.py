"""Where the robot is: the tank of the experiments with its water, flat ground, or a ramp from a shore into water."""

import math
from typing import Any, Literal, NamedTuple

from laticauda.errors import BadArgument, one_of
from laticauda.extras import load_mujoco
from laticauda.robot import Environment, Ground
from laticauda.spatial.bodies import Three

# The tank at Trondheim in which the paper's robot swam [m].
TANK_LENGTH, TANK_WIDTH, TANK_DEPTH = 40.0, 6.45, 1.5
WALL = 0.1  # half thickness [m]
# The ramp: a shore a little above the water, then downhill along x to the depth of the tank [m], [rad].
SHORE_HEIGHT, SHORE_END, SHORE_LENGTH, SHORE_WIDTH, SLOPE = 0.10, 2.5, 12.0, 6.0, math.radians(12.0)
THICK = 0.2  # half thickness of the shore and the ramp [m]
SURFACE = "water"  # to be seen only
GROUNDS = ("flat", "ramp")
TOUCHED: dict[str, Any] = {"contype": 0, "conaffinity": 1}
UNTOUCHED: dict[str, Any] = {"contype": 0, "conaffinity": 0}
# Red, green, blue, opacity.
MATERIALS = {
    "water": (0.30, 0.65, 0.75, 0.22),
    "wall": (0.80, 0.88, 0.90, 0.25),
    "sand": (0.66, 0.60, 0.48, 1.0),
}


class _Solid(NamedTuple):
    """A part of the place."""

    name: str
    kind: str
    size: Three
    material: str
    pos: Three = (0.0, 0.0, 0.0)
    quat: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


def add(
    model: Any, environment: Environment, *, tank: bool, ground: Literal["flat", "ramp"] | None, visuals: bool
) -> None:
    """Put the place into a model; arguments as for `mjcf.spec`.

    Raises:
        ValueError: If there is no such ground, or a ramp is asked for without water or together with the tank.
    """
    if ground is not None:
        one_of("ground", ground, GROUNDS)
    if ground == "ramp" and (tank or isinstance(environment, Ground)):
        raise BadArgument("ground", "must not be `ramp` in the tank or without water: it leads down into open water")
    dressed = visuals and (tank or ground is not None)
    if dressed:
        _add_materials(model)
        _add_light(model)
    solids = _tank() if tank else []
    if ground == "ramp":
        solids = _ramp()
    elif ground == "flat" or isinstance(environment, Ground):
        solids.append(_Solid("ground", "PLANE", (0.0, 0.0, 1.0), "sand"))
    kinds = load_mujoco().mjtGeom
    for name, kind, size, material, pos, quat in solids:
        if name != SURFACE or dressed:
            touch = UNTOUCHED if name == SURFACE else TOUCHED
            shape = getattr(kinds, f"mjGEOM_{kind}")
            geom = model.worldbody.add_geom(name=name, type=shape, size=size, pos=pos, quat=quat, **touch)
            if dressed:
                geom.material = material


def _tank() -> list[_Solid]:
    """Floor and walls around the middle of the world, with the surface of the water at z = 0."""
    x, y, z = 0.5 * TANK_LENGTH, 0.5 * TANK_WIDTH, 0.5 * TANK_DEPTH
    return [
        _Solid("floor", "PLANE", (x, y, 1.0), "tiles", (0.0, 0.0, -TANK_DEPTH)),
        _Solid("wall_left", "BOX", (x, WALL, z), "wall", (0.0, y + WALL, -z)),
        _Solid("wall_right", "BOX", (x, WALL, z), "wall", (0.0, -y - WALL, -z)),
        _Solid("wall_front", "BOX", (WALL, y, z), "wall", (x + WALL, 0.0, -z)),
        _Solid("wall_back", "BOX", (WALL, y, z), "wall", (-x - WALL, 0.0, -z)),
        _Solid(SURFACE, "PLANE", (x, y, 1.0), "water"),
    ]


def _ramp() -> list[_Solid]:
    """A shore that ends at x = SHORE_END, a slope behind it, and the floor that it leads to."""
    length = (SHORE_HEIGHT + TANK_DEPTH) / math.sin(SLOPE)
    cos, sin = math.cos(SLOPE), math.sin(SLOPE)
    shore = (SHORE_END - 0.5 * SHORE_LENGTH, 0.0, SHORE_HEIGHT - THICK)
    # The middle of the slope's face, then half a thickness into the ground.
    middle = (SHORE_END + 0.5 * length * cos - THICK * sin, 0.0, SHORE_HEIGHT - 0.5 * length * sin - THICK * cos)
    downhill = (math.cos(0.5 * SLOPE), 0.0, math.sin(0.5 * SLOPE), 0.0)  # along x
    width = 0.5 * SHORE_WIDTH
    return [
        _Solid("shore", "BOX", (0.5 * SHORE_LENGTH, width, THICK), "sand", shore),
        _Solid("ramp", "BOX", (0.5 * length, width, THICK), "sand", middle, downhill),
        _Solid("floor", "PLANE", (0.0, 0.0, 1.0), "tiles", (0.0, 0.0, -TANK_DEPTH)),
        _Solid(SURFACE, "PLANE", (0.5 * TANK_LENGTH, 0.5 * TANK_LENGTH, 1.0), "water"),
    ]


def _add_materials(model: Any) -> None:
    kind = load_mujoco()
    for name, color in MATERIALS.items():
        model.add_material(name=name, rgba=color, specular=0.2)
    tiles = model.add_texture(name="tiles", type=kind.mjtTexture.mjTEXTURE_2D, width=128, height=128)
    tiles.builtin, tiles.mark = kind.mjtBuiltin.mjBUILTIN_FLAT, kind.mjtMark.mjMARK_EDGE
    tiles.rgb1, tiles.markrgb = (0.36, 0.58, 0.62), (0.26, 0.45, 0.50)
    material = model.add_material(name="tiles", texuniform=True, texrepeat=(2.0, 2.0), specular=0.1)
    material.textures[kind.mjtTextureRole.mjTEXROLE_RGB] = "tiles"


def _add_light(model: Any) -> None:
    """Light from above, and the color of what is far away."""
    kind = load_mujoco()
    sun = model.worldbody.add_light(name="sun", type=kind.mjtLightType.mjLIGHT_DIRECTIONAL, dir=(0.2, 0.3, -1.0))
    sun.pos, sun.castshadow = (0.0, 0.0, 4.0), False
    sky = model.add_texture(name="sky", type=kind.mjtTexture.mjTEXTURE_SKYBOX, width=128, height=128)
    sky.builtin, sky.rgb1, sky.rgb2 = kind.mjtBuiltin.mjBUILTIN_GRADIENT, (0.55, 0.75, 0.85), (0.10, 0.25, 0.32)
