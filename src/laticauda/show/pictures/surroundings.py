"""Surroundings of a robot in a picture: water with its depth above a tiled floor, or dry land, and the sun.

Moving water is shown as arrows around the robot, and a surface that rises and falls.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int

from laticauda.models.spatial import HULL
from laticauda.robot import Environment, Ground, Water
from laticauda.values import codec, load_mujoco, read_toml
from laticauda.water.fluid import Surface, arrows_of, grid_points, has_waves

SAMPLES = 4  # per pixel
TILE = 0.5  # side of a floor tile [m]
COARSE, FINE = 128, 512  # sides of the texture of a grid, and of that of flecks [pixels]
SURFACE, CLEARNESS = (0.16, 0.45, 0.52), 0.32  # of the water, whose surface is drawn twice
WHITE = (1.0, 1.0, 1.0)
LINES = (0.55, 0.85, 0.9)  # on a moving surface, which is also drawn twice
UNDER = 0.01  # how far the floor is below a terrain's lowest place [m]
GLINTS, GRAINS = (
    0.002,
    0.25,
)  # share of the surface that glitters, to make it visible, and of sand that is darker
SUN = np.array((0.14, 0.10, -1.0))
SHADE = 0.42  # brightness of a shadow relative to the ground
THIN, ABOVE = (
    2e-3,
    3e-3,
)  # share of a shape's height that is left in its shadow, and the height of the shadow [-], [m]
CASTS_ON = np.array(
    [1, 0, 0, 0, 0, 0], np.uint8
)  # groups of shapes that receive shadows: the surroundings
WATERY = 2  # group of shapes that receive none
CLEAR = (
    0.5  # the fog distances of `Look` hold for a robot of 2 m and increase for longer ones [1/m]
)
Color = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Look:
    """Colors and light of the surroundings; the defaults are those under water."""

    floor: Color = (0.36, 0.55, 0.56)
    """Red, green and blue of the floor."""
    line: float = 0.76
    """Brightness of the grid lines relative to the floor [-]."""
    far: Color = (0.032, 0.235, 0.310)
    """Color to which distant objects fade."""
    above: Color = (0.30, 0.66, 0.70)
    """Color overhead."""
    fog: tuple[float, float] = (1.2, 8.0)
    """Distances at which fading begins and ends [m]."""
    ambient: Color = (0.34, 0.40, 0.42)
    """Ambient light."""


WATER, AIR, LAND = (
    codec.decode(Look, one) for one in read_toml(Path(__file__).with_name("looks.toml")).values()
)


def add_surroundings(
    model: Any,
    environment: Environment,
    *,
    floor: float,
    length: float,
    level: float | None,
    waves: str | None = None,
) -> None:
    """Add floor, light and background to a `MjSpec`.

    Args:
        model: The `MjSpec` with the robot.
        environment: Environment of the robot.
        floor: Height of the floor [m].
        length: Length of the robot, to which the surroundings are scaled [m].
        level: Height of the water surface; None: not visible [m].
        waves: Mesh of the surface; None: it is level.
    """
    look = LAND if isinstance(environment, Ground) else WATER if level is None else AIR
    for bare in [*model.lights, *(texture for texture in model.textures if texture.name == "sky")]:
        model.delete(bare)  # a scene's own lights are for other programs
    for geom in model.worldbody.geoms:
        if geom.name == "water":
            geom.rgba, geom.material = (0.0, 0.0, 0.0, 0.0), ""
    _add_light(model, look, length)
    _add_floor(model, look, floor)
    for material in model.materials:
        if material.name == "sand":
            _mark(model, material, WHITE, (0.93, 0.92, 0.91), 0.7, flecks=GRAINS)
    if level is not None:
        clear = model.add_material(
            name="surface", specular=0.6, shininess=0.9, rgba=(*WHITE, CLEARNESS)
        )
        plane = _add_plane(model, "surface", level)
        plane.material, plane.group = "surface", WATERY
        if waves is None:
            _mark(model, clear, SURFACE, WHITE, 0.4, flecks=GLINTS)
        else:  # lines on it show its shape
            _mark(model, clear, SURFACE, LINES, 2.0 / TILE)
            plane.type, plane.meshname = load_mujoco().mjtGeom.mjGEOM_MESH, waves


def _add_light(model: Any, look: Look, length: float) -> None:
    """Add sun, fog and background."""
    kind = load_mujoco()
    model.stat.extent = 1.0  # so that the lengths below are in meters
    visual = model.visual
    visual.map.fogstart, visual.map.fogend = (
        max(1.0, CLEAR * length) * distance for distance in look.fog
    )
    visual.map.znear, visual.map.zfar = 0.02 * length, 30.0 * max(length, 2.0)
    visual.rgba.fog = (*look.far, 1.0)
    visual.quality.offsamples, visual.quality.shadowsize = SAMPLES, 0
    visual.quality.numslices, visual.quality.numstacks = 20, 10
    visual.headlight.ambient = look.ambient
    visual.headlight.diffuse = (0.20, 0.24, 0.24)
    visual.headlight.specular = (0.06, 0.06, 0.06)
    gradient = {"builtin": kind.mjtBuiltin.mjBUILTIN_GRADIENT, "rgb1": look.above, "rgb2": look.far}
    model.add_texture(
        name="far", type=kind.mjtTexture.mjTEXTURE_SKYBOX, width=256, height=256, **gradient
    )
    sun = model.worldbody.add_light(name="sun", type=kind.mjtLightType.mjLIGHT_DIRECTIONAL, dir=SUN)
    sun.diffuse, sun.specular = (0.84, 0.86, 0.83), (0.45, 0.50, 0.50)


def _add_floor(model: Any, look: Look, height: float) -> None:
    """Add an infinite tiled plane beneath any terrain; on flat ground, tile the plane that the robot lies on."""
    material = model.add_material(name="floor", specular=0.0, rgba=(*look.floor, 1.0))
    _mark(model, material, WHITE, (look.line, look.line, look.line), 1.0 / TILE)
    terrain = [geom.pos[2] - UNDER for geom in model.geoms if geom.name in ("shore", "terrain")]
    found = [geom for geom in model.geoms if geom.name in ("ground", "floor")]
    for plane in found or [_add_plane(model, "floor", min([height, *terrain]))]:
        plane.material = "floor"


def _mark(
    model: Any,
    material: Any,
    color: Color,
    mark: Color,
    repeat: float,
    *,
    flecks: float | None = None,
) -> None:
    """Add a pattern to a material to make it visible: a grid, or flecks.

    Args:
        model: A `MjSpec`.
        material: One of the model's materials.
        color: Factor on the material's own color [-].
        mark: Factor on the color of the lines or the flecks [-].
        repeat: Repetitions of the pattern per length [1/m].
        flecks: Share of flecks in the material; None: a grid [-].
    """
    kinds, name, size = load_mujoco(), material.name, COARSE if flecks is None else FINE
    texture = model.add_texture(
        name=name, type=kinds.mjtTexture.mjTEXTURE_2D, width=size, height=size
    )
    texture.builtin, texture.rgb1, texture.markrgb = kinds.mjtBuiltin.mjBUILTIN_FLAT, color, mark
    texture.mark = kinds.mjtMark.mjMARK_EDGE if flecks is None else kinds.mjtMark.mjMARK_RANDOM
    texture.random = flecks or 0.0
    material.texuniform, material.texrepeat = True, (repeat, repeat)
    material.textures[kinds.mjtTextureRole.mjTEXROLE_RGB] = name


def _add_plane(model: Any, name: str, height: float) -> Any:
    return model.worldbody.add_geom(
        name=name,
        type=load_mujoco().mjtGeom.mjGEOM_PLANE,
        size=(0.0, 0.0, 1.0),
        pos=(0.0, 0.0, height),
        contype=0,
        conaffinity=0,
    )


def shadow_casters(model: Any) -> Int[np.ndarray, " n"]:
    """Return the shapes that cast shadows: the collision shapes of moving bodies, or visual ones if they have none.

    Args:
        model: A `MjModel`.
    """
    body, group, box = model.geom_bodyid, model.geom_group, load_mujoco().mjtGeom.mjGEOM_BOX
    is_simple = np.array((group == HULL) | (model.geom_type == box))
    has_hull = np.isin(body, body[group == HULL])
    return np.flatnonzero(
        (model.body_weldid[body] > 0) & (is_simple | ~has_hull) & (is_simple | (group < HULL))
    )


def draw_shadows(scene: Any, model: Any, data: Any, casters: Int[np.ndarray, " n"]) -> None:
    """Draw the shadows of shapes in the sun, each flattened onto what is beneath it.

    In software rendering, a shadow map would cost more than everything else, and its edges are
    ragged.

    Args:
        scene: A `MjvScene` that is about to be drawn.
        model: Its `MjModel`.
        data: Its `MjData`.
        casters: The shapes that cast shadows.
    """
    shapes, bodies = scene.geoms, set(model.geom_bodyid[casters].tolist())
    grounds = {body: _ground_below(model, data, body) for body in bodies}
    for k in casters[: scene.maxgeom - scene.ngeom]:
        ground = grounds[model.geom_bodyid[k]]
        if ground is not None:
            flat, shift, color = ground
            mat, pos = flat @ data.geom_xmat[k].reshape(3, 3), flat @ data.geom_xpos[k] + shift
            shadow = shapes[scene.ngeom]
            load_mujoco().mjv_initGeom(
                shadow, model.geom_type[k], model.geom_size[k], pos, mat.ravel(), color
            )
            shadow.dataid, shadow.specular = (
                2 * model.geom_dataid[k],
                0.0,
            )  # of a mesh: each has two display lists
            scene.ngeom += 1


def _ground_below(
    model: Any, data: Any, body: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Return a body's shadow as a flattening matrix, a shift to add, and a color; None if it falls on nothing."""
    geom, normal = np.zeros((1, 1), np.int32), np.zeros((3, 1))
    middle = data.xipos[body]
    distance = load_mujoco().mj_ray(model, data, middle, SUN, CASTS_ON, True, body, geom, normal)
    n, k = normal[:, 0], int(geom.item())
    if distance < 0.0 or n @ SUN > -0.2:
        return None
    along = SUN / (n @ SUN)
    flat = np.eye(3) - (1.0 - THIN) * np.outer(along, n)
    height = n @ (middle + distance * SUN)
    rgba = model.mat_rgba[model.geom_matid[k]] if model.geom_matid[k] >= 0 else model.geom_rgba[k]
    color = np.array([*(SHADE * rgba[:3]), 1.0], np.float32)
    return flat, (1.0 - THIN) * height * along + ABOVE * n, color


