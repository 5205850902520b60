"""The plain shape that a mesh is, or stands for: a box, a cylinder, or the ellipsoid with its moments."""

import math
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import to_quaternion
from laticauda.water.mujoco.elements import Quaternion, Three
from laticauda.water.mujoco.shape_mass import MassShape

SMALLEST_MESH = 1e-6
"""Volume of a mesh over that of the box around it, below which it counts as none [-]."""
AS_GOOD_AS_ZERO = 1e-9
"""Product of inertia over the sum of the moments, below which the mesh's axes are its principal ones [-]."""
BOX_TOLERANCE = 1e-3
"""Relative difference of size and volume up to which a mesh is a box [-]."""
CYLINDER_TOLERANCE = 0.03
"""The same for a cylinder, which is a prism with corners [-]."""


class MeshShape(NamedTuple):
    """The shape that a mesh counts as."""

    shape: MassShape
    half_size: Three
    """Half the length, width and height of the shape [m]."""
    volume: float
    """Of the mesh itself [m^3]."""
    center: np.ndarray
    """Center of its volume, in the geom's axes [m]."""
    axes: Quaternion
    """Axes of the shape, in the geom's axes."""


class Mesh(NamedTuple):
    """The triangles of a mesh."""

    vertices: np.ndarray
    """All vertices, shape (n_vertices, 3) [m]."""
    corners: np.ndarray
    """Corners of each triangle, shape (n_faces, 3, 3) [m]."""


def read_mesh(model: Any, geom: int) -> Mesh:
    """Read the mesh of a geom."""
    mesh = model.geom_dataid[geom]
    first_vertex = model.mesh_vertadr[mesh]
    end_of_vertices = first_vertex + model.mesh_vertnum[mesh]
    first_face = model.mesh_faceadr[mesh]
    end_of_faces = first_face + model.mesh_facenum[mesh]
    vertices = model.mesh_vert[first_vertex:end_of_vertices].astype(float)
    faces = model.mesh_face[first_face:end_of_faces]
    return Mesh(vertices=vertices, corners=vertices[faces])


def volume_of(mesh: Mesh) -> float:
    """Return the volume [m^3]; 0 if it is none of note, as that of an open or flat mesh."""
    volume = float(np.linalg.det(mesh.corners).sum()) / 6.0
    if volume > SMALLEST_MESH * math.prod(np.ptp(mesh.vertices, axis=0).tolist()):
        return volume
    return 0.0


def fit_mesh(mesh: Mesh) -> MeshShape:
    """Return the shape that a mesh with a volume is, or the ellipsoid with its moments of inertia."""
    moments = _measure_moments(mesh)
    own = (mesh.vertices - moments.center) @ moments.axes
    shape: MassShape = "ellipsoid"
    half = np.sqrt(5.0 * moments.spread)
    order = (0, 1, 2)
    if _is_box(own, moments):
        shape = "box"
        half = np.sqrt(3.0 * moments.spread)
    else:
        axis = _axis_of_cylinder(own, moments)
        if axis is not None:
            shape = "cylinder"
            order = (axis, (axis + 1) % 3, (axis + 2) % 3)
            half = _cylinder_half_size(moments.spread, axis)
    return MeshShape(
        shape=shape,
        half_size=(float(half[0]), float(half[1]), float(half[2])),
        volume=moments.volume,
        center=moments.center,
        axes=to_quaternion(moments.axes[:, order]),
    )


class _Moments(NamedTuple):
    """Moments of a mesh's volume."""

    volume: float
    """[m^3]."""
    center: np.ndarray
    """In the geom's axes [m]."""
    spread: np.ndarray
    """Mean square of the distance from the center along each principal axis, largest first [m^2]."""
    axes: np.ndarray
    """Principal axes as columns, right-handed, in the geom's axes."""


def _measure_moments(mesh: Mesh) -> _Moments:
    """Sum over tetrahedra from the origin to the faces."""
    share: np.ndarray = np.linalg.det(mesh.corners) / 6.0
    volume = float(share.sum())
    total = mesh.corners.sum(axis=1)
    center = share @ total / 4.0 / volume
    of_sums = np.einsum("n,ni,nj->ij", share, total, total)
    of_corners = np.einsum("n,nki,nkj->ij", share, mesh.corners, mesh.corners)
    spread_matrix = (of_sums + of_corners) / 20.0 / volume - np.outer(center, center)
    # Of a cube or a square prism every turned axis is a principal one, too; the mesh's own are taken.
    is_zero = np.abs(spread_matrix) < AS_GOOD_AS_ZERO * np.trace(spread_matrix)
    spread, axes = np.linalg.eigh(np.where(is_zero, 0.0, spread_matrix))
    longest_first = axes[:, ::-1]
    right_handed = longest_first * np.linalg.det(longest_first)
    return _Moments(volume=volume, center=center, spread=spread[::-1], axes=right_handed)


def _is_box(own: np.ndarray, moments: _Moments) -> bool:
    """Return whether vertices, along the principal axes, and volume are those of the box with these moments."""
    half = np.sqrt(3.0 * moments.spread)
    fits_volume = abs(moments.volume / (8.0 * np.prod(half)) - 1.0) < BOX_TOLERANCE
    return bool(fits_volume and np.all(np.abs(own).max(axis=0) < (1.0 + BOX_TOLERANCE) * half))


def _axis_of_cylinder(own: np.ndarray, moments: _Moments) -> int | None:
    """Return the principal axis along which the mesh is a cylinder; None: along none."""
    for axis in range(3):
        half_length, width, height = _cylinder_half_size(moments.spread, axis)
        radius = math.sqrt(width * height)
        is_round = abs(width / height - 1.0) < CYLINDER_TOLERANCE
        volume = 2.0 * math.pi * radius**2 * half_length
        fits_volume = abs(moments.volume / volume - 1.0) < CYLINDER_TOLERANCE
        across = np.hypot(own[:, (axis + 1) % 3], own[:, (axis + 2) % 3]).max()
        along = np.abs(own[:, axis]).max()
        is_inside = across < (1.0 + CYLINDER_TOLERANCE) * radius
        is_between_ends = along < (1.0 + CYLINDER_TOLERANCE) * half_length
        if is_round and fits_volume and is_inside and is_between_ends:
            return axis
    return None


def _cylinder_half_size(spread: np.ndarray, axis: int) -> tuple[float, float, float]:
    """Return half the length and two radii of the elliptic cylinder along an axis that has these moments."""
    return (
        math.sqrt(3.0 * spread[axis]),
        2.0 * math.sqrt(spread[(axis + 1) % 3]),
        2.0 * math.sqrt(spread[(axis + 2) % 3]),
    )
