"""Stability of a floating or submerged body: where its metacenter is."""

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import load_mujoco
from laticauda.water.mujoco import hydrostatics
from laticauda.water.mujoco.bodies import body_of, element_pose
from laticauda.water.mujoco.elements import Element

HEEL = 1e-3
"""Angle by which a body is turned to either side [rad]."""
FIRST_TURN = math.radians(4.0)
"""First angle by which a body is turned toward its rest [rad]."""
LAST_TURN = math.radians(0.05)
"""Angle below which it counts as at rest [rad]."""
MOST_TURNS = 300
"""Most turns on the way to its rest."""
NO_LEVER = 1e-7
"""Horizontal distance from the center of mass to that of buoyancy, over the size, that counts as none [-]."""
FAR = math.radians(60.0)
"""Angle to its rest from which on a body turns over, and below which it levels out [rad]."""
BISECTIONS = 32
"""Halvings of the range of drafts in which a body floats."""


def metacentric_height(model: Any, root: int, water: Any) -> float:
    """Return the height of a tree's metacenter above its center of mass in its reference pose, for the weaker axis [m].

    A floating tree is at the draft that carries it; for a submerged one, the metacenter is its
    center of buoyancy.
    """
    floating = _floating_tree(model, root, water)
    if floating is None:
        return 0.0
    return _height_of_metacenter(floating)


def overturning_lever(model: Any, root: int, water: Any) -> float:
    """Return how far the metacenter of a tree is below its center of mass, if the tree turns over [m]; else 0.

    A tree in a pose that is no equilibrium, such as a float that starts pitched, turns over only if
    its rest is more than 60 deg away.
    """
    floating = _floating_tree(model, root, water)
    if floating is None:
        return 0.0
    height = _height_of_metacenter(floating)
    if height >= 0.0:
        return 0.0
    angle = _angle_to_rest(floating)
    is_in_equilibrium = angle < LAST_TURN
    if is_in_equilibrium or angle > FAR:
        return -height
    return 0.0


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


class _Floating(NamedTuple):
    """A tree that displaces water."""

    hull: _Hull
    """Its elements."""
    needed: float
    """Volume that carries it [m^3]."""
    floats: bool
    """Whether it does not have to be submerged for that."""


def _floating_tree(model: Any, root: int, water: Any) -> _Floating | None:
    """Return a tree in its reference pose; None: it displaces nothing."""
    elements = [
        element
        for element in water.elements
        if element.volume > 0.0 and model.body_rootid[body_of(model, element.body)] == root
    ]
    if not elements:
        return None
    hull = _hull_of(model, root, elements)
    needed = float(model.body_subtreemass[root]) / water.options["density"]
    has_surface = water.options["surface"] is not None
    floats = has_surface and needed < float(hull.volumes.sum())
    return _Floating(hull=hull, needed=needed, floats=floats)


def _height_of_metacenter(floating: _Floating) -> float:
    """Return the height of the metacenter above the center of mass, for the weaker axis [m]."""
    about_x = _slope_of_center(floating, 0)
    about_y = _slope_of_center(floating, 1)
    heights = np.linalg.eigvals(np.array([[-about_x[1], -about_y[1]], [about_x[0], about_y[0]]]))
    return float(heights.real.min())


def _angle_to_rest(floating: _Floating) -> float:
    """Return the angle from the vertical by which buoyancy turns a body until it is at rest [rad]."""
    turned = np.eye(3)
    hull = floating.hull
    step = FIRST_TURN
    before = np.zeros(2)
    for _ in range(MOST_TURNS):
        x, y, _ = _center_of_buoyancy(floating._replace(hull=hull))
        lever = math.hypot(x, y)
        if lever < NO_LEVER * hull.reach:
            break
        axis = np.array((y, -x)) / lever
        if axis @ before < 0.0:
            step *= 0.5
        if step < LAST_TURN:
            break
        before = axis
        turn = _rotation((axis[0], axis[1], 0.0), step)
        hull = _turn_hull(hull, turn)
        turned = turn @ turned
    return math.acos(min(1.0, max(-1.0, turned[2, 2])))


def _rotation(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    """Return the matrix of a rotation about an axis of length 1."""
    matrix = np.zeros(9)
    direction = math.sin(0.5 * angle) * np.array(axis)
    load_mujoco().mju_quat2Mat(matrix, [math.cos(0.5 * angle), *direction])
    return matrix.reshape(3, 3)


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


def _slope_of_center(floating: _Floating, axis: int) -> np.ndarray:
    """Return the change of the center of buoyancy per angle about a horizontal axis [m/rad]."""
    about = (1.0, 0.0, 0.0) if axis == 0 else (0.0, 1.0, 0.0)
    ahead = _turn_hull(floating.hull, _rotation(about, HEEL))
    behind = _turn_hull(floating.hull, _rotation(about, -HEEL))
    forward = _center_of_buoyancy(floating._replace(hull=ahead))
    backward = _center_of_buoyancy(floating._replace(hull=behind))
    return (forward - backward) / (2.0 * HEEL)


def _turn_hull(hull: _Hull, turn: np.ndarray) -> _Hull:
    """Turn a hull about its center of mass by a rotation matrix."""
    return replace(hull, places=hull.places @ turn.T, axes=turn @ hull.axes)


def _center_of_buoyancy(floating: _Floating) -> np.ndarray:
    """Return the center of buoyancy relative to that of mass, at the draft that carries the tree if it floats [m]."""
    hull = floating.hull
    low = -hull.reach
    high = hull.reach
    if floating.floats:
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if _displaced(hull, middle)[0] < floating.needed:
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
