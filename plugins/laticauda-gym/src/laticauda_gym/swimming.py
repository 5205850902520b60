"""What all tasks share: robot, water, time between actions and duration; and the definition of a step.

A task is data and pure functions over arrays with one entry per robot. Rewards are rates times the
interval, so a return is an integral over time, whatever the interval.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Unpack, cast

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.models.dynamics import Motion
from laticauda.models.simulate import change_parameters, look_up
from laticauda.models.simulate.numbers import list_parameters
from laticauda.robot import Current, Robot, Water
from laticauda.scenarios import Changes, Scenario, build_scenario
from laticauda.values import (
    check_choice,
    check_instance,
    check_positive,
    check_within,
    option,
    quantity,
    value_class,
)
from laticauda.water.fluid import Flow
from laticauda_gym.senses import names_of_readings

Numbers = Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True)
class Range:
    """Range of a quantity that an action from -1 to 1 commands, or that an episode draws."""

    name: str
    """Name: of an action as in `Command` and `Gait`; of a start as in `Start`, `x` and `y` for the center of mass."""
    low: float
    """Lower end [SI]."""
    high: float
    """Upper end [SI]."""
    is_whole: bool = False
    """Whether only whole numbers are drawn."""

    def at(self, share: Numbers) -> Numbers:
        """Return the values at a share of the way from low to high; all whole numbers have equal shares of it.

        Args:
            share: Fraction of the way from low to high, from 0 to below 1 [-].
        """
        values = self.low + share * (self.high - self.low + self.is_whole)
        if self.is_whole:
            return np.floor(values)
        return values


def ranges(**ends: tuple[float, float]) -> tuple[Range, ...]:
    """Return the ranges of quantities from their `ends`, by name [SI]."""
    return tuple(Range(name=name, low=low, high=high) for name, (low, high) in ends.items())


@dataclass(frozen=True, kw_only=True)
class Step:
    """What happened in one interval; at the start of an episode, both motions are the same."""

    drawn: Mapping[str, Numbers]
    """Quantities that the episodes drew, by name."""
    before: Motion
    """Motion at the start of the interval."""
    after: Motion
    """Motion at the end of the interval."""
    interval: float
    """Length of the interval [s]."""

    @property
    def power(self) -> Numbers:
        """Mean power over the interval [W]."""
        return (self.after.work - self.before.work) / self.interval

    @cached_property
    def velocity(self) -> tuple[Numbers, Numbers]:
        """Velocity over ground at the end, along the heading and to the left of it [m/s]."""
        return in_body_axes(self.after, self.after.velocity_x, self.after.velocity_y)


@dataclass(frozen=True, kw_only=True)
class Sight:
    """One number of an observation."""

    name: str
    """Name of the number."""
    of: Callable[[Step], Numbers]
    """Function that returns the number after a step [SI]."""
    unit: float = 1.0
    """Value that is observed as 1 [SI]."""


def in_body_axes(motion: Motion, x: Numbers, y: Numbers) -> tuple[Numbers, Numbers]:
    """Return the components of a vector along the heading and to the left of it.

    Args:
        motion: Motion of the robots, of which the heading is used [rad].
        x: Component along the x axis of the world.
        y: Component along the y axis of the world.
    """
    c, s = np.cos(motion.heading), np.sin(motion.heading)
    return c * x + s * y, c * y - s * x


FLOW = "water.current."
"""Prefix of the names of a flow's parameters, in sweeps and in the draws of episodes."""
SEEDS = (0.0, 2.0**31 - 1.0)
"""Range from which the seeds of flows are drawn."""
GAIT = lc.Gait(
    amplitude=math.radians(30.0), frequency=math.radians(90.0), phase_shift=math.radians(40.0)
)


def swimmer(
    robot: Robot | str | Path = "mamba-fin",
    gait: lc.Gait = GAIT,
    duration: float = 60.0,
    **changes: Unpack[Changes],
) -> Scenario:
    """Make the scenario of a task from a few arguments.

    Args:
        robot: The robot, the name of a preset, or the path of a file.
        gait: Gait of the robot, apart from the actions.
        duration: Duration of an episode [s].
        changes: Other deviations from the defaults: `environment`, `current`, `model`, `start`,
            `sample_interval` [s],
            or settings of the model: `joints`, `dt` [s] and the other fields of
                `laticauda.scenarios.ModelChanges`.

    Raises:
        ValueError: If an argument is out of its range.
    """
    return build_scenario(robot, gait, duration, **changes)


