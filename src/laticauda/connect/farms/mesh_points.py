"""Vertices of mesh files: how far a shape reaches."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from laticauda.values import RobotFileError
from laticauda.values.files import read_content

Points = Float[np.ndarray, "n_vertices 3"]

STL_HEADER = 84
"""Bytes before the first triangle of a binary STL file."""
STL_TRIANGLE = np.dtype([("numbers", "<f4", (4, 3)), ("attribute", "<u2")])
"""A normal and three vertices."""


def read_vertices(path: Path) -> Points | None:
    """Return the vertices of a mesh file; None if it is not there, or of no kind that is read (OBJ, binary STL).

    Args:
        path: Path of the file.
    """
    if not path.is_file():
        return None
    ending = path.suffix.lower()
    content = read_content(path, RobotFileError)
    if ending == ".obj":
        return _read_obj(content)
    if ending == ".stl":
        return _read_stl(content)
    return None


def _read_obj(content: bytes) -> Points | None:
    """Return the vertices in an OBJ file."""
    """Return the vertices in an OBJ file."""
    vertices: list[list[float]] = []
    for line in content.splitlines():
        keyword, *coordinates = line.split() or [b""]
        if keyword == b"v":
            vertices.append([float(coordinate) for coordinate in coordinates[:3]])
    if not vertices:
        return None
    return np.array(vertices)


def _read_stl(content: bytes) -> Points | None:
    """Return the vertices of the triangles in a binary STL file."""
    """Return the vertices of the triangles in a binary STL file."""
    n_triangles = int.from_bytes(content[STL_HEADER - 4 : STL_HEADER], "little")
    if n_triangles == 0 or len(content) != STL_HEADER + n_triangles * STL_TRIANGLE.itemsize:
        return None  # written as text, or cut off
    triangles = np.frombuffer(
        content,
        dtype=STL_TRIANGLE,
        count=n_triangles,
        offset=STL_HEADER,
    )
    return triangles["numbers"][:, 1:].reshape(-1, 3).astype(float)
