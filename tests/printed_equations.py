"""The paper's equations of motion (1) and (2) with every matrix written out, for reading and as a test oracle.

Nothing here is fast. The model that runs is a separately written recursion; its tests compare it
with this module.

World axes are x forward and y left; links are numbered tail first; theta_i is the counter-clockwise
angle of link i to the x axis. t_hat = (cos theta, sin theta) points along a link toward the head,
n_hat = (-sin theta, cos theta) across it; v_t and v_n are the velocity of the link's center
relative to the water along them. Quantities in both directions are stacked: n values for x, then n
values for y.

Arguments that every function shares: `theta` [rad] and `theta_rate` [rad/s], the link angles and
their rates, shape (n,); `velocity` [m/s] of the center of mass in world axes, shape (2,); `chain`,
the links; `options`, the loads.

The symbols of the paper name the matrices. One sign differs from the print: there D^T u pairs with
theta_i - theta_{i+1}. With the joint angle phi_i = theta_{i+1} - theta_i, the power u . phi' equals
(-D^T u) . theta', so the joint torques enter as -D^T u.

Sources: (1) and (2) of the paper; Kirchhoff's equations (Lamb, Hydrodynamics, 6th ed., chapter 6);
for the trailing edge Lighthill, Large-amplitude elongated-body theory of fish locomotion, Proc. R.
Soc. Lond. B 179 (1971) 125-138.
"""

from dataclasses import dataclass, field, fields
from typing import Literal, NamedTuple, get_args

import numpy as np
from jaxtyping import Bool, Float

from laticauda.values.checks import check_choice, check_not_negative, check_positive
from laticauda.values.errors import BadArgument
from laticauda.water.fluid.laws import DragLaw, Element, PolynomialDrag

AddedMassForm = Literal["relative", "kirchhoff", "classic"]
Plane = Float[np.ndarray, "2"]
Links = Float[np.ndarray, " n_links"]
Joints = Float[np.ndarray, " n_joints"]
LinkPlane = Float[np.ndarray, "n_links 2"]
Square = Float[np.ndarray, "n_links n_links"]
Stacked = Float[np.ndarray, " both"]
StackedSquare = Float[np.ndarray, "both both"]
PlaneByStacked = Float[np.ndarray, "2 both"]
StackedByPlane = Float[np.ndarray, "both 2"]
LinksByStacked = Float[np.ndarray, "n_links both"]
JointsByLinks = Float[np.ndarray, "n_joints n_links"]
TwoByTwo = Float[np.ndarray, "2 2"]
JointFlags = Bool[np.ndarray, " n_joints"]

_SOLID = ("half_length", "mass", "inertia")


