"""The scenarios of SwimBench: one file each, in which everything is fixed.

A file says its `scenario_version` and its `seeds`, under `task` the fields of `Swim`, under `swims` the scenario of
laticauda with all its numbers, and between which two numbers of J the score goes from 0 to 1. A change of
anything but words is a new version; the SHA-256 of the file stands in every score file.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, cast

import laticauda as lc
from laticauda import codec
from laticauda.errors import one_of
from laticauda.files import parse_toml
from laticauda.robot import Robot
from laticauda.scenarios import Scenario
from laticauda.scenarios.toml import run_from_table
from laticauda_gym.environments import SwimmingEnv, SwimmingVectorEnv
from laticauda_swimbench.task import Swim

FOLDER = Path(__file__).parent / "scenarios"
CHALLENGES = ("speed", "economy", "path", "disturbance", "broken")
"""Their names, in the order of the table."""
NOTHING = 1e-9  # what a motor that is off has left, in its own units: a law wants numbers above 0


@dataclass(frozen=True, kw_only=True)
class Challenge:
    """A scenario of the benchmark."""

    name: str
    """As in `CHALLENGES`."""
    version: int
    """Of the file."""
    description: str
    """One line about it."""
    sha256: str
    """Of the file."""
    seeds: tuple[int, ...]
    """One for each episode that is scored."""
    tasks: tuple[Swim, ...]
    """What is to be done; where there are several, they take turns with the seeds."""
    baseline: float
    """J that is a score of 0 [m/s]."""
    reference: float
    """J that is a score of 1 [m/s]."""
    laws: Mapping[str, Any]
    """The numbers of the reference."""

    def score(self, objective: float) -> float:
        """s = (J - J_0) / (J_1 - J_0), of an objective J [m/s]."""
        return (objective - self.baseline) / (self.reference - self.baseline)

    def shares(self, seeds: tuple[int, ...] | None = None) -> list[tuple[Swim, list[int]]]:
        """Which seeds go with which task.

        Args:
            seeds: Of episodes; None: those that are scored.
        """
        chosen = self.seeds if seeds is None else seeds
        n = len(self.tasks)
        return [(task, list(chosen[i::n])) for i, task in enumerate(self.tasks) if chosen[i::n]]


@cache
def challenge(name: str) -> Challenge:
    """A scenario of the benchmark.

    Args:
        name: One of `CHALLENGES`.

    Raises:
        ValueError: If there is none of that name.
    """
    file = FOLDER / f"{one_of('scenario', name, CHALLENGES)}.toml"
    content = file.read_bytes().replace(b"\r\n", b"\n")
    table = parse_toml(content.decode(), file)
    swims = cast(Scenario, run_from_table(table["swims"]))
    robots = [swims.robot, *[limp(swims.robot, joint, table["limp_damping"]) for joint in table.get("limp", ())]]
    scenarios = [replace(swims, robot=one) for one in (robots[1:] or robots)]
    return Challenge(
        name=name,
        version=table["scenario_version"],
        description=table["description"],
        sha256=hashlib.sha256(content).hexdigest(),
        seeds=tuple(table["seeds"]),
        tasks=tuple(codec.decode(Swim, table["task"] | {"scenario": one}) for one in scenarios),
        baseline=table["score"]["baseline"],
        reference=table["score"]["reference"],
        laws=table["score"]["laws"],
    )


def limp(robot: Robot, joint: int, damping: float) -> Robot:
    """The robot with a motor that is off, and takes no power.

    Args:
        robot: With all its motors.
        joint: Which one, from 0 at the tail.
        damping: Of its gear and skin, turned from outside [N m s/rad].
    """
    off = replace(robot.joints[joint].actuator, stall_torque=NOTHING, stall_current=NOTHING, servo_gain=NOTHING)
    joints = list(robot.joints)
    joints[joint] = replace(joints[joint], actuator=off, damping=damping)
    return replace(robot, joints=tuple(joints))


def make(name: str, n: int | None = None, *, variant: int = 0, **how: Any) -> SwimmingEnv | SwimmingVectorEnv:
    """A scenario as a Gymnasium environment, to learn in; its episodes are those of whatever seeds it is reset with.

    Args:
        name: One of `CHALLENGES`.
        n: How many robots side by side; None: one, in an environment that is no vector environment.
        variant: Which one, of a scenario that has several: the broken joint.
        how: What `SwimmingVectorEnv` takes besides its task.

    Raises:
        ValueError: If an argument is out of its range.

    Example:
        >>> env = make("path")
        >>> env.reset(seed=1)[0].shape
        (13,)
    """
    task = challenge(name).tasks[variant]
    return SwimmingEnv(task, **how) if n is None else SwimmingVectorEnv(n, task=task, **how)


def scenario_of(name: str) -> lc.Scenario:
    """Who swims where, healthy.

    Args:
        name: One of `CHALLENGES`.
    """
    table = parse_toml((FOLDER / f"{name}.toml").read_text(encoding="utf-8"), name)
    return cast(Scenario, run_from_table(table["swims"]))
