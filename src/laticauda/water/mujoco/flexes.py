"""Elements for flexes, MuJoCo's nets and ropes: the water acts on their edges as on cylinders.

A vertex carries half of each of its edges, in the directions that they have in the reference pose:
a net that folds keeps the drag of the net as it was hung. The added mass is the mean over all
directions, so that MuJoCo's diagonal of a vertex's inertia holds it.
"""

import math
import warnings
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import load_mujoco, to_quaternion
from laticauda.water.mujoco.elements import Element

DRAG_ACROSS = 1.2
"""C_D of a long cylinder across the flow, on its length times its diameter [-]."""
DRAG_ALONG = 0.05
"""C_D along it, on the same area [-]."""
MEAN_ACROSS = 2.0 / 3.0
"""Mean over all directions of the square of the sine to an edge [-]."""
DIAGONAL = 1.2
"""Length over that of the other edges of both triangles from which on an edge is a diagonal of a cell [-]."""
MOST_DIMENSIONS = 2
"""Flexes of more dimensions are bodies, not nets."""


def flex_elements(model: Any, *, density: float = 1000.0) -> tuple[Element, ...]:
    """Return elements for the edges of all flexes that are nets or ropes; warn of those that are neither.

    Diagonals of a grid's cells, which MuJoCo adds, do not count.

    Args:
        model: A `mujoco.MjModel`.
        density: Density rho of the water [kg/m^3].
    """
    if model.nflex == 0:
        return ()
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_flex(model, data)
    elements: list[Element] = []
    dry: list[str] = []
    for flex in range(model.nflex):
        if model.flex_dim[flex] > MOST_DIMENSIONS or model.flex_interp[flex]:
            dry.append(_name_of_flex(model, flex))
        else:
            elements.extend(_elements_of(model, data, flex, density))
    if dry:
        warnings.warn(
            f"no water acts on flexes that are neither nets nor ropes: {', '.join(dry)}",
            stacklevel=3,
        )
    return tuple(elements)


def _name_of_flex(model: Any, flex: int) -> str:
    mujoco = load_mujoco()
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_FLEX, flex)
    return f"`{name or flex}`"


class _Edge(NamedTuple):
    """An edge of a flex."""

    ends: tuple[int, int]
    """Its two vertices."""
    direction: np.ndarray
    """Along it, in world axes [-]."""
    length: float
    """Its length [m]."""


def _elements_of(model: Any, data: Any, flex: int, density: float) -> Iterator[Element]:
    """Return the elements of one flex, one per vertex that can move."""
    radius = float(model.flex_radius[flex])
    first = int(model.flex_vertadr[flex])
    n_vertices = int(model.flex_vertnum[flex])
    places = data.flexvert_xpos[first : first + n_vertices]
    drag = np.zeros((n_vertices, 3, 3))
    lengths = np.zeros(n_vertices)
    for edge in _edges_of(model, flex, places):
        along = np.outer(edge.direction, edge.direction)
        per_length = DRAG_ACROSS * (np.eye(3) - along) + DRAG_ALONG * along
        for vertex in edge.ends:
            drag[vertex] += 0.5 * density * 2.0 * radius * 0.5 * edge.length * per_length
            lengths[vertex] += 0.5 * edge.length
    for vertex in range(n_vertices):
        body = int(model.flex_vertbodyid[first + vertex])
        if model.body_weldid[body] == 0 or lengths[vertex] == 0.0:
            continue
        body_axes = data.xmat[body].reshape(3, 3)
        along_axes, axes = np.linalg.eigh(body_axes.T @ drag[vertex] @ body_axes)
        axes *= np.linalg.det(axes)  # right-handed
        volume = math.pi * radius**2 * lengths[vertex]
        added = MEAN_ACROSS * density * volume
        c_x, c_y, c_z = np.maximum(along_axes, 0.0).tolist()
        x, y, z = body_axes.T @ (places[vertex] - data.xpos[body])
        yield Element(
            body=model.body(body).name or str(body),
            position=(float(x), float(y), float(z)),
            orientation=to_quaternion(axes),
            drag=(c_x, c_y, c_z),
            added_mass=(added, added, added),
            volume=volume,
            half_size=(radius, radius, radius),
        )


def _edges_of(model: Any, flex: int, places: np.ndarray) -> list[_Edge]:
    """Return the edges of a flex, without the diagonals of cells."""
    first = int(model.flex_edgeadr[flex])
    pairs = model.flex_edge[first : first + int(model.flex_edgenum[flex])].tolist()
    diagonals = _diagonals_of(model, flex, places)
    edges: list[_Edge] = []
    for i, j in pairs:
        along = places[j] - places[i]
        length = float(np.linalg.norm(along))
        if length > 0.0 and frozenset((i, j)) not in diagonals:
            edges.append(_Edge(ends=(i, j), direction=along / length, length=length))
    return edges


def _diagonals_of(model: Any, flex: int, places: np.ndarray) -> set[frozenset[int]]:
    """Return the edges that are by far the longest of two triangles."""
    if model.flex_dim[flex] != MOST_DIMENSIONS:
        return set()
    first = int(model.flex_elemdataadr[flex])
    n_corners = 3
    corners = model.flex_elem[first : first + n_corners * int(model.flex_elemnum[flex])]
    longest: list[frozenset[int]] = []
    for triangle in corners.reshape(-1, n_corners).tolist():
        sides = [frozenset(triangle) - {corner} for corner in triangle]
        by_length = sorted(sides, key=lambda side: _length_between(places, side))
        if _length_between(places, by_length[-1]) > DIAGONAL * _length_between(
            places, by_length[-2]
        ):
            longest.append(by_length[-1])
    return {side for side, n_triangles in Counter(longest).items() if n_triangles > 1}


def _length_between(places: np.ndarray, ends: frozenset[int]) -> float:
    i, j = ends
    return float(np.linalg.norm(places[j] - places[i]))
