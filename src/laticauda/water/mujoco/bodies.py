"""Bodies of a model, by name: their numbers, and where an element on them is."""

from typing import Any, NamedTuple

import numpy as np

from laticauda.values import BadArgument, load_mujoco
from laticauda.water.mujoco.elements import Element


class ElementPose(NamedTuple):
    """Where an element is, in world axes."""

    body: int
    """Number of its body."""
    center: np.ndarray
    """Its center, shape (3,) [m]."""
    axes: np.ndarray
    """Its axes as columns, shape (3, 3) [-]."""


def body_of(model: Any, name: str) -> int:
    """Return the ID of a body from its name, or from its ID as a string.

    Raises:
        ValueError: If there is no such body, or it is the world.
    """
    mujoco = load_mujoco()
    body = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name))
    if body < 0 and name.isdecimal() and int(name) < model.nbody:
        body = int(name)
    if body < 0:
        raise BadArgument("body", f"of an element must be a body of the model, got {name!r}")
    if body == 0:
        raise BadArgument("body", "of an element must move, got the world")
    return body


def element_pose(model: Any, data: Any, element: Element) -> ElementPose:
    """Return where an element is."""
    body = body_of(model, element.body)
    body_axes = data.xmat[body].reshape(3, 3)
    return ElementPose(
        body=body,
        center=data.xpos[body] + body_axes @ element.position,
        axes=body_axes @ element.rotation,
    )


def name_of(model: Any, body: int) -> str:
    """Return the name of a body, or its ID if it has none."""
    return f"`{model.body(body).name or body}`"


def dofs_above(model: Any, body: int) -> list[int]:
    """Return the degrees of freedom that move a body, starting at the root."""
    while body and model.body_dofnum[body] == 0:
        body = int(model.body_parentid[body])
    if body == 0:
        return []
    dof = int(model.body_dofadr[body] + model.body_dofnum[body] - 1)
    dofs: list[int] = []
    while dof >= 0:
        dofs.append(dof)
        dof = int(model.dof_parentid[dof])
    return dofs[::-1]
