"""The scenarios of SwimBench: one file each, which fixes everything.

A file states its `scenario_version` and its `seeds`, the fields of `Swim` under `task`, the
laticauda scenario with all its numbers under `swims`, and the two values of J between which the
score goes from 0 to 1. Any change except in wording makes a new version. Every score file contains
the SHA-256 of the scenario file, and is compared with no other.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, cast

import laticauda as lc
from laticauda.robot import Robot
from laticauda.scenarios import Scenario, run_from_table
from laticauda.values import check_choice, codec, parse_toml
from laticauda_gym.environments import SwimmingEnv, SwimmingVectorEnv
from laticauda_swimbench.challenge_files import read_challenge_file
from laticauda_swimbench.task import Swim

FOLDER = Path(__file__).parent / "scenarios"
CHALLENGES = ("speed", "economy", "path", "disturbance", "broken")
"""Names of the scenarios, in the order of the table."""
NOTHING = 1e-9
"""What remains of a motor that is off, in the unit of each field: a law needs positive numbers."""


@dataclass(frozen=True, kw_only=True)
class TaskSeeds:
    """A task, and the episodes that are swum in it."""

    task: Swim
    """The task."""
    seeds: tuple[int, ...]
    """Seeds, one per episode."""


@dataclass(frozen=True, kw_only=True)
class Challenge:
    """A scenario of the benchmark."""

    name: str
    """Name, as in `CHALLENGES`."""
    version: int
    """Version of the file."""
    description: str
    """Description in one line."""
    sha256: str
    """SHA-256 of the file."""
    seeds: tuple[int, ...]
    """Seeds, one per scored episode."""
    tasks: tuple[Swim, ...]
    """Tasks; if there are several, the seeds go to them in turn."""
    baseline: float
    """J that gives a score of 0 [m/s]."""
    reference: float
    """J that gives a score of 1 [m/s]."""
    laws: Mapping[str, Any]
    """Numbers of the reference."""

    def score(self, objective: float) -> float:
        """Return the score (J - J_0) / (J_1 - J_0) of an `objective` J [m/s]."""
        return (objective - self.baseline) / (self.reference - self.baseline)

    def shares(self, seeds: tuple[int, ...] | None = None) -> list[TaskSeeds]:
        """Return the tasks, each with its seeds; tasks without a seed are left out.

        Args:
            seeds: Seeds of episodes; None: those of the scored episodes.
        """
        if seeds is None:
            seeds = self.seeds
        shares: list[TaskSeeds] = []
        for i, task in enumerate(self.tasks):
            seeds_of_task = seeds[i :: len(self.tasks)]
            if seeds_of_task:
                shares.append(TaskSeeds(task=task, seeds=seeds_of_task))
        return shares


@cache
def challenge(name: str) -> Challenge:
    """Return a scenario of the benchmark.

    Args:
        name: One of `CHALLENGES`.

    Raises:
        ValueError: If there is no scenario of that name.
    """
    file = FOLDER / f"{check_choice('scenario', name, CHALLENGES)}.toml"
    table, sha256 = read_challenge_file(file)
    healthy = cast(Scenario, run_from_table(table["swims"]))
    scenarios: list[Scenario] = []
    for joint in table.get("limp", ()):
        robot = limp(healthy.robot, joint, table["limp_damping"])
        scenarios.append(replace(healthy, robot=robot))
    if not scenarios:
        scenarios.append(healthy)
    tasks = [codec.decode(Swim, table["task"] | {"scenario": scenario}) for scenario in scenarios]
    return Challenge(
        name=name,
        version=table["scenario_version"],
        description=table["description"],
        sha256=sha256,
        seeds=tuple(table["seeds"]),
        tasks=tuple(tasks),
        baseline=table["score"]["baseline"],
        reference=table["score"]["reference"],
        laws=table["score"]["laws"],
    )


def limp(robot: Robot, joint: int, damping: float) -> Robot:
    """Return the robot with one motor off, which takes no power.

    Args:
        robot: Robot with all its motors.
        joint: Index of the motor's joint, from 0 at the tail.
        damping: Damping of the joint's gear and skin when it is turned from outside [N m s/rad].
    """
    off = replace(
        robot.joints[joint].actuator,
        stall_torque=NOTHING,
        stall_current=NOTHING,
        servo_gain=NOTHING,
    )
    joints = list(robot.joints)
    joints[joint] = replace(joints[joint], actuator=off, damping=damping)
    return replace(robot, joints=tuple(joints))


def make(
    name: str, n: int | None = None, *, variant: int = 0, **how: Any
) -> SwimmingEnv | SwimmingVectorEnv:
    """Make a Gymnasium environment of a scenario, to learn in; the seeds of its resets determine its episodes.

    Args:
        name: One of `CHALLENGES`.
        n: Number of robots side by side; None: one, in an environment that is not a vector
            environment.
        variant: Index of the task in a scenario that has several: the broken joint.
        how: Arguments of `SwimmingVectorEnv` other than its task.

    Raises:
        ValueError: If an argument is out of its range.

    Example:
        >>> env = make("path")
        >>> env.reset(seed=1)[0].shape
        (13,)
    """
    task = challenge(name).tasks[variant]
    if n is None:
        return SwimmingEnv(task, **how)
    return SwimmingVectorEnv(n, task=task, **how)


def scenario_of(name: str) -> lc.Scenario:
    """Return the laticauda scenario of a benchmark scenario, with a healthy robot.

    Args:
        name: One of `CHALLENGES`.
    """
    table = parse_toml((FOLDER / f"{name}.toml").read_text(encoding="utf-8"), name)
    return cast(Scenario, run_from_table(table["swims"]))
