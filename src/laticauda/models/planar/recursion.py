"""O(n) recursion for the accelerations of a chain of bodies in water, each joint prescribed or free.

Articulated-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7 and sec. 9.2)
in planar spatial vectors (one rotation, two translations) in world axes, with each body's vectors
taken at its tail end, where its joint is. The 3x3 inertia of a body includes its anisotropic added
mass. A prescribed joint passes on its child's full inertia and known acceleration; a free joint
passes on what remains after the joint has yielded. Body 0, the tail-most, floats: its acceleration
is the final 3x3 solve. With all joints prescribed this is exactly the model with three degrees of
freedom.

In the docstrings below, with Featherstone's letters: I and p are inertia and bias force of a body
alone, I^A and p^A those of the body with all bodies further to the head (articulated), so that the
force on them at its tail end is I^A a + p^A; a = (theta'', qx, qy) is its acceleration, s = (1, 0, 0)
the axis of its joint, q'' = phi'' the joint's acceleration and tau its torque (TOTAL_TORQUE). X takes
velocities and accelerations from the tail end of the body behind to the joint, X v = v + (0, arm) rate,
with `arm` the velocity of the joint per unit of rotation; c is what the rotation of the body behind
adds to the acceleration there (`centripetal`).

`S` is the flat array of `rows`; `n` the number of bodies; `b` the first row of a body's record, `j`
that of the body on the head side of a joint. Functions with the argument `keep_all` also store what
belongs to single bodies: articulated inertias and all accelerations, which only torques and logs
need. No function allocates.

A template (see `templates`), loaded anew for every specialization of `loads`.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportGeneralTypeIssues=false

from laticauda.compiling import kernel
from laticauda.compiling.functions import sincos
from laticauda.compiling.templates import bindings
from laticauda.models.planar.rows import *

loads = bindings(__name__)["loads"]


@kernel
def accelerations(S, n, first_strip, first_plate, is_free, tail_link, has_extras, keep_all):
    """Compute the accelerations of base and free joints for the state in S."""
    velocities(S, n)
    loads.water_around(S, n, first_strip, first_plate, tail_link, has_extras)
    if has_extras:
        loads.extra_loads(S, n, first_strip, first_plate, tail_link)
    articulated = inward(S, n, is_free, keep_all)
    floating_base(S, articulated)
    outward(S, n, is_free, keep_all)


@kernel
def velocities(S, n):
    """Compute angle, rate and velocity of every body from heading, center of mass and joints: v = X v_behind + s phi'.

    Angle and rate of body 0 follow from the mean over the links, its velocity from the mean over the
    mass. V_T and V_N are relative to the uniform current.
    """
    H = HEADER_ROWS
    angle, rate = S[HEADING], S[HEADING_RATE]
    for i in range(1, n):
        b = H + i * BODY_ROWS
        angle -= S[b + HEADING_SHARE] * S[b + ANGLE]
        rate -= S[b + HEADING_SHARE] * S[b + RATE]
    ux, uy, mean_x, mean_y = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        b = H + i * BODY_ROWS
        if i > 0:
            angle += S[b + ANGLE]
            rate += S[b + RATE]
        s, c = sincos(angle)
        S[b + LINK_RATE] = rate
        S[b + SIN] = s
        S[b + COS] = c
        S[b + UX] = ux
        S[b + UY] = uy
        turn = S[b + FIRST_MOMENT_SHARE] * rate
        mean_x += S[b + MASS_SHARE] * ux - turn * s
        mean_y += S[b + MASS_SHARE] * uy + turn * c
        turn = S[b + LENGTH] * rate
        ux -= turn * s
        uy += turn * c
    root_x = S[VX] - mean_x - S[CURRENT_X]
    root_y = S[VY] - mean_y - S[CURRENT_Y]
    for i in range(n):
        b = H + i * BODY_ROWS
        c, s = S[b + COS], S[b + SIN]
        vx, vy = root_x + S[b + UX], root_y + S[b + UY]
        S[b + V_T] = c * vx + s * vy
        S[b + V_N] = c * vy - s * vx


@kernel
def inward(S, n, is_free, keep_all):
    """Return articulated inertia and bias force of body 0, accumulated from the head; store what `outward` needs.

    I^A = I + X^T I^a X and p^A = p + X^T p^a, by `through_joint` of the body ahead and `plus`.
    """
    b = HEADER_ROWS + (n - 1) * BODY_ROWS
    articulated = of_body(S, b)
    for i in range(n - 2, -1, -1):
        if keep_all:
            keep_articulated(S, b, articulated)
        articulated = through_joint(S, b, is_free[i + 1], articulated)
        b -= BODY_ROWS
        articulated = plus(of_body(S, b), articulated)
    if keep_all:
        keep_articulated(S, b, articulated)
    return articulated


@kernel
def of_body(S, b):
    """Return inertia and bias force of one body alone."""
    return *own_inertia(S, b), *own_bias(S, b)


@kernel
def plus(own, ahead):
    """Return the sum of a body's own inertia and bias force and those of the bodies ahead, seen at its tail end."""
    a00, a01, a02, a11, a12, a22, p0, p1, p2 = own
    c00, c01, c02, c11, c12, c22, q0, q1, q2 = ahead
    return (
        a00 + c00,
        a01 + c01,
        a02 + c02,
        a11 + c11,
        a12 + c12,
        a22 + c22,
        p0 + q0,
        p1 + q1,
        p2 + q2,
    )


