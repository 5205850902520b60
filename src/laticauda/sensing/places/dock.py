"""A dock: a funnel into which a robot swims, and the condition under which it is caught."""

import math

import numpy as np
from jaxtyping import Float

from laticauda.sensing.places.place import Place
from laticauda.sensing.places.solids import Solid
from laticauda.sensing.places.structures import upright_panel
from laticauda.values import BadArgument, quantity, value_class
from laticauda.values.angles import wrapped

PLATE_THICKNESS = 0.02
"""Thickness of the funnel's plates [m]."""


@value_class
class Dock(Place):
    """A funnel of two upright plates, and a latch in its throat that catches the head of a robot.

    The robot comes in along `heading`. It is caught when the tip of its head is within
    `capture_radius` of the latch, it points along the dock within `capture_heading`, and swims in
    no faster than `capture_speed`.
    """

    position: tuple[float, float] = quantity("m", "x and y of the latch", default=(0.0, 0.0))
    heading: float = quantity("rad", "Direction in which a robot swims in", default=0.0)
    depth: float = quantity("m", "How far the plates reach down", gt=0.0, default=2.0)
    throat: float = quantity("m", "Width between the plates at the latch", gt=0.0, default=0.4)
    mouth: float = quantity("m", "Width between the plates at the open end", gt=0.0, default=1.6)
    length: float = quantity("m", "From the latch to the open end", gt=0.0, default=0.8)
    capture_radius: float = quantity("m", "How near the head must come", gt=0.0, default=0.15)
    capture_heading: float = quantity(
        "rad", "How far its heading may be off", gt=0.0, le=math.pi, default=math.radians(30.0)
    )
    capture_speed: float = quantity("m/s", "Largest speed at which it catches", gt=0.0, default=0.5)

    def __post_init__(self) -> None:
        """Reject a funnel that widens inward."""
        if self.throat > self.mouth:
            rule = f"must be at most the mouth, {self.mouth:g} m"
            raise BadArgument("throat", f"{rule}, got {self.throat:g} m")

    def solids(self) -> tuple[Solid, ...]:
        """See `Place`."""
        plates: list[Solid] = []
        for side in (-1.0, 1.0):
            inner = self.to_world(0.0, 0.5 * side * self.throat)
            outer = self.to_world(-self.length, 0.5 * side * self.mouth)
            plates.append(upright_panel(inner, outer, self.depth, PLATE_THICKNESS))
        return tuple(plates)

    def to_world(self, along: float, left: float) -> tuple[float, float]:
        """Return x and y of a point that is given from the latch [m].

        Args:
            along: How far it lies in the direction in which a robot swims in [m].
            left: How far it lies to the left of that direction [m].
        """
        cos = math.cos(self.heading)
        sin = math.sin(self.heading)
        x, y = self.position
        return x + cos * along - sin * left, y + sin * along + cos * left

    def catches(self, head: Float[np.ndarray, " 3"], heading: float, speed: float) -> bool:
        """Return whether a robot is caught.

        Args:
            head: Position of the tip of its head, world axes [m].
            heading: Its heading [rad].
            speed: Its speed [m/s].
        """
        is_near = math.dist(self.position, head[:2].tolist()) <= self.capture_radius
        points_along = abs(wrapped(heading - self.heading)) <= self.capture_heading
        return is_near and points_along and speed <= self.capture_speed
