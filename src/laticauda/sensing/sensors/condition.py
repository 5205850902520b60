"""Sensors of the robot's own condition: what it touches, what is left in its battery."""

import math

import numpy as np

from laticauda.sensing.sensors.sensor import Sensor, Sight
from laticauda.values import option, quantity, value_class

SECONDS_PER_HOUR = 3600.0
"""Seconds in an hour, and joules in a watt hour."""


@value_class
class ContactSensor(Sensor):
    """Largest force by which anything touches a link, and that link, 0 = tail.

    In the plane, where nothing touches, there is nothing to tell (nan).
    """

    name: str = option("Name of its readings", default="contact")
    noise: float = quantity("N", "Standard deviation of the force", ge=0.0, default=0.05)
    threshold: float = quantity("N", "Smaller forces are not felt", ge=0.0, default=0.2)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("force", "link")

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        noise = self.noise * random.standard_normal()
        forces_of_links = sight.observation.contact_force
        if forces_of_links is None:
            return np.full(2, np.nan)
        forces = np.linalg.norm(forces_of_links, axis=1)
        link = int(np.argmax(forces))
        force = forces[link] + noise
        if force < self.threshold:
            return np.array((0.0, math.nan))
        return np.array((force, link))


@value_class
class BatteryGauge(Sensor):
    """Share of a battery that is left, from the energy that the robot and its other electronics took."""

    name: str = option("Name of its readings", default="battery")
    rate: float = quantity("Hz", "Measurements per second", gt=0.0, le=1e4, default=1.0)
    capacity: float = quantity("Wh", "Energy of the full battery", gt=0.0, default=100.0)
    full_share: float = quantity(
        "", "Share that is there at the start", gt=0.0, le=1.0, default=1.0
    )
    other_power: float = quantity(
        "W",
        "Power of what does not move the robot, such as lamps and computers",
        ge=0.0,
        default=0.0,
    )
    noise: float = quantity("", "Standard deviation of the share", ge=0.0, default=0.002)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("left",)

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        observation = sight.observation
        taken = observation.energy + self.other_power * float(observation.time)
        left = self.full_share - taken / (self.capacity * SECONDS_PER_HOUR)
        return np.array([max(left, 0.0) + self.noise * random.standard_normal()])
