"""Stability of a floating or submerged body: where its metacenter is."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.values import load_mujoco
from laticauda.water.mujoco import hydrostatics
from laticauda.water.mujoco.bodies import body_of, element_pose
from laticauda.water.mujoco.elements import Element

HEEL = 1e-3
"""Angle by which a body is turned to either side [rad]."""
BISECTIONS = 32
"""Halvings of the range of drafts in which a body floats."""


def metacentric_height(model: Any, root: int, water: Any) -> float:
    """Return the height of a tree's metacenter above its center of mass in its reference pose, for the weaker axis [m].

    A floating tree is at the draft that carries it; for a submerged one, the metacenter is its
    center of buoyancy.
    """
    elements = [
        element
        for element in water.elements
        if element.volume > 0.0 and model.body_rootid[body_of(model, element.body)] == root
    ]
    if not elements:
        return 0.0
    hull = _hull_of(model, root, elements)
    needed = float(model.body_subtreemass[root]) / water.options["density"]
    has_surface = water.options["surface"] is not None
    floats = has_surface and needed < hull.volumes.sum()
    about_x = _slope_of_center(hull, 0, needed, floats)
    about_y = _slope_of_center(hull, 1, needed, floats)
    heights = np.linalg.eigvals(np.array([[-about_x[1], -about_y[1]], [about_x[0], about_y[0]]]))
    return float(heights.real.min())


@dataclass(frozen=True, kw_only=True, eq=False)
class _Hull:
    """Elements of a tree that displace water, in its reference pose; places are relative to its center of mass."""

    elements: list[Element]
    places: np.ndarray
    """Centers of the elements, shape (n, 3) [m]."""
    axes: np.ndarray
    """Axes of the elements as columns, shape (n, 3, 3) [-]."""
    volumes: np.ndarray
    """Volumes of the elements, shape (n,) [m^3]."""
    reach: float
    """Distance from the center of mass within which the tree lies [m]."""


def _hull_of(model: Any, root: int, elements: list[Element]) -> _Hull:
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    poses = [element_pose(model, data, element) for element in elements]
    places = np.array([pose.center for pose in poses]) - data.subtree_com[root]
    largest_element = max(math.hypot(*element.half_size) for element in elements)
    return _Hull(
        elements=elements,
        places=places,
        axes=np.array([pose.axes for pose in poses]),
        volumes=np.array([element.volume for element in elements]),
        reach=float(np.linalg.norm(places, axis=1).max()) + largest_element,
    )


def _slope_of_center(hull: _Hull, axis: int, needed: float, floats: bool) -> np.ndarray:
    """Return the change of the center of buoyancy per angle about a horizontal axis [m/rad]."""
    forward = _center_of_buoyancy(_turn_hull(hull, axis, HEEL), needed, floats)
    backward = _center_of_buoyancy(_turn_hull(hull, axis, -HEEL), needed, floats)
    return (forward - backward) / (2.0 * HEEL)


def _turn_hull(hull: _Hull, axis: int, angle: float) -> _Hull:
    """Turn a hull about a horizontal axis through its center of mass."""
    mujoco = load_mujoco()
    matrix = np.zeros(9)
    direction = math.sin(0.5 * angle) * np.eye(3)[axis]
    mujoco.mju_quat2Mat(matrix, [math.cos(0.5 * angle), *direction])
    turn = matrix.reshape(3, 3)
    return replace(hull, places=hull.places @ turn.T, axes=turn @ hull.axes)


def _center_of_buoyancy(hull: _Hull, needed: float, floats: bool) -> np.ndarray:
    """Return the center of buoyancy relative to that of mass, at the draft that carries the tree if it floats [m]."""
    low = -hull.reach
    high = hull.reach
    if floats:
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if _displaced(hull, middle)[0] < needed:
                low = middle
            else:
                high = middle
    total = _displaced(hull, high)
    return total[1:] / total[0]


def _displaced(hull: _Hull, depth: float) -> np.ndarray:
    """Return the volume that a hull displaces at a depth of its center of mass [m^3], then its moments [m^4]."""
    ups = hull.axes[:, 2].tolist()
    depths = (depth - hull.places[:, 2]).tolist()
    wet = np.array(
        [
            hydrostatics.wetted(_shape_of(element), element.half_size, up, own_depth)
            for element, up, own_depth in zip(hull.elements, ups, depths, strict=True)
        ]
    )
    centers = hull.places + np.einsum("nij,nj->ni", hull.axes, wet[:, 1:])
    volume_and_moments = np.column_stack([np.ones(len(centers)), centers])
    return (hull.volumes * wet[:, 0]) @ volume_and_moments


def _shape_of(element: Element) -> float:
    """Return the number by which the formulas of hydrostatics know an element's shape."""
    return float(getattr(hydrostatics, element.shape.upper()))
