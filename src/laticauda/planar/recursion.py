"""One O(n) recursion: the accelerations of a chain of bodies in water, any joint prescribed or free.

Articulated-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7 and sec. 9.2) in planar spatial
vectors (one rotation, two translations) in world axes, each body's vectors taken at its tail end, where its joint is.
The 3x3 inertia of a body holds its anisotropic added mass. A prescribed joint passes its child's whole inertia and
known acceleration on; a free joint passes on what is left after the joint has given way. Body 0, the tail-most, floats:
its acceleration is the last 3x3 solve. With all joints prescribed this is exactly the model with three degrees of
freedom.

A template (see `specialize`). `S` is the flat array of `rows`; `n` the number of bodies; every loop over `k` runs over
the lanes. No function allocates.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

from typing import no_type_check

import numpy as np

from laticauda.fluid import laws
from laticauda.planar.rows import *  # noqa: F403  (the table of rows is this module's vocabulary)
from laticauda.planar.specialize import bindings, compiled, kernel, routine

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


@routine
@no_type_check
def accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras):
    """Accelerations of the base and of the joints, for the state in S."""
    velocities(S, n)
    if has_extras:
        extra_loads(S, n, first_strip, first_plate, tether_body)
    inward(S, n, is_free)
    floating_base(S)
    outward(S, n, is_free)


@kernel
@no_type_check
def velocities(S, n):
    """Angle, rate and velocity of every body from heading, center of mass and joints."""
    H = HEADER_ROWS
    for k in range(W):
        angle = S[HEADING * W + k]
        rate = S[HEADING_RATE * W + k]
        for i in range(1, n):
            b = H + i * BODY_ROWS
            angle -= S[(b + HEADING_SHARE) * W + k] * S[(b + ANGLE) * W + k]
            rate -= S[(b + HEADING_SHARE) * W + k] * S[(b + RATE) * W + k]
        S[(H + LINK_ANGLE) * W + k] = angle
        S[(H + LINK_RATE) * W + k] = rate
        S[(H + UX) * W + k] = 0.0
        S[(H + UY) * W + k] = 0.0
        S[SUM_X * W + k] = 0.0
        S[SUM_Y * W + k] = 0.0
    for i in range(n):
        b = H + i * BODY_ROWS
        for k in range(W):
            if i > 0:
                a = b - BODY_ROWS
                turn = S[(a + LENGTH) * W + k] * S[(a + LINK_RATE) * W + k]
                S[(b + UX) * W + k] = S[(a + UX) * W + k] - turn * S[(a + SIN) * W + k]
                S[(b + UY) * W + k] = S[(a + UY) * W + k] + turn * S[(a + COS) * W + k]
                S[(b + LINK_ANGLE) * W + k] = S[(a + LINK_ANGLE) * W + k] + S[(b + ANGLE) * W + k]
                S[(b + LINK_RATE) * W + k] = S[(a + LINK_RATE) * W + k] + S[(b + RATE) * W + k]
            s, c = sincos(S[(b + LINK_ANGLE) * W + k])
            S[(b + SIN) * W + k] = s
            S[(b + COS) * W + k] = c
            turn = S[(b + FIRST_MOMENT_SHARE) * W + k] * S[(b + LINK_RATE) * W + k]
            S[SUM_X * W + k] += S[(b + MASS_SHARE) * W + k] * S[(b + UX) * W + k] - turn * s
            S[SUM_Y * W + k] += S[(b + MASS_SHARE) * W + k] * S[(b + UY) * W + k] + turn * c
    for k in range(W):
        S[ROOT_VX * W + k] = S[VX * W + k] - S[SUM_X * W + k] - S[CURRENT_X * W + k]
        S[ROOT_VY * W + k] = S[VY * W + k] - S[SUM_Y * W + k] - S[CURRENT_Y * W + k]
    for i in range(n):
        b = H + i * BODY_ROWS
        for k in range(W):
            c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
            vx = S[ROOT_VX * W + k] + S[(b + UX) * W + k]
            vy = S[ROOT_VY * W + k] + S[(b + UY) * W + k]
            S[(b + V_T) * W + k] = c * vx + s * vy
            S[(b + V_N) * W + k] = c * vy - s * vx


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
        rate = S[(b + LINK_RATE) * W + k]
        x = S[(e + STRIP_POSITION) * W + k]
        f_t, f_n, tau = law(
            S[(b + V_T) * W + k],
            S[(b + V_N) * W + k] + x * rate,
            rate,
            S[(e + STRIP_C_T) * W + k],
            S[(e + STRIP_C_N) * W + k],
            S[(e + STRIP_LAMBDA_2) * W + k],
            S[(e + STRIP_LAMBDA_3) * W + k],
            S[REFERENCE_SPEED * W + k],
            S[LINEAR * W + k],
            S[QUADRATIC * W + k],
        )
        S[(b + EXTRA_T) * W + k] += f_t
        S[(b + EXTRA_N) * W + k] += f_n
        S[(b + EXTRA_MOMENT) * W + k] += tau + x * f_n


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
def inward(S, n, is_free):
    """Articulated inertia and bias force of every body, from the head to the tail."""
    for i in range(n - 1, -1, -1):
        b = HEADER_ROWS + i * BODY_ROWS
        has_child = i < n - 1
        child_is_free = has_child and is_free[i + 1]
        for k in range(W):
            a00, a01, a02, a11, a12, a22 = own_inertia(S, b, k)
            p0, p1, p2 = own_bias(S, b, k)
            if has_child:
                c00, c01, c02, c11, c12, c22, q0, q1, q2 = through_joint(S, b, k, child_is_free)
                a00, a01, a02, a11, a12, a22 = a00 + c00, a01 + c01, a02 + c02, a11 + c11, a12 + c12, a22 + c22
                p0, p1, p2 = p0 + q0, p1 + q1, p2 + q2
            S[(b + A00) * W + k] = a00
            S[(b + A01) * W + k] = a01
            S[(b + A02) * W + k] = a02
            S[(b + A11) * W + k] = a11
            S[(b + A12) * W + k] = a12
            S[(b + A22) * W + k] = a22
            S[(b + P0) * W + k] = p0
            S[(b + P1) * W + k] = p1
            S[(b + P2) * W + k] = p2


@kernel
@no_type_check
def own_inertia(S, b, k):
    """Inertia of the body and of the water it takes along, about its tail end, world axes."""
    c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
    mass_t, mass_n = S[(b + MASS_T) * W + k], S[(b + MASS_N) * W + k]
    coupling = S[(b + COUPLING) * W + k]
    across = (mass_n - mass_t) * s
    return S[(b + INERTIA) * W + k], -s * coupling, c * coupling, mass_t + across * s, -across * c, mass_n - across * s


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
def own_drag(S, b, k):
    """Drag of the body itself, link axes, and its moment about the tail end."""
    rate = S[(b + LINK_RATE) * W + k]
    x = S[(b + CENTER) * W + k]
    f_t, f_n, tau = law(
        S[(b + V_T) * W + k],
        S[(b + V_N) * W + k] + x * rate,
        rate,
        S[(b + C_T) * W + k],
        S[(b + C_N) * W + k],
        S[(b + LAMBDA_2) * W + k],
        S[(b + LAMBDA_3) * W + k],
        S[REFERENCE_SPEED * W + k],
        S[LINEAR * W + k],
        S[QUADRATIC * W + k],
    )
    return f_t, f_n, tau + x * f_n


@kernel
@no_type_check
def own_bias(S, b, k):
    """Bias force of the body: centripetal terms less all loads that do not depend on acceleration."""
    rate = S[(b + LINK_RATE) * W + k]
    f_t, f_n, moment = added_mass_velocity_terms(S, b, k)
    drag_t, drag_n, drag_moment = own_drag(S, b, k)
    f_t += drag_t + S[(b + EXTRA_T) * W + k] + S[(b + CENTRIPETAL) * W + k] * rate * rate
    f_n += drag_n + S[(b + EXTRA_N) * W + k]
    moment += drag_moment + S[(b + EXTRA_MOMENT) * W + k]
    c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
    return -moment, s * f_n - c * f_t, -(s * f_t + c * f_n)


@kernel
@no_type_check
def centripetal(S, a, k):
    """Acceleration -theta'^2 2l t of the head end of body a relative to its tail end."""
    pull = -S[(a + LENGTH) * W + k] * S[(a + LINK_RATE) * W + k] * S[(a + LINK_RATE) * W + k]
    return pull * S[(a + COS) * W + k], pull * S[(a + SIN) * W + k]