@kernel
def keep_articulated(S, b, articulated):
    """Store the rotation row of a body's articulated inertia, and its bias force."""
    a00, a01, a02, _, _, _, p0, p1, p2 = articulated
    for k, number in enumerate((a00, a01, a02, p0, p1, p2)):
        S[b + A00 + k] = number


@kernel
def own_inertia(S, b):
    """Return I of the body including added mass, about its tail end, world axes: 00, 01, 02, 11, 12, 22 of the matrix.

    In link axes it is ((I00, 0, k), (0, m_t, 0), (k, 0, m_n)), with k = COUPLING.
    """
    c, s = S[b + COS], S[b + SIN]
    mass_t, mass_n = S[b + MASS_T], S[b + MASS_N]
    coupling = S[b + COUPLING]
    across = (mass_n - mass_t) * s
    return (
        S[b + INERTIA],
        -s * coupling,
        c * coupling,
        mass_t + across * s,
        -across * c,
        mass_n - across * s,
    )


@kernel
def own_bias(S, b):
    """Return p of the body: what its velocity demands, minus all loads that do not depend on acceleration.

    Moment about the tail end, then force in world axes.
    """
    rate = S[b + LINK_RATE]
    f_t, f_n, moment = loads.added_mass_velocity_terms(S, b)
    drag_t, drag_n, drag_moment = loads.element_drag(S, b, b + CENTER)
    f_t += drag_t + S[b + EXTRA_T] + S[b + CENTRIPETAL] * rate * rate
    f_n += drag_n + S[b + EXTRA_N]
    moment += drag_moment + S[b + EXTRA_MOMENT]
    c, s = S[b + COS], S[b + SIN]
    return -moment, s * f_n - c * f_t, -(s * f_t + c * f_n)


@kernel
def centripetal(S, a):
    """Return c = -theta'^2 2l t: acceleration of the head end of body a relative to its tail end, by rotation."""
    pull = -S[a + LENGTH] * S[a + LINK_RATE] * S[a + LINK_RATE]
    return pull * S[a + COS], pull * S[a + SIN]


@kernel
def through_joint(S, j, joint_is_free, articulated):
    """Return articulated inertia and bias of body j as seen through its joint, at the tail end of the body behind.

    They are X^T I^a X and X^T p^a. Prescribed, the joint passes on everything, and its known q'':

        I^a = I^A,                      p^a = p^A + I^A (c + s q'')

    Free, with U = I^A s, D = s^T U and u = tau - s^T (p^A + I^A c), it keeps what is left after it
    has yielded (Featherstone writes the same p^a with I^a c, and u without c):

        I^a = I^A - U D^-1 U^T,         p^a = p^A + I^A c + U D^-1 u

    IMPLICIT is added to D. X^T U is (w0, a01, a02), since X leaves translations alone; `outward` needs
    SWING = D^-1 u and GIVE ... GIVE_Y = D^-1 X^T U. The 3x3 matrices are symmetric: b00, b01, b02 begin
    as the first row of X^T I^A X.
    """
    b = j - BODY_ROWS
    a00, a01, a02, a11, a12, a22, p0, p1, p2 = articulated
    pull_x, pull_y = centripetal(S, b)
    p0 += a01 * pull_x + a02 * pull_y
    p1 += a11 * pull_x + a12 * pull_y
    p2 += a12 * pull_x + a22 * pull_y
    arm_x = -S[b + LENGTH] * S[b + SIN]
    arm_y = S[b + LENGTH] * S[b + COS]
    w0 = a00 + arm_x * a01 + arm_y * a02
    b01 = a01 + arm_x * a11 + arm_y * a12
    b02 = a02 + arm_x * a12 + arm_y * a22
    b00 = w0 + arm_x * b01 + arm_y * b02
    swing = S[j + REFERENCE_2]
    if joint_is_free:
        # A rank-1 correction for its yielding, applied last because it waits for the division.
        give = 1.0 / (a00 + S[j + IMPLICIT])
        swing = (S[j + TOTAL_TORQUE] - p0) * give
        g0, g1, g2 = w0 * give, a01 * give, a02 * give
        for k, number in enumerate((swing, g0, g1, g2)):
            S[j + SWING + k] = number
        b00, b01, b02 = b00 - w0 * g0, b01 - w0 * g1, b02 - w0 * g2
        a11, a12, a22 = a11 - a01 * g1, a12 - a01 * g2, a22 - a02 * g2
    p0 += arm_x * p1 + arm_y * p2
    return b00, b01, b02, a11, a12, a22, p0 + w0 * swing, p1 + a01 * swing, p2 + a02 * swing


