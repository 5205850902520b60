"""Solid shapes of which places consist: boxes, cylinders and spheres, met by rays and touched by points.

All shapes of one kind are computed together, as arrays: a ray is transformed into the axes of every
shape, where the intersection has a formula. The models in space build the same shapes as geoms.
"""

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

Three: TypeAlias = tuple[float, float, float]
ShapeKind: TypeAlias = Literal["box", "cylinder", "sphere"]
Points: TypeAlias = Float[np.ndarray, "n_points 3"]
Directions: TypeAlias = Float[np.ndarray, "n_rays 3"]
Outline: TypeAlias = Float[np.ndarray, "_ 2"]

TINY = 1e-12
"""Smallest component of a direction by which is divided [-]."""
N_AROUND = 48
"""Points around a round shape in its outline."""
BOX_CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
"""Corners of a box, in halves of its sides."""
DIGITS_OF_CORNERS = 9
"""Decimals of outlines, so that points one above the other are one corner."""


class Solid(NamedTuple):
    """One shape, at rest in the world."""

    kind: ShapeKind
    center: Three
    """Its middle, world axes [m]."""
    size: Three
    """Of a box: half its length, width and height; of a cylinder: radius, radius and half its length along its
    third axis; of a sphere: radius, three times [m]."""
    axes: tuple[Three, Three, Three] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    """Its three axes, orthogonal and of length 1, world axes [-]."""

    def outline(self) -> Outline:
        """Return what is seen of it from above: the corners of a convex polygon, counter-clockwise [m]."""
        points = np.array(self.center) + _extreme_points(self) @ np.array(self.axes)
        return _convex_hull(points[:, :2])


def _extreme_points(solid: Solid) -> Points:
    """Return corners of a box or points around the ends of a round shape, in its own axes from its middle [m]."""
    if solid.kind == "box":
        return BOX_CORNERS * solid.size
    radius, _, half_length = solid.size
    ring = radius * _points_around()
    if solid.kind == "sphere":
        return ring
    to_end = np.array((0.0, 0.0, half_length))
    return np.concatenate((ring - to_end, ring + to_end))


def _points_around() -> Points:
    """Return points of a circle of radius 1 around the third axis."""
    angles = np.linspace(0.0, 2.0 * math.pi, N_AROUND, endpoint=False)
    points = np.zeros((N_AROUND, 3))
    points[:, 0] = np.cos(angles)
    points[:, 1] = np.sin(angles)
    return points


def _convex_hull(points: Float[np.ndarray, "n_points 2"]) -> Outline:
    """Return those of some points that are the corners of their convex hull, counter-clockwise."""
    rounded = np.round(points, DIGITS_OF_CORNERS)
    different_points = np.unique(rounded, axis=0)
    from_left: list[list[float]] = different_points.tolist()
    from_right = from_left[::-1]
    below = _boundary(from_left)
    above = _boundary(from_right)
    return np.array(below[:-1] + above[:-1])


def _boundary(points: list[list[float]]) -> list[list[float]]:
    """Return the corners of the convex hull of sorted points that lie to the right of the way along them."""
    corners: list[list[float]] = []
    for point in points:
        while len(corners) >= 2 and not _turns_left(corners[-2], corners[-1], point):
            corners.pop()
        corners.append(point)
    return corners


def _turns_left(begin: list[float], middle: list[float], end: list[float]) -> bool:
    """Return whether the way over three points turns left at the middle one."""
    along_x = middle[0] - begin[0]
    along_y = middle[1] - begin[1]
    onward_x = end[0] - middle[0]
    onward_y = end[1] - middle[1]
    return along_x * onward_y > along_y * onward_x


class Solids:
    """Many shapes, of which rays and points are asked.

    Args:
        solids: The shapes; none for open water.
    """

    def __init__(self, solids: Sequence[Solid]) -> None:
        self._groups: list[_Group] = []
        for kind, group in GROUPS.items():
            members = [solid for solid in solids if solid.kind == kind]
            if members:
                self._groups.append(group(members))

    def cast(
        self,
        origin: Float[np.ndarray, "3"],
        directions: Directions,
        largest_range: float = math.inf,
    ) -> "Hits":
        """Return what rays hit first.

        Args:
            origin: Where all rays begin, world axes [m].
            directions: Their directions, of length 1, world axes [-].
            largest_range: Shapes that are farther away may be left out, which saves time [m].
        """
        hits = Hits(
            distance=np.full(len(directions), np.inf), normal=np.zeros((len(directions), 3))
        )
        for group in self._groups:
            nearby = group.within(origin, largest_range)
            if nearby is not None:
                hits = _nearer_hits(hits, nearby.cast(origin, directions))
        return hits

    def distances(self, points: Points) -> Float[np.ndarray, " n_points"]:
        """Return how far points are from the nearest shape, negative inside it; infinite in open water [m].

        Args:
            points: The points, world axes [m].
        """
        distances = np.full(len(points), np.inf)
        for group in self._groups:
            distances = np.minimum(distances, group.distances(points))
        return distances


