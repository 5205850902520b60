"""Thrusters and pectoral fins that take time to do what they are told, or do not move for little.

What an effector does goes to its target as v' = (target - v) / T with T = rise_time / ln 9, so that a
step takes the rise time from 10 % to 90 %. The servo of a fin with a dead band stands still once it is
that near. The target of a thruster is 0 within its dead band, and no target is beyond the limit.

Within a piece of a march an effector is held at its mean over the piece, so that its impulse is exact.
What the effectors do at the start of a run is its first command.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import numpy as np

from laticauda.robot import Robot
from laticauda.scenarios import EFFECTORS, Command

RISE_OF_TIME_CONSTANT = math.log(9.0)
"""Time from 10 % to 90 % of a step, relative to the time constant [-]."""
SETTLED = 1e-6
"""Distance from the target below which an effector is there, relative to its limit [-]."""
PIECES_PER_TIME_CONSTANT = 4.0
"""Pieces of a march within the shortest time constant [-]."""


@dataclass(frozen=True, kw_only=True)
class CommandInEffect(Command):
    """A command with what all driven effectors do at a moment, which is set as it is."""

    def effectors(self, robot: Robot) -> Robot:
        """See `Command`."""
        changes: dict[str, Any] = {}
        for kind in EFFECTORS:
            effectors = list(getattr(robot, kind.robot_field))
            values: Sequence[float] = getattr(self, kind.command_field)
            driven = [i for i, effector in enumerate(effectors) if kind.drives(effector)]
            for i, value in zip(driven, values, strict=True):
                effectors[i] = replace(effectors[i], **{kind.quantity: value})
            changes[kind.robot_field] = tuple(effectors)
        return replace(robot, **changes)


class Course(NamedTuple):
    """What effectors do in a piece of a march."""

    mean: np.ndarray
    """Mean over the piece [N, rad]."""
    end: np.ndarray
    """Value at its end [N, rad]."""


class EffectorDynamics:
    """The driven effectors of a robot: thrusters, then fins, in the robot's order.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        names: list[str] = []
        limits: list[float] = []
        time_constants: list[float] = []
        stops_within: list[float] = []
        for kind in EFFECTORS:
            for i, effector in enumerate(getattr(robot, kind.robot_field)):
                limit = kind.limit_of(effector)
                if limit is None:
                    continue
                names.append(f"{kind.quantity}_{i}")
                limits.append(limit)
                time_constants.append(effector.rise_time / RISE_OF_TIME_CONSTANT)
                stops_within.append(effector.dead_band if kind.has_servo else 0.0)
        self.names = tuple(names)
        """Names of what they do, for logs."""
        self._time_constants = np.array(time_constants)
        self._stops_within = np.array(stops_within)
        self.has_memory = bool(
            np.any(self._time_constants > 0.0) or np.any(self._stops_within > 0.0)
        )
        """Whether what any of them does depends on what it did before."""
        self._near = self._stops_within + SETTLED * np.array(limits)

    @property
    def n(self) -> int:
        """Number of driven effectors."""
        return len(self.names)

    @property
    def longest_piece(self) -> float:
        """Longest piece of a march while an effector moves [s]."""
        lags = self._time_constants[self._time_constants > 0.0]
        if lags.size == 0:
            return math.inf
        return float(lags.min()) / PIECES_PER_TIME_CONSTANT

    def targets_of(self, command: Command) -> np.ndarray:
        """Return what the effectors will do if a command is held for long [N, rad].

        Args:
            command: The command.

        Raises:
            ValueError: If the numbers of values and of driven effectors differ, or a value is not finite.
        """
        robot = command.effectors(self._robot)
        values: list[float] = []
        for kind in EFFECTORS:
            for effector in getattr(robot, kind.robot_field):
                if kind.drives(effector):
                    values.append(getattr(effector, kind.quantity))
        return np.array(values)

    def are_settled(self, values: np.ndarray, targets: np.ndarray) -> bool:
        """Return whether no effector moves any more.

        Args:
            values: What they do [N, rad].
            targets: Their targets [N, rad].
        """
        return bool(np.all(np.abs(targets - values) <= self._near))

    def move(self, values: np.ndarray, targets: np.ndarray, duration: float) -> Course:
        """Return what the effectors do in a piece of a march.

        Args:
            values: What they do at its begin [N, rad].
            targets: Their targets [N, rad].
            duration: Its duration [s].
        """
        mean = np.empty_like(values)
        end = np.empty_like(values)
        for i, (value, target) in enumerate(zip(values.tolist(), targets.tolist(), strict=True)):
            mean[i], end[i] = self._move_one(i, value - target, duration)
        return Course(mean=targets + mean, end=targets + end)

    def _move_one(self, i: int, distance: float, duration: float) -> tuple[float, float]:
        """Return the mean distance from the target over a piece, and that at its end."""
        stop = float(self._stops_within[i])
        if abs(distance) <= self._near[i]:
            # A servo stands still; any other effector is there.
            rest = distance if stop > 0.0 else 0.0
            return rest, rest
        time_constant = float(self._time_constants[i])
        if time_constant == 0.0:
            return 0.0, 0.0
        moving = duration
        if stop > 0.0:
            moving = min(duration, time_constant * math.log(abs(distance) / stop))
        end = distance * math.exp(-moving / time_constant)
        area = time_constant * (distance - end) + end * (duration - moving)
        return area / duration, end

    def in_effect(self, command: Command, values: np.ndarray) -> Command:
        """Return a command with what the effectors do at a moment.

        Args:
            command: The command that is held.
            values: What they do [N, rad].
        """
        told = {field.name: getattr(command, field.name) for field in fields(command)}
        rest = iter(values.tolist())
        for kind in EFFECTORS:
            effectors = getattr(self._robot, kind.robot_field)
            told[kind.command_field] = tuple(
                next(rest) for effector in effectors if kind.drives(effector)
            )
        return CommandInEffect(**told)
