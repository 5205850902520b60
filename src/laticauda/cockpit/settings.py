"""What swims in the cockpit and how: one value, that a page changes and a command line or a script can repeat."""

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine
from laticauda.errors import instance
from laticauda.gaits import Gait
from laticauda.interfaces import Plant
from laticauda.robot import CaudalFin, Robot, Water, load_robot, load_water
from laticauda.scenarios import default_water
from laticauda.simulate import plant
from laticauda.trial import MeasuredTrial, measured_setting

# The paper's path following of Mamba.
LOOK_AHEAD, GAIN, MAX_OFFSET = 0.18, 0.4, math.radians(20.0)
N_HINGES = 3  # of a fin that bends
CURRENT = (0.0, 0.0)


@cache
def mamba_fin() -> CaudalFin:
    """The fin that any robot is given that has none of its own: Mamba's."""
    fin = load_robot("mamba-fin").caudal_fin
    assert fin is not None
    return fin


@dataclass(frozen=True, kw_only=True)
class Setting:
    """What swims, how and where.

    Raises:
        ValueError: If a field is of another kind; what does not go together is refused by `plant` and `controller`.
    """

    robot: Robot
    """What swims, with or without its fin."""
    gait: Gait
    """What the joints are asked for."""
    water: Water | None = None
    """Where it swims; None: in the paper's water for the gait."""
    current: tuple[float, float] = CURRENT
    """V, the velocity that the water moves to, in world axes [m/s]."""
    model: str = "planar"
    """planar or spatial."""
    joints: str = "prescribed"
    """prescribed, pd or servo."""
    path: StraightLine | None = None
    """What it follows; None: nothing, it swims as the gait says."""

    def __post_init__(self) -> None:
        """Check the kinds once."""
        instance("robot", self.robot, Robot)
        instance("gait", self.gait, Gait)
        instance("water", self.water, Water, type(None))
        instance("path", self.path, StraightLine, type(None))

    @property
    def environment(self) -> Water:
        """The water with its current."""
        water = load_water(default_water(self.gait)) if self.water is None else self.water
        return water if water.current == self.current else replace(water, current=self.current)

    def plant(self) -> Plant[Any]:
        """The plant.

        Raises:
            ValueError: If something does not fit together.
            MissingExtra: If the spatial model is asked for without MuJoCo.
        """
        return plant(self.robot, self.environment, model=self.model, joints=self.joints)

    def body(self) -> tuple[Any, ...]:
        """What the plant is made of: settings with equal ones share a plant."""
        return self.robot, self.environment, self.model, self.joints

    def controller(self) -> PathFollowing | None:
        """Path following as in the paper, or None without a path.

        Raises:
            ValueError: If the joints have no room for its steering.
        """
        if self.path is None:
            return None
        controller = PathFollowing(
            gait=self.gait,
            path=self.path,
            guidance=LineOfSight(look_ahead_distance=LOOK_AHEAD),
            heading=HeadingController(gain=GAIN, max_offset=MAX_OFFSET),
        )
        controller.check(self.robot)
        return controller

    def measured(self) -> MeasuredTrial | None:
        """What was measured in this setting, if anything."""
        return None if self.path is not None else measured_setting(self.robot, self.gait, self.environment)


def with_fin(robot: Robot, has_fin: bool, rigidity: float | None) -> Robot:
    """The robot with or without a fin: its own, or Mamba's if it has none.

    Args:
        robot: What swims.
        has_fin: Whether it is to have one.
        rigidity: E I of a fin that bends; None: rigid [N m^2].

    Raises:
        ValueError: If the rigidity is not positive.
    """
    if not has_fin:
        return robot if robot.caudal_fin is None else replace(robot, caudal_fin=None)
    fin = robot.caudal_fin or mamba_fin()
    hinges = 0 if rigidity is None else N_HINGES
    return replace(robot, caudal_fin=replace(fin, n_hinges=hinges, flexural_rigidity=rigidity))
