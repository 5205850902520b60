"""Checks that reject models for which water in MuJoCo is not valid, and changes that make others valid."""

import warnings
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import BadArgument, load_mujoco
from laticauda.water.mujoco.bodies import body_of, dofs_above, element_pose, name_of
from laticauda.water.mujoco.elements import Element

INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")
"""Integrators of MuJoCo that work with water."""
INTEGRATORS_OF_IMPLICIT_DRAG = ("euler", "implicitfast")
"""Those that work with the drag's slope in the inertia, in small letters."""
MOST_DENSE = 300
"""Degrees of freedom up to which matrices may be dense."""
POSES_TRIED = 4
"""Random poses in which the added mass is compared with the room for it."""
ROUNDING = 1e-9
"""Share of the added mass up to which an entry counts as zero [-]."""


class _Rule(NamedTuple):
    """What a model must have."""

    holds: bool
    """Whether it has it."""
    text: str
    """What it must have, and why."""


def check_model(
    model: Any, elements: Sequence[Element], heavy: set[int], implicit_drag: bool
) -> None:
    """Reject a model for which added mass in the passive callback is not valid.

    Args:
        model: The `mujoco.MjModel`.
        elements: The elements that it will have.
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
        _check_full_inertia(model, elements, body, implicit_drag)


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


def _check_full_inertia(
    model: Any, elements: Sequence[Element], body: int, implicit_drag: bool
) -> None:
    """Reject a body whose inertia has only its diagonal in MuJoCo's matrix, if that has no room for the added mass."""
    dofs = dofs_above(model, body)
    if all(model.M_rownnz[dof] == above + 1 for above, dof in enumerate(dofs)):
        return
    if not implicit_drag and _is_diagonal_always(model, elements, dofs):
        return
    rule = f"must store the full inertia matrix of body {name_of(model, body)}"
    problem = "but stores only its diagonal"
    cure = (
        "attach the water to its file or `MjSpec` instead, which then is compiled with room for it"
    )
    raise BadArgument("model", f"{rule}, {problem}; {cure}")


def _is_diagonal_always(model: Any, elements: Sequence[Element], dofs: list[int]) -> bool:
    """Return whether the added mass of a body couples none of its motions, as that of a sphere; tried in some poses."""
    mujoco = load_mujoco()
    own = [
        element for element in elements if dofs_above(model, body_of(model, element.body)) == dofs
    ]
    data = mujoco.MjData(model)
    random = np.random.default_rng(0)
    linear = np.zeros((3, model.nv))
    turning = np.zeros((3, model.nv))
    for _ in range(POSES_TRIED):
        mujoco.mj_integratePos(model, data.qpos, random.uniform(-1.0, 1.0, model.nv), 1.0)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        added = np.zeros((len(dofs), len(dofs)))
        for element in own:
            pose = element_pose(model, data, element)
            mujoco.mj_jac(model, data, linear, turning, pose.center, pose.body)
            along = pose.axes.T @ linear[:, dofs]
            about = pose.axes.T @ turning[:, dofs]
            added += along.T @ (np.array(element.added_mass)[:, np.newaxis] * along)
            added += about.T @ (np.array(element.added_inertia)[:, np.newaxis] * about)
        coupling = np.abs(added - np.diag(np.diag(added)))
        if np.any(coupling > ROUNDING * np.max(added)):
            return False
    return True


def make_room(model: Any, elements: Sequence[Element]) -> None:
    """Disable what the water replaces, and the sparse Jacobian of 4.0.0's Newton solver.

    The water replaces MuJoCo's own medium and, of bodies that displace water, the compensation of
    gravity by which models without water float: both would act in addition.

    That solver's factorization of a sparse Hessian can be wrong: errors in accelerations were as
    large as the accelerations where constraints join branches of the tree; 4.0.1 is correct again.

    Large models get the solver CG instead, as their arena has no room for dense matrices.

    Args:
        model: The `mujoco.MjModel`; its options `density`, `viscosity`, `jacobian` and `solver`,
            and the `gravcomp` of its bodies, may be changed.
        elements: The elements of its water.
    """
    option = model.opt
    displacing = {body_of(model, element.body) for element in elements if element.volume > 0.0}
    lifted = [body for body in sorted(displacing) if model.body_gravcomp[body] != 0.0]
    for message in _replaced(model, lifted):
        warnings.warn(message, stacklevel=3)
    option.density = 0.0
    option.viscosity = 0.0
    model.body_gravcomp[lifted] = 0.0
    choose_right_solver(model)


def choose_right_solver(model: Any) -> None:
    """Let a model be solved rightly in MuJoCo 4.0.0, too: with dense matrices, or by CG if it is large.

    Args:
        model: The `mujoco.MjModel`; its options `jacobian` and `solver` may be changed.
    """
    if not _is_solved_wrongly(model):
        return
    mujoco = load_mujoco()
    if model.nv > MOST_DENSE:
        model.opt.solver = mujoco.mjtSolver.mjSOL_CG
    else:
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE


def _is_solved_wrongly(model: Any) -> bool:
    """Return whether MuJoCo 4.0.0 would factor a sparse Hessian."""
    mujoco = load_mujoco()
    is_newton = model.opt.solver == mujoco.mjtSolver.mjSOL_NEWTON
    return mujoco.__version__ == "4.0.0" and is_newton and bool(mujoco.mj_isSparse(model))


def _replaced(model: Any, lifted: list[int]) -> Iterator[str]:
    """Return what the water replaces, in words.

    Args:
        model: The `mujoco.MjModel`.
        lifted: Bodies that displace water and have a `gravcomp`.
    """
    option = model.opt
    if option.density > 0.0 or option.viscosity > 0.0:
        medium = f"{option.density:g} kg/m^3 and {option.viscosity:g} Pa s"
        yield f"the water replaces MuJoCo's own medium of {medium}"
    if _is_solved_wrongly(model) and model.nv > MOST_DENSE:
        yield (
            f"with {model.nv} degrees of freedom, the solver CG replaces Newton, whose sparse matrices are wrong in "
            "MuJoCo 4.0.0; other versions are right"
        )
    if lifted:
        names = ", ".join(name_of(model, body) for body in lifted)
        yield (
            f"buoyancy replaces `gravcomp` of {names}; where that stands for something else, set "
            "`model.body_gravcomp` again after `attach`"
        )