@dataclass(frozen=True, kw_only=True)
class Chain:
    """Links joined head to tail, tail first, each with its center of mass at mid-length; every field has shape (n,)."""

    half_length: Links
    """Half the length of each link, l [m]."""
    mass: Links
    """Mass m [kg]."""
    inertia: Links
    """Moment of inertia about the center of mass, J [kg m2]."""
    c_t: Links
    """Drag coefficient along the link [kg/m]."""
    c_n: Links
    """Drag coefficient across the link [kg/m]."""
    mu_t: Links
    """Added mass along the link [kg]."""
    mu_n: Links
    """Added mass across the link [kg]."""
    lambda_1: Links
    """Added moment of inertia [kg m2]."""
    lambda_2: Links
    """Linear rotational drag coefficient [kg m]; multiplied by the reference speed."""
    lambda_3: Links
    """Quadratic rotational drag coefficient [kg m2]."""

    def __post_init__(self) -> None:
        """Refuse fields of different shapes, lengths and masses that are not positive, negative coefficients."""
        for name in (f.name for f in fields(self)):
            values, check = (
                getattr(self, name),
                check_positive if name in _SOLID else check_not_negative,
            )
            if np.ndim(values) != 1 or np.shape(values) != np.shape(self.half_length):
                raise BadArgument(
                    name, f"must have one value per link, got shape {np.shape(values)}"
                )
            for i, value in enumerate(values):
                check(f"{name}[{i}]", value)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Which fluid loads act, and the current."""

    form: AddedMassForm = "relative"
    """How the added mass turns with the link: "relative" (the paper), "kirchhoff" or "classic" [-]."""
    drag: DragLaw = PolynomialDrag()
    """The law of the drag on one link; the paper's has U_ref = 1 m/s [-]."""
    current: Plane = field(default_factory=lambda: np.zeros(2))
    """Velocity (V_x, V_y) that the water moves to, world axes [m/s]."""
    wake_mass: float = 0.0
    """Added mass per length at the tail end of the first link, m' = rho pi C_A a^2; 0 for no wake [kg/m]."""

    def __post_init__(self) -> None:
        """Refuse an unknown form, negative numbers, and a wake without the form it belongs to."""
        check_choice("form", self.form, get_args(AddedMassForm))
        check_not_negative("wake_mass", self.wake_mass, "kg/m")
        if np.shape(self.current) != (2,) or not np.all(np.isfinite(self.current)):
            raise BadArgument("current", f"must be 2 finite numbers in m/s, got {self.current}")
        if self.wake_mass > 0 and self.form != "kirchhoff":
            raise BadArgument(
                "wake_mass", f"must be 0 kg/m unless `form` is `kirchhoff`, got {self.wake_mass}"
            )


class Matrices(NamedTuple):
    """Every matrix of (1) and (2), the x half of stacked rows and columns before the y half.

    - Kbar [m]: link positions from link angles, X = -Kbar^T cos(theta) + e p_x. Vbar [kg m2]:
      inertia of the centers.
    - M_p [1/kg]: inverse of the mass with added mass. N_p, L_p [kg]: N2 and Gamma summed over the
      links.
    - M_theta, W_theta [kg m2] multiply theta'' and theta'^2; V [N m s] is V_{theta,theta'} and
      multiplies theta'.
    - N, P [N s] are N_{theta,theta'}, P_{theta,theta'} and multiply e p_x' - V_x and e p_y' - V_y.
    - Q = [K_x K_y] [m]: lever arms of the forces on the links.
    - Gamma [kg]: added mass in world axes. N2 [kg]: its turning, see `matrices`.
    """

    Kbar: Square
    Vbar: Square
    M_p: TwoByTwo
    N_p: PlaneByStacked
    L_p: PlaneByStacked
    M_theta: Square
    W_theta: Square
    V: Square
    N: Square
    P: Square
    K_x: Square
    K_y: Square
    Q: LinksByStacked
    Gamma: StackedSquare
    N2: StackedSquare


def _adjacent(n_links: int) -> tuple[JointsByLinks, JointsByLinks]:
    """Return A, which adds neighboring links, and D, which subtracts the head-side one from the tail-side one."""
    tail_side, head_side = np.eye(n_links)[:-1], np.eye(n_links)[1:]
    return tail_side + head_side, tail_side - head_side


def _both(e: Links) -> StackedByPlane:
    """Return E = blkdiag(e, e)."""
    zero = np.zeros_like(e)
    return np.column_stack([np.concatenate([e, zero]), np.concatenate([zero, e])])


def _constant_matrices(chain: Chain) -> tuple[Square, Square]:
    """Return Kbar [m] and Vbar [kg m2], from D X + A L cos(theta) = 0 (closed joints) and e^T M X = m_t p_x."""
    A, D = _adjacent(len(chain.mass))
    L, M_inverse = np.diag(chain.half_length), np.diag(1 / chain.mass)
    joint_mass = np.linalg.inv(D @ M_inverse @ D.T)
    return L @ A.T @ joint_mass @ D @ M_inverse, L @ A.T @ joint_mass @ A @ L


