"""A school: identical robots side by side, each of which receives a new command after every control interval.

A robot may restart at any time, with its own start and current, and one that diverges does not
affect the others. Its results are those of the same robot alone (`Plant.step`), whatever its
neighbors do.
"""

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.models.dynamics.plant import Plant, PlantState
from laticauda.robot import Current, Water
from laticauda.scenarios import Command, Observation
from laticauda.values import BadArgument, check_positive, check_whole_number
from laticauda.water.fluid import Flow

Currents: TypeAlias = Sequence[Current]
PlantType = TypeVar("PlantType", bound=Plant[Any])
CLOSE = 1e-9  # [s]: times that differ by less are equal
TOLD = ("amplitude", "frequency", "phase_shift", "offset")
"""Gait parameters that robots of a school are commanded."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """Motion of all robots of a school at one instant; world axes, one entry per robot."""

    time: Float[np.ndarray, " n"]
    """Time since the robot's start [s]."""
    x: Float[np.ndarray, " n"]
    """x of the center of mass [m]."""
    y: Float[np.ndarray, " n"]
    """y of the center of mass [m]."""
    velocity_x: Float[np.ndarray, " n"]
    """Velocity of the center of mass along x, over ground [m/s]."""
    velocity_y: Float[np.ndarray, " n"]
    """Velocity of the center of mass along y, over ground [m/s]."""
    heading: Float[np.ndarray, " n"]
    """Mean link angle (6), unwrapped, with the gait's ripple [rad]."""
    heading_rate: Float[np.ndarray, " n"]
    """Rate of the heading [rad/s]."""
    phase: Float[np.ndarray, " n"]
    """Phase of the gait at the tail-most joint, unwrapped [rad]."""
    amplitude: Float[np.ndarray, " n"]
    """Current alpha of the reference generator, without the smooth start [rad]."""
    frequency: Float[np.ndarray, " n"]
    """Current omega of the reference generator [rad/s]."""
    phase_shift: Float[np.ndarray, " n"]
    """Current delta of the reference generator [rad]."""
    offset: Float[np.ndarray, " n"]
    """Current phi_0 of the reference generator [rad]."""
    work: Float[np.ndarray, " n"]
    """Work since the start, as for `mean_power`: electrical if the robot has a power model, else mechanical [J]."""
    observations: tuple[Observation, ...] = ()
    """Full observation of each robot, including contacts and rays; spatial model only."""


NAMES = tuple(part.name for part in fields(Motion))[:-1]


