"""Rigid bodies of an animal or robot in one common frame, and the hinges between them: what a morphology file says.

Readers of SDF and of MJCF fill these records; `spine` makes a robot of them.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

Vector: TypeAlias = Float[np.ndarray, " 3"]
Matrix: TypeAlias = Float[np.ndarray, "3 3"]
SolidKind: TypeAlias = Literal["box", "cylinder", "capsule", "ellipsoid", "mesh"]


class Placement(NamedTuple):
    """Where a frame is in another one, and how it is turned."""

    position: Vector
    """Its origin [m]."""
    rotation: Matrix
    """Its axes, as columns."""

    def move(self, point: Vector) -> Vector:
        """Return a point of this frame in the other one.

        Args:
            point: Coordinates in this frame [m].
        """
        return self.position + self.rotation @ point

    def place(self, inner: "Placement") -> "Placement":
        """Return where a frame is in the other frame.

        Args:
            inner: Where it is in this one.
        """
        return Placement(self.move(inner.position), self.rotation @ inner.rotation)

    def turn(self, tensor: Matrix) -> Matrix:
        """Return a tensor of this frame with the axes of the other one.

        Args:
            tensor: Tensor, such as a moment of inertia.
        """
        return self.rotation @ tensor @ self.rotation.T


WEIGHTLESS = 1e-9
"""Mass up to which a body has none: FARMS writes 1e-10 kg for it in MJCF files [kg]."""
UNMOVED = Placement(np.zeros(3), np.eye(3))
"""Placement of a frame in itself."""


class Limits(NamedTuple):
    """Between which values something may be; infinite where it has no limit."""

    low: float
    """The least one."""
    high: float
    """The largest one."""


class Extent(NamedTuple):
    """What a body covers along a direction, from the origin of the common frame."""

    low: float
    """Its least coordinate [m]."""
    high: float
    """Its largest coordinate [m]."""

    @property
    def half(self) -> float:
        """Half of its size [m]."""
        return 0.5 * (self.high - self.low)


@dataclass(frozen=True, eq=False, kw_only=True)
class Solid:
    """Shape of a part of a body."""

    kind: SolidKind
    placement: Placement
    """Where it is in the common frame."""
    half_size: Vector
    """Half edges of a box, half axes of an ellipsoid; radius, radius and half length along z of the others [m]."""
    vertices: Float[np.ndarray, "n_vertices 3"] | None = None
    """Those of a mesh, in its own frame [m]."""

    def extent(self, direction: Vector) -> Extent:
        """Return what it covers along a direction.

        Args:
            direction: Unit vector in the common frame.
        """
        middle = float(direction @ self.placement.position)
        own_direction = self.placement.rotation.T @ direction
        if self.vertices is not None:
            coordinates = self.vertices @ own_direction
            return Extent(
                low=middle + float(coordinates.min()), high=middle + float(coordinates.max())
            )
        reach = self._reach(own_direction)
        return Extent(low=middle - reach, high=middle + reach)

    def _reach(self, direction: Vector) -> float:
        """Return how far it reaches from its middle along a direction of its own frame [m]."""
        shares = np.abs(direction) * self.half_size
        if self.kind == "box":
            return float(shares.sum())
        if self.kind == "ellipsoid":
            return float(np.linalg.norm(shares))
        along, radius = float(shares[2]), float(self.half_size[0])
        if self.kind == "capsule":
            return along + radius
        return along + float(np.linalg.norm(shares[:2]))


@dataclass(frozen=True, eq=False, kw_only=True)
class Hinge:
    """Hinge of a body to its parent."""

    name: str
    anchor: Vector
    """A point of its axis, in the common frame [m]."""
    axis: Vector
    """Unit vector about which it turns the body, in the common frame."""
    lower: float
    """Least angle [rad]."""
    upper: float
    """Largest angle [rad]."""
    stiffness: float = 0.0
    """Of a spring at rest at 0 [N m/rad]."""
    damping: float = 0.0
    """Viscous [N m s/rad]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """Rigid body."""

    name: str
    parent: str | None
    """Name of the body that carries it; None for a root."""
    hinge: Hinge | None
    """Its hinge to the parent; None if it is fixed to it, or a root."""
    placement: Placement
    """Where its frame is in the common frame, all angles being 0."""
    mass: float
    """Mass [kg]."""
    center: Vector
    """Center of mass, in the common frame [m]."""
    inertia: Matrix
    """Moment of inertia about the center of mass, with the axes of the common frame [kg m^2]."""
    solids: Sequence[Solid] = ()
    """Shapes that touch and displace water."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Morphology:
    """Bodies of one animal or robot."""

    name: str
    bodies: Mapping[str, Body]
    """By name, every parent before its children."""
    remarks: Sequence[str] = ()
    """What of the file is not in here."""

    @property
    def root(self) -> Body:
        """Body without a parent."""
        return next(body for body in self.bodies.values() if body.parent is None)


class Lump(NamedTuple):
    """Bodies that move as one."""

    mass: float
    """Their mass [kg]."""
    center: Vector
    """Their center of mass [m]."""
    inertia: Matrix
    """Their moment of inertia about it [kg m^2]."""

    @classmethod
    def of(cls, bodies: Sequence[Body]) -> "Lump":
        """Return several bodies as one.

        Args:
            bodies: The bodies; together they have a mass.
        """
        masses = np.array([body.mass for body in bodies])
        mass = float(masses.sum())
        centers = np.array([body.center for body in bodies])
        center = masses @ centers / mass
        inertia = np.zeros((3, 3))
        for body in bodies:
            lever = body.center - center
            squares = np.dot(lever, lever) * np.eye(3) - np.outer(lever, lever)
            inertia = inertia + body.inertia + body.mass * squares
        return cls(mass, center, inertia)


def solids_of(bodies: Sequence[Body]) -> list[Solid]:
    """Return the shapes of bodies.

    Args:
        bodies: The bodies.
    """
    solids: list[Solid] = []
    for body in bodies:
        solids.extend(body.solids)
    return solids


def extent_of(bodies: Sequence[Body], direction: Vector) -> Extent | None:
    """Return what the shapes of bodies cover along a direction; None if they have none.

    Args:
        bodies: The bodies.
        direction: Unit vector in the common frame.
    """
    extents = [solid.extent(direction) for solid in solids_of(bodies)]
    if not extents:
        return None
    return Extent(
        low=min(extent.low for extent in extents), high=max(extent.high for extent in extents)
    )


PARALLEL = 0.9
"""Least share of a unit vector along another one that counts as parallel [-]."""


def is_parallel(first: Vector, second: Vector) -> bool:
    """Return whether two unit vectors are about parallel, in either sense.

    Args:
        first: A unit vector.
        second: Another one.
    """
    return abs(float(first @ second)) > PARALLEL


def normalize(vector: Vector) -> Vector:
    """Return the unit vector of a direction.

    Args:
        vector: Vector that is not 0.
    """
    return vector / np.linalg.norm(vector)


def rotate_by_rpy(roll: float, pitch: float, yaw: float) -> Matrix:
    """Return the rotation about x, then y, then z, all three fixed: angles of SDF and URDF.

    Args:
        roll: Angle about x [rad].
        pitch: Angle about y [rad].
        yaw: Angle about z [rad].
    """
    about_x = _rotate_about(roll, 1, 2)
    about_y = _rotate_about(pitch, 2, 0)
    about_z = _rotate_about(yaw, 0, 1)
    return about_z @ about_y @ about_x


def _rotate_about(angle: float, first: int, second: int) -> Matrix:
    """Return the rotation that turns the first axis toward the second one."""
    rotation = np.eye(3)
    rotation[first, first] = math.cos(angle)
    rotation[second, second] = math.cos(angle)
    rotation[second, first] = math.sin(angle)
    rotation[first, second] = -math.sin(angle)
    return rotation