class Hits(NamedTuple):
    """What rays hit first."""

    distance: Float[np.ndarray, " n_rays"]
    """From where the ray begins, infinite if nothing is hit [m]."""
    normal: Float[np.ndarray, "n_rays 3"]
    """Normal of the surface that is hit, outward, world axes; 0 if nothing is hit [-]."""


class _Group(ABC):
    """All shapes of one kind, as arrays whose first axis counts the shapes.

    Args:
        solids: The shapes.
    """

    def __init__(self, solids: Sequence[Solid]) -> None:
        self._solids = solids
        self._parts: dict[bytes, _Group | None] = {}
        self._center = np.array([solid.center for solid in solids])
        self._axes = np.array([solid.axes for solid in solids])
        sizes = np.array([solid.size for solid in solids])
        self.size = sizes[:, np.newaxis]
        """Size of every shape, the same for all rays or points."""
        self._reach = np.linalg.norm(sizes, axis=1)

    def within(self, origin: np.ndarray, largest_range: float) -> "_Group | None":
        """Return those shapes of which some part may be within a range of a point; None if there is none.

        Args:
            origin: The point, world axes [m].
            largest_range: The range [m].
        """
        if math.isinf(largest_range):
            return self
        distances = np.linalg.norm(self._center - origin, axis=1)
        is_near = distances <= largest_range + self._reach
        key = is_near.tobytes()
        if key not in self._parts:
            nearby = [self._solids[i] for i in np.flatnonzero(is_near).tolist()]
            self._parts[key] = None
            if nearby:
                self._parts[key] = type(self)(nearby)
        return self._parts[key]

    def cast(self, origin: np.ndarray, directions: np.ndarray) -> Hits:
        """See `Solids.cast`."""
        from_center = origin - self._center
        own_origin = np.einsum("sij,sj->si", self._axes, from_center)
        own_directions = np.einsum("sij,rj->sri", self._axes, directions)
        hits = self.cast_in_own_axes(own_origin[:, np.newaxis], own_directions)
        nearest = np.argmin(hits.distance, axis=0)
        rays = np.arange(len(directions))
        own_normal = hits.normal[nearest, rays]
        return Hits(
            distance=hits.distance[nearest, rays],
            normal=np.einsum("rij,ri->rj", self._axes[nearest], own_normal),
        )

    def distances(self, points: np.ndarray) -> np.ndarray:
        """See `Solids.distances`."""
        from_center = points - self._center[:, np.newaxis]
        own_points = np.einsum("sij,spj->spi", self._axes, from_center)
        distances = self.distances_in_own_axes(own_points)
        return np.min(distances, axis=0)

    @abstractmethod
    def cast_in_own_axes(self, origin: np.ndarray, direction: np.ndarray) -> Hits:
        """Return what rays hit of every shape.

        Args:
            origin: Where the rays begin, in the axes of each shape (shapes, 1, 3) [m].
            direction: Their directions, likewise (shapes, rays, 3) [-].
        """

    @abstractmethod
    def distances_in_own_axes(self, points: np.ndarray) -> np.ndarray:
        """Return how far points are from every shape, negative inside [m].

        Args:
            points: The points, in the axes of each shape (shapes, points, 3) [m].
        """


class _Boxes(_Group):
    """Boxes: a ray is in one while it is between all three pairs of faces."""

    def cast_in_own_axes(self, origin: np.ndarray, direction: np.ndarray) -> Hits:
        """See `_Group`."""
        slope = _nonzero(direction)
        to_lower_face = (-self.size - origin) / slope
        to_upper_face = (self.size - origin) / slope
        entries = np.minimum(to_lower_face, to_upper_face)
        exits = np.maximum(to_lower_face, to_upper_face)
        entry = np.max(entries, axis=-1)
        is_hit = entry <= np.min(exits, axis=-1)
        is_ahead = entry >= 0.0
        # The face by which the ray enters is that of the last entry.
        is_of_last_entry = entries == entry[..., np.newaxis]
        normal = np.where(is_of_last_entry, -np.sign(slope), 0.0)
        length = np.linalg.norm(normal, axis=-1, keepdims=True)
        return _hits(is_hit & is_ahead, entry, normal / length)

    def distances_in_own_axes(self, points: np.ndarray) -> np.ndarray:
        """See `_Group`."""
        return _distance_beyond(np.abs(points) - self.size)