class School(ABC, Generic[PlantType]):
    """Robots of one plant, each in a fixed slot.

    Args:
        plant: Plant of each robot, in water.
        command: Initial command, held until another one is given; the generators start from it.
        n: Number of robots.
        interval: Time between two commands [s].
        threads: Number of threads that share the robots, without effect on the results; None: see
            `usual_threads`.

    Raises:
        ValueError: If an argument is out of range.
    """

    usual_threads: ClassVar[int]
    """Number of threads that pays off when the load on the cores is unknown."""

    def __init__(
        self,
        plant: PlantType,
        command: Command,
        n: int,
        interval: float,
        *,
        threads: int | None = None,
    ) -> None:
        if not isinstance(plant.environment, Water):
            raise BadArgument("plant", "must swim in water, got one on the ground")
        self.plant, self.n, self.command = plant, check_whole_number("n", n, 1), command
        self.interval = check_positive("interval", interval, "s")
        self._well = np.full(n, True)
        gait = command.steered
        self._first = np.array([gait.amplitude, gait.frequency, gait.phase_shift, gait.offset])
        # The queue ends with the latest command; a command that acts until the delay is over
        # precedes the next one.
        late, part = divmod(plant.settings.loop_delay + CLOSE, self.interval)
        cut = [part - CLOSE] if part > 2.0 * CLOSE else []
        self._line = [
            np.repeat(self._first[:, np.newaxis], n, axis=1)
            for _ in range(int(late) + 1 + len(cut))
        ]
        self._parts = [*cut, self.interval - sum(cut)]
        self._shares = self._begin(
            self.usual_threads if threads is None else check_whole_number("threads", threads, 1)
        )
        self._workers = ThreadPoolExecutor(len(self._shares))
        self._keep_seen()

    @property
    def motion(self) -> Motion:
        """Motion of all robots; for a failed robot, its last valid motion."""
        return self._motion

    @property
    def is_well(self) -> Bool[np.ndarray, " n"]:
        """Whether each robot's numbers are still within bounds."""
        return self._well.copy()

    def place(
        self,
        which: Int[np.ndarray, " n_placed"],
        *,
        center_of_mass: Float[np.ndarray, "n_placed 2"],
        heading: Float[np.ndarray, " n_placed"],
        current: Sequence[Current] | Float[np.ndarray, "n_placed 2"],
    ) -> None:
        """Restart some of the robots: straight, at rest, their generators at the initial command.

        Args:
            which: Indices of the robots.
            center_of_mass: Positions of the center of mass [m].
            heading: Headings [rad].
            current: Velocity of the water around each robot, world axes [m/s], or its flow, which
                must have the same kinds and numbers of parts as the plant's.

        Raises:
            ValueError: If a flow has other parts.
        """
        for told in self._line:
            told[:, which] = self._first[:, np.newaxis]
        waters = [
            one if isinstance(one, Flow) else (float(one[0]), float(one[1])) for one in current
        ]
        self._place(which, center_of_mass, heading, waters)
        self._well[which] = True
        self._keep_seen()

    def tell(self, command: Mapping[str, Float[np.ndarray, " n"]]) -> None:
        """Give every robot a new command, which takes effect after the plant's `loop_delay`, if any.

        Args:
            command: Any of amplitude [rad], frequency [rad/s], phase_shift [rad] and offset [rad];
                the last is the gait's own offset plus that of steering.
        """
        for name, values in command.items():
            self._line[-1][TOLD.index(name)] = values

    def march(self) -> None:
        """Simulate one interval."""
        for duration, told in zip(self._parts, self._line, strict=False):
            self._well &= self._swim(told, duration)
        self._line = [*self._line[1:], self._line[-1].copy()]
        self._keep_seen()

    def observe(self, which: int) -> Observation:
        """Return the observation of one robot."""
        return self.plant.observe(self.state(which))

    @abstractmethod
    def state(self, which: int) -> PlantState:
        """Return the state of one robot, for the plant."""

    def close(self) -> None:
        """Release the threads."""
        self._workers.shutdown()

    @abstractmethod
    def _begin(self, threads: int) -> Sequence[Any]:
        """Allocate all robots; return their shares, one per thread and at most `threads`."""

    def _on_threads(self, work: Callable[[Any], None]) -> None:
        """Apply `work` to every share."""
        if len(self._shares) == 1:
            work(self._shares[0])
        else:
            list(self._workers.map(work, self._shares))

    @abstractmethod
    def _place(
        self, which: np.ndarray, center_of_mass: np.ndarray, heading: np.ndarray, current: Currents
    ) -> None:
        """Restart robots as `place` does."""

    @abstractmethod
    def _swim(self, told: np.ndarray, duration: float) -> np.ndarray:
        """Simulate all robots with the commands `told` for `duration` [s]; return whether each is within bounds."""

    @abstractmethod
    def _look(self) -> tuple[np.ndarray, tuple[Observation, ...]]:
        """Return the fields of a `Motion`, one row each, and the observations."""

    def _keep_seen(self) -> None:
        rows, observations = self._look()
        if not self._well.all():
            rows = np.where(self._well, rows, [getattr(self._motion, name) for name in NAMES])
        rows.flags.writeable = False  # it is handed out
        self._motion = Motion(**dict(zip(NAMES, rows, strict=True)), observations=observations)


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1  # pragma: no cover - systems that bind no process to cores