@value_class
class Swimming(ABC):
    """Robot, water, time between actions and duration of a task; each task defines its own goal.

    Raises:
        ValueError: If a field is out of its range.
    """

    scenario: Scenario = option(
        "Robot, gait, water, duration; episodes set start and current", default_factory=swimmer
    )
    currents: Mapping[str, tuple[float, float]] = option(
        "Ranges from which episodes draw numbers of the flow; seeds are drawn anyway",
        default_factory=dict[str, Any],
    )
    reading_units: Mapping[str, float] = option(
        "What is observed as 1 of what sensors tell, by sensor or by value, such as sonar or beacon_range; else 1 [SI]",
        default_factory=dict[str, Any],
    )
    interval: float = quantity("s", "Time between actions", gt=0.0, default=0.2)
    failure_reward: float = quantity(
        "", "Reward of the last step if it diverges", ge=-1e9, le=0.0, default=-1000.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        check_instance("scenario.motion", self.scenario.motion, lc.Gait)
        check_within("interval", self.interval, 0.0, self.scenario.duration, "s")
        sensors = self.scenario.model.sensors
        names_with_units = (*(sensor.name for sensor in sensors), *self.reading_names)
        for name, unit in self.reading_units.items():
            check_choice("reading_units", name, names_with_units)
            check_positive(f"reading_units.{name}", unit, "")
        for end in ("low", "high"):
            self.current({draw.name: getattr(draw, end) for draw in self.flow_draws})

    @property
    def flow(self) -> Flow | None:
        """Flow of the water; None if its velocity is uniform and constant."""
        water = self.scenario.environment
        if not isinstance(water, Water):
            return None
        return water.flow

    @cached_property
    def flow_draws(self) -> tuple[Range, ...]:
        """Parameters of the flow that every episode draws."""
        parameters = list_parameters(self.scenario)
        ends_of_draws: dict[str, tuple[float, float]] = {}
        for name in parameters:
            if name.startswith(FLOW) and name.endswith("seed"):
                ends_of_draws[name] = SEEDS
        for name, ends in self.currents.items():
            parameter = look_up(FLOW + name, parameters, "currents")
            ends_of_draws[parameter.name] = ends
        return tuple(
            Range(name=name, low=low, high=high, is_whole=parameters[name].is_whole)
            for name, (low, high) in ends_of_draws.items()
        )

    def current(self, drawn: Mapping[str, float]) -> Current:
        """Return the current of the water with other values of the flow's parameters.

        Args:
            drawn: Values by name, as in `flow_draws` [SI].
        """
        return cast(Water, change_parameters(self.scenario, drawn).environment).current

    @property
    def gait(self) -> lc.Gait:
        """Gait of the robot, apart from the actions."""
        return self.scenario.gait

    @property
    def n_steps(self) -> int:
        """Number of actions in an episode that does not end early."""
        return round(self.scenario.duration / self.interval)

    @cached_property
    def plant(self) -> lc.Plant[Any]:
        """Plant of the scenario."""
        return lc.build_plant(self.scenario)

    @property
    @abstractmethod
    def actions(self) -> tuple[Range, ...]:
        """What each number of an action commands at -1 and at 1; all other parameters are those of the gait."""

    @property
    @abstractmethod
    def draws(self) -> tuple[Range, ...]:
        """Quantities that every episode draws, uniformly and in this order."""

    def origins(self, n: int) -> Float[np.ndarray, "n 2"]:
        """Return the origins of the positions that episodes draw, for `n` robots [m]."""
        return np.zeros((n, 2))

    @property
    @abstractmethod
    def sights(self) -> tuple[Sight, ...]:
        """Numbers of an observation."""

    @property
    def reading_names(self) -> tuple[str, ...]:
        """Names of what the sensors of the scenario's model tell, which observations hold behind the sights."""
        return names_of_readings(self.scenario.model.sensors)

    @abstractmethod
    def reward(self, step: Step) -> Numbers:
        """Return the reward of `step` [-]."""
