"""What a sensor is, and how the sensors of one robot are read during a run.

A sensor measures at its own rate. A measurement is taken at the first control instant at or after
its time, is noisy, may be lost, and arrives `latency` later. A sensor of one's own is a subclass
with `columns` and `measure`.
"""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.robot import Environment
from laticauda.sensing.observed import Observed, Reading
from laticauda.sensing.places import Place, Surroundings, surroundings_of
from laticauda.values import (
    BadArgument,
    Extensible,
    check_label,
    option,
    quantity,
    value_class,
)

ROUNDING = 1e-9
"""Time by which an instant may be too early and still counts as the time of a measurement [s]."""


@value_class
class SensorFault:
    """A time during which a sensor does not work as it should."""

    begin: float = quantity("s", "When it begins", ge=0.0)
    end: float = quantity("s", "When it ends; infinite: never", gt=0.0, default=math.inf)
    kind: Literal["silent", "frozen", "biased"] = option(
        "`silent`: nothing arrives; `frozen`: the last values, as if new; `biased`: all values are off by `bias`",
        default="silent",
    )
    bias: float = quantity("", "What is added to every value, in the sensor's unit", default=0.0)

    def __post_init__(self) -> None:
        """Reject a fault that ends before it begins."""
        if self.end <= self.begin:
            rule = f"must be > `begin` = {self.begin:g} s"
            raise BadArgument("end", f"{rule}, got {self.end:g} s")


@dataclass(frozen=True, kw_only=True)
class Sight:
    """What is true at the moment of a measurement, of which a sensor measures a part."""

    observation: Observed
    """The robot."""
    environment: Environment
    """The water with its motion, or the ground."""
    surroundings: Surroundings
    """The places."""
    previous: "Sight | None"
    """The same at the measurement before; None for the first one."""


@value_class
class Sensor(Extensible, group="sensors"):
    """Base of sensors, part of a model's settings; its readings are in `Observation.readings` under its name."""

    name: str = option("Name of its readings", check=check_label)
    rate: float = quantity("Hz", "Measurements per second", gt=0.0, le=1e4, default=10.0)
    latency: float = quantity("s", "From a measurement to its arrival", ge=0.0, default=0.0)
    dropout: float = quantity(
        "", "Probability that a measurement is lost", ge=0.0, le=0.99, default=0.0
    )
    seed: int = quantity("", "Seed of its noise and its losses", ge=0, default=0)
    faults: tuple[SensorFault, ...] = option("When it does not work", default=())

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of its values; that of the sensor and `_` come before each in logs."""
        raise NotImplementedError

    def measure(self, sight: Sight, random: np.random.Generator) -> Float[np.ndarray, " n_columns"]:
        """Return its values, with noise; nan where there is none, such as no echo.

        Args:
            sight: What is true at this moment.
            random: Source of the noise.
        """
        raise NotImplementedError


class _Arrival(NamedTuple):
    """A reading on its way."""

    time: float
    """When it arrives [s]."""
    reading: Reading


class _SensorInUse:
    """A sensor during a run: when it measures next, what is on its way, and what arrived last.

    Args:
        sensor: The sensor.
        number: Its number among those of the robot, so that equal seeds give different noise.
    """

    def __init__(self, sensor: Sensor, number: int) -> None:
        self.sensor = sensor
        self._random = np.random.default_rng((sensor.seed, number))
        self._n_measured = 0
        self._on_its_way: deque[_Arrival] = deque()
        self._previous: Sight | None = None
        self._last_values: np.ndarray | None = None
        missing = np.full(len(sensor.columns), np.nan)
        self.reading = Reading(time=-math.inf, values=missing, is_new=False)

    def read(self, sight: Sight) -> None:
        """Measure if it is time to, and take what arrives."""
        now = float(sight.observation.time)
        due = self._n_measured / self.sensor.rate
        if now >= due - ROUNDING:
            self._n_measured = math.floor(now * self.sensor.rate + ROUNDING) + 1
            self._measure(sight, now)
        self.reading = self.reading._replace(is_new=False)
        while self._on_its_way and self._on_its_way[0].time <= now + ROUNDING:
            arrival = self._on_its_way.popleft()
            self.reading = arrival.reading

    def _measure(self, sight: Sight, now: float) -> None:
        """Take a measurement, unless it is lost."""
        sight = replace(sight, previous=self._previous)
        measured = self.sensor.measure(sight, self._random)
        # Kept without its own past, which nobody needs.
        self._previous = replace(sight, previous=None)
        values = self._with_faults(np.asarray(measured, dtype=float), now)
        if values is None:
            return
        self._last_values = values
        values.flags.writeable = False
        reading = Reading(time=now, values=values, is_new=True)
        arrives_at = now + self.sensor.latency
        self._on_its_way.append(_Arrival(arrives_at, reading))

    def _with_faults(self, values: np.ndarray, now: float) -> np.ndarray | None:
        """Return the values that leave the sensor; None if they are lost."""
        dropout = self.sensor.dropout
        if dropout > 0.0 and self._random.random() < dropout:
            return None
        for fault in self.sensor.faults:
            if not fault.begin <= now < fault.end:
                continue
            if fault.kind == "silent":
                return None
            if fault.kind == "biased":
                values = values + fault.bias
            elif self._last_values is not None:
                values = self._last_values
        return values


class Senses:
    """The sensors of one robot during one run.

    Args:
        sensors: The sensors, by different names.
        places: What they see.
        environment: The water or the ground.
    """

    def __init__(
        self, sensors: Sequence[Sensor], places: tuple[Place, ...], environment: Environment
    ) -> None:
        self._in_use = [_SensorInUse(sensor, number) for number, sensor in enumerate(sensors)]
        self._surroundings = surroundings_of(places)
        self._environment = environment

    def read(self, observation: Observed) -> dict[str, Reading]:
        """Return the last reading of every sensor, by its name; called once per control instant.

        Args:
            observation: The true observation.
        """
        sight = Sight(
            observation=observation,
            environment=self._environment,
            surroundings=self._surroundings,
            previous=None,
        )
        readings: dict[str, Reading] = {}
        for sensor_in_use in self._in_use:
            sensor_in_use.read(sight)
            readings[sensor_in_use.sensor.name] = sensor_in_use.reading
        return readings


def senses_of(model: Any, environment: Environment) -> Senses | None:
    """Return the senses of a robot; None if it has no sensors.

    Args:
        model: The model's settings, with its sensors and places.
        environment: The water or the ground.
    """
    if not model.sensors:
        return None
    return Senses(model.sensors, model.places, environment)


def signals_of_readings(
    sensors: Sequence[Sensor], readings: Mapping[str, Reading]
) -> dict[str, float]:
    """Return the values of readings by the names that logs give them: sensor, `_`, column; nan where there is none.

    Args:
        sensors: The sensors.
        readings: Their readings.
    """
    signals: dict[str, float] = {}
    for sensor in sensors:
        numbers = readings[sensor.name].values.tolist()
        for column, number in zip(sensor.columns, numbers, strict=True):
            signals[f"{sensor.name}_{column}"] = number
    return signals
