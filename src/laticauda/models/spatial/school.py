"""Several robots in space: a school that shares a few MuJoCo models, one per thread, or all robots in one model."""

# pyright: reportPrivateUsage=false

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from laticauda import robot
from laticauda.models.dynamics import school
from laticauda.models.dynamics.plant import PlantState, Stretch
from laticauda.models.dynamics.school import Currents
from laticauda.models.spatial import model, rows, scene, twin
from laticauda.scenarios import Command, interfaces

WAVE = rows.PHASE + np.array((0, 1, 3, 5, 7))  # phase, amplitude, frequency, phase shift, offset


class School(school.School[model.SpatialPlant]):
    """Robots in space, whose runs release the interpreter lock. Arguments are those of the base class."""

    usual_threads = school.usable_cores()

    def _begin(self, threads: int) -> Sequence[range]:
        plant, n = self.plant, self.n
        own: list[model.SpatialPlant] = [plant] + [
            replace(plant) for _ in range(1, min(threads, n))
        ]
        self._bodies = [own[i % len(own)] for i in range(n)]
        self._states = [plant.init(interfaces.Start(), self.command)] * n
        self._work = rows.WORK_ABSOLUTE + (
            3 if robot.has_power_model(plant.robot, plant.joints) else 0
        )
        return [range(first, n, len(own)) for first in range(len(own))]

    def state(self, which: int) -> PlantState:
        """Return the state of one robot, for `SpatialPlant`."""
        return self._states[which]

    def _place(
        self, which: np.ndarray, center_of_mass: np.ndarray, heading: np.ndarray, current: Currents
    ) -> None:
        for k, i in enumerate(map(int, which)):
            start = interfaces.Start(
                center_of_mass=tuple(center_of_mass[k].tolist()), heading=float(heading[k])
            )
            self._bodies[i] = self._bodies[i].in_current(cast(Any, current[k]))
            self._states[i] = self._bodies[i].init(start, self.command)

    def _swim(self, told: np.ndarray, duration: float) -> np.ndarray:
        gaits = [
            replace(self.command.gait, **dict(zip(school.TOLD, one, strict=True)))
            for one in told.T.tolist()
        ]
        well = self._well.copy()

        def march(share: range) -> None:
            for i in share:
                command = replace(self.command, gait=gaits[i], offset=0.0)
                self._states[i], _, failure = self._bodies[i].march(
                    self._states[i], command, duration, duration
                )
                well[i] &= failure is None

        self._on_threads(march)
        return well

    def _look(self) -> tuple[np.ndarray, tuple[interfaces.Observation, ...]]:
        found: list[np.ndarray] = []
        seen = tuple(
            body.observe(state) for body, state in zip(self._bodies, self._states, strict=True)
        )
        for one, state in zip(seen, self._states, strict=True):
            place, velocity = one.center_of_mass[:2], one.center_of_mass_velocity[:2]
            waves = state.values[[*WAVE, self._work]]
            found.append(
                np.array([one.time, *place, *velocity, one.heading, one.heading_rate, *waves])
            )
        return np.stack(found, axis=1), seen


class Together:
    """The plants of several robots in one scene, advanced together; see `Twin` for their names in its model.

    Args:
        plants: One plant per robot, with the robot's own settings and the same scene for all.
    """

    def __init__(self, plants: Sequence[model.SpatialPlant]) -> None:
        self.plants, first = plants, plants[0]
        others = [(plant.robot, plant.settings) for plant in plants[1:]]
        self.twin = twin.Twin(first.robot, first.environment, first.settings, others)

    def check(self, each: Sequence[PlantState]) -> None:
        """Raise a ValueError if robots penetrate one another, or another object, in the initial states."""
        data = self.twin.data([state.values for state in each])
        scene.check_free(self.twin.model, data, self.twin.order.tolist())

    def march(
        self,
        each: Sequence[PlantState],
        commands: Sequence[Command],
        duration: float,
        sample_interval: float,
    ) -> tuple[list[PlantState], list[Stretch], str | None]:
        """Advance by many steps at once; see `Plant.advance`.

        Args:
            each: Initial state of each robot.
            commands: One command per robot, held throughout.
            duration: Duration [s].
            sample_interval: Interval between two samples of the logs [s].
        """
        n_intervals = max(1, round(duration / sample_interval))
        every = max(plant.steps_in(duration / n_intervals) for plant in self.plants)
        known = list(zip(self.plants, commands, strict=True))
        given = [plant._rows(command) for plant, command in known]
        ends = [plant._begun(a, b) for plant, a, b in zip(self.plants, each, commands, strict=True)]
        dt = duration / n_intervals / every
        log = self.twin.run(ends, given, n_intervals * every, dt, every, self.plants[0].environment)
        parts = np.split(log, self.twin.places[1:-1, rows.FIRST_COLUMN], axis=1)
        logs = [Stretch(part, command) for command, part in zip(commands, parts, strict=True)]
        if len(log) <= n_intervals:
            when = each[0].values[0] + len(log) * duration / n_intervals
            return list(each), logs, self.plants[0].what_went_wrong(when)
        found = [
            plant._ended(at, c, end) for (plant, c), at, end in zip(known, each, ends, strict=True)
        ]
        return found, logs, None
