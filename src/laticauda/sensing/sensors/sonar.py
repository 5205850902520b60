"""Sonar: distances from the head to what reflects sound."""

import math
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.sensing.sensors.sensor import Sensor, Sight
from laticauda.values import BadArgument, option, quantity, value_class

MOST_BEAMS = 361
"""Beams of a sonar at most."""
N_RAYS_PER_BEAM = 3
"""Rays across the width of a beam; the nearest echo counts."""
DOWNWARD = np.array([(0.0, 0.0, -1.0)])
"""Direction of an altimeter's ray in the axes of the head [-]."""


@value_class
class Sonar(Sensor):
    """A fan of beams from the tip of the head, in the plane of the head; each tells the nearest echo in its width.

    A surface that is hit at a flatter angle than `grazing` sends no echo back.
    """

    name: str = option("Name of its readings", default="sonar")
    beams: tuple[float, ...] = quantity(
        "rad",
        "Directions of the beams, positive left",
        ge=-math.pi,
        le=math.pi,
        default=tuple(math.radians(angle) for angle in range(-90, 91, 15)),
    )
    beam_width: float = quantity(
        "rad", "Width of a beam", ge=0.0, le=1.0, default=math.radians(10.0)
    )
    least_range: float = quantity("m", "Nothing nearer is seen", ge=0.0, default=0.05)
    largest_range: float = quantity("m", "Nothing farther is seen", gt=0.0, default=5.0)
    grazing: float = quantity(
        "rad",
        "Least angle between a ray and a surface that reflects it",
        ge=0.0,
        le=1.5,
        default=math.radians(20.0),
    )
    noise: float = quantity("m", "Standard deviation of a distance", ge=0.0, default=0.02)

    def __post_init__(self) -> None:
        """Reject a fan without beams, or with very many."""
        if not 1 <= len(self.beams) <= MOST_BEAMS:
            rule = f"must have 1 to {MOST_BEAMS} directions"
            raise BadArgument("beams", f"{rule}, got {len(self.beams)}")

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return tuple(f"range_{beam}" for beam in range(len(self.beams)))

    @cached_property
    def _rays(self) -> Float[np.ndarray, "n_rays 3"]:
        """Directions of all rays in the axes of the head: forward, left, up."""
        shares = np.linspace(-0.5, 0.5, N_RAYS_PER_BEAM)
        angles = np.add.outer(np.array(self.beams), shares * self.beam_width).ravel()
        return np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), axis=-1)

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        of_rays = _echoes(sight, self._rays, self.grazing, self.largest_range)
        nearest = np.min(of_rays.reshape(-1, N_RAYS_PER_BEAM), axis=-1)
        is_seen = (nearest >= self.least_range) & (nearest <= self.largest_range)
        noise = self.noise * random.standard_normal(len(self.beams))
        return np.where(is_seen, nearest + noise, np.nan)


@value_class
class Altimeter(Sensor):
    """One beam from the head downward: height above what lies below."""

    name: str = option("Name of its readings", default="altimeter")
    largest_range: float = quantity("m", "Nothing farther is seen", gt=0.0, default=30.0)
    noise: float = quantity("m", "Standard deviation", ge=0.0, default=0.02)

    @property
    def columns(self) -> tuple[str, ...]:
        """See `Sensor`."""
        return ("height",)

    def measure(self, sight: Sight, random: np.random.Generator) -> np.ndarray:
        """Return its values, with noise of `random`, at the moment of `sight`."""
        noise = self.noise * random.standard_normal()
        (distance,) = _echoes(sight, DOWNWARD, 0.0, self.largest_range)
        if distance > self.largest_range:
            return np.full(1, np.nan)
        return np.array([distance + noise])


def _echoes(
    sight: Sight, rays: Float[np.ndarray, "n_rays 3"], grazing: float, largest_range: float
) -> Float[np.ndarray, " n_rays"]:
    """Return the distance of the echo of every ray, infinite without one [m].

    Args:
        sight: What is true at this moment.
        rays: Directions in the axes of the head: forward, left, up.
        grazing: Least angle between a ray and a surface that reflects it [rad].
        largest_range: Echoes from farther away need not be found [m].
    """
    head = sight.observation.head
    directions = rays @ head.axes.T
    hits = sight.surroundings.solids.cast(head.position, directions, largest_range)
    sine_to_surface = -np.sum(hits.normal * directions, axis=-1)
    reflects = sine_to_surface >= math.sin(grazing)
    return np.where(reflects, hits.distance, np.inf)
