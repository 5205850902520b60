"""Models compiled so that every body has room for added mass in MuJoCo's inertia matrix."""

from typing import Any

import numpy as np

from laticauda.values import check_instance, load_mujoco

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
    simple = [b for b in range(1, model.nbody) if model.body_simple[b] and model.body_dofnum[b]]
    if not simple:
        return model
    spec = spec.copy()
    for number in simple:
        body = spec.bodies[number]
        body.explicitinertial = True
        body.mass = model.body_mass[number]
        body.inertia = model.body_inertia[number]
        body.iquat = model.body_iquat[number]
        body.ipos = model.body_ipos[number] + np.array(ASIDE)
    full = spec.compile()
    for name in RESTORED:
        getattr(full, name)[:] = getattr(model, name)
    data = mujoco.MjData(full)
    mujoco.mj_setConst(full, data)
    return full
