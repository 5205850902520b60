"""A school of robots in space: they share a few models in MuJoCo, one for every thread that marches them."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from laticauda import interfaces, robot
from laticauda.dynamics import school
from laticauda.dynamics.plant import PlantState
from laticauda.dynamics.school import Currents
from laticauda.spatial import model, rows

WAVE = rows.PHASE + np.array((0, 1, 3, 5, 7))  # phase, amplitude, frequency, phase shift, offset


class School(school.School[model.SpatialPlant]):
    """Robots in space, whose marches let go of the interpreter. Arguments are those of the base."""

    usual_threads = school.usable_cores()

    def _begin(self, threads: int) -> Sequence[range]:
        plant, n = self.plant, self.n
        own: list[model.SpatialPlant] = [plant] + [replace(plant) for _ in range(1, min(threads, n))]
        self._bodies = [own[i % len(own)] for i in range(n)]
        self._states = [plant.init(interfaces.Start(), self.command)] * n
        self._work = rows.WORK_ABSOLUTE + (3 if robot.has_power_model(plant.robot, plant.joints) else 0)
        return [range(first, n, len(own)) for first in range(len(own))]

    def state(self, which: int) -> PlantState:
        """The state of one of them, for `SpatialPlant`."""
        return self._states[which]

    def _place(self, which: np.ndarray, center_of_mass: np.ndarray, heading: np.ndarray, current: Currents) -> None:
        for k, i in enumerate(map(int, which)):
            start = interfaces.Start(center_of_mass=tuple(center_of_mass[k].tolist()), heading=float(heading[k]))
            self._bodies[i] = self._bodies[i].in_current(cast(Any, current[k]))
            self._states[i] = self._bodies[i].init(start, self.command)

    def _swim(self, told: np.ndarray, duration: float) -> np.ndarray:
        gaits = [replace(self.command.gait, **dict(zip(school.TOLD, one, strict=True))) for one in told.T.tolist()]
        well = self._well.copy()

        def march(share: range) -> None:
            for i in share:
                command = replace(self.command, gait=gaits[i], offset=0.0)
                self._states[i], _, failure = self._bodies[i].march(self._states[i], command, duration, duration)
                well[i] &= failure is None

        self._on_threads(march)
        return well

    def _look(self) -> tuple[np.ndarray, tuple[interfaces.Observation, ...]]:
        found: list[np.ndarray] = []
        seen = tuple(body.observe(state) for body, state in zip(self._bodies, self._states, strict=True))
        for one, state in zip(seen, self._states, strict=True):
            place, velocity = one.center_of_mass[:2], one.center_of_mass_velocity[:2]
            waves = state.values[[*WAVE, self._work]]
            found.append(np.array([one.time, *place, *velocity, one.heading, one.heading_rate, *waves]))
        return np.stack(found, axis=1), seen
