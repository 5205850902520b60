"""Where the robot is: water with its surface and floor, the tank of the experiments, ground and ramp, and the light."""

from typing import Any, Literal

from laticauda.errors import one_of
from laticauda.robot import Environment, Ground
from laticauda.spatial.door import engine

# The tank at Trondheim in which the paper's robot swam [m].
TANK_LENGTH, TANK_WIDTH, TANK_DEPTH = 40.0, 6.45, 1.5
WALL = 0.1  # [m]
GROUNDS = ("flat", "ramp")
TOUCHED: dict[str, Any] = {"contype": 0, "conaffinity": 1}
SEEN: dict[str, Any] = {"contype": 0, "conaffinity": 0}


def add(
    model: Any, environment: Environment, *, tank: bool, ground: Literal["flat", "ramp"] | None, visuals: bool
) -> None:
    """Put the place into a model; arguments as for `mjcf.spec`."""
    if ground is not None:
        one_of("ground", ground, GROUNDS)
    if tank:
        _add_tank(model, visuals=visuals)
    if ground is None and isinstance(environment, Ground):
        ground = "flat"
    if ground == "flat":
        model.worldbody.add_geom(name="ground", type=engine().mjtGeom.mjGEOM_PLANE, size=(0.0, 0.0, 1.0), **TOUCHED)


def _add_tank(model: Any, *, visuals: bool) -> None:
    """Floor and walls around the middle of the world, surface at z = 0."""
    kind = engine().mjtGeom
    x, y, z = 0.5 * TANK_LENGTH, 0.5 * TANK_WIDTH, 0.5 * TANK_DEPTH
    model.worldbody.add_geom(
        name="floor", type=kind.mjGEOM_PLANE, size=(x, y, 1.0), pos=(0.0, 0.0, -TANK_DEPTH), **TOUCHED
    )
    for name, at, size in (
        ("wall_left", (0.0, y + WALL, -z), (x, WALL, z)),
        ("wall_right", (0.0, -y - WALL, -z), (x, WALL, z)),
        ("wall_front", (x + WALL, 0.0, -z), (WALL, y, z)),
        ("wall_back", (-x - WALL, 0.0, -z), (WALL, y, z)),
    ):
        model.worldbody.add_geom(name=name, type=kind.mjGEOM_BOX, size=size, pos=at, **TOUCHED)
