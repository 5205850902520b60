"""Places that are built in water: walls, net pens, pipelines, buoys."""

import math

import numpy as np

from laticauda.sensing.places.place import Place
from laticauda.sensing.places.solids import Outline, Solid, Three
from laticauda.values import BadArgument, check_label, option, quantity, value_class

FREEBOARD = 0.5
"""How far what stands in the water rises above its surface [m]."""
WALL_THICKNESS = 0.1
"""Thickness of a wall [m]."""
UPRIGHT = 1e-9
"""Level part of a direction below which it counts as upright [-]."""
BED_HALF_EXTENT = 500.0
"""How far the bed reaches from the origin along x and y [m]."""
BED_HALF_THICKNESS = 0.5
"""Half thickness of the bed's box [m]."""
NET_THICKNESS = 0.02
"""Thickness of a net with what grows on it [m]."""


@value_class
class Wall(Place):
    """An upright wall between two points, from above the surface down."""

    begin: tuple[float, float] = quantity("m", "x and y of one end")
    end: tuple[float, float] = quantity("m", "x and y of the other end")
    depth: float = quantity("m", "How far it reaches down", gt=0.0, default=3.0)

    def __post_init__(self) -> None:
        """Reject a wall without length."""
        if self.begin == self.end:
            raise BadArgument("end", f"must differ from `begin`, got {self.end} for both")

    def solids(self) -> tuple[Solid, ...]:
        """See `Place`."""
        return (upright_panel(self.begin, self.end, self.depth, WALL_THICKNESS),)


@value_class
class Net(Place):
    """The net of a pen: an upright ring of flat panels, seen from outside or from inside."""

    center: tuple[float, float] = quantity("m", "x and y of its middle", default=(0.0, 0.0))
    radius: float = quantity("m", "Radius of the circle through its corners", gt=0.0)
    depth: float = quantity("m", "How far it reaches down", gt=0.0, default=3.0)
    panels: int = quantity("", "Number of its panels", ge=3, le=360, default=24)

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Its corners in plan, counter-clockwise [m]."""
        x, y = self.center
        angles = [2.0 * math.pi * panel / self.panels for panel in range(self.panels)]
        return tuple(
            (x + self.radius * math.cos(angle), y + self.radius * math.sin(angle))
            for angle in angles
        )

    @property
    def circumference(self) -> float:
        """Length of all its panels [m]."""
        return 2.0 * self.panels * self.radius * math.sin(math.pi / self.panels)

    def solids(self) -> tuple[Solid, ...]:
        """See `Place`."""
        corners = self.corners
        following_corners = (*corners[1:], corners[0])
        return tuple(
            upright_panel(begin, end, self.depth, NET_THICKNESS)
            for begin, end in zip(corners, following_corners, strict=True)
        )


@value_class
class Pipeline(Place):
    """A straight pipe through the water, to be inspected from outside."""

    begin: Three = quantity("m", "One end of its axis")
    end: Three = quantity("m", "The other end")
    radius: float = quantity("m", "Its outer radius", gt=0.0, default=0.3)

    def __post_init__(self) -> None:
        """Reject a pipe without length."""
        if self.begin == self.end:
            raise BadArgument("end", f"must differ from `begin`, got {self.end} for both")

    def solids(self) -> tuple[Solid, ...]:
        """See `Place`."""
        begin = np.array(self.begin)
        span = np.array(self.end) - begin
        length = float(np.linalg.norm(span))
        along = span / length
        side = _level_direction_across(along)
        up = np.cross(along, side)
        return (
            Solid(
                kind="cylinder",
                center=_three(begin + 0.5 * span),
                size=(self.radius, self.radius, 0.5 * length),
                axes=(_three(side), _three(up), _three(along)),
            ),
        )


@value_class
class Buoy(Place):
    """A ball that is moored in the water."""

    center: Three = quantity("m", "Its middle", default=(0.0, 0.0, 0.0))
    radius: float = quantity("m", "Its radius", gt=0.0, default=0.2)

    def solids(self) -> tuple[Solid, ...]:
        """See `Place`."""
        return (Solid("sphere", self.center, (self.radius, self.radius, self.radius)),)


@value_class
class Seabed(Place):
    """Level ground at the bottom of the water."""

    name: str = option("Name in messages, pictures and models", default="seabed", check=check_label)
    depth: float = quantity("m", "Depth of the water", gt=0.0)

    def solids(self) -> tuple[Solid, ...]:
        """See `Place`."""
        center = (0.0, 0.0, -self.depth - BED_HALF_THICKNESS)
        return (Solid("box", center, (BED_HALF_EXTENT, BED_HALF_EXTENT, BED_HALF_THICKNESS)),)

    def outlines(self) -> tuple[Outline, ...]:
        """Return no outline: the bed is everywhere."""
        return ()


def upright_panel(
    begin: tuple[float, float], end: tuple[float, float], depth: float, thickness: float
) -> Solid:
    """Return a flat upright panel between two points in plan, from above the surface down.

    Args:
        begin: x and y of one end [m].
        end: x and y of the other end [m].
        depth: How far it reaches down [m].
        thickness: Its thickness [m].
    """
    length = math.dist(begin, end)
    cos = (end[0] - begin[0]) / length
    sin = (end[1] - begin[1]) / length
    x = 0.5 * (begin[0] + end[0])
    y = 0.5 * (begin[1] + end[1])
    middle_height = 0.5 * (FREEBOARD - depth)
    half_height = 0.5 * (FREEBOARD + depth)
    return Solid(
        kind="box",
        center=(x, y, middle_height),
        size=(0.5 * length, 0.5 * thickness, half_height),
        axes=((cos, sin, 0.0), (-sin, cos, 0.0), (0.0, 0.0, 1.0)),
    )


def _level_direction_across(along: np.ndarray) -> np.ndarray:
    """Return a level direction of length 1 that is orthogonal to another direction."""
    across = np.array((-along[1], along[0], 0.0))
    length = np.linalg.norm(across)
    if length < UPRIGHT:
        return np.array((1.0, 0.0, 0.0))
    return across / length


def _three(vector: np.ndarray) -> Three:
    """Return three numbers as a tuple."""
    x, y, z = vector.tolist()
    return x, y, z
