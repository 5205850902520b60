"""What the sensors of a task's robots tell, in observations: one robot per lane, with noise of its own episode."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from laticauda.robot import Environment
from laticauda.scenarios import Observation, Scenario
from laticauda.sensing import Senses, Sensor, senses_of, signals_of_readings

LARGEST_SEED = 2**31
"""Seeds of episodes are below this."""


def names_of_readings(sensors: tuple[Sensor, ...]) -> tuple[str, ...]:
    """Return the names of all values that sensors tell, as in logs: sensor, `_`, column.

    Args:
        sensors: The sensors.
    """
    names: list[str] = []
    for sensor in sensors:
        names += [f"{sensor.name}_{column}" for column in sensor.columns]
    return tuple(names)


def units_of_readings(
    sensors: tuple[Sensor, ...], units: Mapping[str, float]
) -> Float[np.ndarray, " n_columns"]:
    """Return what is observed as 1, for every value that sensors tell.

    Args:
        sensors: The sensors.
        units: What is observed as 1, by the name of a value or of a sensor; 1 for all others [SI].
    """
    units_of_columns: list[float] = []
    for sensor in sensors:
        unit_of_sensor = units.get(sensor.name, 1.0)
        for name in names_of_readings((sensor,)):
            units_of_columns.append(units.get(name, unit_of_sensor))
    return np.array(units_of_columns)


class SensesOfLanes:
    """The sensors of robots in lanes.

    Args:
        scenario: What all robots share, with the sensors and the places that they see.
        n: Number of lanes.
    """

    def __init__(self, scenario: Scenario, n: int) -> None:
        self._model = scenario.model
        self.values = np.full((n, len(names_of_readings(self._model.sensors))), np.nan)
        """What the sensors of every lane last told; nan where there is nothing [SI]."""
        self._senses: list[Senses | None] = [None] * n

    def begin(self, lane: int, environment: Environment, generator: np.random.Generator) -> None:
        """Begin an episode, whose noise is its own; without sensors, nothing is drawn.

        Args:
            lane: Its lane.
            environment: The water in the lane.
            generator: Random number generator of the lane.
        """
        if not self._model.sensors:
            return
        seed = int(generator.integers(LARGEST_SEED))
        sensors = tuple(replace(sensor, seed=seed) for sensor in self._model.sensors)
        model = replace(self._model, sensors=sensors)
        self._senses[lane] = senses_of(model, environment)

    def look(self, lane: int, observation: Observation) -> None:
        """Let the sensors of a lane measure.

        Args:
            lane: The lane.
            observation: What is true of its robot.
        """
        senses = self._senses[lane]
        if senses is None:
            return
        readings = senses.read(observation)
        signals = signals_of_readings(self._model.sensors, readings)
        self.values[lane] = list(signals.values())
