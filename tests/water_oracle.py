"""The water's loads computed outside of any callback, from Jacobians, as an oracle for `laticauda.water.mujoco.water`.

Way (b): the force that makes a model without added mass accelerate as one with it. Nothing of the
compiled code is used: velocities and their rates come from `mj_jac` and `mj_jacDot`, the velocity
terms from their textbook definitions.
"""

from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from laticauda.water.fluid.laws import PolynomialDrag
from laticauda.water.mujoco.elements import Element


def snake(
    n_bodies: int = 5, *, option: str = "", joint: str = "", root: str = "<freejoint/>"
) -> str:
    """A chain of ellipsoids, joints alternating, as MJCF; its bodies are `b0` and so on."""
    text = f'<mujoco><option timestep="0.001" gravity="0 0 0" {option}/><worldbody>'
    for i in range(n_bodies):
        hinge = f'<joint axis="0 {i % 2} {1 - i % 2}" {joint}/>' if i else root
        text += f'<body name="b{i}" pos="{0.2 * (i > 0)} 0 0">{hinge}'
        text += f'<geom name="g{i}" type="ellipsoid" size=".1 .04 .06" pos=".1 0 .01" density="1000" contype="0"'
        text += ' conaffinity="0"/>'
    return text + "</body>" * n_bodies + "</worldbody></mujoco>"


def elements(n_bodies: int = 5, *, drag: float = 1.0) -> list[Element]:
    """Elements that are alike in nothing: off center, turned, every coefficient another."""
    rng = np.random.default_rng(5)
    return [
        Element(
            body=f"b{i}",
            position=tuple(rng.normal(size=3) * 0.05),
            orientation=tuple(rng.normal(size=4)),
            drag=tuple(drag * rng.uniform(0.1, 3.0, 3)),
            torque_linear=tuple(drag * rng.uniform(1e-3, 1e-2, 3)),
            torque_quadratic=tuple(drag * rng.uniform(1e-3, 1e-2, 3)),
            added_mass=tuple(rng.uniform(0.1, 2.0, 3)),
            added_inertia=tuple(rng.uniform(1e-3, 1e-2, 3)),
            law=PolynomialDrag(reference_speed=0.7),
        )
        for i in range(n_bodies)
    ]


def random_state(
    model: mujoco.MjModel, data: mujoco.MjData, seed: int = 0, speed: float = 1.0
) -> None:
    """Some pose and some velocity."""
    rng = np.random.default_rng(seed)
    mujoco.mj_resetData(model, data)
    mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv) * 0.5, 1.0)
    data.qvel[:] = rng.normal(size=model.nv) * speed


def inertia_and_force(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    elements: Sequence[Element],
    form: str = "kirchhoff",
    current: Sequence[float] | Callable[..., Sequence[float]] = (0.0, 0.0, 0.0),
) -> tuple[np.ndarray, np.ndarray]:
    """A, and the generalized force of drag and added mass for joints that do not accelerate (tau_fluid - b_A).

    `data` has been through `mj_forward` of a model without water. `current` is the water's
    velocity, or a function of place and time of its velocity, material acceleration and rotation.
    """
    A, force = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
    shape = (3, model.nv)
    J, K, J_dot, K_dot = (np.zeros(shape) for _ in range(4))
    for e in elements:
        body = model.body(e.body).id
        R_body = data.xmat[body].reshape(3, 3)
        R, at = R_body @ e.rotation, data.xpos[body] + R_body @ np.array(e.position)
        mujoco.mj_jac(model, data, J, K, at, body)
        mujoco.mj_jacDot(model, data, J_dot, K_dot, at, body)
        v, w = J @ data.qvel, K @ data.qvel
        a, alpha = J_dot @ data.qvel, K_dot @ data.qvel
        moving = current(*at, data.time) if callable(current) else (*current, 0, 0, 0, 0, 0, 0)
        V, flow, spin = np.reshape(moving, (3, 3))
        m, i = R @ np.diag(e.added_mass) @ R.T, R @ np.diag(e.added_inertia) @ R.T
        A += J.T @ m @ J + K.T @ i @ K
        u = v - V
        seen = -V if form == "classic" else u
        f = -m @ (a - np.cross(w, seen) - flow - np.cross(spin, u)) + 1000.0 * e.volume * flow
        w = w - spin  # from here on
        tau = -i @ (alpha + np.cross(w, spin))
        if form == "kirchhoff":
            f -= np.cross(w, m @ u)
            tau -= np.cross(w, i @ w) + np.cross(u, m @ u)
        u_own, w_own = R.T @ u, R.T @ w
        f += R @ (-np.array(e.drag) * u_own * (e.law.reference_speed + abs(u_own)))
        slope = e.law.reference_speed * np.array(e.torque_linear) + np.array(
            e.torque_quadratic
        ) * abs(w_own)
        tau += R @ (-slope * w_own)
        force += J.T @ f + K.T @ tau
    return A, force


def acceleration(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    elements: Sequence[Element],
    form: str = "kirchhoff",
    current: Sequence[float] | Callable[..., Sequence[float]] = (0.0, 0.0, 0.0),
) -> np.ndarray:
    """(M + A)^-1 of all forces, at the state in `data`, with a model without water."""
    mujoco.mj_forward(model, data)
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    A, fluid = inertia_and_force(model, data, elements, form, current)
    return np.linalg.solve(M + A, data.qfrc_smooth + fluid)


def qfrc(
    model: mujoco.MjModel, data: mujoco.MjData, elements: Sequence[Element], form: str = "kirchhoff"
) -> np.ndarray:
    """Way (b): qfrc = tau_fluid - b_A - A (M + A)^-1 (tau - b + tau_fluid - b_A)."""
    goal = acceleration(model, data, elements, form)
    A, fluid = inertia_and_force(model, data, elements, form)
    return fluid - A @ goal