class _Cylinders(_Group):
    """Cylinders: a ray enters by the round side or by an end."""

    @property
    def _radius(self) -> np.ndarray:
        return self.size[..., 0]

    @property
    def _half_length(self) -> np.ndarray:
        return self.size[..., 2]

    def cast_in_own_axes(self, origin: np.ndarray, direction: np.ndarray) -> Hits:
        """See `_Group`."""
        by_side = self._cast_at_side(origin, direction)
        by_end = self._cast_at_end(origin, direction)
        return _nearer_hits(by_side, by_end)

    def _cast_at_side(self, origin: np.ndarray, direction: np.ndarray) -> Hits:
        """Return what rays hit of the round sides: the roots of a quadratic equation in the distance."""
        across = direction[..., :2]
        origin_across = origin[..., :2]
        steepness = np.maximum(_dot(across, across), TINY)
        approach = _dot(origin_across, across)
        beyond = _dot(origin_across, origin_across) - self._radius**2
        discriminant = approach**2 - steepness * beyond
        root = np.sqrt(np.maximum(discriminant, 0.0))
        distance = (-approach - root) / steepness
        point = _walk(origin, direction, distance)
        is_on_side = np.abs(point[..., 2]) <= self._half_length
        is_hit = (discriminant > 0.0) & (distance >= 0.0) & is_on_side
        normal = point / self.size
        normal[..., 2] = 0.0
        return _hits(is_hit, distance, normal)

    def _cast_at_end(self, origin: np.ndarray, direction: np.ndarray) -> Hits:
        """Return what rays hit of the ends that face them."""
        rise = _nonzero(direction[..., 2])
        side_of_end = -np.sign(rise)
        distance = (side_of_end * self._half_length - origin[..., 2]) / rise
        point = _walk(origin, direction, distance)
        across = point[..., :2]
        is_on_end = _dot(across, across) <= self._radius**2
        is_hit = (distance >= 0.0) & is_on_end
        normal = np.zeros_like(point)
        normal[..., 2] = side_of_end
        return _hits(is_hit, distance, normal)

    def distances_in_own_axes(self, points: np.ndarray) -> np.ndarray:
        """See `_Group`."""
        beyond_side = np.linalg.norm(points[..., :2], axis=-1) - self._radius
        beyond_end = np.abs(points[..., 2]) - self._half_length
        return _distance_beyond(np.stack((beyond_side, beyond_end), axis=-1))


class _Spheres(_Group):
    """Spheres."""

    @property
    def _radius(self) -> np.ndarray:
        return self.size[..., 0]

    def cast_in_own_axes(self, origin: np.ndarray, direction: np.ndarray) -> Hits:
        """See `_Group`."""
        approach = _dot(origin, direction)
        beyond = _dot(origin, origin) - self._radius**2
        discriminant = approach**2 - beyond
        root = np.sqrt(np.maximum(discriminant, 0.0))
        distance = -approach - root
        is_hit = (discriminant > 0.0) & (distance >= 0.0)
        point = _walk(origin, direction, distance)
        return _hits(is_hit, distance, point / self.size)

    def distances_in_own_axes(self, points: np.ndarray) -> np.ndarray:
        """See `_Group`."""
        return np.linalg.norm(points, axis=-1) - self._radius


GROUPS: Mapping[ShapeKind, type[_Group]] = {
    "box": _Boxes,
    "cylinder": _Cylinders,
    "sphere": _Spheres,
}
"""What computes the shapes of every kind."""


def _dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the scalar products of vectors along the last axis."""
    return np.sum(first * second, axis=-1)


def _nonzero(values: np.ndarray) -> np.ndarray:
    """Return numbers by which can be divided: those near 0 become `TINY`."""
    return np.where(np.abs(values) < TINY, TINY, values)


def _distance_beyond(beyond: np.ndarray) -> np.ndarray:
    """Return the distance of points that are so far beyond each pair of faces, negative between all of them [m]."""
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
    inside = np.minimum(np.max(beyond, axis=-1), 0.0)
    return outside + inside


def _walk(origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return the points at which rays arrive after a distance."""
    return origin + distance[..., np.newaxis] * direction


def _hits(is_hit: np.ndarray, distance: np.ndarray, normal: np.ndarray) -> Hits:
    """Return hits where there are any, infinitely far away elsewhere."""
    return Hits(distance=np.where(is_hit, distance, np.inf), normal=normal)


def _nearer_hits(first: Hits, second: Hits) -> Hits:
    """Return, for every ray, the nearer one of two hits."""
    second_is_nearer = second.distance < first.distance
    return Hits(
        distance=np.where(second_is_nearer, second.distance, first.distance),
        normal=np.where(second_is_nearer[..., np.newaxis], second.normal, first.normal),
    )
