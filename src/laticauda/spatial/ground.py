"""The ground under a piece of a robot: a normal force by how deep it is in, and anisotropic friction in proportion to it.

MuJoCo's friction has its axes in the contact's frame, which turns with the body only for a capsule on a plane, so not
on a ramp. Here friction is along and across the piece wherever it lies, by the planar model's laws with the normal
force N in place of the weight. A piece touches with the lowest point of its elliptic section at either end:

    N = k d max(0, 1 + beta d')        f = -mu N v / sqrt(v^2 + eps^2), or -mu N v for viscous ground

d is how deep the point is in. k lets a module that lies flat sink in by SINK, beta damps its bounce critically.
Plain scalar functions, which the kernels compile.
"""

import math
from dataclasses import dataclass

from laticauda.fluid.laws import coulomb_friction, polynomial_drag
from laticauda.robot import Ground

SINK = 1e-3  # [m]
_TINY = 1e-12


@dataclass(frozen=True, kw_only=True)
class Contact:
    """How an element touches the ground."""

    stiffness: float
    """k at each end [N/m]."""
    damping: float
    """beta [s/m]."""
    along: float
    """Friction along the element per normal force: mu_t, or viscous in s/m [-]."""
    across: float
    """The same across it [-]."""
    regularization_speed: float
    """eps of dry friction; 0: viscous [m/s]."""


@dataclass(frozen=True, kw_only=True)
class Terrain:
    """Flat ground that may end in a slope down along x to a floor."""

    height: float = 0.0
    """Of the flat ground [m]."""
    edge: float = 0.0
    """x at which the slope begins [m]."""
    slope: float = 0.0
    """Tangent of the slope; 0: flat everywhere [-]."""
    floor: float = 0.0
    """Height of the floor at the slope's foot [m]."""


def contact(mass: float, ground: Ground) -> Contact:
    """How a piece of a robot touches the ground.

    Args:
        mass: Of the piece [kg].
        ground: Its friction; viscous coefficients hold for a piece that lies flat with its own weight.
    """
    weight = mass * ground.gravity
    dry = ground.friction == "coulomb"
    return Contact(
        stiffness=0.5 * weight / SINK,
        damping=2.0 / math.sqrt(ground.gravity * SINK),
        along=ground.tangential if dry else ground.tangential / weight,
        across=ground.normal if dry else ground.normal / weight,
        regularization_speed=ground.regularization_speed if dry else 0.0,
    )


def stable_step(contacts: list[Contact], gravity: float) -> float:
    """A step [s] at which contacts are well resolved: spring and friction of a piece that carries its own weight."""
    rate = math.sqrt(gravity / SINK)
    for c in contacts:
        share = max(c.along, c.across) * gravity
        rate = max(rate, share / c.regularization_speed if c.regularization_speed > 0.0 else share)
    return 1.0 / rate


def terrain(x: float, height: float, edge: float, slope: float, floor: float) -> tuple[float, float]:
    """Height of the ground at x [m], and the tangent of its fall along x [-]; arguments as in `Terrain`."""
    if slope == 0.0 or x <= edge:
        return height, 0.0
    here = height - slope * (x - edge)
    return (here, slope) if here > floor else (floor, 0.0)


def touch(
    depth: float, rate: float, v_t: float, v_n: float, k: float, beta: float, along: float, across: float, eps: float
) -> tuple[float, float, float]:
    """Forces of the ground on a point: along the piece, across it, and normal to the ground [N].

    Args:
        depth: How deep the point is in [m].
        rate: How fast it goes in [m/s].
        v_t: Its velocity along the piece, in the plane of the ground [m/s].
        v_n: The same across it [m/s].
        k: `Contact.stiffness` [N/m].
        beta: `Contact.damping` [s/m].
        along: `Contact.along`.
        across: `Contact.across`.
        eps: `Contact.regularization_speed` [m/s].
    """
    normal = k * depth * (1.0 + beta * rate)
    if depth <= 0.0 or normal <= 0.0:
        return 0.0, 0.0, 0.0
    c_t, c_n = along * normal, across * normal
    if eps > 0.0:
        f_t, f_n, _ = coulomb_friction(v_t, v_n, 0.0, c_t, c_n, 0.0, 0.0, eps, 0.0, 1.0)
    else:
        f_t, f_n, _ = polynomial_drag(v_t, v_n, 0.0, c_t, c_n, 0.0, 0.0, 1.0, 1.0, 0.0)
    return f_t, f_n, normal