def add_piece(
    scene: Any, one: np.ndarray, other: np.ndarray, width: float, color: np.ndarray, kind: str
) -> None:
    """Add a piece of a `LINE` [pixels], or an `ARROW` [m], to a scene that is about to be drawn."""
    if scene.ngeom < scene.maxgeom:
        mujoco, geom, zero = load_mujoco(), scene.geoms[scene.ngeom], np.zeros(3)
        shape = getattr(mujoco.mjtGeom, f"mjGEOM_{kind}")
        mujoco.mjv_initGeom(
            geom, shape, zero, zero, np.zeros(9), np.append(color, 1.0).astype(np.float32)
        )
        mujoco.mjv_connector(geom, shape, width, one, other)
        scene.ngeom += 1


# ---- water that moves ----------------------------------------------------------------------------

SHAFT = 0.004  # width of an arrow, in robot lengths
FAINT = 0.05  # length below which an arrow is omitted, relative to the spacing of arrows [-]
COLOR = np.array((0.80, 0.95, 1.0))
CORNERS = 81  # vertices of the surface along a side
NAME = "waves"


class MovingWater:
    """The water of a picture, which may be moving.

    Args:
        environment: Environment of the robot.
        length: Length of the robot [m].
        way: Two corners of the region in which it will be shown, in the plane or in space, world
            axes [m].
        times: Times at which it is shown [s].
    """

    def __init__(
        self, environment: Environment, length: float, way: np.ndarray, times: Sequence[float]
    ) -> None:
        self._length, self._arrows, flow = length, None, None
        if isinstance(environment, Water):
            flow = environment.flow
            self._arrows = arrows_of(environment.velocity, way[0], way[1], times, length, flow)
        self.words = [self._arrows.words] if self._arrows else []
        """Text about the arrows."""
        self.surface: Surface | None = None
        """The surface of the water if it moves, else None."""
        if flow is not None and has_waves(flow, way[0]):
            self.surface = Surface(flow, max(1.0, CLEAR * length) * AIR.fog[1], CORNERS)

    def mesh(self, model: Any) -> str | None:
        """Add the surface's mesh, shaped by `move`, to a `MjSpec`; return its name, or None if the surface is level."""
        if self.surface is None:
            return None
        # Upright and oblong at first, so that its principal axes, which MuJoCo adopts as its own,
        # are the world's.
        x, y = grid_points(self.surface.line, self.surface.line).T
        faces, inertia = self.surface.faces, load_mujoco().mjtMeshInertia.mjMESH_INERTIA_SHELL
        upright = np.column_stack((0.0 * x, x, 2.0 * y)).ravel()
        model.add_mesh(
            name=NAME, uservert=upright, userface=np.append(faces, faces[:, ::-1]), inertia=inertia
        )
        return NAME

    def move(self, model: Any, center: np.ndarray, t: float) -> int | None:
        """Move the surface of a model to its shape at time `t`.

        Args:
            model: A `MjModel` with that mesh.
            center: Position of the robot [m].
            t: Time since the start of the run [s].

        Returns:
            ID of the mesh that must be sent to the renderer, if any.
        """
        if self.surface is None:
            return None
        mesh, line, corners = model.mesh(NAME), self.surface.line, self.surface.at(center, t)
        slopes = np.gradient(corners[:, 2].reshape(CORNERS, CORNERS), line, line)
        normal = np.column_stack((-slopes[0].ravel(), -slopes[1].ravel(), np.ones(len(corners))))
        own = slice(mesh.vertadr[0], mesh.vertadr[0] + len(corners))
        model.mesh_vert[own], model.mesh_normal[own] = (
            corners,
            normal / np.linalg.norm(normal, axis=1, keepdims=True),
        )
        return int(mesh.id)

    def draw(self, scene: Any, center: np.ndarray, t: float) -> None:
        """Draw the arrows into a `MjvScene`; arguments as for `move`."""
        if self._arrows is None:
            return
        for tail, tip in self._arrows.around(center, t):
            if np.linalg.norm(tip - tail) > FAINT * self._arrows.spacing:
                add_piece(scene, tail, tip, SHAFT * self._length, COLOR, "ARROW")