def matrices(theta: Links, theta_rate: Links, chain: Chain, options: Options) -> Matrices:
    """Return every matrix of (1) and (2) for the `relative` form of the added mass.

    With the velocity u relative to the water, the added mass force on a link is

        f_A = -mu_t t_hat d(t_hat . u)/dt - mu_n n_hat d(n_hat . u)/dt = -Gamma_i u' - N2_i theta' u.

    From t_hat' = theta' n_hat and n_hat' = -theta' t_hat, per link and with R = [t_hat n_hat],

        Gamma_i = mu_t t_hat t_hat^T + mu_n n_hat n_hat^T = R diag(mu_t, mu_n) R^T,
        N2_i = mu_t t_hat n_hat^T - mu_n n_hat t_hat^T,

    which is [mu_n s c, mu_n s^2; -mu_n c^2, -mu_n s c] + [-mu_t s c, mu_t c^2; -mu_t s^2, mu_t s
    c]. The other forms add forces: see `fluid_forces`. Of the options, only the drag law matters
    here.
    """
    n = len(theta)
    S, C, Th = np.diag(np.sin(theta)), np.diag(np.cos(theta)), np.diag(theta_rate)
    mu_t, mu_n = np.diag(chain.mu_t), np.diag(chain.mu_n)
    E = _both(np.ones(n))
    Kbar, Vbar = _constant_matrices(chain)

    Gamma = np.block(
        [
            [mu_n @ S @ S + mu_t @ C @ C, (mu_t - mu_n) @ S @ C],
            [(mu_t - mu_n) @ S @ C, mu_n @ C @ C + mu_t @ S @ S],
        ]
    )
    N2 = np.block(
        [
            [(mu_n - mu_t) @ S @ C, mu_n @ S @ S + mu_t @ C @ C],
            [-mu_n @ C @ C - mu_t @ S @ S, (mu_t - mu_n) @ S @ C],
        ]
    )
    M_p = np.linalg.inv(float(np.sum(chain.mass)) * np.eye(2) + E.T @ Gamma @ E)
    Q = np.hstack([-S @ Kbar, C @ Kbar]) @ (np.eye(2 * n) - Gamma @ E @ M_p @ E.T)

    J, Lambda_1 = np.diag(chain.inertia), np.diag(chain.lambda_1)
    Lambda = np.diag(
        _rotational_drag(theta_rate, chain, options)
    )  # Lambda_2 U_ref + Lambda_3 |Theta'|
    Q_N2 = Q @ N2
    M_theta = (
        J
        + S @ Vbar @ S
        + C @ Vbar @ C
        + Lambda_1
        - Q @ Gamma @ np.vstack([Kbar.T @ S, -Kbar.T @ C])
    )
    W_theta = S @ Vbar @ C - C @ Vbar @ S - Q @ Gamma @ np.vstack([Kbar.T @ C, Kbar.T @ S])
    V = Lambda - Q_N2 @ np.vstack([Th @ Kbar.T @ S, -Th @ Kbar.T @ C])
    return Matrices(
        Kbar=Kbar, Vbar=Vbar, M_p=M_p, N_p=E.T @ N2, L_p=E.T @ Gamma, M_theta=M_theta, W_theta=W_theta, V=V,
        N=-Q_N2[:, :n] @ Th, P=-Q_N2[:, n:] @ Th, K_x=Q[:, :n], K_y=Q[:, n:], Q=Q, Gamma=Gamma, N2=N2,
    )  # fmt: skip


def link_positions(theta: Links, position: Plane, chain: Chain) -> LinkPlane:
    """Return the centers of the links [m] in world axes, from the center of mass `position` [m]."""
    K = _constant_matrices(chain)[0].T
    return position - np.column_stack([K @ np.cos(theta), K @ np.sin(theta)])


