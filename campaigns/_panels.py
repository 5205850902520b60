"""Added mass and inertia of a body in unbounded water, by panels of constant source strength.

The body is symmetric about its three planes, and the panels cover the octant x, y, z >= 0. With a
source of strength sigma per area on panel q, the potential at the middle of panel p and its slope
along the outward normal n_p are sums over the panels and their mirror images (Hess and Smith, 1964).
The strengths follow from the normal velocity of the unit motion; then m = -rho * integral of phi v_n.

References:
    J. L. Hess and A. M. O. Smith, Calculation of nonlifting potential flow about arbitrary
    three-dimensional bodies, J. Ship Research 8, 1964.
"""

import itertools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

MOTIONS = ("x", "y", "z", "about x", "about y", "about z")
ODD_IN = ((0,), (1,), (2,), (1, 2), (0, 2), (0, 1))
"""Axes in whose mirror the normal velocity of a motion changes its sign, motion by motion."""
SMALLEST_EDGE = 1e-14
"""Edge of a panel below which it is a triangle [m]."""
SMALLEST_LENGTH = 1e-300
"""Keeps the logarithm of a point on an edge finite [m]."""


class Panels(NamedTuple):
    """Flat quadrilaterals of one octant."""

    corners: np.ndarray
    """(N, 4, 3), counter-clockwise as seen from the water [m]."""

    @property
    def middles(self) -> np.ndarray:
        """(N, 3) [m]."""
        return self.corners.mean(axis=1)

    @property
    def normals(self) -> np.ndarray:
        """Into the water, with the panels' areas as lengths, (N, 3) [m^2]."""
        first = self.corners[:, 2] - self.corners[:, 0]
        second = self.corners[:, 3] - self.corners[:, 1]
        return 0.5 * np.cross(first, second)

    def mirrored(self, signs: np.ndarray) -> "Panels":
        """Return the image with x, y and z times the signs."""
        corners = self.corners * signs
        if np.prod(signs) < 0.0:
            corners = corners[:, ::-1]
        return Panels(corners)


def added_mass(panels: Panels) -> np.ndarray:
    """Return added mass along x, y, z [m^3] and inertia about them [m^5], relative to the water's density."""
    normals = panels.normals
    areas = np.linalg.norm(normals, axis=1)
    units = normals / areas[:, np.newaxis]
    middles = panels.middles
    potentials: dict[tuple[float, ...], np.ndarray] = {}
    slopes: dict[tuple[float, ...], np.ndarray] = {}
    for signs in itertools.product((1.0, -1.0), repeat=3):
        image = panels.mirrored(np.array(signs))
        potential, velocity = _influence(middles, image)
        slope = np.einsum("pqi,pi->pq", velocity, units)
        if min(signs) > 0.0:
            np.fill_diagonal(slope, -2.0 * np.pi)
        potentials[signs] = potential
        slopes[signs] = slope
    normal_velocities = np.hstack([units, np.cross(middles, units)]).T
    results = []
    for odd_axes, normal_velocity in zip(ODD_IN, normal_velocities, strict=True):
        parity = {signs: np.prod([signs[axis] for axis in odd_axes]) for signs in potentials}
        slope = sum(parity[signs] * slopes[signs] for signs in slopes)
        potential = sum(parity[signs] * potentials[signs] for signs in potentials)
        strengths = np.linalg.solve(slope, normal_velocity)
        results.append(-8.0 * np.sum((potential @ strengths) * normal_velocity * areas))
    return np.array(results)


def extrapolated(make_panels: Callable[[int], Panels], n: int) -> np.ndarray:
    """Return `added_mass` for panels of no size: their error is of first order, so n and 2 n per side tell it."""
    coarse = added_mass(make_panels(n))
    fine = added_mass(make_panels(2 * n))
    return 2.0 * fine - coarse


def _influence(points: np.ndarray, panels: Panels) -> tuple[np.ndarray, np.ndarray]:
    """Return the potential (P, N) and velocity (P, N, 3) at points: the integrals of 1/r and of its gradient."""
    corners = panels.corners
    normals = panels.normals
    units = normals / np.linalg.norm(normals, axis=1)[:, np.newaxis]
    from_first = points[:, np.newaxis] - corners[np.newaxis, :, 0]
    height = np.einsum("pqi,qi->pq", from_first, units)
    potential = np.zeros(height.shape)
    velocity = np.zeros((*height.shape, 3))
    for edge in range(4):
        start = corners[:, edge]
        end = corners[:, (edge + 1) % 4]
        length = np.linalg.norm(end - start, axis=1)
        is_edge = length > SMALLEST_EDGE
        outward = np.cross(end - start, units) / np.where(is_edge, length, 1.0)[:, np.newaxis]
        to_start = start[np.newaxis] - points[:, np.newaxis]
        to_end = end[np.newaxis] - points[:, np.newaxis]
        around = np.linalg.norm(to_start, axis=2) + np.linalg.norm(to_end, axis=2)
        logarithm = np.log((around + length) / np.maximum(around - length, SMALLEST_LENGTH))
        logarithm = np.where(is_edge, logarithm, 0.0)
        potential += np.einsum("pqi,qi->pq", to_start, outward) * logarithm
        velocity -= outward * logarithm[..., np.newaxis]
    angle = _solid_angle(points, corners[:, [0, 1, 2]]) + _solid_angle(
        points, corners[:, [0, 2, 3]]
    )
    angle = np.abs(angle) * np.sign(height)
    potential -= height * angle
    velocity -= units * angle[..., np.newaxis]
    return potential, velocity


