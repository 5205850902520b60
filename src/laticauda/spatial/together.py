"""Several robots in one MuJoCo model: their plants march as one, and each keeps its own state, command and log."""

# pyright: reportPrivateUsage=false

from collections.abc import Sequence

import numpy as np

from laticauda import series
from laticauda.dynamics.plant import PlantState
from laticauda.interfaces import Command
from laticauda.spatial import model, rows, scene, twin


class Together:
    """The plants of several robots in one scene; see `Twin` for their names in its model.

    Args:
        plants: Each alone with its robot, settings and scene, which is the same for all.
    """

    def __init__(self, plants: Sequence[model.SpatialPlant]) -> None:
        self.plants, first = plants, plants[0]
        others = [(plant.robot, plant.settings) for plant in plants[1:]]
        self.twin = twin.Twin(first.robot, first.environment, first.settings, others)
        self._environment = first.environment

    def check(self, each: Sequence[PlantState]) -> None:
        """Refuse states to begin with in which robots are in one another, or in something; in that case ValueError."""
        data = self.twin.data([state.values for state in each])
        scene.check_free(self.twin.model, data, self.twin.order.tolist())

    def march(
        self, each: Sequence[PlantState], commands: Sequence[Command], duration: float, sample_interval: float
    ) -> tuple[list[PlantState], list[series.Log], str | None]:
        """Many steps at once; see `Plant.march`.

        Args:
            each: Where each robot starts.
            commands: One for each robot, held all the while.
            duration: [s].
            sample_interval: Between two samples of the logs [s].
        """
        n_intervals = max(1, round(duration / sample_interval))
        every = max(plant.steps_in(duration / n_intervals) for plant in self.plants)
        given = [plant._rows(command) for plant, command in zip(self.plants, commands, strict=True)]
        ends = [plant._begun(a, b) for plant, a, b in zip(self.plants, each, commands, strict=True)]
        dt = duration / n_intervals / every
        log = self.twin.run(ends, given, n_intervals * every, dt, every, self._environment)
        parts = np.split(log, self.twin.places[1:-1, rows.FIRST_COLUMN], axis=1)
        known = list(zip(self.plants, commands, strict=True))
        logs = [plant._log(part, command) for (plant, command), part in zip(known, parts, strict=True)]
        if len(log) <= n_intervals:
            when = each[0].values[0] + len(log) * duration / n_intervals
            return list(each), logs, self.plants[0].what_went_wrong(when)
        found = [plant._ended(at, c, end) for (plant, c), at, end in zip(known, each, ends, strict=True)]
        return found, logs, None
