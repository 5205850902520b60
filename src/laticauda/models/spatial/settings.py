"""What the settings of the spatial model mean for a robot: its weight, its ground, its model and its elements."""

from typing import Any

from laticauda.models.spatial import mjcf, water_robot
from laticauda.models.spatial.ground_robot import lay_on_ground
from laticauda.models.spatial.surroundings import add_places, is_ground
from laticauda.robot import Environment, Ground, Robot
from laticauda.scenarios import Spatial
from laticauda.values import load_mujoco
from laticauda.water.mujoco import Element


def is_floating(setup: Spatial) -> bool:
    """Return whether `setup` has weight and buoyancy, and a root that they can move."""
    return setup.gravity and setup.root == "free"


def land_of(environment: Environment, setup: Spatial) -> Ground | None:
    """Return the ground on which the robot lies with its weight; None if there is none, or if it slides in the plane.

    Args:
        environment: The water it swims in, or the ground.
        setup: The model's settings.
    """
    scene = setup.surroundings
    ground_of_scene = None if scene is None else scene.ground
    if not isinstance(environment, Ground):
        return ground_of_scene
    if not is_floating(setup):
        return None
    if ground_of_scene is not None:
        return ground_of_scene
    return environment


def used_ballast_depth(setup: Spatial) -> float:
    """Return how far the modules' centers of mass lie below their axes [m]."""
    if is_floating(setup):
        return setup.ballast_depth
    return 0.0


def numbers_per_link(setup: Spatial) -> int:
    """Return how many numbers of every link a state holds: its angle and, in a scene, its contact force."""
    if setup.surroundings is None:
        return 1
    return 4


def build_plant_spec(
    robot: Robot, environment: Environment, setup: Spatial, *, sensors: bool = False
) -> Any:
    """Return the `mujoco.MjSpec` of a robot in its surroundings.

    Args:
        robot: The robot.
        environment: The water it swims in, or the ground.
        setup: The model's settings.
        sensors: Whether it has the sensors of the real robot.
    """
    mujoco = load_mujoco()
    spec = mjcf.build_spec(
        robot,
        environment,
        root=setup.root or "free",
        sensors=sensors,
        visuals=False,
        scene=setup.surroundings,
        ballast_depth=used_ballast_depth(setup),
    )
    add_places(spec, setup.places)
    if setup.surroundings is not None:
        # The solver's initial guess must not depend on earlier runs.
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_WARMSTART
        # At low friction, MuJoCo's pyramidal cones make contacts hundreds of times stiffer than
        # intended.
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    land = land_of(environment, setup)
    if land is not None:
        _let_ground_act_through_loads(spec)
        spec.option.gravity = (0.0, 0.0, -land.gravity)
    if not setup.gravity or setup.root == "planar":
        spec.option.gravity = (0.0, 0.0, 0.0)
    return spec


def _let_ground_act_through_loads(spec: Any) -> None:
    """Let no geom of the ground touch the robot, because the ground acts on its elements."""
    for geom in spec.geoms:
        if is_ground(geom.name):
            geom.contype = 0
            geom.conaffinity = 0


def build_plant_elements(
    robot: Robot, environment: Environment, setup: Spatial
) -> tuple[Element, ...]:
    """Return the elements of a robot on which the water and the ground act.

    Args:
        robot: The robot.
        environment: The water it swims in, or the ground.
        setup: The model's settings.
    """
    elements = water_robot.robot_elements(
        robot, environment, floats=is_floating(setup), advances_edge=True
    )
    land = land_of(environment, setup)
    if land is None:
        return elements
    has_water = not isinstance(environment, Ground)
    return lay_on_ground(elements, robot, land, wet=has_water)