@kernel
@no_type_check
def through_joint(S, b, k, joint_is_free):
    """Articulated inertia and bias of the child of body b, seen through the joint and moved to the tail end of b."""
    j = b + BODY_ROWS
    a00, a01, a02 = S[(j + A00) * W + k], S[(j + A01) * W + k], S[(j + A02) * W + k]
    a11, a12, a22 = S[(j + A11) * W + k], S[(j + A12) * W + k], S[(j + A22) * W + k]
    pull_x, pull_y = centripetal(S, b, k)
    p0 = S[(j + P0) * W + k] + a01 * pull_x + a02 * pull_y
    p1 = S[(j + P1) * W + k] + a11 * pull_x + a12 * pull_y
    p2 = S[(j + P2) * W + k] + a12 * pull_x + a22 * pull_y
    if joint_is_free:
        left = S[(j + TOTAL_TORQUE) * W + k] - p0
        give = 1.0 / (a00 + S[(j + IMPLICIT) * W + k])
        S[(j + TORQUE_LEFT) * W + k] = left
        S[(j + GIVE) * W + k] = give
        swing = left * give
        p0, p1, p2 = p0 + a00 * swing, p1 + a01 * swing, p2 + a02 * swing
        g0, g1, g2 = a00 * give, a01 * give, a02 * give
        a11, a12, a22 = a11 - a01 * g1, a12 - a01 * g2, a22 - a02 * g2
        a00, a01, a02 = a00 - a00 * g0, a01 - a01 * g0, a02 - a02 * g0
    else:
        swing = S[(j + REFERENCE_2) * W + k]
        p0, p1, p2 = p0 + a00 * swing, p1 + a01 * swing, p2 + a02 * swing
    arm_x = -S[(b + LENGTH) * W + k] * S[(b + SIN) * W + k]  # velocity of the joint per unit of rotation
    arm_y = S[(b + LENGTH) * W + k] * S[(b + COS) * W + k]
    b01 = a01 + arm_x * a11 + arm_y * a12
    b02 = a02 + arm_x * a12 + arm_y * a22
    b00 = a00 + arm_x * (a01 + b01) + arm_y * (a02 + b02)
    return b00, b01, b02, a11, a12, a22, p0 + arm_x * p1 + arm_y * p2, p1, p2


