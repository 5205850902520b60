"""What all tasks share: who swims where, and what a step is made of.

A task is data and pure functions over arrays with one entry per robot. Rewards are rates times the interval, so that a
return is an integral over time, whatever the interval.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.actuation.laws import JointLaw
from laticauda.errors import BadArgument, finite, instance, not_negative, positive, within
from laticauda.gaits import Gait
from laticauda.interfaces import Command
from laticauda.planar.model import PlanarPlant
from laticauda.planar.school import Motion
from laticauda.robot import Robot, Water, load_robot, load_water

GAIT = Gait(amplitude=math.radians(30.0), frequency=math.radians(90.0), phase_shift=math.radians(40.0))
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


@dataclass(frozen=True, kw_only=True)
class Sight:
    """One number of an observation."""

    name: str
    """What it is."""
    unit: float = 1.0
    """What is seen as 1 [SI]."""


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

    @property
    def velocity(self) -> tuple[Numbers, Numbers]:
        """Over ground at the end, along the heading and to the left of it [m/s]."""
        return in_body_axes(self.after, self.after.velocity_x, self.after.velocity_y)


@dataclass(frozen=True, kw_only=True)
class Swimming(ABC):
    """Who swims where, how often it is told what to do, how long; what it is for is the matter of each task.

    Raises:
        ValueError: If a field is out of its range.
    """

    robot: str | Robot = "mamba-fin"
    """A preset's name, a file, or a robot [-]."""
    water: str | Water = "paper-lateral"
    """The same; its current is replaced by that of the episode [-]."""
    gait: Gait = GAIT
    """What it swims with, apart from the actions."""
    joints: str = "prescribed"
    """prescribed, pd or servo [-]."""
    dt: float | None = None
    """Largest time step; None: a converged one [s]."""
    interval: float = 0.2
    """From one action to the next [s]."""
    duration: float = 60.0
    """Of an episode, which is truncated then [s]."""
    failure_reward: float = -1000.0
    """Of a step in which the motion diverges, which ends the episode [-]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        instance("robot", self.robot, str, Robot)
        instance("water", self.water, str, Water)
        instance("gait", self.gait, Gait)
        settle(self, positive, "s", "interval", "duration")
        within("interval", self.interval, 0.0, self.duration, "s")
        within("failure_reward", self.failure_reward, -1e9, 0.0)

    @property
    def n_steps(self) -> int:
        """Actions in an episode that nothing ends."""
        return round(self.duration / self.interval)

    @property
    def command(self) -> Command:
        """What a robot is asked for before the first action."""
        return Command(gait=self.gait)

    @cached_property
    def plant(self) -> PlanarPlant:
        """What swims."""
        robot = load_robot(self.robot) if isinstance(self.robot, str) else self.robot
        water = load_water(self.water) if isinstance(self.water, str) else self.water
        return PlanarPlant(robot=robot, environment=water, joints=JointLaw.of(self.joints), dt=self.dt)

    @property
    @abstractmethod
    def actions(self) -> tuple[Range, ...]:
        """What each number of an action asks for at -1 and at 1; what it leaves out is that of the gait."""

    @property
    @abstractmethod
    def draws(self) -> tuple[Range, ...]:
        """What every episode draws, evenly, and in this order."""

    @property
    @abstractmethod
    def sights(self) -> tuple[Sight, ...]:
        """What the numbers of an observation are."""

    @abstractmethod
    def see(self, step: Step) -> tuple[Numbers, ...]:
        """The quantities of `sights` after `step` [SI]."""

    @abstractmethod
    def reward(self, step: Step) -> Numbers:
        """What `step` is worth [-]."""


def settle(task: object, check: Callable[[str, object, str], float], unit: str, *names: str) -> None:
    """Check fields of a frozen task, and keep them as floats."""
    for name in names:
        object.__setattr__(task, name, check(name, getattr(task, name), unit))


def settle_ends(task: object, unit: str, *names: str) -> None:
    """The same for fields that are two ends, of which the lower one comes first.

    Raises:
        ValueError: If one is not.
    """
    for name in names:
        given = getattr(task, name)
        if isinstance(given, str) or not hasattr(given, "__len__") or len(given) != 2:
            raise BadArgument(name, f"must be two numbers in {unit}, the lower one first, got {given!r}")
        low, high = (finite(f"{name}[{i}]", value, unit) for i, value in enumerate(given))
        if low > high:
            raise BadArgument(name, f"must be two numbers in {unit}, the lower one first, got {given!r}")
        object.__setattr__(task, name, (low, high))


def current_draws(fastest: float) -> tuple[Range, Range]:
    """A current up to a speed [m/s], in any direction."""
    return (
        Range(name="current_speed", low=0.0, high=not_negative("max_current", fastest, "m/s")),
        Range(name="current_direction", low=-math.pi, high=math.pi),
    )


def in_body_axes(motion: Motion, x: Numbers, y: Numbers) -> tuple[Numbers, Numbers]:
    """A vector in world axes, seen along the heading and to the left of it."""
    c, s = np.cos(motion.heading), np.sin(motion.heading)
    return c * x + s * y, c * y - s * x


def log_square(value: Numbers, tolerance: float) -> Numbers:
    """ln(1 + (x/a)^2): (x/a)^2 for small x; from there on ten times the distance costs 4.6 more, wherever it is [-]."""
    return np.log1p((value / tolerance) ** 2)
