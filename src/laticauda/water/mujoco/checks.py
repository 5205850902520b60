"""Checks that reject models for which water in MuJoCo is not valid, and changes that make others valid."""

import warnings
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import BadArgument, load_mujoco
from laticauda.water.mujoco.bodies import dofs_above, name_of

INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")
"""Integrators of MuJoCo that work with water."""
INTEGRATORS_OF_IMPLICIT_DRAG = ("euler", "implicitfast")
"""Those that work with the drag's slope in the inertia, in small letters."""


class _Rule(NamedTuple):
    """What a model must have."""

    holds: bool
    """Whether it has it."""
    text: str
    """What it must have, and why."""


def check_model(model: Any, heavy: set[int], implicit_drag: bool) -> None:
    """Reject a model for which added mass in the passive callback is not valid.

    Args:
        model: The `mujoco.MjModel`.
        heavy: IDs of the bodies that will have added mass.
        implicit_drag: Whether the drag's slope will be added to the inertia.

    Raises:
        ValueError: If the model is rejected; the message gives the reason.
    """
    rules = list(_rules_of_all_water(model))
    if heavy:
        rules.extend(_rules_of_added_mass(model))
    for rule in rules:
        if not rule.holds:
            raise BadArgument("model", f"must have {rule.text}")
    integrator = _name_of_integrator(model)
    if implicit_drag and integrator not in INTEGRATORS_OF_IMPLICIT_DRAG:
        raise BadArgument(
            "implicit_drag",
            f"must be used with the integrator Euler or implicitfast, got {integrator}",
        )
    for body in heavy:
        _check_full_inertia(model, body)


def _rules_of_all_water(model: Any) -> Iterator[_Rule]:
    mujoco = load_mujoco()
    option = model.opt
    integrator = _name_of_integrator(model)
    integrators = ", ".join(INTEGRATORS)
    yield _Rule(
        integrator in integrators.lower().split(", "),
        f"one of the integrators {integrators}, got {integrator}",
    )
    passive = mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    yield _Rule(
        option.disableflags & passive != passive,
        "passive forces, but springs and dampers are both disabled",
    )
    yield _Rule(
        not option.enableflags & mujoco.mjtEnableBit.mjENBL_OVERRIDE,
        "no contact override: its fields hold the water's mark",
    )


def _rules_of_added_mass(model: Any) -> Iterator[_Rule]:
    mujoco = load_mujoco()
    yield _Rule(
        model.opt.solver != mujoco.mjtSolver.mjSOL_PGS,
        "the solver Newton or CG: PGS evaluates too early",
    )
    asleep = getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", 0)
    yield _Rule(
        not model.opt.enableflags & asleep, "no sleeping bodies: their inertia is not recomputed"
    )
    yield _Rule(not np.any(model.tendon_armature > 0.0), "no tendons with armature")


def _name_of_integrator(model: Any) -> str:
    """Return MuJoCo's name of a model's integrator, in small letters."""
    name = load_mujoco().mjtIntegrator(model.opt.integrator).name
    return name.removeprefix("mjINT_").lower()


def _check_full_inertia(model: Any, body: int) -> None:
    """Reject a body whose inertia has only its diagonal in MuJoCo's matrix, which has no room for added mass."""
    dofs = dofs_above(model, body)
    if all(model.M_rownnz[dof] == above + 1 for above, dof in enumerate(dofs)):
        return
    rule = f"must store the full inertia matrix of body {name_of(model, body)}"
    problem = "but stores only its diagonal"
    cure = "compile its MjSpec with `laticauda.water.mujoco.compile_spec`"
    raise BadArgument("model", f"{rule}, {problem}; {cure}")


def make_room(model: Any) -> None:
    """Disable MuJoCo's own medium, which would act in addition, and the sparse Jacobian of 4.0.0's Newton solver.

    That solver's factorization of a sparse Hessian can be wrong: errors in accelerations were as
    large as the accelerations where constraints join branches of the tree; 4.0.1 is correct again.

    Args:
        model: The `mujoco.MjModel`; its options `density`, `viscosity` and `jacobian` may be
            changed.
    """
    mujoco = load_mujoco()
    option = model.opt
    if option.density > 0.0 or option.viscosity > 0.0:
        medium = f"{option.density:g} kg/m^3 and {option.viscosity:g} Pa s"
        warnings.warn(f"the water replaces MuJoCo's own medium of {medium}", stacklevel=3)
        option.density = 0.0
        option.viscosity = 0.0
    is_newton = option.solver == mujoco.mjtSolver.mjSOL_NEWTON
    if mujoco.__version__ == "4.0.0" and is_newton and mujoco.mj_isSparse(model):
        option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
