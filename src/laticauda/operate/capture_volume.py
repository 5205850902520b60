"""What the motion capture covers of the tank, and where the path frame lies in the tank frame."""

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda.errors import BadArgument
from laticauda.quantities import quantity, value

Vector: TypeAlias = NDArray[np.float64]  # two or three axes


@value
class CaptureVolume:
    """What the motion capture covers of the tank, and where the path lies in it; tank frame."""

    volume_x: tuple[float, float] = quantity("m", "measuring volume along the tank", default=(0.0, 12.0))
    volume_y: tuple[float, float] = quantity("m", "across it", default=(-2.725, 2.725))
    path_origin: tuple[float, float] = quantity("m", "origin of the path frame", default=(0.0, 0.0))
    path_heading: float = quantity("rad", "direction of its x axis", default=0.0)

    def __post_init__(self) -> None:
        """Refuse a volume that is turned inside out."""
        for name in ("volume_x", "volume_y"):
            low, high = getattr(self, name)
            if low >= high:
                raise BadArgument(name, f"must be a smaller and a greater number in m, got {(low, high)!r}")

    def to_path(self, position: Vector) -> Vector:
        """A position of the tank frame in the path frame [m]; the height stays."""
        cos, sin = math.cos(self.path_heading), math.sin(self.path_heading)
        x, y = position[0] - self.path_origin[0], position[1] - self.path_origin[1]
        return np.array([cos * x + sin * y, cos * y - sin * x, *position[2:]])

    def to_tank(self, position: Vector) -> Vector:
        """A position of the path frame in the tank frame [m]."""
        cos, sin = math.cos(self.path_heading), math.sin(self.path_heading)
        x, y = position[0], position[1]
        return np.array(
            [self.path_origin[0] + cos * x - sin * y, self.path_origin[1] + sin * x + cos * y, *position[2:]]
        )

    def room(self, position: Vector, velocity: Vector) -> float:
        """Distance to the edge that the robot moves to; infinite if it moves to none [m].

        Args:
            position: Tank frame [m].
            velocity: Tank frame [m/s].
        """
        room = math.inf
        for (low, high), at, speed in zip((self.volume_x, self.volume_y), position[:2], velocity[:2], strict=True):
            if abs(speed) > 0.01:  # one that lies still at the edge may swim away from it
                room = min(room, high - at if speed > 0.0 else at - low)
        return float(room)