@kernel
def floating_base(S, articulated):
    """Compute the acceleration of body 0 from I^A a + p^A = 0, since nothing else holds it."""
    b = HEADER_ROWS
    rotation, qx, qy = solved(articulated)
    S[b + LINK_ACCELERATION] = rotation
    S[b + QX] = qx
    S[b + QY] = qy


@kernel
def solved(articulated):
    """Return the acceleration a (rotation, x, y) for which I^A a + p^A = 0."""
    a00, a01, a02, a11, a12, a22, p0, p1, p2 = articulated
    determinant = a11 * a22 - a12 * a12  # eliminate the translations, which are well conditioned
    share = 1.0 / determinant  # a division takes as long as ten other operations
    x_1 = (a22 * a01 - a12 * a02) * share
    x_2 = (a11 * a02 - a12 * a01) * share
    rotation = -(p0 - x_1 * p1 - x_2 * p2) / (a00 - x_1 * a01 - x_2 * a02)
    qx = (a12 * p2 - a22 * p1) * share - x_1 * rotation
    qy = (a12 * p1 - a11 * p2) * share - x_2 * rotation
    return rotation, qx, qy


@kernel
def outward(S, n, is_free, keep_all):
    """Compute accelerations of heading, center of mass and free joints, from that of body 0 to the head.

    At each joint, with the acceleration a of the body behind: q'' = D^-1 (u - U^T X a) if it is free
    (`through_joint`), then a = X a + c + s q''.
    """
    H = HEADER_ROWS
    spin, qx, qy = S[H + LINK_ACCELERATION], S[H + QX], S[H + QY]
    heading, ax, ay = spin, 0.0, 0.0
    for i in range(n):
        b = H + i * BODY_ROWS
        if i > 0:
            a = b - BODY_ROWS
            swing = S[b + REFERENCE_2]
            if is_free[i]:
                swing = S[b + SWING] - S[b + GIVE_X] * qx - S[b + GIVE_Y] * qy - S[b + GIVE] * spin
                S[b + ACCELERATION] = swing
            pull_x, pull_y = centripetal(S, a)
            turn = S[a + LENGTH] * spin
            qx += pull_x - turn * S[a + SIN]  # X a + c
            qy += pull_y + turn * S[a + COS]
            spin += swing
            heading += S[b + HEADING_SHARE] * swing
            if keep_all:
                S[b + ACCELERATION] = swing
                S[b + LINK_ACCELERATION] = spin
                S[b + QX] = qx
                S[b + QY] = qy
        rate, arm = S[b + LINK_RATE], S[b + FIRST_MOMENT_SHARE]
        across, along = arm * spin, arm * rate * rate
        c, s = S[b + COS], S[b + SIN]
        ax += S[b + MASS_SHARE] * qx - across * s - along * c
        ay += S[b + MASS_SHARE] * qy + across * c - along * s
    S[HEADING_ACCELERATION] = heading
    S[AX] = ax
    S[AY] = ay


@kernel
def holding_torques(S, n, is_free):
    """Compute TOTAL_TORQUE of every prescribed joint, once the accelerations are known: tau = s^T (I^A a + p^A)."""
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if not is_free[i]:
            push = S[b + A01] * S[b + QX] + S[b + A02] * S[b + QY]
            S[b + TOTAL_TORQUE] = S[b + A00] * S[b + LINK_ACCELERATION] + push + S[b + P0]
