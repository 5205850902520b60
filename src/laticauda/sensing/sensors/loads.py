"""Sensors of what the body bears: strain gauges in the joints, pressure sensors on the sides of the links."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.sensing.sensors.sensor import Sensor, Sight
from laticauda.values import DIRECTIONS, BadArgument, option, quantity, value_class

KINDS = ("force", "moment")
"""What strain gauges in a joint measure, along each axis."""


@value_class
class StrainGauge(Sensor):
    """Force and moment in some joints, by strain gauges that are not quite at zero.

    They are what the tail side of a joint does to its head side, in the axes of the link on the tail
    side: see `BodyLoads`.
    """

    name: str = option("Name of its readings", default="load")
    rate: float = quantity("Hz", "Measurements per second", gt=0.0, le=1e4, default=100.0)
    joints: tuple[int, ...] = quantity("", "Joints with gauges, 0 = tail", ge=0, default=(0,))
    force_noise: float = quantity("N", "Standard deviation of each force", ge=0.0, default=0.05)
    moment_noise: float = quantity(
        "N m", "Standard deviation of each moment", ge=0.0, default=0.005
    )
    force_zero_error: float = quantity(
        "N", "Largest constant error of a force, either sign, by the seed", ge=0.0, default=0.1
    )
    moment_zero_error: float = quantity(
        "N m", "Largest constant error of a moment, likewise", ge=0.0, default=0.01
    )
    force_limit: float = quantity("N", "A gauge shows no more", gt=0.0, default=300.0)
    moment_limit: float = quantity("N m", "A gauge shows no more", gt=0.0, default=30.0)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        names: list[str] = []
        for joint in self.joints:
            for kind in KINDS:
                names += [f"{kind}_{direction}_{joint}" for direction in DIRECTIONS]
        return tuple(names)

    @cached_property
    def _zeros(self) -> Float[np.ndarray, "n_sensed 2 3"]:
        """What the gauges show without a load, as shares of the largest zero errors."""
        return _draw_zeros(self.seed, (len(self.joints), len(KINDS), len(DIRECTIONS)))

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        loads = sight.observation.loads
        _check_places(self, "joints", self.joints, len(loads.joint_force))
        joints = list(self.joints)
        force = loads.joint_force[joints]
        moment = loads.joint_moment[joints]
        true = np.stack((force, moment), axis=1)
        zero_error = self._of_kinds("zero_error")
        deviation = self._of_kinds("noise")
        limit = self._of_kinds("limit")
        noise = deviation * random.standard_normal(true.shape)
        shown = true + zero_error * self._zeros + noise
        return np.clip(shown, -limit, limit).ravel()

    def _of_kinds(self, name: str) -> Float[np.ndarray, "2 1"]:
        """Return a number of the gauges for forces, and that for moments."""
        numbers = [getattr(self, f"{kind}_{name}") for kind in KINDS]
        return np.array(numbers)[:, np.newaxis]


@value_class
class PressureSensor(Sensor):
    """Difference of the mean pressures on the two sides of some links, right less left: see `BodyLoads`."""

    name: str = option("Name of its readings", default="pressure")
    rate: float = quantity("Hz", "Measurements per second", gt=0.0, le=1e4, default=100.0)
    links: tuple[int, ...] = quantity("", "Links with sensors, 0 = tail", ge=0, default=(0,))
    noise: float = quantity("Pa", "Standard deviation", ge=0.0, default=5.0)
    zero_error: float = quantity(
        "Pa", "Largest constant error, either sign, by the seed", ge=0.0, default=10.0
    )
    limit: float = quantity("Pa", "A sensor shows no more", gt=0.0, default=1e4)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return tuple(f"difference_{link}" for link in self.links)

    @cached_property
    def _zeros(self) -> Float[np.ndarray, " n_sensed"]:
        """What the sensors show without a difference, as shares of the largest zero error."""
        return _draw_zeros(self.seed, (len(self.links),))

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        of_all = sight.observation.loads.pressure_difference
        _check_places(self, "links", self.links, len(of_all))
        links = list(self.links)
        true = of_all[links]
        noise = self.noise * random.standard_normal(true.shape)
        shown = true + self.zero_error * self._zeros + noise
        return np.clip(shown, -self.limit, self.limit)


def _draw_zeros(seed: int, shape: tuple[int, ...]) -> np.ndarray:
    """Return numbers from -1 to 1 that stay the same in all runs of a seed."""
    return np.random.default_rng((seed, 0)).uniform(-1.0, 1.0, shape)


def _check_places(sensor: Sensor, field: str, places: Sequence[int], count: int) -> None:
    """Reject places that the robot does not have."""
    for place in places:
        if place >= count:
            rule = f"must be {field} of the robot, 0 to {count - 1}, got {place}"
            raise BadArgument(f"sensors.{sensor.name}.{field}", rule)
