"""Triangle meshes, and how they are made: surfaces through elliptic sections."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

VERTICES_PER_SECTION = 20
"""Vertices around a section, enough to look smooth."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """A closed triangle mesh, with faces counterclockwise when seen from outside."""

    vertices: Float[np.ndarray, "n_vertices 3"]
    """Coordinates [m]."""
    faces: Int[np.ndarray, "n_faces 3"]
    """Three vertex indices per face [-]."""


class Section(NamedTuple):
    """An elliptic section of a surface, centered on the x axis and normal to it."""

    x: float
    """Position along the axis [m]."""
    half_height: float
    """Half size along z [m]."""
    half_width: float
    """Half size along y [m]."""


def loft_sections(sections: Sequence[Section], *, around: int = VERTICES_PER_SECTION) -> Mesh:
    """Return a surface through elliptic sections, closed at both ends.

    Args:
        sections: The sections, with x nondecreasing.
        around: Number of vertices per section.
    """
    vertices = _vertices_of_sections(sections, around)
    first = np.arange(around)
    second = (first + 1) % around
    faces: list[np.ndarray] = []
    for k in range(len(sections) - 1):
        start = k * around
        end = start + around
        faces.append(np.stack((start + first, start + second, end + second), axis=1))
        faces.append(np.stack((start + first, end + second, end + first), axis=1))
    last_ring = (len(sections) - 1) * around
    first_center = len(sections) * around
    last_center = first_center + 1
    start_cap = (np.full(around, first_center), second, first)
    end_cap = (np.full(around, last_center), last_ring + first, last_ring + second)
    faces.append(np.stack(start_cap, axis=1))
    faces.append(np.stack(end_cap, axis=1))
    return Mesh(vertices=vertices, faces=np.vstack(faces))


def _vertices_of_sections(sections: Sequence[Section], around: int) -> np.ndarray:
    """Return the vertices around every section, then the centers of the first and the last one."""
    angle = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    cos = np.cos(angle)
    sin = np.sin(angle)
    rings: list[np.ndarray] = []
    for section in sections:
        x = np.full(around, section.x)
        rings.append(np.stack((x, section.half_width * cos, section.half_height * sin), axis=1))
    centers = [(sections[0].x, 0.0, 0.0), (sections[-1].x, 0.0, 0.0)]
    return np.vstack([*rings, centers])


def join_meshes(*meshes: Mesh) -> Mesh:
    """Merge several meshes into one."""
    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []
    n_vertices = 0
    for mesh in meshes:
        vertices.append(mesh.vertices)
        faces.append(mesh.faces + n_vertices)
        n_vertices += len(mesh.vertices)
    return Mesh(vertices=np.vstack(vertices), faces=np.vstack(faces))
