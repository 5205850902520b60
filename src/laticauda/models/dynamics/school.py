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

from laticauda.models.dynamics.plant import Plant
from laticauda.models.dynamics.samples import PlantState
from laticauda.robot import Current, Water
from laticauda.scenarios import Command, Observation
from laticauda.values import BadArgument, check_positive, check_whole_number
from laticauda.water.fluid import Flow

Currents: TypeAlias = Sequence[Current]
PlantType = TypeVar("PlantType", bound=Plant[Any])
CLOSE = 1e-9
"""Times that differ by less are equal [s]."""
GAIT_PARAMETERS = ("amplitude", "frequency", "phase_shift", "offset")
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


NUMBERS_OF_MOTION = tuple(field.name for field in fields(Motion) if field.name != "observations")
"""Fields of a `Motion` that are one number per robot."""


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
        self.plant = plant
        self.n = check_whole_number("n", n, 1)
        self.command = command
        self.interval = check_positive("interval", interval, "s")
        self._is_well = np.full(n, True)
        gait = command.steered
        self._first = np.array([getattr(gait, name) for name in GAIT_PARAMETERS])
        self._durations = self._split_interval()
        self._waiting_gaits = self._create_queue()
        if threads is None:
            threads = self.usual_threads
        else:
            threads = check_whole_number("threads", threads, 1)
        self._shares = self._allocate(threads)
        self._workers = ThreadPoolExecutor(len(self._shares))
        self._update_motion()

    def _split_delay(self) -> tuple[int, float]:
        """Return the plant's delay as a number of whole intervals, and what is left over [s]."""
        n_intervals, remainder = divmod(self.plant.settings.loop_delay + CLOSE, self.interval)
        return int(n_intervals), remainder - CLOSE

    def _split_interval(self) -> list[float]:
        """Return the durations of the parts of an interval [s]: before a new command takes effect, and after it."""
        _, remainder = self._split_delay()
        if remainder <= CLOSE:
            return [self.interval]
        return [remainder, self.interval - remainder]

    def _create_queue(self) -> list[np.ndarray]:
        """Return the gaits of the next parts of intervals, one row per parameter; the last is the latest command.

        A command that acts until the delay is over precedes the next one.
        """
        n_late, _ = self._split_delay()
        n_waiting = n_late + len(self._durations)
        return [np.repeat(self._first[:, np.newaxis], self.n, axis=1) for _ in range(n_waiting)]

    @property
    def motion(self) -> Motion:
        """Motion of all robots; for a failed robot, its last valid motion."""
        return self._motion

    @property
    def is_well(self) -> Bool[np.ndarray, " n"]:
        """Whether each robot's numbers are still within bounds."""
        return self._is_well.copy()

    def place(
        self,
        indices: Int[np.ndarray, " n_placed"],
        *,
        center_of_mass: Float[np.ndarray, "n_placed 2"],
        heading: Float[np.ndarray, " n_placed"],
        current: Sequence[Current] | Float[np.ndarray, "n_placed 2"],
    ) -> None:
        """Restart some of the robots: straight, at rest, their generators at the initial command.

        Args:
            indices: Indices of the robots.
            center_of_mass: Positions of the center of mass [m].
            heading: Headings [rad].
            current: Velocity of the water around each robot, world axes [m/s], or its flow, which
                must have the same kinds and numbers of parts as the plant's.

        Raises:
            ValueError: If a flow has other parts.
        """
        for gaits in self._waiting_gaits:
            gaits[:, indices] = self._first[:, np.newaxis]
        currents: list[Current] = []
        for motion in current:
            if isinstance(motion, Flow):
                currents.append(motion)
            else:
                currents.append((float(motion[0]), float(motion[1])))
        self._restart(indices, center_of_mass, heading, currents)
        self._is_well[indices] = True
        self._update_motion()

    def tell(self, command: Mapping[str, Float[np.ndarray, " n"]]) -> None:
        """Give every robot a new command, which takes effect after the plant's `loop_delay`, if any.

        Args:
            command: Any of amplitude [rad], frequency [rad/s], phase_shift [rad] and offset [rad];
                the last is the gait's own offset plus that of steering.
        """
        latest_gaits = self._waiting_gaits[-1]
        for name, values in command.items():
            latest_gaits[GAIT_PARAMETERS.index(name)] = values

    def march(self) -> None:
        """Simulate one interval."""
        # More commands than parts of an interval wait if the delay is longer than an interval.
        for duration, gaits in zip(self._durations, self._waiting_gaits, strict=False):
            self._is_well &= self._swim(gaits, duration)
        latest_gaits = self._waiting_gaits[-1]
        self._waiting_gaits = [*self._waiting_gaits[1:], latest_gaits.copy()]
        self._update_motion()

    def observe(self, index: int) -> Observation:
        """Return the observation of one robot."""
        return self.plant.observe(self.state(index))

    @abstractmethod
    def state(self, index: int) -> PlantState:
        """Return the state of one robot, for the plant."""

    def close(self) -> None:
        """Release the threads."""
        self._workers.shutdown()

    @abstractmethod
    def _allocate(self, n_threads: int) -> Sequence[Any]:
        """Allocate all robots; return their shares, one per thread and at most `n_threads`."""

    def _apply_to_shares(self, work: Callable[[Any], None]) -> None:
        """Apply `work` to every share, each in its thread."""
        if len(self._shares) == 1:
            work(self._shares[0])
        else:
            list(self._workers.map(work, self._shares))

    @abstractmethod
    def _restart(
        self,
        indices: np.ndarray,
        center_of_mass: np.ndarray,
        heading: np.ndarray,
        currents: Currents,
    ) -> None:
        """Restart robots as `place` does."""

    @abstractmethod
    def _swim(self, gaits: np.ndarray, duration: float) -> np.ndarray:
        """Simulate all robots with these gaits for `duration` [s]; return whether each is within bounds."""

    @abstractmethod
    def _read_motion(self) -> tuple[np.ndarray, tuple[Observation, ...]]:
        """Return the fields of a `Motion`, one row each, and the observations."""

    def _update_motion(self) -> None:
        """Read the motion of all robots; a failed robot keeps its last valid one."""
        rows, observations = self._read_motion()
        if not self._is_well.all():
            last_rows = [getattr(self._motion, name) for name in NUMBERS_OF_MOTION]
            rows = np.where(self._is_well, rows, last_rows)
        # It is handed out.
        rows.flags.writeable = False
        numbers = dict(zip(NUMBERS_OF_MOTION, rows, strict=True))
        self._motion = Motion(**numbers, observations=observations)


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1  # pragma: no cover - systems that bind no process to cores
