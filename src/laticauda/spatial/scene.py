"""Where the robot is: the tank of the experiments with its water, flat ground, or a ramp from a shore into water."""

import math
from typing import Any, Literal

from laticauda.errors import BadArgument, one_of
from laticauda.extras import load_mujoco
from laticauda.robot import Environment, Ground

# The tank at Trondheim in which the paper's robot swam [m].
TANK_LENGTH, TANK_WIDTH, TANK_DEPTH = 40.0, 6.45, 1.5
WALL = 0.1  # half thickness [m]
# The ramp: a shore a little above the water, then downhill along x to the depth of the tank [m], [rad].
SHORE_HEIGHT, SHORE_END, SHORE_LENGTH, SHORE_WIDTH, SLOPE = 0.10, 2.5, 12.0, 6.0, math.radians(12.0)
THICK = 0.2  # half thickness of the shore and the ramp [m]
GROUNDS = ("flat", "ramp")
TOUCHED: dict[str, Any] = {"contype": 0, "conaffinity": 1}
UNTOUCHED: dict[str, Any] = {"contype": 0, "conaffinity": 0}
# Red, green, blue, opacity.
MATERIALS = {
    "water": (0.30, 0.65, 0.75, 0.22),
    "wall": (0.80, 0.88, 0.90, 0.25),
    "sand": (0.66, 0.60, 0.48, 1.0),
}


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
    if tank:
        _add_tank(model, dressed=dressed)
    if ground == "ramp":
        _add_ramp(model, dressed=dressed)
    elif ground == "flat" or isinstance(environment, Ground):
        kind = load_mujoco().mjtGeom.mjGEOM_PLANE
        _dress(model.worldbody.add_geom(name="ground", type=kind, size=(0.0, 0.0, 1.0), **TOUCHED), "sand", dressed)


def _add_tank(model: Any, *, dressed: bool) -> None:
    """Floor and walls around the middle of the world, with the surface of the water at z = 0."""
    kind = load_mujoco().mjtGeom
    x, y, z = 0.5 * TANK_LENGTH, 0.5 * TANK_WIDTH, 0.5 * TANK_DEPTH
    floor = model.worldbody.add_geom(name="floor", type=kind.mjGEOM_PLANE, size=(x, y, 1.0), **TOUCHED)
    floor.pos = (0.0, 0.0, -TANK_DEPTH)
    _dress(floor, "tiles", dressed)
    for name, at, size in (
        ("wall_left", (0.0, y + WALL, -z), (x, WALL, z)),
        ("wall_right", (0.0, -y - WALL, -z), (x, WALL, z)),
        ("wall_front", (x + WALL, 0.0, -z), (WALL, y, z)),
        ("wall_back", (-x - WALL, 0.0, -z), (WALL, y, z)),
    ):
        wall = model.worldbody.add_geom(name=name, type=kind.mjGEOM_BOX, size=size, pos=at, **TOUCHED)
        _dress(wall, "wall", dressed)
    if dressed:
        _add_surface(model, x, y)


def _add_ramp(model: Any, *, dressed: bool) -> None:
    """A shore that ends at x = SHORE_END, a slope behind it, and the floor that it leads to."""
    kind = load_mujoco().mjtGeom
    drop = SHORE_HEIGHT + TANK_DEPTH
    length = drop / math.sin(SLOPE)
    cos, sin = math.cos(SLOPE), math.sin(SLOPE)
    # The middle of the slope's face, then half a thickness into the ground.
    middle = (SHORE_END + 0.5 * length * cos - THICK * sin, 0.0, SHORE_HEIGHT - 0.5 * length * sin - THICK * cos)
    half = 0.5 * SLOPE  # about y: downhill along x
    shore = model.worldbody.add_geom(
        name="shore",
        type=kind.mjGEOM_BOX,
        size=(0.5 * SHORE_LENGTH, 0.5 * SHORE_WIDTH, THICK),
        pos=(SHORE_END - 0.5 * SHORE_LENGTH, 0.0, SHORE_HEIGHT - THICK),
        **TOUCHED,
    )
    ramp = model.worldbody.add_geom(
        name="ramp",
        type=kind.mjGEOM_BOX,
        size=(0.5 * length, 0.5 * SHORE_WIDTH, THICK),
        pos=middle,
        quat=(math.cos(half), 0.0, math.sin(half), 0.0),
        **TOUCHED,
    )
    floor = model.worldbody.add_geom(name="floor", type=kind.mjGEOM_PLANE, size=(0.0, 0.0, 1.0), **TOUCHED)
    floor.pos = (0.0, 0.0, -TANK_DEPTH)
    for geom, material in ((shore, "sand"), (ramp, "sand"), (floor, "tiles")):
        _dress(geom, material, dressed)
    if dressed:
        _add_surface(model, 0.5 * TANK_LENGTH, 0.5 * TANK_LENGTH)


def _add_surface(model: Any, x: float, y: float) -> None:
    """The surface of the water, to be seen only."""
    plane = load_mujoco().mjtGeom.mjGEOM_PLANE
    model.worldbody.add_geom(name="water", type=plane, size=(x, y, 1.0), material="water", **UNTOUCHED)


def _dress(geom: Any, material: str, dressed: bool) -> None:
    if dressed:
        geom.material = material


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
