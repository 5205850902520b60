"""How the surroundings of a robot are added to its MuJoCo model, and what is checked with them.

A scene (`laticauda.robot.Scene`) edits the model. The robot touches its objects through MuJoCo's
contacts. Only the ground acts on the robot's elements instead (`laticauda.water.mujoco.ground`)
where a `Ground`, that of the scene or the environment, defines the friction along and across the
robot. The ground of a scene consists of its geoms with the names in `GROUNDS`.
"""

from collections.abc import Collection, Generator
from contextlib import contextmanager
from typing import Any

from laticauda.models.spatial.scene import TANK_LENGTH, TANK_WIDTH, Tank
from laticauda.models.spatial.solids import add_solid
from laticauda.robot import Environment, Ground, Scene
from laticauda.values import BadArgument, load_mujoco

GROUNDS = ("ground", "shore", "ramp", "floor", "terrain")
"""Names of the geoms that are ground."""
SURFACE = "water"
"""Name of the water's surface, which is visual only."""
DEEPEST = 2e-3
"""Maximum initial penetration of a robot [m]."""


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
        yield
    except ValueError as error:
        message = " ".join(str(error).removeprefix("Error: ").split())
        rule = f"must compile in MuJoCo together with the robot; MuJoCo says: {message}"
        raise BadArgument("scene", rule) from error


def check_free(model: Any, data: Any, robots: Collection[int]) -> None:
    """Reject a start at which a robot is inside another object.

    Args:
        model: A `mujoco.MjModel` with a scene.
        data: A `mujoco.MjData` at the start, with computed kinematics.
        robots: IDs of the robots' bodies.
    """
    load_mujoco().mj_collision(model, data)
    for contact in data.contact[: data.ncon]:
        geoms = [int(geom) for geom in contact.geom]
        of_robots = [geom for geom in geoms if int(model.geom_bodyid[geom]) in robots]
        if not of_robots or contact.dist >= -DEEPEST:
            continue
        touching = of_robots[0]
        geoms.remove(touching)
        touched = geoms[0]
        part = model.geom(touching).name.removesuffix("_hull")
        depth = f"{part} is {-1e3 * contact.dist:.0f} mm deep in it"
        name = _name_of_object(model, touched)
        rule = f"must not put the robot into `{name}` of the scene, but {depth}"
        raise BadArgument("start", rule)


def _name_of_object(model: Any, geom: int) -> str:
    """Return the name of a geom, or that of its body."""
    name = model.geom(geom).name
    if name:
        return name
    return model.body(int(model.geom_bodyid[geom])).name
