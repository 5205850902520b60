"""What the water (or the ground) and the effectors do to the bodies of the chain.

Forces are in the axes of the link, moments about its tail end. A template (see `specialize`): `S` is the flat array of
`rows`, `b` the first row of a body's record, `k` a lane.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

from typing import no_type_check

import numpy as np

from laticauda.compiling import compiled, kernel
from laticauda.fluid import laws
from laticauda.planar.rows import *
from laticauda.planar.specialize import bindings

_names = bindings(__name__)
W = _names["WIDTH"]
law = compiled(_names["fluid_law"])
plate_law = compiled(laws.plate)


@kernel
@no_type_check
def sincos(x):
    """sin and cos to 2e-16 for |x| < 1e5, without branches so that lanes stay in vector registers.

    Reduction by multiples of pi/2 in three parts (Cody and Waite) and the minimax polynomials of fdlibm's kernels.
    """
    q = np.floor(x.real * 0.6366197723675814 + 0.5)
    y = x - q * 1.5707963267341256
    y = y - q * 6.077100506303966e-11
    y = y - q * 2.0222662487959506e-21
    z = y * y
    s = y + y * z * (
        -1.66666666666666324348e-01
        + z
        * (
            8.33333333332248946124e-03
            + z
            * (
                -1.98412698298579493134e-04
                + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))
            )
        )
    )
    c = (
        1.0
        - 0.5 * z
        + z
        * z
        * (
            4.16666666666666019037e-02
            + z
            * (
                -1.38888888888741095749e-03
                + z
                * (
                    2.48015872894767294178e-05
                    + z
                    * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11))
                )
            )
        )
    )
    quadrant = int(q) & 3
    swap = quadrant & 1
    sine = c if swap else s
    cosine = s if swap else c
    return (-sine if quadrant & 2 else sine), (-cosine if (quadrant + 1) & 2 else cosine)


@kernel
@no_type_check
def element_drag(S, b, e, k):
    """Drag of one element rigid on body b, link axes, and its moment about the tail end of b.

    `e` is the first of the element's five rows: its distance from the tail end, c_t, c_n, lambda_2, lambda_3. A body's
    own (from CENTER on) and a strip's (from STRIP_POSITION on) stand in the same order.
    """
    rate = S[(b + LINK_RATE) * W + k]
    x = S[e * W + k]
    f_t, f_n, tau = law(
        S[(b + V_T) * W + k],
        S[(b + V_N) * W + k] + x * rate,
        rate,
        S[(e + 1) * W + k],
        S[(e + 2) * W + k],
        S[(e + 3) * W + k],
        S[(e + 4) * W + k],
        S[REFERENCE_SPEED * W + k],
        S[LINEAR * W + k],
        S[QUADRATIC * W + k],
    )
    return f_t, f_n, tau + x * f_n


@kernel
@no_type_check
def added_mass_velocity_terms(S, b, k):
    """Velocity-dependent part of the added-mass force (link axes) and its moment about the tail end."""
    rate = S[(b + LINK_RATE) * W + k]
    v_t, v_n = S[(b + V_T) * W + k], S[(b + V_N) * W + k]
    mu_t, mu_n = S[(b + MU_T) * W + k], S[(b + MU_N) * W + k]
    moment_t, moment_n = S[(b + MOMENT_T) * W + k], S[(b + MOMENT_N) * W + k]
    # The classic form sees the current only: its velocity is -V where the others have v - V.
    own, keep = S[OWN_VELOCITY * W + k], S[KIRCHHOFF * W + k]
    c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
    V_t = c * S[CURRENT_X * W + k] + s * S[CURRENT_Y * W + k]
    V_n = c * S[CURRENT_Y * W + k] - s * S[CURRENT_X * W + k]
    seen_t = own * (v_t + V_t) - V_t
    seen_n = own * (v_n + V_n) - V_n
    momentum_n = mu_n * v_n + moment_n * rate
    f_t = rate * (keep * momentum_n - mu_t * seen_n)
    f_n = rate * (mu_n * seen_t - keep * mu_t * v_t)
    munk = -keep * v_t * (momentum_n - mu_t * v_n - moment_t * rate)
    return f_t, f_n, munk + rate * (moment_n * seen_t - keep * moment_t * v_t)


@kernel
@no_type_check
def extra_loads(S, n, first_strip, first_plate, tether_body):
    """Thrusters, fin strips, pectoral fins, tether and trailing edge: loads that only some bodies have."""
    H = HEADER_ROWS
    for i in range(n):
        b = H + i * BODY_ROWS
        for k in range(W):
            S[(b + EXTRA_T) * W + k] = S[(b + THRUST_T) * W + k]
            S[(b + EXTRA_N) * W + k] = S[(b + THRUST_N) * W + k]
            S[(b + EXTRA_MOMENT) * W + k] = S[(b + THRUST_MOMENT) * W + k]
        for e in range(first_strip[i], first_strip[i + 1]):
            strip_drag(S, b, H + n * BODY_ROWS + e * STRIP_ROWS)
        for e in range(first_plate[i], first_plate[i + 1]):
            plate_load(S, b, H + n * BODY_ROWS + first_strip[n] * STRIP_ROWS + e * PLATE_ROWS)
    tether(S, H + tether_body * BODY_ROWS)
    trailing_edge(S)


@kernel
@no_type_check
def strip_drag(S, b, e):
    """Drag of one strip, rigid on body b at its own distance from the tail end."""
    for k in range(W):
        f_t, f_n, moment = element_drag(S, b, e + STRIP_POSITION, k)
        S[(b + EXTRA_T) * W + k] += f_t
        S[(b + EXTRA_N) * W + k] += f_n
        S[(b + EXTRA_MOMENT) * W + k] += moment


@kernel
@no_type_check
def plate_load(S, b, e):
    """Lift and drag of one pectoral fin mounted on body b."""
    for k in range(W):
        rate = S[(b + LINK_RATE) * W + k]
        x = S[(e + PLATE_X) * W + k]
        y = S[(e + PLATE_Y) * W + k]
        v_t = S[(b + V_T) * W + k] - y * rate
        v_n = S[(b + V_N) * W + k] + x * rate
        s, c = sincos(S[(e + PLATE_ANGLE) * W + k])
        f_chord, f_normal = plate_law(
            c * v_t + s * v_n,
            c * v_n - s * v_t,
            S[(e + PLATE_AREA) * W + k],
            S[(e + PLATE_LIFT_SLOPE) * W + k],
            S[(e + PLATE_STALL_ANGLE) * W + k],
            S[(e + PLATE_SHARPNESS) * W + k],
            S[(e + PLATE_DRAG) * W + k],
        )
        f_t = c * f_chord - s * f_normal
        f_n = s * f_chord + c * f_normal
        S[(b + EXTRA_T) * W + k] += f_t
        S[(b + EXTRA_N) * W + k] += f_n
        S[(b + EXTRA_MOMENT) * W + k] += x * f_n - y * f_t


@kernel
@no_type_check
def tether(S, b):
    """F = -k |v| v + constant, at the tail end of the tail link."""
    for k in range(W):
        c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
        v_t, v_n = S[(b + V_T) * W + k], S[(b + V_N) * W + k]
        drag = S[TETHER_DRAG * W + k] * (v_t * v_t + v_n * v_n) ** 0.5
        S[(b + EXTRA_T) * W + k] += c * S[TETHER_FORCE_X * W + k] + s * S[TETHER_FORCE_Y * W + k] - drag * v_t
        S[(b + EXTRA_N) * W + k] += c * S[TETHER_FORCE_Y * W + k] - s * S[TETHER_FORCE_X * W + k] - drag * v_n


@kernel
@no_type_check
def trailing_edge(S):
    """Momentum that leaves with the wake (Lighthill 1971): m'/2 w^2 t - m' u w n while u > 0."""
    b = HEADER_ROWS
    for k in range(W):
        x = S[WAKE_POSITION * W + k]
        u = S[(b + V_T) * W + k]
        w = S[(b + V_N) * W + k] + x * S[(b + LINK_RATE) * W + k]
        shed = S[WAKE_MASS * W + k] if u.real > 0.0 else 0.0 * u
        f_n = -shed * u * w
        S[(b + EXTRA_T) * W + k] += 0.5 * shed * w * w
        S[(b + EXTRA_N) * W + k] += f_n
        S[(b + EXTRA_MOMENT) * W + k] += x * f_n


@kernel
@no_type_check
def body_forces(S, n, first_strip, force):
    """Drag, added-mass and effector force on every body, world axes, once the accelerations are known."""
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        for k in range(W):
            put_force(S, b, k, force[2, i], S[(b + EXTRA_T) * W + k], S[(b + EXTRA_N) * W + k])
            f_t, f_n = added_mass_force(S, b, k)
            put_force(S, b, k, force[1, i], f_t, f_n)
            f_t, f_n, _ = element_drag(S, b, b + CENTER, k)
            put_force(S, b, k, force[0, i], f_t, f_n)
        # Strips add to the extra loads: collect theirs alone, and move them from effectors to drag.
        for k in range(W):
            S[(b + EXTRA_T) * W + k] = 0.0
            S[(b + EXTRA_N) * W + k] = 0.0
        for e in range(first_strip[i], first_strip[i + 1]):
            strip_drag(S, b, HEADER_ROWS + n * BODY_ROWS + e * STRIP_ROWS)
        for k in range(W):
            c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
            f_x = c * S[(b + EXTRA_T) * W + k] - s * S[(b + EXTRA_N) * W + k]
            f_y = s * S[(b + EXTRA_T) * W + k] + c * S[(b + EXTRA_N) * W + k]
            force[0, i, 0, k] += f_x
            force[0, i, 1, k] += f_y
            force[2, i, 0, k] -= f_x
            force[2, i, 1, k] -= f_y


@kernel
@no_type_check
def put_force(S, b, k, force, f_t, f_n):
    """Store a force given in link axes of body b in world axes."""
    c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
    force[0, k] = c * f_t - s * f_n
    force[1, k] = s * f_t + c * f_n


@kernel
@no_type_check
def added_mass_force(S, b, k):
    """The whole added-mass force on body b, link axes: what its acceleration and its velocity call for."""
    f_t, f_n, _ = added_mass_velocity_terms(S, b, k)
    c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
    rate = S[(b + LINK_RATE) * W + k]
    a_t = c * S[(b + QX) * W + k] + s * S[(b + QY) * W + k]
    a_n = c * S[(b + QY) * W + k] - s * S[(b + QX) * W + k]
    # In all forms but the classic one the centripetal part along the body cancels.
    left = (1.0 - S[OWN_VELOCITY * W + k]) * S[(b + MOMENT_T) * W + k] * rate * rate
    f_t += left - S[(b + MU_T) * W + k] * a_t
    f_n -= S[(b + MU_N) * W + k] * a_n + S[(b + MOMENT_N) * W + k] * S[(b + LINK_ACCELERATION) * W + k]
    return f_t, f_n
