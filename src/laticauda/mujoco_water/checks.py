"""What water in MuJoCo does not hold for is refused, and what is likely not meant is warned of."""

import math
import warnings
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from laticauda.errors import BadArgument
from laticauda.extras import load_mujoco
from laticauda.fluid.laws import Element as Coefficients
from laticauda.mujoco_water.elements import Element

INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")


def body_of(model: Any, name: str) -> int:
    """Number of a body by its name.

    Raises:
        ValueError: If there is none, or it is the world.
    """
    mujoco = load_mujoco()
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if body < 0:
        raise BadArgument("body", f"of an element must be a body of the model, got {name!r}")
    if body == 0:
        raise BadArgument("body", "of an element must move, got the world")
    return int(body)


def stable_step(model: Any, elements: Iterable[Element], speed: float) -> float:
    """Largest step at which the drag may be treated explicitly, in the model's reference pose.

    Args:
        model: The model that the water is attached to.
        elements: What the water sees of it.
        speed: Up to which the elements move, along all axes at once [m/s].

    Returns:
        2 over the largest eigenvalue of (M + A)^-1 D, D the slope of the drag [s]; infinite without drag.
    """
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    slopes = np.zeros_like(inertia)
    linear, turning = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for element in elements:
        body = body_of(model, element.body)
        R = data.xmat[body].reshape(3, 3) @ element.rotation
        at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ np.array(element.position)
        mujoco.mj_jac(model, data, linear, turning, at, body)
        slope, slope_2 = _slopes(element, speed)
        J, K = R.T @ linear, R.T @ turning
        slopes += J.T @ (slope[:, np.newaxis] * J) + K.T @ (slope_2[:, np.newaxis] * K)
    fastest = float(np.max(np.real(np.linalg.eigvals(np.linalg.solve(inertia, slopes))))) if model.nv else 0.0
    return 2.0 / fastest if fastest > 0.0 else math.inf


