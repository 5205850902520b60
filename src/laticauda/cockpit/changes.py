"""What a page can change about a scenario, and what goes along with it."""

import math
from dataclasses import replace
from functools import cache
from typing import TypedDict, Unpack

from laticauda.actuation.laws import JointLaw
from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine
from laticauda.errors import instance
from laticauda.gaits import Gait
from laticauda.robot import CaudalFin, Robot, Water, load_robot
from laticauda.scenarios import Model, Scenario, default_water, model_of, preset_water
from laticauda.trial.measured import MeasuredTrial, measured_setting

# The paper's path following of Mamba.
GUIDANCE = LineOfSight(look_ahead_distance=0.18)
HEADING = HeadingController(gain=0.4, max_offset=math.radians(20.0))
N_HINGES = 3  # of a fin that bends
STILL = (0.0, 0.0)


class Changes(TypedDict, total=False):
    """What can be changed; `model` and `joints` may be names, no `path` is None."""

    robot: Robot
    gait: Gait
    environment: Water
    current: tuple[float, float]
    model: Model | str
    joints: JointLaw | str
    path: StraightLine | None


def changed(scenario: Scenario, **changes: Unpack[Changes]) -> Scenario:
    """Another scenario; the paper's water goes along with the gait, as it has one for each kind.

    Args:
        scenario: As it is.
        changes: What is to be otherwise.

    Raises:
        ValueError: If something is out of its range.
    """
    gait, motion, model = changes.get("gait", scenario.gait), scenario.motion, scenario.model
    if "path" in changes:
        path = changes["path"]
        if path is None:
            motion = gait
        elif isinstance(motion, PathFollowing):
            motion = replace(motion, gait=gait, path=path)
        else:
            motion = PathFollowing(gait=gait, path=path, guidance=GUIDANCE, heading=HEADING)
    elif "gait" in changes:
        motion = replace(motion, gait=gait) if isinstance(motion, PathFollowing) else gait
    if "model" in changes or "joints" in changes:
        model = model_of(changes.get("model", model), joints=changes.get("joints", model.joints))
    robot, water = changes.get("robot", scenario.robot), changes.get("environment", scenario.environment)
    assert isinstance(water, Water)
    current = changes.get("current", water.current)
    if replace(water, current=STILL) == preset_water(default_water(scenario.gait)) and gait.kind != scenario.gait.kind:
        water = preset_water(default_water(gait))
    water = water if water.current == current else replace(water, current=current)
    return replace(scenario, robot=robot, motion=motion, environment=water, model=model)


def checked(scenario: Scenario) -> Scenario:
    """The scenario, if a page can show it.

    Raises:
        ValueError: If it swims in no water, is steered by something else than path following, or its joints have no
            room for the steering.
    """
    instance("environment", scenario.environment, Water)
    instance("motion", scenario.motion, Gait, PathFollowing)
    scenario.controller.check(scenario.robot)
    return scenario


def path_of(scenario: Scenario) -> StraightLine | None:
    """The straight line that is followed, or None."""
    path = scenario.motion.path if isinstance(scenario.motion, PathFollowing) else None
    return path if isinstance(path, StraightLine) else None


def measured(scenario: Scenario) -> MeasuredTrial | None:
    """The paper's trial of this scenario, if it is one."""
    gait = scenario.motion if isinstance(scenario.motion, Gait) else None
    return measured_setting(scenario.robot, gait, scenario.environment)


@cache
def _mamba_fin() -> CaudalFin:
    fin = load_robot("mamba-fin").caudal_fin
    assert fin is not None
    return fin


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
    fin = robot.caudal_fin or _mamba_fin()
    hinges = 0 if rigidity is None else N_HINGES
    return replace(robot, caudal_fin=replace(fin, n_hinges=hinges, flexural_rigidity=rigidity))
