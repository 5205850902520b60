"""What a robot on a mission believes of itself and of the water around it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple


class Echo(NamedTuple):
    """What one beam of the sonar told."""

    bearing: float
    """Direction of the beam from that of the head, positive left [rad]."""
    distance: float
    """From the tip of the head [m]."""
    x: float
    """Where it comes from, as far as the robot knows where it is [m]."""
    y: float
    """Likewise [m]."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """Belief of a robot at one control instant, made from sensors and from the joints' own encoders only."""

    time: float
    """Time [s]."""
    position: tuple[float, float]
    """Middle of the body, x and y [m]."""
    position_std: float
    """Its standard deviation along each axis [m]."""
    velocity: tuple[float, float]
    """Velocity of the middle over ground, mean over about a cycle [m/s]."""
    velocity_now: tuple[float, float]
    """The same, not averaged [m/s]."""
    heading: float
    """Direction of the body, mean over the last cycle, unwrapped [rad]."""
    heading_now: float
    """The same, not averaged [rad]."""
    bow: tuple[float, float]
    """Point half a body ahead of the middle along the heading, where the head is without its swing [m]."""
    current: tuple[float, float]
    """Velocity of the water, waves averaged out [m/s]."""
    head_position: tuple[float, float]
    """Tip of the head [m]."""
    head_heading: float
    """Direction of the head [rad]."""
    echoes: tuple[Echo, ...]
    """Echoes of the sonar's last ping, unless that is long ago."""
    last_echo: Echo | None
    """The nearest echo of the last ping that had one; None: there was none yet."""
    sightings: tuple[tuple[float, float], ...]
    """Points from which echoes came since the start, one for every square of a grid [m]."""
    battery: float | None
    """Share of the battery that is left; None without a gauge."""
    silence: Mapping[str, float]
    """By sensor, for how long it has told nothing, or the same again and again [s]."""
    sonar_silence: float = 0.0
    """For how long the sonar has told nothing new [s]."""
    depth: float | None = None
    """Depth of the head that was last told; None without a gauge [m]."""
    beacon_distance: float | None = None
    """Distance of the beacon from the head that was last told; None if it was not heard [m]."""
    contact_force: float | None = None
    """Largest force of anything on a link that was last told; None without a sensor [N]."""

    def nearest_echo(
        self, *, away_from: tuple[float, float] = (0.0, 0.0), radius: float = 0.0
    ) -> Echo | None:
        """Return the nearest echo; None in open water.

        Args:
            away_from: A point near which nothing counts, x and y [m].
            radius: How near to it [m].
        """
        echoes = [echo for echo in self.echoes if math.dist((echo.x, echo.y), away_from) >= radius]
        if not echoes:
            return None
        return min(echoes, key=_distance_of)

    def distance_to(self, point: tuple[float, float]) -> float:
        """Return how far the middle of the body is from a point [m].

        Args:
            point: Its x and y [m].
        """
        return math.dist(self.position, point)

    def course_to(self, point: tuple[float, float]) -> float:
        """Return the direction from the middle of the body to a point [rad].

        Args:
            point: Its x and y [m].
        """
        return math.atan2(point[1] - self.position[1], point[0] - self.position[0])


def _distance_of(echo: Echo) -> float:
    """Return how far an echo came from [m]."""
    return echo.distance
