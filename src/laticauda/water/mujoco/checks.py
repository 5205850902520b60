"""Checks that reject models for which water in MuJoCo is not valid, and warn of likely mistakes."""

import math
import warnings
from collections.abc import Iterable
from typing import Any

import numpy as np

from laticauda.values import BadArgument, load_mujoco
from laticauda.water.fluid.laws import Element as Coefficients
from laticauda.water.mujoco import hydrostatics
from laticauda.water.mujoco.elements import Element

INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")


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


def element_pose(model: Any, data: Any, element: Element) -> tuple[int, np.ndarray, np.ndarray]:
    """Return the body of an element, and its center [m] and its axes, in world axes."""
    body = body_of(model, element.body)
    axes = data.xmat[body].reshape(3, 3)
    return body, data.xpos[body] + axes @ element.position, axes @ element.rotation


def name_of(model: Any, body: int) -> str:
    """Return the name of a body, or its ID if it has none."""
    return f"`{model.body(body).name or body}`"


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
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    slopes = np.zeros_like(inertia)
    linear, turning = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for element in elements:
        body, at, R = element_pose(model, data, element)
        mujoco.mj_jac(model, data, linear, turning, at, body)
        slope, slope_2 = _slopes(element, speed)
        J, K = R.T @ linear, R.T @ turning
        slopes += J.T @ (slope[:, np.newaxis] * J) + K.T @ (slope_2[:, np.newaxis] * K)
    fastest = (
        float(np.max(np.real(np.linalg.eigvals(np.linalg.solve(inertia, slopes)))))
        if model.nv
        else 0.0
    )
    return 2.0 / fastest if fastest > 0.0 else math.inf


