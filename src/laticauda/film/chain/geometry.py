"""Where points of a chain are, and how they move with its coordinates; places are complex numbers x + i y.

The coordinates are the center of mass, the heading (mean angle of the links) and the joint angles, in this
order: the motion of the center of mass is smooth, whereas that of either end swings. With theta the link
angles and t_k = exp(i theta_k), a point is

    p + sum_k G_k t_k,         G = its lever (`laticauda.robot.levers`) + i times its distance to the left
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Complex, Float, Int

from laticauda.robot import Robot, levers
from laticauda.values import BadArgument

N_ROOT = 3
"""Coordinates of the root: x and y of the center of mass, and the heading."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PointPlaces:
    """Where tracked points sit on the straight body, and how surely; not only on joints.

    Example:
        >>> import numpy as np
        >>> PointPlaces(along=np.array([0.02, 0.6]), left=np.zeros(2)).along_deviation
        0.0
    """

    along: Float[np.ndarray, " n_points"]
    """Distance of each point from the tail end along the body; on a fin it is negative [m]."""
    left: Float[np.ndarray, " n_points"]
    """Distance of each point from the axis, to the left [m]."""
    along_deviation: float = 0.0
    """Standard deviation of `along`; above 0 the fit finds the places, too [m]."""
    left_deviation: float = 0.0
    """Standard deviation of `left` [m]."""

    def __post_init__(self) -> None:
        """Check the consistency of the fields."""
        if self.along.ndim != 1 or self.along.shape != self.left.shape:
            rule = "must have one distance per point, as `along` has"
            raise BadArgument("left", f"{rule}, got {self.left.size} for {self.along.size}")
        for name in ("along", "left"):
            if not np.all(np.isfinite(getattr(self, name))):
                raise BadArgument(name, "must hold finite distances in m")
        for name in ("along_deviation", "left_deviation"):
            if not getattr(self, name) >= 0.0:
                raise BadArgument(name, f"must be >= 0 m, got {getattr(self, name)}")


Distances = Sequence[float] | Float[np.ndarray, " n_points"]


def places_at(along: Distances, left: Distances | None = None) -> PointPlaces:
    """Return points at known distances from the tail end along the body.

    Args:
        along: Distance of each point from the tail end [m].
        left: Distance of each from the axis, to the left; None: on the axis [m].
    """
    distances = np.asarray(along, dtype=float)
    if left is None:
        left = np.zeros_like(distances)
    return PointPlaces(along=distances, left=np.asarray(left, dtype=float))


@dataclass(frozen=True, kw_only=True, eq=False)
class ChainGeometry:
    """Points on the links of a robot."""

    robot: Robot
    """The planar robot."""
    link: Int[np.ndarray, " n_points"]
    """Link that each point moves with, tail first."""
    lever: Complex[np.ndarray, "n_points n_links"]
    """G of every point, for its place as given [m]."""

    @classmethod
    def of(cls, robot: Robot, places: PointPlaces) -> "ChainGeometry":
        """Return the geometry of points on a robot.

        Args:
            robot: The robot, without pitch joints (`Robot.planar`).
            places: Where the points sit.

        Raises:
            ValueError: If a point is not on the body or its fin.
        """
        begin = link_begins(robot)
        fin_length = robot.reach - robot.length
        for i, distance in enumerate(places.along):
            if not -fin_length - 1e-9 <= distance <= robot.length + 1e-9:
                raise BadArgument(
                    f"along[{i}]",
                    f"must be {-fin_length:.4g} to {robot.length:.4g} m from the tail end, "
                    f"on the body of `{robot.name}`, got {distance:.4g}",
                )
        last_link = robot.n_links - 1
        link = np.clip(np.searchsorted(begin, places.along, side="right") - 1, 0, last_link)
        n_points = places.along.size
        lever = levers_of_ends(robot)[link].astype(complex)
        lever[np.arange(n_points), link] += places.along - begin[link] + 1j * places.left
        return cls(robot=robot, link=link, lever=lever)

    @property
    def n_coordinates(self) -> int:
        """Number of coordinates of the chain."""
        return self.robot.n_links + N_ROOT - 1

    @cached_property
    def angle_shares(self) -> Float[np.ndarray, "n_links n_angles"]:
        """Link angles per heading and joint angles."""
        n = self.robot.n_links
        bends = np.tril(np.ones((n, n)), k=-1)[:, : n - 1]
        return np.column_stack((np.ones(n), bends - bends.mean(axis=0)))

    def directions(
        self, coordinates: Float[np.ndarray, "*batch n_coordinates"]
    ) -> Complex[np.ndarray, "*batch n_links"]:
        """Return the direction of every link as a complex number of size 1.

        Args:
            coordinates: Coordinates of the chain.
        """
        return np.exp(1j * (coordinates[..., N_ROOT - 1 :] @ self.angle_shares.T))

    def points(
        self,
        coordinates: Float[np.ndarray, "*batch n_coordinates"],
        shift: Complex[np.ndarray, " n_points"] | None = None,
    ) -> Complex[np.ndarray, "*batch n_points"]:
        """Return where the points are [m].

        Args:
            coordinates: Coordinates of the chain.
            shift: By how much each point sits elsewhere on its link, headward + i leftward [m].
        """
        directions = self.directions(coordinates)
        center = coordinates[..., 0] + 1j * coordinates[..., 1]
        places = center[..., np.newaxis] + directions @ self.lever.T
        if shift is None:
            return places
        return places + shift * directions[..., self.link]

    def jacobian(
        self,
        coordinates: Float[np.ndarray, "n_frames n_coordinates"],
        shift: Complex[np.ndarray, " n_points"],
    ) -> Complex[np.ndarray, "n_frames n_points n_coordinates"]:
        """Return the derivatives of `points` by the coordinates.

        Args:
            coordinates: Coordinates of the chain in every frame.
            shift: By how much each point sits elsewhere on its link, headward + i leftward [m].
        """
        lever = self.lever.copy()
        lever[np.arange(lever.shape[0]), self.link] += shift
        turning = 1j * lever * self.directions(coordinates)[:, np.newaxis, :]
        jacobian = np.empty((*turning.shape[:2], self.n_coordinates), dtype=complex)
        jacobian[..., 0] = 1.0
        jacobian[..., 1] = 1j
        jacobian[..., N_ROOT - 1 :] = turning @ self.angle_shares
        return jacobian


def link_begins(robot: Robot) -> Float[np.ndarray, " n_links"]:
    """Return the distance of every link's tail end from that of the body [m].

    Args:
        robot: The robot.
    """
    lengths = np.array([module.length for module in robot.modules])
    return np.cumsum(lengths) - lengths


def levers_of_ends(robot: Robot) -> Float[np.ndarray, "n_ends n_links"]:
    """Return the levers of tail end, joints and head end, with a rigid fin as part of the tail link [m].

    Args:
        robot: The robot.
    """
    of_ends = levers(robot).end
    n_fin_pieces = of_ends.shape[1] - robot.n_links
    folded = of_ends[:, n_fin_pieces:].copy()
    folded[:, 0] += of_ends[:, :n_fin_pieces].sum(axis=1)
    return folded
