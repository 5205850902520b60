"""How the surroundings of a robot are added to its MuJoCo model, and what is checked with them.

A scene (`laticauda.robot.Scene`) edits the model. The robot touches its objects through MuJoCo's
contacts. Only the ground acts on the robot's elements instead (`laticauda.water.mujoco.ground`)
where a `Ground`, that of the scene or the environment, defines the friction along and across the
robot. The ground of a scene consists of its geoms with the names in `GROUNDS`.
"""

import sys
import warnings
from collections.abc import Collection, Generator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

from laticauda.models.spatial.bodies import Three
from laticauda.models.spatial.scene import SCENE_PREFIX, TANK_LENGTH, TANK_WIDTH, Tank
from laticauda.models.spatial.solids import add_solid
from laticauda.robot import Environment, Ground, Scene, to_quaternion
from laticauda.sensing import Net, Place, Solid
from laticauda.values import BadArgument, load_mujoco

GEOM_OF_SOLID = {"box": "BOX", "cylinder": "CYLINDER", "sphere": "SPHERE"}
"""Geoms of MuJoCo by the kinds of solid shapes of places."""
GROUNDS = ("ground", "shore", "ramp", "floor", "terrain")
"""Names of the geoms that are ground."""
NET = (0.15, 0.22, 0.22, 0.4)
"""Color of nets, through which one sees."""
SURFACE = "water"
"""Name of the water's surface, which is visual only."""
EMPTY_PREFIX = "empty prefix"
"""What MuJoCo warns of when a file is attached with its own names."""
DEEPEST = 2e-3
"""Maximum initial penetration of a robot [m]."""


def is_ground(name: str) -> bool:
    """Return whether a geom of this name is ground, be it in a file whose names have a prefix."""
    return name.removeprefix(SCENE_PREFIX) in GROUNDS


def add_surroundings(
    model: Any, environment: Environment, scene: Scene | None, *, visuals: bool
) -> None:
    """Add the surroundings to a model that already has its robots; arguments as for `mjcf.build_spec`.

    Raises:
        ValueError: If the scene is incompatible with the environment, or MuJoCo rejects it.
    """
    is_on_land = isinstance(environment, Ground)
    if is_on_land and (scene is None or scene.terrain is None):
        add_solid(model, name="ground", kind="PLANE", size=(0.0, 0.0, 1.0))
    if scene is None:
        return
    scene.check(environment)
    with reporting_scene_errors():
        scene(model)
    if visuals and not is_on_land:
        _add_surface(model, scene)


def add_places(model: Any, places: Sequence[Place]) -> None:
    """Add the solid shapes of places to a model, with names that begin with those of the places.

    Args:
        model: A `mujoco.MjSpec`.
        places: The places.
    """
    for place in places:
        for k, solid in enumerate(place.solids()):
            geom = add_solid(
                model,
                name=f"{place.name}_{k}",
                kind=GEOM_OF_SOLID[solid.kind],
                size=_geom_size(solid),
                position=solid.center,
                orientation=to_quaternion(np.transpose(solid.axes)),
            )
            if isinstance(place, Net):
                geom.rgba = NET


def _geom_size(solid: Solid) -> Three:
    """Return the size of a shape as MuJoCo wants it."""
    if solid.kind == "cylinder":
        return (solid.size[0], solid.size[2], 0.0)
    return solid.size


def _add_surface(model: Any, scene: Scene) -> None:
    """Add the water's surface, which touches nothing."""
    width = TANK_LENGTH
    if isinstance(scene, Tank):
        width = TANK_WIDTH
    surface = add_solid(
        model,
        name=SURFACE,
        kind="PLANE",
        size=(0.5 * TANK_LENGTH, 0.5 * width, 1.0),
        position=(0.0, 0.0, scene.level),
    )
    surface.conaffinity = 0


@contextmanager
def reporting_scene_errors() -> Generator[None]:
    """Turn errors of MuJoCo within this context into errors about the scene; the robot alone causes none."""
    try:
        with _ignoring_empty_prefix():
            yield
    except ValueError as error:
        message = " ".join(str(error).removeprefix("Error: ").split())
        rule = f"must compile in MuJoCo together with the robot; MuJoCo says: {message}"
        raise BadArgument("scene", rule) from error


@contextmanager
def _ignoring_empty_prefix() -> Generator[None]:
    """Keep from the user MuJoCo's warning of a prefix that is empty, on both ways on which it comes."""
    mujoco = load_mujoco()
    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(_print_warning)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=f".*{EMPTY_PREFIX}")
            yield
    finally:
        mujoco.set_mju_user_warning(handler)


def _print_warning(message: str) -> None:
    """Print a warning of MuJoCo, unless it is that of an empty prefix."""
    if EMPTY_PREFIX not in message:
        sys.stderr.write(f"WARNING: {message}\n")


def check_free(model: Any, data: Any, robots: Collection[int]) -> None:
    """Reject a start at which a robot is inside another object.

    Args:
        model: A `mujoco.MjModel` with a scene.
        data: A `mujoco.MjData` at the start, with computed kinematics.
        robots: IDs of the robots' bodies.
    """
    mujoco = load_mujoco()
    mujoco.mj_flex(model, data)
    mujoco.mj_collision(model, data)
    for contact in data.contact[: data.ncon]:
        sides = [_side_of(model, contact, k) for k in range(2)]
        of_robots = [side for side in sides if side.body in robots]
        if not of_robots or contact.dist >= -DEEPEST:
            continue
        touching = of_robots[0]
        sides.remove(touching)
        part = touching.name.removesuffix("_hull")
        depth = f"{part} is {-1e3 * contact.dist:.0f} mm deep in it"
        rule = f"must not put the robot into `{sides[0].name}` of the scene, but {depth}"
        raise BadArgument("start", rule)


class _Side(NamedTuple):
    """One of the two objects that touch."""

    name: str
    """Name of the geom, of its body if it has none, or of the flex."""
    body: int
    """Number of the geom's body; a flex is on many: -1."""


def _side_of(model: Any, contact: Any, k: int) -> _Side:
    geom = int(contact.geom[k])
    if geom < 0:
        flex = int(contact.flex[k])
        mujoco = load_mujoco()
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_FLEX, flex)
        return _Side(name=name or f"flex {flex}", body=-1)
    return _Side(name=_name_of_object(model, geom), body=int(model.geom_bodyid[geom]))


def _name_of_object(model: Any, geom: int) -> str:
    """Return the name of a geom, or that of its body."""
    name = model.geom(geom).name
    if name:
        return name
    return model.body(int(model.geom_bodyid[geom])).name
