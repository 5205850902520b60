"""Warnings of likely mistakes in a model with water: nothing floats, nothing is stable, or something turns over."""

import warnings
from typing import Any

import numpy as np

from laticauda.values import load_mujoco
from laticauda.water.mujoco.bodies import body_of, dofs_above, name_of
from laticauda.water.mujoco.floating import overturning_lever
from laticauda.water.mujoco.steps import stable_step

LARGEST_GRAVITY = 50.0
"""Gravity beyond which a model is hardly in SI units [m/s^2]."""
OVERTURNING = 1e-5
"""Depth of the metacenter below the center of mass from which on a body turns over [m]."""


def warn_of_mistakes(model: Any, water: Any, speed: float | None, fitted: bool) -> None:
    """Warn of likely mistakes.

    Args:
        model: The `mujoco.MjModel`.
        water: Water attached to it.
        speed: Speed at which the step is checked against the drag [m/s]; None: no check.
        fitted: Whether the elements are those of all geoms, whose volume does not imply that
            anything should float.
    """
    bodies = [body_of(model, element.body) for element in water.elements]
    roots = {int(model.body_rootid[body]) for body in bodies}
    messages: list[str] = []
    for root in sorted(roots):
        bodies_of_tree = [body for body in bodies if model.body_rootid[body] == root]
        problem = _problem_of_tree(model, root, bodies_of_tree, water, fitted)
        if problem:
            messages.append(f"body {name_of(model, root)} {problem}")
    gravity = float(np.linalg.norm(model.opt.gravity))
    if gravity > LARGEST_GRAVITY:
        density = water.options["density"]
        messages.append(
            f"gravity is {gravity:g}: if the model is not in meters and kilograms, `density` {density:g} has to be in "
            "its units, too (1 in centimeters and grams)"
        )
    if speed is not None:
        limit = stable_step(model, water.elements, speed)
        if model.opt.timestep > limit:
            messages.append(
                f"`timestep` {model.opt.timestep:g} s is too large for the drag: at {speed:g} m/s, steps are stable up "
                f"to {limit:.2g} s; use a smaller one, or `implicit_drag`"
            )
    for message in messages:
        warnings.warn(message, stacklevel=3)


def _problem_of_tree(
    model: Any, root: int, bodies: list[int], water: Any, fitted: bool
) -> str | None:
    """Return what is likely wrong with a tree of bodies in water; None: nothing."""
    if np.any(model.flex_vertbodyid == root):
        return None  # a vertex of a net or rope
    is_heavy = _has_gravity(model)
    if _is_free(model, root):
        if not is_heavy:
            return None
        lever = overturning_lever(model, root, water)
        if lever <= OVERTURNING:
            return None
        return (
            f"turns over: as modeled, its metacenter (if submerged, its center of buoyancy) is "
            f"{lever:.2g} m below its center of mass"
        )
    if not any(dofs_above(model, body) for body in bodies):
        return "is in the water but cannot move: it has no joint"
    has_volume = any(element.volume > 0.0 for element in water.elements)
    if is_heavy and not fitted and has_volume:
        return "has buoyancy but no free joint, so it does not float freely"
    return None


def _has_gravity(model: Any) -> bool:
    is_disabled = model.opt.disableflags & load_mujoco().mjtDisableBit.mjDSBL_GRAVITY
    return bool(np.any(model.opt.gravity)) and not is_disabled


def _is_free(model: Any, body: int) -> bool:
    """Return whether a body has a free joint."""
    joints = np.flatnonzero(model.jnt_bodyid == body)
    return bool(np.any(model.jnt_type[joints] == load_mujoco().mjtJoint.mjJNT_FREE))
