"""A school: equal robots side by side, each told anew what to do whenever a control interval is over.

A robot may begin anew at any time, with a start and a current of its own, and one whose numbers leave all bounds harms
no other one. Its numbers are those of the same robot alone (`Plant.step`), whatever its neighbors do.
"""

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.dynamics.plant import Plant, PlantState
from laticauda.errors import BadArgument, positive, whole
from laticauda.fluid.flow import Flow
from laticauda.interfaces import Command, Observation
from laticauda.robot import Current, Water

Currents: TypeAlias = Sequence[Current]
PlantType = TypeVar("PlantType", bound=Plant[Any])
CLOSE = 1e-9  # [s]: two moments that are one
TOLD = ("amplitude", "frequency", "phase_shift", "offset")
"""What robots of a school are told."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """How all robots of a school move at one moment; world axes, one entry per robot."""

    time: Float[np.ndarray, " n"]
    """Since its start [s]."""
    x: Float[np.ndarray, " n"]
    """Of the center of mass [m]."""
    y: Float[np.ndarray, " n"]
    """The same [m]."""
    velocity_x: Float[np.ndarray, " n"]
    """Of the center of mass, over ground [m/s]."""
    velocity_y: Float[np.ndarray, " n"]
    """The same [m/s]."""
    heading: Float[np.ndarray, " n"]
    """Mean link angle (6), unwrapped, with the gait's ripple [rad]."""
    heading_rate: Float[np.ndarray, " n"]
    """[rad/s]."""
    phase: Float[np.ndarray, " n"]
    """Of the gait at the tail-most joint, unwrapped [rad]."""
    amplitude: Float[np.ndarray, " n"]
    """alpha as the reference generator has it by now, without the smooth start [rad]."""
    frequency: Float[np.ndarray, " n"]
    """omega, the same [rad/s]."""
    phase_shift: Float[np.ndarray, " n"]
    """delta, the same [rad]."""
    offset: Float[np.ndarray, " n"]
    """phi_0, the same [rad]."""
    work: Float[np.ndarray, " n"]
    """What `mean_power` counts, since its start: electrical where the robot has a power model, else mechanical [J]."""
    observations: tuple[Observation, ...] = ()
    """All that can be seen of each robot, its contacts and its rays too; of the spatial model alone."""


NAMES = tuple(part.name for part in fields(Motion))[:-1]


class School(ABC, Generic[PlantType]):
    """Robots of one plant in places that stay.

    Args:
        plant: What each of them is; it swims in water.
        command: What they are asked for until they are told otherwise, and where their generators begin.
        n: How many.
        interval: From one command to the next [s].
        threads: The robots are shared out among as many, to no effect on their numbers; None: see `usual_threads`.

    Raises:
        ValueError: If an argument is out of its range.
    """

    usual_threads: ClassVar[int]
    """How many pay where nobody knows what else the cores have to do."""

    def __init__(
        self, plant: PlantType, command: Command, n: int, interval: float, *, threads: int | None = None
    ) -> None:
        if not isinstance(plant.environment, Water):
            raise BadArgument("plant", "must swim in water, got one on the ground")
        self.plant, self.n, self.command = plant, whole("n", n, 1), command
        self.interval = positive("interval", interval, "s")
        self._well = np.full(n, True)
        gait = command.steered
        self._first = np.array([gait.amplitude, gait.frequency, gait.phase_shift, gait.offset])
        # What was told last stands last in line; what acts until the delay is over, before what acts from then on.
        late, part = divmod(plant.settings.loop_delay + CLOSE, self.interval)
        cut = [part - CLOSE] if part > 2.0 * CLOSE else []
        self._line = [np.repeat(self._first[:, np.newaxis], n, axis=1) for _ in range(int(late) + 1 + len(cut))]
        self._parts = [*cut, self.interval - sum(cut)]
        self._shares = self._begin(self.usual_threads if threads is None else whole("threads", threads, 1))
        self._workers = ThreadPoolExecutor(len(self._shares))
        self._keep_seen()

    @property
    def motion(self) -> Motion:
        """How they move; of one that failed, the last that made sense."""
        return self._motion

    @property
    def is_well(self) -> Bool[np.ndarray, " n"]:
        """Whether the numbers of each robot are still within all bounds."""
        return self._well.copy()

    def place(
        self,
        which: Int[np.ndarray, " n_placed"],
        *,
        center_of_mass: Float[np.ndarray, "n_placed 2"],
        heading: Float[np.ndarray, " n_placed"],
        current: Sequence[Current] | Float[np.ndarray, "n_placed 2"],
    ) -> None:
        """Let some of them begin anew: straight, at rest, their generators at the first command.

        Args:
            which: Their numbers.
            center_of_mass: Where [m].
            heading: [rad].
            current: Velocity of the water around each, world axes [m/s], or its flow; one of the same kinds of parts as
                the plant's, and as many of each.

        Raises:
            ValueError: If a flow is another one.
        """
        for told in self._line:
            told[:, which] = self._first[:, np.newaxis]
        waters = [one if isinstance(one, Flow) else (float(one[0]), float(one[1])) for one in current]
        self._place(which, center_of_mass, heading, waters)
        self._well[which] = True
        self._keep_seen()

    def tell(self, command: Mapping[str, Float[np.ndarray, " n"]]) -> None:
        """Ask every robot for something else from now on, or from when the plant's `loop_delay` is over.

        Args:
            command: Any of amplitude [rad], frequency [rad/s], phase_shift [rad] and offset [rad]; the last is the
                gait's own and what steering adds.
        """
        for name, values in command.items():
            self._line[-1][TOLD.index(name)] = values

    def march(self) -> None:
        """Let one interval go by."""
        for duration, told in zip(self._parts, self._line, strict=False):
            self._well &= self._swim(told, duration)
        self._line = [*self._line[1:], self._line[-1].copy()]
        self._keep_seen()

    def observe(self, which: int) -> Observation:
        """What can be seen of one of them."""
        return self.plant.observe(self.state(which))

    @abstractmethod
    def state(self, which: int) -> PlantState:
        """The state of one of them, for the plant."""

    def close(self) -> None:
        """Let threads go."""
        self._workers.shutdown()

    @abstractmethod
    def _begin(self, threads: int) -> Sequence[Any]:
        """Make room for all robots; their shares, one for each thread and no more than `threads`."""

    def _on_threads(self, work: Callable[[Any], None]) -> None:
        """Do something with every share."""
        if len(self._shares) == 1:
            work(self._shares[0])
        else:
            list(self._workers.map(work, self._shares))

    @abstractmethod
    def _place(self, which: np.ndarray, center_of_mass: np.ndarray, heading: np.ndarray, current: Currents) -> None:
        """As `place`."""

    @abstractmethod
    def _swim(self, told: np.ndarray, duration: float) -> np.ndarray:
        """All of them, as they were told, for so long [s]; whether each is well."""

    @abstractmethod
    def _look(self) -> tuple[np.ndarray, tuple[Observation, ...]]:
        """The numbers of a `Motion`, a row each, and what can be seen."""

    def _keep_seen(self) -> None:
        rows, observations = self._look()
        if not self._well.all():
            rows = np.where(self._well, rows, [getattr(self._motion, name) for name in NAMES])
        rows.flags.writeable = False  # it is handed out
        self._motion = Motion(**dict(zip(NAMES, rows, strict=True)), observations=observations)


def usable_cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1  # pragma: no cover - systems that bind no process to cores