def _slopes(element: Element, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Steepest slope of the drag between rest and a speed, along and about the element's axes."""
    law, near = element.law, 1e-6

    def steepest(load: int, top: float, *coefficients: float) -> float:
        def at(v: float, w: float) -> float:
            moving = ((w, v, v, 0.0), (v, w, abs(w), 0.0), (0.0, 0.0, 0.0, w))[load]
            return law(*moving, Coefficients(*coefficients))[load]

        return max(at(v, v - near) - at(v, v + near) for v in (0.0, top)) / (2.0 * near)

    x, y, z = element.drag
    slopes = [steepest(0, speed, x, 0.0, 0.0, 0.0), *(steepest(1, speed, 0.0, c, 0.0, 0.0) for c in (y, z))]
    pairs = zip(element.torque_linear, element.torque_quadratic, strict=True)
    turning = [steepest(2, speed / max(element.half_size), 0.0, 0.0, *pair) for pair in pairs]
    return np.array(slopes), np.array(turning)


def check_model(model: Any, heavy: set[int], implicit_drag: bool) -> None:
    """Refuse what added mass in the passive callback does not hold for.

    Args:
        model: The `mujoco.MjModel`.
        heavy: Numbers of the bodies that will have added mass.
        implicit_drag: Whether the drag's slope will go into the inertia.

    Raises:
        ValueError: With the reason.
    """
    mujoco = load_mujoco()
    option = model.opt
    names = {getattr(mujoco.mjtIntegrator, f"mjINT_{name.upper()}"): name for name in INTEGRATORS}
    integrator = names.get(option.integrator)
    if option.density > 0.0 or option.viscosity > 0.0:
        raise BadArgument(
            "model",
            "must have option density and viscosity 0, or MuJoCo's own fluid model would act as well, got "
            f"{option.density:g} and {option.viscosity:g}",
        )
    if (
        option.disableflags & mujoco.mjtDisableBit.mjDSBL_SPRING
        and option.disableflags & mujoco.mjtDisableBit.mjDSBL_DAMPER
    ):
        raise BadArgument("model", "must have passive forces, but springs and dampers are both disabled")
    if integrator is None:
        raise BadArgument(
            "model", f"must have one of the integrators {', '.join(INTEGRATORS)}, got {option.integrator}"
        )
    if implicit_drag and integrator not in ("Euler", "implicitfast"):
        raise BadArgument("implicit_drag", f"must go with the integrator Euler or implicitfast, got {integrator}")
    if option.enableflags & mujoco.mjtEnableBit.mjENBL_OVERRIDE:
        raise BadArgument("model", "must not override contact parameters: the mark of its water stands in `o_margin`")
    if not heavy:
        return
    if option.solver == mujoco.mjtSolver.mjSOL_PGS:
        raise BadArgument(
            "model", "must have the solver Newton or CG: PGS sees the constraints before the added mass is there"
        )
    if option.enableflags & getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", 0):
        raise BadArgument("model", "must not have sleeping bodies enabled: their inertia is not computed anew")
    if model.ntendon and np.any(model.tendon_armature > 0.0):
        raise BadArgument("model", "must not have tendons with armature")
    for body in heavy:
        dofs = _dofs_above(model, body)
        if any(model.M_rownnz[j] != n + 1 for n, j in enumerate(dofs)):
            raise BadArgument(
                "model",
                f"must store the whole inertia matrix of body `{model.body(body).name}`, but keeps its "
                "diagonal only; compile its MjSpec with `laticauda.mujoco_water.compiled`",
            )


def avoid_sparse_fault(model: Any) -> None:
    """Let the Newton solver of MuJoCo 4.0.0 take a dense Jacobian: its factor of a sparse Hessian can be wrong.

    Accelerations were off by all of their size where constraints join branches of the tree; 4.0.1 is right again.

    Args:
        model: The `mujoco.MjModel`; its option `jacobian` may be changed.
    """
    mujoco = load_mujoco()
    newton = model.opt.solver == mujoco.mjtSolver.mjSOL_NEWTON
    if mujoco.__version__ == "4.0.0" and newton and mujoco.mj_isSparse(model):
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE


def _dofs_above(model: Any, body: int) -> list[int]:
    """Degrees of freedom that move a body, from the root on."""
    while body and model.body_dofnum[body] == 0:
        body = int(model.body_parentid[body])
    if body == 0:
        return []
    dof = int(model.body_dofadr[body] + model.body_dofnum[body] - 1)
    found: list[int] = []
    while dof >= 0:
        found.append(dof)
        dof = int(model.dof_parentid[dof])
    return found[::-1]


def warn_of(model: Any, elements: Sequence[Element], bodies: np.ndarray, speed: float | None) -> None:
    """Warn of what is likely not meant: nothing floats, nothing is stable, or nothing stays upright.

    Args:
        model: The `mujoco.MjModel`, its water attached.
        elements: What the water sees of it.
        bodies: Number of each element's body.
        speed: At which the step is checked against the drag [m/s]; None: not at all.
    """
    mujoco = load_mujoco()
    free = {int(model.jnt_bodyid[j]) for j in range(model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_FREE}
    roots = {int(model.body_rootid[b]) for b in bodies}
    for root in sorted(roots - free):
        if not any(_dofs_above(model, int(b)) for b in bodies if model.body_rootid[b] == root):
            warnings.warn(
                f"body `{model.body(root).name}` is in the water but cannot move: it has no joint", stacklevel=4
            )
        elif any(e.volume > 0.0 for e in elements):
            name = model.body(root).name
            warnings.warn(f"body `{name}` has buoyancy but no free joint, so it does not float freely", stacklevel=4)
    for root in sorted(roots & free):
        _warn_upright(model, root, elements, bodies)
    if speed is None:
        return
    limit = stable_step(model, elements, speed)
    if model.opt.timestep > limit:
        warnings.warn(
            f"`timestep` {model.opt.timestep:g} s is too large for the drag: at {speed:g} m/s it is stable up to "
            f"{limit:.2g} s; take a smaller one, or `implicit_drag`",
            stacklevel=4,
        )


def _warn_upright(model: Any, root: int, elements: Sequence[Element], bodies: np.ndarray) -> None:
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    volume, moment = 0.0, np.zeros(3)
    for element, body in zip(elements, bodies, strict=True):
        if model.body_rootid[body] == root and element.volume > 0.0:
            at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ np.array(element.position)
            volume, moment = volume + element.volume, moment + element.volume * at
    if volume > 0.0 and moment[2] / volume <= data.subtree_com[root][2] and np.any(model.opt.gravity):
        warnings.warn(
            f"body `{model.body(root).name}` floats freely with its center of buoyancy at or below its center of mass: "
            "nothing keeps it upright",
            stacklevel=4,
        )
