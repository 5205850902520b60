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

from laticauda.compiling import kernel
from laticauda.planar.rows import *
from laticauda.planar.specialize import bindings

_names = bindings(__name__)
W = _names["WIDTH"]
_loads = _names["loads"]
added_mass_velocity_terms = _loads.added_mass_velocity_terms
element_drag = _loads.element_drag
extra_loads = _loads.extra_loads
sincos = _loads.sincos


@kernel
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
def own_bias(S, b, k):
    """Bias force of the body: centripetal terms less all loads that do not depend on acceleration."""
    rate = S[(b + LINK_RATE) * W + k]
    f_t, f_n, moment = added_mass_velocity_terms(S, b, k)
    drag_t, drag_n, drag_moment = element_drag(S, b, b + CENTER, k)
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