def ground_force(
    p: tuple[float, float, float],
    r: tuple[float, float, float, float, float, float, float, float, float],
    v: tuple[float, float, float],
    w: tuple[float, float, float],
    half: tuple[float, float, float],
    c: tuple[float, float, float, float, float],
    ground: tuple[float, float, float, float],
) -> tuple[float, float, float, float, float, float]:
    """Force of the ground on a piece and its torque about the middle, in world axes [N], [N m].

    Args:
        p: Its middle [m].
        r: Rotation from its axes to the world's, row by row.
        v: Velocity of the middle [m/s].
        w: Angular velocity, world axes [rad/s].
        half: Half its length, width and height [m].
        c: The fields of `Contact`.
        ground: The fields of `Terrain`.
    """
    f0, f1, f2, t0, t1, t2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for sign in (-1.0, 1.0):
        _, fall = terrain(p[0] + sign * half[0] * r[0], ground[0], ground[1], ground[2], ground[3])
        n_z = 1.0 / math.sqrt(1.0 + fall * fall)
        n_x = fall * n_z
        # The lowest point of the section, as seen along the ground's normal.
        g_y, g_z = -(r[1] * n_x + r[7] * n_z), -(r[2] * n_x + r[8] * n_z)
        size = math.sqrt(half[1] * half[1] * g_y * g_y + half[2] * half[2] * g_z * g_z) + _TINY
        y, z = half[1] * half[1] * g_y / size, half[2] * half[2] * g_z / size
        x = sign * half[0]
        a0, a1, a2 = r[0] * x + r[1] * y + r[2] * z, r[3] * x + r[4] * y + r[5] * z, r[6] * x + r[7] * y + r[8] * z
        height, _ = terrain(p[0] + a0, ground[0], ground[1], ground[2], ground[3])
        depth = (height - p[2] - a2) * n_z
        if depth > 0.0:
            v0, v1, v2 = v[0] + w[1] * a2 - w[2] * a1, v[1] + w[2] * a0 - w[0] * a2, v[2] + w[0] * a1 - w[1] * a0
            # Along the piece and across it, in the plane of the ground
            lift = r[0] * n_x + r[6] * n_z
            e0, e1, e2 = r[0] - lift * n_x, r[3], r[6] - lift * n_z
            long = math.sqrt(e0 * e0 + e1 * e1 + e2 * e2) + _TINY
            e0, e1, e2 = e0 / long, e1 / long, e2 / long
            d0, d1, d2 = -n_z * e1, n_z * e0 - n_x * e2, n_x * e1
            f_t, f_n, normal = touch(
                depth,
                -(v0 * n_x + v2 * n_z),
                v0 * e0 + v1 * e1 + v2 * e2,
                v0 * d0 + v1 * d1 + v2 * d2,
                c[0],
                c[1],
                c[2],
                c[3],
                c[4],
            )
            q0, q1, q2 = f_t * e0 + f_n * d0 + normal * n_x, f_t * e1 + f_n * d1, f_t * e2 + f_n * d2 + normal * n_z
            f0, f1, f2 = f0 + q0, f1 + q1, f2 + q2
            t0, t1, t2 = t0 + a1 * q2 - a2 * q1, t1 + a2 * q0 - a0 * q2, t2 + a0 * q1 - a1 * q0
    return f0, f1, f2, t0, t1, t2