def link_velocities(theta: Links, theta_rate: Links, velocity: Plane, chain: Chain) -> LinkPlane:
    """Return the velocities of the link centers [m/s] in world axes, from the center of mass' `velocity` [m/s]."""
    K = _constant_matrices(chain)[0].T
    return velocity + np.column_stack(
        [K @ (np.sin(theta) * theta_rate), -K @ (np.cos(theta) * theta_rate)]
    )


def _along_and_across(theta: Links, vectors: LinkPlane) -> tuple[Links, Links]:
    """Return the components of one world vector per link along t_hat and n_hat."""
    s, c = np.sin(theta), np.cos(theta)
    return c * vectors[:, 0] + s * vectors[:, 1], -s * vectors[:, 0] + c * vectors[:, 1]


def _to_world(theta: Links, along: Links, across: Links) -> tuple[Links, Links]:
    """Return the world components of the vectors along t_hat + across n_hat."""
    s, c = np.sin(theta), np.cos(theta)
    return c * along - s * across, s * along + c * across


def _water_velocities(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options
) -> tuple[Links, Links]:
    """Return v_t and v_n of every link, relative to the water [m/s]."""
    return _along_and_across(
        theta, link_velocities(theta, theta_rate, velocity, chain) - options.current
    )


def _drag(v_t: Links, v_n: Links, chain: Chain, options: Options) -> tuple[Links, Links]:
    """Return the drag along and across every link [N]."""
    elements = map(Element, chain.c_t, chain.c_n, chain.lambda_2, chain.lambda_3)
    loads = [options.drag(t, n, abs(n), 0.0, e) for t, n, e in zip(v_t, v_n, elements, strict=True)]
    return np.array([f_t for f_t, _, _ in loads]), np.array([f_n for _, f_n, _ in loads])


def _rotational_drag(theta_rate: Links, chain: Chain, options: Options) -> Links:
    """Return what theta' is multiplied by in the rotational drag, U_ref lambda_2 + lambda_3 |theta'| [N m s]."""
    rates = np.where(theta_rate == 0.0, 1e-30, theta_rate)
    elements = map(Element, chain.c_t, chain.c_n, chain.lambda_2, chain.lambda_3)
    loads = [options.drag(0.0, 0.0, 0.0, rate, e) for rate, e in zip(rates, elements, strict=True)]
    return np.array([-tau for _, _, tau in loads]) / rates


def _trailing_edge(theta_rate: Links, v_t: Links, v_n: Links, chain: Chain) -> tuple[float, float]:
    """Return u and w, the velocity of the trailing edge relative to the water along and across the first link [m/s]."""
    return float(v_t[0]), float(v_n[0] - chain.half_length[0] * theta_rate[0])


def fluid_forces(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options
) -> tuple[Links, Links, Links]:
    """Return the fluid loads that enter (1) and (2) where f_D and tau_t do: f_x, f_y [N] in world axes and tau [N m].

    - Drag, by `options.drag`: the paper's f_t = -c_t v_t (U_ref + |v_t|), f_n = -c_n v_n (U_ref +
      |v_n|), or another law, such as `TotalSpeedDrag`.
    - `kirchhoff`: the change of direction of the added momentum, f_t = +mu_n v_n theta', f_n =
      -mu_t v_t theta', and the Munk moment -(mu_n - mu_t) v_t v_n.
    - `classic`: only the current enters the velocity term of the added mass force. So the part of
      the link's own velocity v is taken back, +N2 theta' v: f_n = -mu_n theta' (t_hat . v), f_t =
      +mu_t theta' (n_hat . v).
    - Wake, at the tail end of the first link while u > 0: f_t = 1/2 m' w^2, f_n = -m' u w.

    The rotational drag and added inertia (lambda) are in `matrices`, not here.
    """
    v_t, v_n = _water_velocities(theta, theta_rate, velocity, chain, options)
    (f_t, f_n), tau = _drag(v_t, v_n, chain, options), np.zeros(len(theta))
    if options.form == "kirchhoff":
        f_t = f_t + chain.mu_n * v_n * theta_rate
        f_n = f_n - chain.mu_t * v_t * theta_rate
        tau = tau - (chain.mu_n - chain.mu_t) * v_t * v_n
    elif options.form == "classic":
        absolute_t, absolute_n = _along_and_across(
            theta, link_velocities(theta, theta_rate, velocity, chain)
        )
        f_t = f_t + chain.mu_t * theta_rate * absolute_n
        f_n = f_n - chain.mu_n * theta_rate * absolute_t
    u, w = _trailing_edge(theta_rate, v_t, v_n, chain)
    if options.wake_mass > 0 and u > 0:
        tail = np.eye(len(theta))[0]
        f_t = f_t + tail * options.wake_mass * w**2 / 2
        f_n = f_n - tail * options.wake_mass * u * w
        tau = tau + tail * chain.half_length[0] * options.wake_mass * u * w  # f_n acts at -l t_hat
    return *_to_world(theta, f_t, f_n), tau


