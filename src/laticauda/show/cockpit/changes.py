"""Changes to a scenario that a page can make, what they entail, and what a page reads of a scenario."""

from dataclasses import replace
from typing import Any, TypedDict, Unpack, cast

import numpy as np

import laticauda as lc
from laticauda import control
from laticauda.robot import Current
from laticauda.scenarios import (
    Model,
    Planar,
    Scenario,
    default_water,
    identified_parameters,
    model_of,
)
from laticauda.trials import MeasuredTrial, measured_setting
from laticauda.values import check_instance

N_HINGES = 3
"""Hinges of an elastic fin."""
STILL = (0.0, 0.0)
"""Velocity of still water [m/s]."""
WIDE = 60.0
"""How far an unbounded path is drawn, to either side [m]."""
ROUTE_STEP = 0.05
"""Distance between two points of a bounded path [m]."""
UNBOUNDED_ROUTE_STEP = 2.0
"""Distance between two points of an unbounded path, which is straight [m]."""


class Changes(TypedDict, total=False):
    """Possible changes; `model` and `joints` may be names, and None means no `path`, or no `depth` along it."""

    robot: lc.Robot
    gait: lc.Gait
    environment: lc.Water
    current: Current
    model: Model | str
    joints: lc.JointLaw | str
    path: control.Path[Any] | None
    depth: float | None


def adapt_scenario(scenario: Scenario, **changes: Unpack[Changes]) -> Scenario:
    """Return a changed scenario; the default water adapts to robot and gait.

    So do numbers that were identified on a robot: while nobody has changed its water, another robot
    comes with what was identified on it, or else with its default water and prescribed joints.

    Args:
        scenario: The current scenario.
        changes: Fields to change.

    Raises:
        ValueError: If a value is out of range.
    """
    new_robot = changes.get("robot")
    if new_robot is not None and _has_water_of_start(scenario):
        changes = cast("Changes", {**_start_with(new_robot, scenario), **changes})
        changes["robot"] = _with_identified_numbers(new_robot, scenario.gait)
    return replace(
        scenario,
        robot=changes.get("robot", scenario.robot),
        motion=_adapt_motion(scenario, changes),
        environment=_adapt_water(scenario, changes),
        model=_adapt_model(scenario.model, changes),
    )


def _has_water_of_start(scenario: Scenario) -> bool:
    """Return whether nobody has said anything of the water, except that it flows.

    A robot on which parameters were identified starts with their water, any other one with its
    default water and prescribed joints.
    """
    assert isinstance(scenario.environment, lc.Water)
    still_water = replace(scenario.environment, current=STILL)
    parameters = identified_parameters(scenario.robot.name)
    if parameters is not None:
        return still_water == parameters.water(scenario.gait.kind)
    is_default = still_water == default_water(scenario.robot, scenario.gait)
    return is_default and scenario.model.joints == lc.Prescribed()


def _start_with(robot: lc.Robot, scenario: Scenario) -> Changes:
    """Return the changes of water and joints that come with a robot; none if both robots start alike."""
    parameters = identified_parameters(robot.name)
    if parameters == identified_parameters(scenario.robot.name):
        return {}
    assert isinstance(scenario.environment, lc.Water)
    current = scenario.environment.current
    if parameters is None:
        water = default_water(robot, scenario.gait)
        return {"environment": replace(water, current=current), "joints": "prescribed"}
    water = parameters.water(scenario.gait.kind)
    joints = parameters.joints or "prescribed"
    return {"environment": replace(water, current=current), "joints": joints}


def _with_identified_numbers(robot: lc.Robot, gait: lc.Gait) -> lc.Robot:
    """Return a robot with the numbers that were identified on it, if there are any."""
    parameters = identified_parameters(robot.name)
    if parameters is None:
        return robot
    return parameters.robot(robot, gait.kind)


def _adapt_motion(scenario: Scenario, changes: Changes) -> Any:
    """Return the gait alone if there is no path; steering continues as far as its path and depth are the same."""
    motion = scenario.motion
    gait = changes.get("gait", scenario.gait)
    path = changes.get("path", read_path(scenario))
    if path is None:
        if "path" in changes or isinstance(motion, lc.Gait):
            return gait
        return replace(cast("Any", motion), gait=gait)
    old_depth = read_depth(scenario)
    depth = changes.get("depth", old_depth)
    if isinstance(motion, lc.PathFollowing) and depth == old_depth:
        return replace(motion, gait=gait, path=path)
    path_depth = None if depth is None else (depth,)
    steering = lc.Following(path_depth=path_depth).controller(gait)
    return replace(steering, path=path)


