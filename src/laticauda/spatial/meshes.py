"""Triangle meshes of bodies with an elliptic section: vertices and faces, made from a few numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

AROUND = 40  # vertices around a section; the eye sees no corners


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """A closed surface, seen from outside counter-clockwise."""

    vertices: Float[np.ndarray, "n_vertices 3"]
    """[m]."""
    faces: Int[np.ndarray, "n_faces 3"]
    """Three vertices each [-]."""


def loft(stations: Sequence[tuple[float, float, float]], *, around: int = AROUND, squareness: float = 2.0) -> Mesh:
    """A surface through sections that stand on the x axis, closed at both ends.

    Args:
        stations: Of every section its place x, its half height and its half width [m], x not falling.
        around: Vertices of one section.
        squareness: Exponent of the sections |y/b|^s + |z/a|^s = 1: 2 is an ellipse, more comes nearer to a rectangle.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    side, up = (np.sign(part) * np.abs(part) ** (2.0 / squareness) for part in (np.cos(angle), np.sin(angle)))
    rings = [np.stack((np.full(around, x), b * side, a * up), axis=1) for x, a, b in stations]
    ends = [(stations[0][0], 0.0, 0.0), (stations[-1][0], 0.0, 0.0)]
    first = np.arange(around)
    second = (first + 1) % around
    faces: list[np.ndarray] = []
    for k in range(len(stations) - 1):
        low, high = k * around, (k + 1) * around
        faces.append(np.stack((low + first, low + second, high + second), axis=1))
        faces.append(np.stack((low + first, high + second, high + first), axis=1))
    last, n = (len(stations) - 1) * around, len(stations) * around
    faces.append(np.stack((np.full(around, n), second, first), axis=1))
    faces.append(np.stack((np.full(around, n + 1), last + first, last + second), axis=1))
    return Mesh(vertices=np.vstack([*rings, ends]), faces=np.vstack(faces))


def joined(*meshes: Mesh) -> Mesh:
    """Several surfaces as one."""
    shifts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + shift for mesh, shift in zip(meshes, shifts, strict=True)]
    return Mesh(vertices=np.vstack([mesh.vertices for mesh in meshes]), faces=np.vstack(faces))