def dissipated_power(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options
) -> float:
    """Return the power that drag takes from the robot in the water's frame [W]; never negative."""
    v_t, v_n = _water_velocities(theta, theta_rate, velocity, chain, options)
    f_t, f_n = _drag(v_t, v_n, chain, options)
    return float(
        np.sum(_rotational_drag(theta_rate, chain, options) * theta_rate**2 - f_t * v_t - f_n * v_n)
    )


def wake_power(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options
) -> float:
    """Return the kinetic energy left in the wake per time, 1/2 m' w^2 u while u > 0 [W]; never negative."""
    u, w = _trailing_edge(
        theta_rate, *_water_velocities(theta, theta_rate, velocity, chain, options), chain
    )
    return options.wake_mass * w**2 * max(u, 0.0) / 2


def _loads(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options,
    effector_force: LinkPlane, effector_torque: Links,
) -> tuple[Matrices, Stacked, Links]:  # fmt: skip
    """Return the matrices, f_D + f_t [N], and (2) without accelerations and joint torques, on its right side [N m]."""
    m = matrices(theta, theta_rate, chain, options)
    f_x, f_y, tau = fluid_forces(theta, theta_rate, velocity, chain, options)
    f_x, f_y, tau = f_x + effector_force[:, 0], f_y + effector_force[:, 1], tau + effector_torque
    e = np.ones(len(theta))
    (p_x, p_y), (V_x, V_y) = velocity, options.current
    velocity_terms = (
        m.W_theta @ theta_rate**2
        + m.V @ theta_rate
        + m.N @ (e * (p_x - V_x))
        + m.P @ (e * (p_y - V_y))
    )
    return m, np.concatenate([f_x, f_y]), tau - velocity_terms - m.K_x @ f_x - m.K_y @ f_y


def _com_acceleration(
    theta: Links, theta_rate: Links, theta_acceleration: Links, velocity: Plane,
    options: Options, m: Matrices, force: Stacked,
) -> Plane:  # fmt: skip
    """Return p'' [m/s2] from (1), given theta'' [rad/s2] and f_D + f_t [N]."""
    S, C, KbarT = np.diag(np.sin(theta)), np.diag(np.cos(theta)), m.Kbar.T
    Th2 = np.diag(np.tile(theta_rate, 2))
    E = _both(np.ones(len(theta)))
    turning = (
        np.concatenate([KbarT @ S @ theta_rate, -KbarT @ C @ theta_rate]) - E @ options.current
    )
    bending_x = KbarT @ (C @ theta_rate**2 + S @ theta_acceleration)
    bending_y = KbarT @ (S @ theta_rate**2 - C @ theta_acceleration)
    bending = np.concatenate([bending_x, bending_y])
    N_p_Th2 = m.N_p @ Th2
    return m.M_p @ (-N_p_Th2 @ E @ velocity - N_p_Th2 @ turning - m.L_p @ bending + E.T @ force)


