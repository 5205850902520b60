"""A school of robots in space: they share a few models in MuJoCo, one for every thread that marches them."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import cast

import numpy as np

from laticauda.dynamics import school
from laticauda.dynamics.plant import PlantState
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
        models = school.shares(threads or school.usable_cores(), n)
        own = [plant, *(replace(plant) for _ in models[1:])]
        self._shares = models
        self._bodies = [own[i % len(own)] for i in range(n)]
        self._states = [plant.init(Start(), command)] * n
        self._workers = ThreadPoolExecutor(len(models))
        self._work = rows.WORK_ABSOLUTE + (3 if has_power_model(plant.robot, plant.joints) else 0)
        self._keep_seen()
