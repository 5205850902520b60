"""Models compiled so that every body has room for added mass in MuJoCo's inertia matrix."""

from pathlib import Path
from typing import Any

import numpy as np

from laticauda.values import BadArgument, check_instance, load_mujoco

ASIDE = (1e-3, 2e-3, 3e-3)
"""Offset of a body's inertial frame while the model is compiled, along no axis [m]."""
RESTORED = ("body_ipos", "body_iquat", "body_inertia", "body_mass")
"""Fields of the model that have their true values again after that."""


def compile_spec(spec: Any) -> Any:
    """Compile a `mujoco.MjSpec` so that every body can have added mass.

    MuJoCo stores only the diagonal of the inertia of a free body whose frame is its inertial frame.
    Added mass needs the whole matrix, so the inertial frame is moved aside while the model is
    compiled, and restored afterward.

    Args:
        spec: A model; it is not modified.

    Returns:
        A `mujoco.MjModel`.
    """
    mujoco = load_mujoco()
    check_instance("spec", spec, mujoco.MjSpec)
    model = spec.compile()
    simple = {b for b in range(1, model.nbody) if model.body_simple[b] and model.body_dofnum[b]}
    if not simple:
        return model
    spec = spec.copy()
    explicit = set(simple)
    if spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE:
        # Inertias given explicitly would be ignored, so all of them are given as they were found.
        spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO
        explicit = set(range(1, model.nbody))
    for number in explicit:
        body = spec.bodies[number]
        body.explicitinertial = True
        body.mass = model.body_mass[number]
        body.inertia = model.body_inertia[number]
        body.iquat = model.body_iquat[number]
        body.ipos = model.body_ipos[number]
        if number in simple:
            body.ipos += np.array(ASIDE)
    full = spec.compile()
    for name in RESTORED:
        getattr(full, name)[:] = getattr(model, name)
    data = mujoco.MjData(full)
    mujoco.mj_setConst(full, data)
    return full


def compile_file(path: str | Path) -> Any:
    """Compile a file (MJCF or URDF) so that every body can have added mass; see `compile_spec`.

    Raises:
        ValueError: If MuJoCo cannot read or compile it; the message is MuJoCo's.
    """
    try:
        return compile_spec(load_mujoco().MjSpec.from_file(str(path)))
    except ValueError as error:
        message = " ".join(str(error).removeprefix("Error: ").split())
        raise BadArgument("model", f"must be a file that MuJoCo compiles: {message}") from error
