"""What all tasks share: who swims where, how often it is told what to do, how long.

A task is data and pure functions over arrays with one entry per robot. Rewards are rates times the interval, so that a
return is an integral over time, whatever the interval.
"""

import math
from abc import ABC, abstractmethod
from functools import cached_property
from pathlib import Path
from typing import Unpack, cast

from laticauda.cosim.gym.steps import Numbers, Range, Sight, Step
from laticauda.errors import BadArgument, instance, positive, within
from laticauda.gaits import Gait
from laticauda.interfaces import Command
from laticauda.planar.model import PlanarPlant
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot
from laticauda.scenarios import Changes, Planar, Scenario, scenario
from laticauda.simulate import plant

GAIT = Gait(amplitude=math.radians(30.0), frequency=math.radians(90.0), phase_shift=math.radians(40.0))


def swimmer(
    robot: Robot | str | Path = "mamba-fin", gait: Gait = GAIT, duration: float = 60.0, **changes: Unpack[Changes]
) -> Scenario:
    """The scenario of a task, in a few words.

    Args:
        robot: What swims, or a preset's name, or the path of a file.
        gait: What it swims with, apart from the actions.
        duration: Of an episode [s].
        changes: See `laticauda.scenarios.Changes`; the environment's default is the water `paper-lateral`.

    Raises:
        ValueError: If something is out of its range.
    """
    return scenario(robot, gait, duration, **{"environment": "paper-lateral", **changes})


@value
class Swimming(ABC):
    """Who swims where, how often it is told what to do, how long; what it is for is the matter of each task.

    Raises:
        ValueError: If a field is out of its range.
    """

    scenario: Scenario = option(
        "Who swims where with which gait, apart from the actions, and how long an episode is; where it begins and the "
        "current are those of the episode",
        default_factory=swimmer,
    )
    interval: float = quantity("s", "From one action to the next", gt=0.0, default=0.2)
    failure_reward: float = quantity(
        "", "Of a step in which the motion diverges, which ends the episode", ge=-1e9, le=0.0, default=-1000.0
    )

    def __post_init__(self) -> None:
        """Check what goes together."""
        instance("scenario.motion", self.scenario.motion, Gait)
        instance("scenario.model", self.scenario.model, Planar)
        within("interval", self.interval, 0.0, self.scenario.duration, "s")

    @property
    def gait(self) -> Gait:
        """What it swims with, apart from the actions."""
        return self.scenario.gait

    @property
    def n_steps(self) -> int:
        """Actions in an episode that nothing ends."""
        return round(self.scenario.duration / self.interval)

    @property
    def command(self) -> Command:
        """What a robot is asked for before the first action."""
        return Command(gait=self.gait)

    @cached_property
    def plant(self) -> PlanarPlant:
        """What swims."""
        return cast(PlanarPlant, plant(self.scenario))

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
    def reward(self, step: Step) -> Numbers:
        """What `step` is worth [-]."""


def check_ends(task: Swimming, unit: str, *names: str) -> None:
    """Refuse fields that are two ends, of which the lower one does not come first, or the upper one is not positive.

    Args:
        task: Whose fields.
        unit: Theirs.
        names: Of the fields.

    Raises:
        ValueError: If there is one.
    """
    for name in names:
        low, high = getattr(task, name)
        if low > high:
            raise BadArgument(name, f"must be two numbers in {unit}, the lower one first, got {(low, high)}")
        positive(f"{name}[1]", high, unit)
