"""The largest step at which drag may be treated explicitly."""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import load_mujoco
from laticauda.water.fluid.laws import DragLaw, Element as Coefficients
from laticauda.water.mujoco.bodies import element_pose
from laticauda.water.mujoco.elements import Element

NEAR = 1e-6
"""Half the difference of speeds from which a slope is computed [m/s]."""


def stable_step(model: Any, elements: Iterable[Element], speed: float) -> float:
    """Return the largest step at which the drag may be treated explicitly, in the model's reference pose.

    Args:
        model: The model to which the water is attached.
        elements: Its elements.
        speed: Maximum speed of the elements, along all axes at once [m/s].

    Returns:
        2 over the largest eigenvalue of (M + A)^-1 D, with D the slope of the drag [s]; infinite
        without drag.
    """
    if model.nv == 0:
        return math.inf
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    slopes: dict[int, np.ndarray] = {}
    linear = np.zeros((3, model.nv))
    turning = np.zeros((3, model.nv))
    root_of_dof = model.body_rootid[model.dof_bodyid]
    for element in elements:
        pose = element_pose(model, data, element)
        mujoco.mj_jac(model, data, linear, turning, pose.center, pose.body)
        own = _steepest_slopes(element, speed)
        root = int(model.body_rootid[pose.body])
        dofs = np.flatnonzero(root_of_dof == root)
        J = pose.axes.T @ linear[:, dofs]
        K = pose.axes.T @ turning[:, dofs]
        slope = J.T @ (own.along[:, np.newaxis] * J) + K.T @ (own.about[:, np.newaxis] * K)
        slopes[root] = slopes.get(root, 0.0) + slope
    fastest = 0.0
    for root, slope in slopes.items():
        dofs = np.flatnonzero(root_of_dof == root)
        if dofs.size:
            rates = np.linalg.eigvals(np.linalg.solve(inertia[np.ix_(dofs, dofs)], slope))
            fastest = max(fastest, float(np.max(np.real(rates))))
    if fastest > 0.0:
        return 2.0 / fastest
    return math.inf


class _Slopes(NamedTuple):
    """Steepest slopes of an element's drag."""

    along: np.ndarray
    """Of the forces along its axes, shape (3,) [N s/m]."""
    about: np.ndarray
    """Of the torques about its axes, shape (3,) [N m s]."""


def _steepest_slopes(element: Element, speed: float) -> _Slopes:
    """Return the steepest slopes of the drag between rest and a speed."""
    law = element.law
    x, y, z = element.drag
    along = [
        _steepest(_force_along, law, speed, Coefficients(x, 0.0, 0.0, 0.0)),
        _steepest(_force_across, law, speed, Coefficients(0.0, y, 0.0, 0.0)),
        _steepest(_force_across, law, speed, Coefficients(0.0, z, 0.0, 0.0)),
    ]
    rate = speed / max(element.half_size)
    about = [
        _steepest(_torque, law, rate, Coefficients(0.0, 0.0, lambda_2, lambda_3))
        for lambda_2, lambda_3 in zip(element.torque_linear, element.torque_quadratic, strict=True)
    ]
    return _Slopes(along=np.array(along), about=np.array(about))


def _steepest(load: Any, law: DragLaw, highest: float, coefficients: Coefficients) -> float:
    """Return the steepest slope of a load at rest and at the highest velocity, which both of its velocities have."""
    drops = [
        load(law, coefficients, v, v - NEAR) - load(law, coefficients, v, v + NEAR)
        for v in (0.0, highest)
    ]
    return max(drops) / (2.0 * NEAR)


def _force_along(law: DragLaw, coefficients: Coefficients, side: float, own: float) -> float:
    f_t, _, _ = law(own, side, side, 0.0, coefficients)
    return f_t


def _force_across(law: DragLaw, coefficients: Coefficients, side: float, own: float) -> float:
    _, f_n, _ = law(side, own, abs(own), 0.0, coefficients)
    return f_n


def _torque(law: DragLaw, coefficients: Coefficients, side: float, own: float) -> float:
    _, _, tau = law(0.0, 0.0, 0.0, own, coefficients)
    return tau
