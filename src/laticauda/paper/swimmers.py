"""The four swimmers of the paper's path-following trials, both gaits without and with the fin, and how they are run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

from laticauda.control import HeadingController, IntegralLineOfSight, LineOfSight, PathFollowing
from laticauda.control import Path as FollowedPath
from laticauda.errors import SimulationFailed, within
from laticauda.gaits import Gait
from laticauda.interfaces import Controller, Plant, Start
from laticauda.paper.measured import path_following_trials
from laticauda.paper.settings import Coefficients, efficiency_settings, paper_coefficients
from laticauda.robot import Parameters, Robot, Water, load_robot
from laticauda.simulate import plant, run
from laticauda.simulate.runner import Until
from laticauda.trial import Trial
from laticauda.trial.contents import Setting
from laticauda.trial.null_models import group_name

_robot = cache(load_robot)


@dataclass(frozen=True, kw_only=True)
class Swimmer:
    """One gait with one configuration of the robot, in its water."""

    gait: Gait
    """What the joints are asked for, apart from the steering."""
    robot: str
    """The robot's name (`load_robot`)."""
    water: Water
    """What it swims in."""
    parameters: Parameters | None = field(default=None, compare=False)  # they cannot be hashed, the rest has to be
    """What they change about the robot; None: nothing."""

    @property
    def body(self) -> Robot:
        """The robot."""
        robot = _robot(self.robot)
        return robot if self.parameters is None else self.parameters.robot(robot, self.gait.kind)

    @property
    def has_fin(self) -> bool:
        """Whether it wears a caudal fin."""
        return self.body.caudal_fin is not None

    @property
    def name(self) -> str:
        """What tables and files call it."""
        return group_name(self.gait.kind, self.has_fin)

    @property
    def length(self) -> float:
        """Of the straight robot, its fin included [m]."""
        robot = self.body
        return robot.length + (robot.caudal_fin.length if robot.caudal_fin is not None else 0.0)


@dataclass(frozen=True, kw_only=True)
class Steering:
    """How a swimmer is steered along a path: guidance, heading law and heading."""

    name: str
    """What tables and files call it."""
    guidance: LineOfSight | IntegralLineOfSight
    """The law that leads to the path."""
    gain: float
    """k of the heading law [-]."""
    max_offset: float
    """Largest offset to either side [rad]."""
    heading_estimate: str = "raw"
    """Which heading is used: raw or cycle_mean."""

    def controller(self, gait: Gait, path: FollowedPath[Any], interval: float) -> PathFollowing:
        """The controller.

        Args:
            gait: What swims along the path.
            path: What is followed.
            interval: Between two control instants [s].
        """
        return PathFollowing(
            gait=gait,
            path=path,
            guidance=self.guidance,
            heading=HeadingController(gain=self.gain, max_offset=self.max_offset),
            heading_estimate=self.heading_estimate,
            interval=interval,
        )


def swimmers(coefficients: Coefficients | None = None) -> tuple[Swimmer, ...]:
    """The gaits of the paper's path-following trials, each without and with the fin.

    Args:
        coefficients: The water of every gait, and what they change about the robots; None takes the paper's.
    """
    coefficients = coefficients or paper_coefficients()
    robots = {group.has_fin: group.robot for group in efficiency_settings().groups}
    found = [
        Swimmer(
            gait=row.gait,
            robot=robots[row.has_fin],
            water=coefficients.water(row.gait.kind),
            parameters=coefficients.parameters,
        )
        for row in path_following_trials()
    ]
    return tuple(dict.fromkeys(found))


def in_water(
    swimmer: Swimmer,
    *,
    model: str,
    joints: str,
    offset_bandwidth: float,
    current: tuple[float, float] = (0.0, 0.0),
) -> Plant[Any]:
    """A swimmer as something that can be stepped.

    Args:
        swimmer: Who swims.
        model: See `laticauda.simulate.plant`.
        joints: See `laticauda.simulate.plant`.
        offset_bandwidth: See `laticauda.simulate.plant` [rad/s].
        current: Velocity that the water moves to, world axes [m/s].
    """
    water = replace(swimmer.water, current=current)
    return plant(swimmer.body, water, model=model, joints=joints, offset_bandwidth=offset_bandwidth)


def run_named(
    name: str,
    body: Plant[Any],
    controller: Controller[Any],
    duration: float,
    *,
    start: Start | None = None,
    sample_interval: float = 0.05,
    until: Until | None = None,
) -> Trial:
    """As `laticauda.simulate.run`, but a run that blows up says which one it was.

    Args:
        name: Which one it is.
        body: See there.
        controller: See there.
        duration: See there [s].
        start: See there.
        sample_interval: See there [s].
        until: See there.

    Raises:
        SimulationFailed: If the run blows up.
    """
    try:
        return run(body, controller, duration, start=start, sample_interval=sample_interval, until=until, throw=True)
    except SimulationFailed as error:
        raise SimulationFailed(f"{name}: {error}") from error


def how_made(trial: Trial) -> Mapping[str, Setting]:
    """How the plant of a trial was computed, without what steered it."""
    names = ("model", "joints", "dt", "offset_bandwidth", "ramp")
    return {name: trial.settings[name] for name in names if name in trial.settings}


def long_enough(name: str, duration: float, gaits: tuple[Gait, ...], n_cycles: float) -> float:
    """A duration that holds so many cycles of every gait.

    Args:
        name: Of the argument.
        duration: [s].
        gaits: That are to be seen.
        n_cycles: How many of their cycles [-].

    Raises:
        ValueError: If it is too short.
    """
    longest = max(2.0 * math.pi / gait.frequency for gait in gaits)
    return within(name, duration, n_cycles * longest, 1e5, "s")
