"""The tank: what the motion capture sees of it, and where the path frame lies in the tank frame."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from jaxtyping import Float

from laticauda.errors import finite


def put(owner: object, name: str, value: object) -> None:
    """Set a field of a frozen dataclass while it is being made."""
    object.__setattr__(owner, name, value)


def pair(name: str, value: object, unit: str) -> tuple[float, float]:
    """`value` as two finite numbers."""
    if isinstance(value, str) or not isinstance(value, Sequence) or len(cast("Sequence[Any]", value)) != 2:
        raise ValueError(f"`{name}` must be two numbers in {unit}, got {value!r}.")
    first, second = cast("Sequence[object]", value)
    return finite(f"{name}[0]", first, unit), finite(f"{name}[1]", second, unit)


def span(name: str, value: object) -> tuple[float, float]:
    """`value` as a smaller and a greater number [m]."""
    low, high = pair(name, value, "m")
    if low >= high:
        raise ValueError(f"`{name}` must be a smaller and a greater number in m, got {value!r}.")
    return low, high


@dataclass(frozen=True, kw_only=True)
class Tank:
    """What the motion capture sees, and where the path lies in it; tank frame."""

    volume_x: tuple[float, float] = (0.0, 12.0)
    """Measuring volume along the tank [m]."""
    volume_y: tuple[float, float] = (-2.725, 2.725)
    """Across it [m]."""
    path_origin: tuple[float, float] = (0.0, 0.0)
    """Origin of the path frame [m]."""
    path_heading: float = 0.0
    """Direction of its x axis [rad]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        for name in ("volume_x", "volume_y"):
            put(self, name, span(name, getattr(self, name)))
        put(self, "path_origin", pair("path_origin", self.path_origin, "m"))
        put(self, "path_heading", finite("path_heading", self.path_heading, "rad"))

    def to_path(self, position: Float[np.ndarray, " n_axes"]) -> Float[np.ndarray, " n_axes"]:
        """A position of the tank frame in the path frame [m]; the height stays."""
        cos, sin = math.cos(self.path_heading), math.sin(self.path_heading)
        x, y = position[0] - self.path_origin[0], position[1] - self.path_origin[1]
        return np.array([cos * x + sin * y, cos * y - sin * x, *position[2:]])

    def to_tank(self, position: Float[np.ndarray, " n_axes"]) -> Float[np.ndarray, " n_axes"]:
        """A position of the path frame in the tank frame [m]."""
        cos, sin = math.cos(self.path_heading), math.sin(self.path_heading)
        x, y = position[0], position[1]
        return np.array(
            [self.path_origin[0] + cos * x - sin * y, self.path_origin[1] + sin * x + cos * y, *position[2:]]
        )

    def room(self, position: Float[np.ndarray, " n_axes"], velocity: Float[np.ndarray, " n_axes"]) -> float:
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