def accelerations(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options,
    joint_torque: Joints, effector_force: LinkPlane, effector_torque: Links,
) -> tuple[Links, Plane]:  # fmt: skip
    """Solve (2) for theta'' [rad/s2], then (1) for the center of mass' p'' [m/s2], world axes.

    `joint_torque` u [N m] is positive where it raises theta_{i+1} - theta_i; `effector_force` [N]
    acts at each link's center in world axes, `effector_torque` [N m] beside it.
    """
    D = _adjacent(len(theta))[1]
    m, force, torque = _loads(
        theta, theta_rate, velocity, chain, options, effector_force, effector_torque
    )
    theta_acceleration = np.linalg.solve(m.M_theta, torque - D.T @ joint_torque)
    return theta_acceleration, _com_acceleration(
        theta, theta_rate, theta_acceleration, velocity, options, m, force
    )


def constrained_accelerations(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options,
    joint_acceleration: Joints, effector_force: LinkPlane, effector_torque: Links,
    prescribed: JointFlags | None = None, joint_torque: Joints | None = None,
) -> tuple[Links, Plane, Joints]:  # fmt: skip
    """Return theta'' [rad/s2], p'' [m/s2] and the torque of every joint [N m] where joints follow a given motion.

    Solves (2) together with one row per joint: phi'' = -D theta'' is given where the joint is
    prescribed, its torque u where it is free. All joints prescribed is the model with three degrees
    of freedom; 0 locks a joint.

    Joints are prescribed where `prescribed` says so, all by default. `joint_acceleration` phi''
    [rad/s2] is used where they are, `joint_torque` (0 by default) where they are not. Effectors as
    for `accelerations`.
    """
    n = len(theta)
    D = _adjacent(n)[1]
    fixed = np.ones(n - 1, dtype=bool) if prescribed is None else prescribed
    given_torque = np.zeros(n - 1) if joint_torque is None else joint_torque
    m, force, torque = _loads(
        theta, theta_rate, velocity, chain, options, effector_force, effector_torque
    )
    system = np.block([[m.M_theta, D.T], [np.diag(fixed) @ D, np.diag(~fixed)]])
    known = np.concatenate([torque, np.where(fixed, -joint_acceleration, given_torque)])
    solution = np.linalg.solve(system, known)
    theta_acceleration = solution[:n]
    p_acceleration = _com_acceleration(
        theta, theta_rate, theta_acceleration, velocity, options, m, force
    )
    return theta_acceleration, p_acceleration, solution[n:]


def kinetic_energy(
    theta: Links, theta_rate: Links, velocity: Plane, chain: Chain, options: Options
) -> float:
    """Return the kinetic energy of body and added mass in the water's frame [J]."""
    v_t, v_n = _water_velocities(theta, theta_rate, velocity, chain, options)
    turning = (chain.inertia + chain.lambda_1) * theta_rate**2
    return float(
        np.sum((chain.mass + chain.mu_t) * v_t**2 + (chain.mass + chain.mu_n) * v_n**2 + turning)
        / 2
    )


def momentum(
    theta: Links,
    theta_rate: Links,
    position: Plane,
    velocity: Plane,
    chain: Chain,
    options: Options,
) -> tuple[Plane, float]:
    """Return the momentum of body and added mass in the water's frame: linear [kg m/s], angular [kg m2/s].

    `position` [m] of the center of mass is taken in a frame that moves with the water (p - V t),
    and the angular momentum about the origin of that frame. Without outer forces `kirchhoff` keeps
    both.
    """
    v_t, v_n = _water_velocities(theta, theta_rate, velocity, chain, options)
    p_x, p_y = _to_world(theta, (chain.mass + chain.mu_t) * v_t, (chain.mass + chain.mu_n) * v_n)
    r = link_positions(theta, position, chain)
    spin = (chain.inertia + chain.lambda_1) * theta_rate + r[:, 0] * p_y - r[:, 1] * p_x
    return np.array([np.sum(p_x), np.sum(p_y)]), float(np.sum(spin))