def _solid_angle(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the angle in which points see triangles, (P, N) [sr] (van Oosterom and Strackee, 1983)."""
    a, b, c = (triangles[np.newaxis, :, i] - points[:, np.newaxis] for i in range(3))
    length_a, length_b, length_c = (np.linalg.norm(side, axis=2) for side in (a, b, c))
    numerator = np.einsum("pqi,pqi->pq", a, np.cross(b, c))
    denominator = (
        length_a * length_b * length_c
        + np.einsum("pqi,pqi->pq", a, b) * length_c
        + np.einsum("pqi,pqi->pq", b, c) * length_a
        + np.einsum("pqi,pqi->pq", c, a) * length_b
    )
    return 2.0 * np.arctan2(numerator, denominator)


def _toward_edge(half: float, n: int) -> np.ndarray:
    """Return n + 1 places from 0 to the half size, dense at the edge, where the velocity is singular."""
    return half * np.sin(np.linspace(0.0, 0.5 * np.pi, n + 1))


def box_panels(half: tuple[float, float, float], counts: tuple[int, int, int]) -> Panels:
    """Return panels of a box.

    Args:
        half: Half the size along x, y and z [m].
        counts: Panels along each.
    """
    quads = []
    for axis in range(3):
        second = (axis + 1) % 3
        third = (axis + 2) % 3
        u = _toward_edge(half[second], counts[second])
        v = _toward_edge(half[third], counts[third])
        for i, j in itertools.product(range(counts[second]), range(counts[third])):
            quad = np.zeros((4, 3))
            quad[:, axis] = half[axis]
            quad[:, second] = (u[i], u[i + 1], u[i + 1], u[i])
            quad[:, third] = (v[j], v[j], v[j + 1], v[j + 1])
            quads.append(quad)
    return Panels(np.array(quads))


def cylinder_panels(
    radius: float, half_length: float, counts: tuple[int, int], n_around: int
) -> Panels:
    """Return panels of a cylinder along x.

    Args:
        radius: Its radius [m].
        half_length: Half of its length [m].
        counts: Panels along the side and along the radius of the end.
        n_around: Panels around a quarter.
    """
    side = [(x, radius) for x in _toward_edge(half_length, counts[0])]
    end = [(half_length, r) for r in _toward_edge(radius, counts[1])[-2::-1]]
    return _revolve(np.array(side + end), n_around)


def capsule_panels(
    radius: float, half_length: float, counts: tuple[int, int], n_around: int
) -> Panels:
    """Return panels of a capsule along x.

    Args:
        radius: Its radius [m].
        half_length: Half of the length of its cylinder; 0: a sphere [m].
        counts: Panels along the cylinder and along the cap.
        n_around: Panels around a quarter.
    """
    angle = np.linspace(0.0, 0.5 * np.pi, counts[1] + 1)
    outline = [(half_length + radius * np.sin(a), radius * np.cos(a)) for a in angle]
    if half_length > 0.0:
        side = np.linspace(0.0, half_length, counts[0] + 1)[:-1]
        outline = [(x, radius) for x in side] + outline
    return _revolve(np.array(outline), n_around)


def _revolve(outline: np.ndarray, n_around: int) -> Panels:
    """Return panels around the x axis; each polygon has the area of its circle.

    Args:
        outline: x and radius from the middle to the tip, (N, 2) [m].
        n_around: Panels around a quarter.
    """
    angle = np.linspace(0.0, 0.5 * np.pi, n_around + 1)
    step = angle[1]
    larger = np.sqrt(step / np.sin(step))
    quads = []
    for (x_0, r_0), (x_1, r_1) in itertools.pairwise(outline):
        for a_0, a_1 in itertools.pairwise(angle):
            corners = ((x_0, r_0, a_0), (x_1, r_1, a_0), (x_1, r_1, a_1), (x_0, r_0, a_1))
            quads.append(
                [(x, larger * r * np.sin(a), larger * r * np.cos(a)) for x, r, a in corners]
            )
    return Panels(np.array(quads))
