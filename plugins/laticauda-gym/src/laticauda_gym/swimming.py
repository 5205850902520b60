"""What all tasks share: who swims where, how often it is told what to do, how long; and what a step of theirs is.

A task is data and pure functions over arrays with one entry per robot. Rewards are rates times the interval, so that a
return is an integral over time, whatever the interval.
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
from laticauda.dynamics.school import Motion
from laticauda.errors import instance, within
from laticauda.fluid.flow import Flow
from laticauda.quantities import option, quantity, value
from laticauda.robot import Current, Robot, Water
from laticauda.scenarios import Changes, Scenario, scenario
from laticauda.simulate.numbers import changed, look_up, parameters

Numbers = Float[np.ndarray, " n"]


@dataclass(frozen=True, kw_only=True)
class Range:
    """A quantity that goes from one value to another: an action from -1 to 1, or what an episode draws."""

    name: str
    """Of an action as in `Command` and `Gait`; of a start as in `Start`, `x` and `y` for the center of mass."""
    low: float
    """[SI]."""
    high: float
    """[SI]."""
    is_whole: bool = False
    """Whether it is drawn from whole numbers only."""

    def at(self, share: Numbers) -> Numbers:
        """What is some way from low to high; of whole numbers every one has an equal share.

        Args:
            share: Of the way, from 0 to below 1 [-].
        """
        found = self.low + share * (self.high - self.low + self.is_whole)
        return np.floor(found) if self.is_whole else found


def ranges(**ends: tuple[float, float]) -> tuple[Range, ...]:
    """Quantities that go from one value to another, by name [SI]."""
    return tuple(Range(name=name, low=low, high=high) for name, (low, high) in ends.items())


@dataclass(frozen=True, kw_only=True)
class Step:
    """What happened in one interval; at the start of an episode both motions are the same."""

    drawn: Mapping[str, Numbers]
    """What the episodes drew, by name."""
    before: Motion
    """At the begin of the interval."""
    after: Motion
    """At its end."""
    interval: float
    """[s]."""

    @property
    def power(self) -> Numbers:
        """Mean over the interval [W]."""
        return (self.after.work - self.before.work) / self.interval

    @cached_property
    def velocity(self) -> tuple[Numbers, Numbers]:
        """Over ground at the end, along the heading and to the left of it [m/s]."""
        return in_body_axes(self.after, self.after.velocity_x, self.after.velocity_y)


@dataclass(frozen=True, kw_only=True)
class Sight:
    """One number of an observation."""

    name: str
    """What it is."""
    of: Callable[[Step], Numbers]
    """Itself, after a step [SI]."""
    unit: float = 1.0
    """What is seen as 1 [SI]."""


def in_body_axes(motion: Motion, x: Numbers, y: Numbers) -> tuple[Numbers, Numbers]:
    """A vector in world axes, seen along the heading and to the left of it."""
    c, s = np.cos(motion.heading), np.sin(motion.heading)
    return c * x + s * y, c * y - s * x


FLOW = "water.current."
"""What the names of a flow's numbers begin with, in sweeps and where episodes draw them."""
SEEDS = (0.0, 2.0**31 - 1.0)
GAIT = lc.Gait(amplitude=math.radians(30.0), frequency=math.radians(90.0), phase_shift=math.radians(40.0))


def swimmer(
    robot: Robot | str | Path = "mamba-fin", gait: lc.Gait = GAIT, duration: float = 60.0, **changes: Unpack[Changes]
) -> Scenario:
    """The scenario of a task, in a few words.

    Args:
        robot: What swims, or a preset's name, or the path of a file.
        gait: What it swims with, apart from the actions.
        duration: Of an episode [s].
        changes: What else differs from the defaults: `environment`, `current`, `model`, `start`, `sample_interval` [s],
            or of the model `joints`, `dt` [s] and the other fields of `laticauda.scenarios.ModelChanges`.

    Raises:
        ValueError: If something is out of its range.
    """
    return scenario(robot, gait, duration, **changes)


@value
class Swimming(ABC):
    """Who swims where, how often it is told what to do, how long; what it is for is the matter of each task.

    Raises:
        ValueError: If a field is out of its range.
    """

    scenario: Scenario = option("Robot, gait, water, duration; episodes set start and current", default_factory=swimmer)
    currents: Mapping[str, tuple[float, float]] = option(
        "Ranges from which episodes draw numbers of the flow; seeds are drawn anyway", default_factory=dict[str, Any]
    )
    interval: float = quantity("s", "Time between actions", gt=0.0, default=0.2)
    failure_reward: float = quantity("", "Reward of the last step if it diverges", ge=-1e9, le=0.0, default=-1000.0)

    def __post_init__(self) -> None:
        """Check what goes together."""
        instance("scenario.motion", self.scenario.motion, lc.Gait)
        within("interval", self.interval, 0.0, self.scenario.duration, "s")
        for end in ("low", "high"):
            self.current({draw.name: getattr(draw, end) for draw in self.flow_draws})

    @property
    def flow(self) -> Flow | None:
        """How its water moves, if not as one."""
        water = self.scenario.environment
        return water.flow if isinstance(water, Water) else None

    @cached_property
    def flow_draws(self) -> tuple[Range, ...]:
        """What every episode draws of the flow's numbers."""
        known = parameters(self.scenario)
        ranges = {name: SEEDS for name in known if name.startswith(FLOW) and name.endswith("seed")}
        ranges |= {look_up(FLOW + name, known, "currents").name: ends for name, ends in self.currents.items()}
        return tuple(
            Range(name=name, low=low, high=high, is_whole=known[name].is_whole) for name, (low, high) in ranges.items()
        )

    def current(self, drawn: Mapping[str, float]) -> Current:
        """How the water moves with other numbers.

        Args:
            drawn: By name, as in `flow_draws` [SI].
        """
        return cast(Water, changed(self.scenario, drawn).environment).current

    @property
    def gait(self) -> lc.Gait:
        """What it swims with, apart from the actions."""
        return self.scenario.gait

    @property
    def n_steps(self) -> int:
        """Actions in an episode that nothing ends."""
        return round(self.scenario.duration / self.interval)

    @cached_property
    def plant(self) -> lc.Plant[Any]:
        """What swims."""
        return lc.plant(self.scenario)

    @property
    @abstractmethod
    def actions(self) -> tuple[Range, ...]:
        """What each number of an action asks for at -1 and at 1; what it leaves out is that of the gait."""

    @property
    @abstractmethod
    def draws(self) -> tuple[Range, ...]:
        """What every episode draws, evenly, and in this order."""

    def origins(self, n: int) -> Float[np.ndarray, "n 2"]:
        """From where the places are counted that episodes draw, of `n` robots [m]."""
        return np.zeros((n, 2))

    @property
    @abstractmethod
    def sights(self) -> tuple[Sight, ...]:
        """What the numbers of an observation are."""

    @abstractmethod
    def reward(self, step: Step) -> Numbers:
        """What `step` is worth [-]."""
