"""Sensors of where the robot is and how it moves. All of them sit at the tip of the head."""

import math

import numpy as np

from laticauda.robot import Water
from laticauda.sensing.sensors.sensor import Sensor, Sight
from laticauda.values import option, quantity, value_class

FELT_AT_REST = np.array((0.0, 0.0, 9.81))
"""What an accelerometer at rest measures: upward, against gravity, world axes [m/s^2]."""


@value_class
class Compass(Sensor):
    """Heading of the head, with a bias that stays."""

    name: str = option("Name of its readings", default="compass")
    noise: float = quantity(
        "rad", "Standard deviation", ge=0.0, le=math.pi, default=math.radians(1.0)
    )
    bias: float = quantity("rad", "Constant error", ge=-math.pi, le=math.pi, default=0.0)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("heading",)

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        forward = sight.observation.head.axes[:, 0]
        heading = math.atan2(forward[1], forward[0])
        return np.array([heading + self.bias + self.noise * random.standard_normal()])


@value_class
class DepthGauge(Sensor):
    """Depth of the head below still water, from the pressure."""

    name: str = option("Name of its readings", default="depth")
    noise: float = quantity("m", "Standard deviation", ge=0.0, default=0.01)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("depth",)

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        depth = -float(sight.observation.head.position[2])
        return np.array([depth + self.noise * random.standard_normal()])


@value_class
class AcousticPosition(Sensor):
    """Distance and direction of a beacon, by ultra-short baseline (USBL); nothing beyond its range.

    The direction is that in the axes of the head: bearing positive left, elevation positive up.
    """

    name: str = option("Name of its readings", default="beacon")
    rate: float = quantity("Hz", "Measurements per second", gt=0.0, le=1e4, default=1.0)
    beacon: tuple[float, float, float] = quantity(
        "m", "Where the beacon is, world axes", default=(0.0, 0.0, 0.0)
    )
    largest_range: float = quantity("m", "Nothing farther is heard", gt=0.0, default=100.0)
    range_noise: float = quantity("m", "Standard deviation of the distance", ge=0.0, default=0.05)
    angle_noise: float = quantity(
        "rad", "Standard deviation of each angle", ge=0.0, le=math.pi, default=math.radians(1.0)
    )

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("range", "bearing", "elevation")

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        head = sight.observation.head
        noise = random.standard_normal(3)
        to_beacon = (np.array(self.beacon) - head.position) @ head.axes
        distance = float(np.linalg.norm(to_beacon))
        if distance > self.largest_range:
            return np.full(3, np.nan)
        bearing = math.atan2(to_beacon[1], to_beacon[0])
        elevation = math.atan2(to_beacon[2], math.hypot(to_beacon[0], to_beacon[1]))
        return np.array(
            (
                distance + self.range_noise * noise[0],
                bearing + self.angle_noise * noise[1],
                elevation + self.angle_noise * noise[2],
            )
        )


@value_class
class DopplerVelocity(Sensor):
    """Velocity of the head in its own axes, by Doppler shift: over ground, or through the water."""

    name: str = option("Name of its readings", default="velocity")
    rate: float = quantity("Hz", "Measurements per second", gt=0.0, le=1e4, default=5.0)
    through_water: bool = option(
        "Whether it measures relative to the water instead of the ground", default=False
    )
    noise: float = quantity("m/s", "Standard deviation of each component", ge=0.0, default=0.01)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("forward", "left", "up")

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        head = sight.observation.head
        velocity = head.velocity
        if self.through_water and isinstance(sight.environment, Water):
            water = sight.environment.velocity(head.position, sight.observation.time)
            velocity = velocity - water
        return velocity @ head.axes + self.noise * random.standard_normal(3)


@value_class
class InertialUnit(Sensor):
    """Angular velocity and acceleration of the head in its own axes, gravity included.

    The acceleration is the mean since the measurement before, as units that add up their samples
    tell it.
    """

    name: str = option("Name of its readings", default="inertial")
    rate: float = quantity("Hz", "Measurements per second", gt=0.0, le=1e4, default=50.0)
    turn_noise: float = quantity(
        "rad/s", "Standard deviation of each angular velocity", ge=0.0, default=0.005
    )
    turn_bias: float = quantity("rad/s", "Constant error of each angular velocity", default=0.0)
    acceleration_noise: float = quantity(
        "m/s^2", "Standard deviation of each acceleration", ge=0.0, default=0.05
    )

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("turn_x", "turn_y", "turn_z", "acceleration_x", "acceleration_y", "acceleration_z")

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        head = sight.observation.head
        acceleration = np.zeros(3)
        if sight.previous is not None:
            before = sight.previous.observation
            elapsed = float(sight.observation.time) - float(before.time)
            acceleration = (head.velocity - before.head.velocity) / elapsed
        felt = (acceleration + FELT_AT_REST) @ head.axes
        turn = head.turn_rate @ head.axes + self.turn_bias
        return np.concatenate(
            (
                turn + self.turn_noise * random.standard_normal(3),
                felt + self.acceleration_noise * random.standard_normal(3),
            )
        )