def _adapt_water(scenario: Scenario, changes: Changes) -> lc.Water:
    water = changes.get("environment", scenario.environment)
    assert isinstance(water, lc.Water)
    current = changes.get("current", water.current)
    if replace(water, current=STILL) == default_water(scenario.robot, scenario.gait):
        robot = changes.get("robot", scenario.robot)
        gait = changes.get("gait", scenario.gait)
        water = default_water(robot, gait)
    if water.current == current:
        return water
    return replace(water, current=current)


def _adapt_model(model: Model, changes: Changes) -> Model:
    if "model" not in changes and "joints" not in changes:
        return model
    return model_of(changes.get("model", model), joints=changes.get("joints", model.joints))


def check_scenario(scenario: Scenario) -> Scenario:
    """Return the scenario, if a page can show it.

    Args:
        scenario: The scenario.

    Raises:
        ValueError: If the robot is not in water, is steered by anything other than path following,
            or its joints have no room for the steering.
    """
    check_instance("environment", scenario.environment, lc.Water)
    check_instance("motion", scenario.motion, lc.Gait, lc.PathFollowing)
    robot = scenario.robot
    if isinstance(scenario.model, Planar):
        robot = robot.planar()
    scenario.controller.check(robot)
    return scenario


def change_fin(robot: lc.Robot, has_fin: bool, rigidity: float | None) -> lc.Robot:
    """Return the robot with or without a fin: its own, or Mamba's if it has none.

    Args:
        robot: The robot.
        has_fin: Whether the result has a fin.
        rigidity: E I of an elastic fin; None: rigid [N m^2].

    Raises:
        ValueError: If the rigidity is not positive.
    """
    fin = robot.caudal_fin
    if not has_fin:
        if fin is None:
            return robot
        return replace(robot, caudal_fin=None)
    fin = fin or lc.load_robot("mamba-fin").caudal_fin
    assert fin is not None
    n_hinges = 0 if rigidity is None else N_HINGES
    return replace(robot, caudal_fin=replace(fin, n_hinges=n_hinges, flexural_rigidity=rigidity))


# ---- what a page reads of a scenario -------------------------------------------------------------


def read_path(scenario: Scenario) -> control.Path[Any] | None:
    """Return the path that is followed, in plan view, or None."""
    if isinstance(scenario.motion, lc.PathFollowing):
        return scenario.motion.path
    return None


def read_depth(scenario: Scenario) -> float | None:
    """Return the depth that is held along the path, or None [m]."""
    motion = scenario.motion
    if not isinstance(motion, lc.SpatialPathFollowing):
        return None
    profile = motion.profile
    if not isinstance(profile, lc.StraightLine):
        return None
    _, height = profile.point
    return -height


def sample_route(scenario: Scenario, height: float) -> np.ndarray:
    """Return points of the followed path [m], if any: at its own heights, or at `height` if depth is not steered.

    Args:
        scenario: The scenario.
        height: Height of a path whose depth is not steered [m].
    """
    path = read_path(scenario)
    if path is None:
        return np.empty((0, 3))
    length = _path_length(path)
    distance = np.arange(-WIDE, WIDE, UNBOUNDED_ROUTE_STEP)
    if length:
        distance = np.arange(0.0, length, ROUTE_STEP)
    profile = np.array([(0.0, height)])
    if isinstance(scenario.motion, lc.SpatialPathFollowing):
        profile_distance = np.linspace(-WIDE, WIDE + 2.0 * length, 4000)
        profile = scenario.motion.profile.points(profile_distance)
    heights = np.interp(distance, profile[:, 0], profile[:, 1])
    return np.column_stack((path.points(distance), heights))


def _path_length(path: control.Path[Any]) -> float:
    """Return the length of a path; 0 for a straight line, which is unbounded [m]."""
    distances_of_waypoints = getattr(path, "lengths", (0.0,))
    return distances_of_waypoints[-1]


def find_measured(scenario: Scenario) -> MeasuredTrial | None:
    """Return the paper's trial with this scenario, or None."""
    gait = None
    if isinstance(scenario.motion, lc.Gait):
        gait = scenario.motion
    return measured_setting(scenario.robot, gait, scenario.environment)
