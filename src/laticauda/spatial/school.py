"""A school of robots in space: they share a few models in MuJoCo, one for every thread that marches them."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from laticauda.dynamics import school
from laticauda.dynamics.plant import PlantState
from laticauda.dynamics.school import usable_cores
from laticauda.errors import whole
from laticauda.interfaces import Command, Observation, Start
from laticauda.robot import has_power_model
from laticauda.spatial import rows
from laticauda.spatial.model import SpatialPlant

WAVE = rows.PHASE + np.array((0, 1, 3, 5, 7))  # phase, amplitude, frequency, phase shift, offset


class School(school.School[SpatialPlant]):
    """Robots in space.

    Args:
        plant: See `laticauda.dynamics.school.School`.
        command: As there.
        n: As there.
        interval: As there [s].
        threads: How many march them; None: one for every core that this process may use.

    Raises:
        ValueError: If an argument is out of its range.
    """

    def __init__(
        self, plant: SpatialPlant, command: Command, n: int, interval: float, *, threads: int | None = None
    ) -> None:
        super().__init__(plant, command, n, interval)
        own = [plant] + [
            replace(plant)
            for _ in range(1, min(whole("threads", usable_cores() if threads is None else threads, 1), n))
        ]
        self._bodies: list[SpatialPlant] = [own[i % len(own)] for i in range(n)]
        self._states = [plant.init(Start(), command)] * n
        self._shares = [range(first, n, len(own)) for first in range(len(own))]
        self._workers = ThreadPoolExecutor(len(own))
        self._work = rows.WORK_ABSOLUTE + (3 if has_power_model(plant.robot, plant.joints) else 0)
        self._keep_seen()

    def state(self, which: int) -> PlantState:
        """The state of one of them, for `SpatialPlant`."""
        return self._states[which]

    def close(self) -> None:
        """Let threads go."""
        self._workers.shutdown()

    def _place(self, which: np.ndarray, center_of_mass: np.ndarray, heading: np.ndarray, current: np.ndarray) -> None:
        for k, i in enumerate(map(int, which)):
            start = Start(center_of_mass=tuple(center_of_mass[k].tolist()), heading=float(heading[k]))
            self._bodies[i] = self._bodies[i].in_current(current[k].tolist())
            self._states[i] = self._bodies[i].init(start, self.command)

    def _swim(self, told: np.ndarray, duration: float) -> np.ndarray:
        gaits = [replace(self.command.gait, **dict(zip(school.TOLD, one, strict=True))) for one in told.T.tolist()]
        well = self._well.copy()

        def march(share: range) -> None:
            for i in share:
                command = replace(self.command, gait=gaits[i], offset=0.0)
                self._states[i], _, failure = self._bodies[i].march(self._states[i], command, duration, duration)
                well[i] &= failure is None

        list(self._workers.map(march, self._shares))
        return well

    def _look(self) -> tuple[np.ndarray, tuple[Observation, ...]]:
        found: list[np.ndarray] = []
        seen = tuple(body.observe(state) for body, state in zip(self._bodies, self._states, strict=True))
        for one, state in zip(seen, self._states, strict=True):
            place, velocity = one.center_of_mass[:2], one.center_of_mass_velocity[:2]
            waves = state.values[[*WAVE, self._work]]
            found.append(np.array([one.time, *place, *velocity, one.heading, one.heading_rate, *waves]))
        return np.stack(found, axis=1), seen