@kernel
@no_type_check
def floating_base(S):
    """Acceleration of body 0 from A a + p = 0."""
    b = HEADER_ROWS
    for k in range(W):
        a00, a01, a02 = S[(b + A00) * W + k], S[(b + A01) * W + k], S[(b + A02) * W + k]
        a11, a12, a22 = S[(b + A11) * W + k], S[(b + A12) * W + k], S[(b + A22) * W + k]
        p0, p1, p2 = S[(b + P0) * W + k], S[(b + P1) * W + k], S[(b + P2) * W + k]
        determinant = a11 * a22 - a12 * a12  # eliminate the translations, which are well conditioned
        x_1 = (a22 * a01 - a12 * a02) / determinant
        x_2 = (a11 * a02 - a12 * a01) / determinant
        rotation = -(p0 - x_1 * p1 - x_2 * p2) / (a00 - x_1 * a01 - x_2 * a02)
        S[(b + LINK_ACCELERATION) * W + k] = rotation
        S[(b + QX) * W + k] = (a12 * p2 - a22 * p1) / determinant - x_1 * rotation
        S[(b + QY) * W + k] = (a12 * p1 - a11 * p2) / determinant - x_2 * rotation


@kernel
@no_type_check
def outward(S, n, is_free):
    """Accelerations of all bodies and joints, joint torques, and those of heading and center of mass."""
    H = HEADER_ROWS
    for k in range(W):
        S[HEADING_ACCELERATION * W + k] = S[(H + LINK_ACCELERATION) * W + k]
        S[AX * W + k] = 0.0
        S[AY * W + k] = 0.0
    for i in range(n):
        b = H + i * BODY_ROWS
        for k in range(W):
            if i > 0:
                a = b - BODY_ROWS
                pull_x, pull_y = centripetal(S, a, k)
                turn = S[(a + LENGTH) * W + k] * S[(a + LINK_ACCELERATION) * W + k]
                carried_x = S[(a + QX) * W + k] - turn * S[(a + SIN) * W + k]
                carried_y = S[(a + QY) * W + k] + turn * S[(a + COS) * W + k]
                spin = S[(a + LINK_ACCELERATION) * W + k]
                a00, a01, a02 = S[(b + A00) * W + k], S[(b + A01) * W + k], S[(b + A02) * W + k]
                if is_free[i]:
                    load = a00 * spin + a01 * carried_x + a02 * carried_y
                    swing = (S[(b + TORQUE_LEFT) * W + k] - load) * S[(b + GIVE) * W + k]
                    qx, qy = carried_x + pull_x, carried_y + pull_y
                else:
                    swing = S[(b + REFERENCE_2) * W + k]
                    qx, qy = carried_x + pull_x, carried_y + pull_y
                    S[(b + TOTAL_TORQUE) * W + k] = a00 * (spin + swing) + a01 * qx + a02 * qy + S[(b + P0) * W + k]
                S[(b + ACCELERATION) * W + k] = swing
                S[(b + LINK_ACCELERATION) * W + k] = spin + swing
                S[(b + QX) * W + k] = qx
                S[(b + QY) * W + k] = qy
                S[HEADING_ACCELERATION * W + k] += S[(b + HEADING_SHARE) * W + k] * swing
            rate = S[(b + LINK_RATE) * W + k]
            arm = S[(b + FIRST_MOMENT_SHARE) * W + k]
            spin_arm, pull = arm * S[(b + LINK_ACCELERATION) * W + k], arm * rate * rate
            c, s = S[(b + COS) * W + k], S[(b + SIN) * W + k]
            S[AX * W + k] += S[(b + MASS_SHARE) * W + k] * S[(b + QX) * W + k] - spin_arm * s - pull * c
            S[AY * W + k] += S[(b + MASS_SHARE) * W + k] * S[(b + QY) * W + k] + spin_arm * c - pull * s


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
            f_t, f_n, _ = own_drag(S, b, k)
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