def _slopes(element: Element, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the steepest slope of the drag between rest and a speed, along and about the element's axes."""
    law, near = element.law, 1e-6

    def steepest(load: int, top: float, *coefficients: float) -> float:
        def at(v: float, w: float) -> float:
            moving = ((w, v, v, 0.0), (v, w, abs(w), 0.0), (0.0, 0.0, 0.0, w))[load]
            return law(*moving, Coefficients(*coefficients))[load]

        return max(at(v, v - near) - at(v, v + near) for v in (0.0, top)) / (2.0 * near)

    x, y, z = element.drag
    slopes = [
        steepest(0, speed, x, 0.0, 0.0, 0.0),
        *(steepest(1, speed, 0.0, c, 0.0, 0.0) for c in (y, z)),
    ]
    pairs = zip(element.torque_linear, element.torque_quadratic, strict=True)
    turning = [steepest(2, speed / max(element.half_size), 0.0, 0.0, *pair) for pair in pairs]
    return np.array(slopes), np.array(turning)


def check_model(model: Any, heavy: set[int], implicit_drag: bool) -> None:
    """Reject a model for which added mass in the passive callback is not valid.

    Args:
        model: The `mujoco.MjModel`.
        heavy: IDs of the bodies that will have added mass.
        implicit_drag: Whether the drag's slope will be added to the inertia.

    Raises:
        ValueError: If the model is rejected; the message gives the reason.
    """
    mujoco = load_mujoco()
    option, disable, enable = model.opt, mujoco.mjtDisableBit, mujoco.mjtEnableBit
    integrator = mujoco.mjtIntegrator(option.integrator).name.removeprefix("mjINT_").lower()
    passive, asleep = (
        disable.mjDSBL_SPRING | disable.mjDSBL_DAMPER,
        getattr(enable, "mjENBL_SLEEP", 0),
    )
    at_work = ", ".join(INTEGRATORS)
    rules = (
        (
            integrator in at_work.lower().split(", "),
            f"one of the integrators {at_work}, got {integrator}",
        ),
        (
            option.disableflags & passive != passive,
            "passive forces, but springs and dampers are both disabled",
        ),
        (
            not option.enableflags & enable.mjENBL_OVERRIDE,
            "no contact override: its fields hold the water's mark",
        ),
        (
            not heavy or option.solver != mujoco.mjtSolver.mjSOL_PGS,
            "the solver Newton or CG: PGS evaluates too early",
        ),
        (
            not heavy or not option.enableflags & asleep,
            "no sleeping bodies: their inertia is not recomputed",
        ),
        (not heavy or not np.any(model.tendon_armature > 0.0), "no tendons with armature"),
    )
    for holds, rule in rules:
        if not holds:
            raise BadArgument("model", f"must have {rule}")
    if implicit_drag and integrator not in ("euler", "implicitfast"):
        raise BadArgument(
            "implicit_drag",
            f"must be used with the integrator Euler or implicitfast, got {integrator}",
        )
    for body in heavy:
        dofs = _dofs_above(model, body)
        if any(model.M_rownnz[j] != n + 1 for n, j in enumerate(dofs)):
            rule = f"must store the full inertia matrix of body {name_of(model, body)}, but stores only its diagonal"
            raise BadArgument(
                "model", f"{rule}; compile its MjSpec with `laticauda.water.mujoco.compile_spec`"
            )


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
        had = f"{option.density:g} kg/m^3 and {option.viscosity:g} Pa s"
        warnings.warn(f"the water replaces MuJoCo's own medium of {had}", stacklevel=3)
        option.density = option.viscosity = 0.0
    newton = option.solver == mujoco.mjtSolver.mjSOL_NEWTON
    if mujoco.__version__ == "4.0.0" and newton and mujoco.mj_isSparse(model):
        option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE


def _dofs_above(model: Any, body: int) -> list[int]:
    """Return the degrees of freedom that move a body, starting at the root."""
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


def warn_of(model: Any, water: Any, speed: float | None, fitted: bool) -> None:
    """Warn of likely mistakes: nothing floats, nothing is stable, or something turns over.

    Args:
        model: The `mujoco.MjModel`.
        water: Water attached to it.
        speed: Speed at which the step is checked against the drag [m/s]; None: no check.
        fitted: Whether the elements are those of all geoms, whose volume does not imply that
            anything should float.
    """
    mujoco = load_mujoco()
    bodies = [body_of(model, element.body) for element in water.elements]
    free = {
        int(model.jnt_bodyid[j])
        for j in range(model.njnt)
        if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_FREE
    }
    heavy = (
        np.any(model.opt.gravity)
        and not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    )
    found: list[str] = []
    for root in sorted({int(model.body_rootid[b]) for b in bodies}):
        said = f"body {name_of(model, root)}"
        if root in free:
            height = metacentric_height(model, root, water) if heavy else 0.0
            if height < -1e-5:
                found.append(
                    f"{said} turns over: as modeled, its metacenter (if submerged, its center of buoyancy) is "
                    f"{-height:.2g} m below its center of mass"
                )
        elif not any(_dofs_above(model, b) for b in bodies if model.body_rootid[b] == root):
            found.append(f"{said} is in the water but cannot move: it has no joint")
        elif heavy and not fitted and any(e.volume > 0.0 for e in water.elements):
            found.append(f"{said} has buoyancy but no free joint, so it does not float freely")
    limit = math.inf if speed is None else stable_step(model, water.elements, speed)
    if model.opt.timestep > limit:
        found.append(
            f"`timestep` {model.opt.timestep:g} s is too large for the drag: at {speed:g} m/s, steps are stable up to "
            f"{limit:.2g} s; use a smaller one, or `implicit_drag`"
        )
    for one in found:
        warnings.warn(one, stacklevel=3)


def metacentric_height(model: Any, root: int, water: Any) -> float:
    """Return the height of a tree's metacenter above its center of mass in its reference pose, for the weaker axis [m].

    A floating tree is at the draft that carries it; for a submerged one, the metacenter is its
    center of buoyancy.
    """
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    own = [
        e
        for e in water.elements
        if e.volume > 0.0 and model.body_rootid[body_of(model, e.body)] == root
    ]
    if not own:
        return 0.0
    _, places, axes = (
        np.array(each) for each in zip(*(element_pose(model, data, e) for e in own), strict=True)
    )
    places -= data.subtree_com[root]
    shapes = [(float(getattr(hydrostatics, e.shape.upper())), e.half_size) for e in own]
    volumes = np.array([e.volume for e in own])
    needed = float(model.body_subtreemass[root]) / water.options["density"]
    floats = water.options["surface"] is not None and needed < volumes.sum()
    reach = float(np.linalg.norm(places, axis=1).max()) + max(math.hypot(*e.half_size) for e in own)

    def center(axis: int, angle: float) -> np.ndarray:
        """Return the center of buoyancy relative to that of mass, turned about a horizontal axis through the latter."""
        matrix, low, high = np.zeros(9), -reach, reach
        mujoco.mju_quat2Mat(
            matrix, [math.cos(0.5 * angle), *(math.sin(0.5 * angle) * np.eye(3)[axis])]
        )
        turn = matrix.reshape(3, 3)
        at, turned = places @ turn.T, turn @ axes

        def lift(depth: float) -> np.ndarray:
            ups, depths = turned[:, 2].tolist(), (depth - at[:, 2]).tolist()
            wet = np.array(
                [
                    hydrostatics.wetted(*one, *row)
                    for one, *row in zip(shapes, ups, depths, strict=True)
                ]
            )
            centers = at + np.einsum("nij,nj->ni", turned, wet[:, 1:])
            return (volumes * wet[:, 0]) @ np.column_stack([np.ones(len(at)), centers])

        for _ in range(32 if floats else 0):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if lift(middle)[0] < needed else (low, middle)
        total = lift(high)
        return total[1:] / total[0]

    about_x, about_y = ((center(axis, 1e-3) - center(axis, -1e-3)) / 2e-3 for axis in (0, 1))
    return float(
        np.linalg.eigvals(
            np.array([[-about_x[1], -about_y[1]], [about_x[0], about_y[0]]])
        ).real.min()
    )
