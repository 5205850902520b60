"""Accelerations and torques when all joints are prescribed, in still water or a uniform current, without extras.

The same model as that of `recursion`, from the same loads. What only free joints need is left out,
and what is known beforehand is computed once:

- The *shape*, that is, how the bodies stand and move relative to body 0, the tail-most, depends on
  the time alone: stages at the same time share it. So does the inertia of the stiff body about the
  tail end of body 0 (`compute_shape`).
- One pass over the bodies, from tail to head, with the velocities in registers, gives the bias force
  of all of them (`accelerations`). A 3x3 solve follows, as in `recursion.floating_base`.

Vectors are in axes of body 0 (base axes), or, with the endings _t and _n, in those of a body. Of
body 0 the rows of the joint are those of a joint that stays straight. `S` and `b` are as in
`recursion`.

A template (see `templates`), loaded anew for every specialization of `loads`.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import compile_scalar, kernel
from laticauda.compiling.formulas import rows_from
from laticauda.compiling.functions import sincos
from laticauda.compiling.templates import bindings
from laticauda.models.planar import number_types
from laticauda.models.planar.rows import *

_specialization = bindings(__name__)
loads = _specialization["loads"]
recursion = _specialization["recursion"]
zero_like = compile_scalar(number_types.zero_like)
stiff_inertia = rows_from(STIFF_INERTIA, 6)


@kernel
def prepare(S, n):
    """Set the rows that do not change during a run."""
    b = HEADER_ROWS
    zero = zero_like(S[b + LENGTH])
    S[b + JOINT_COS] = 1.0 + zero
    S[b + JOINT_SIN] = zero
    S[b + ANGLE] = zero
    S[b + RATE] = zero
    S[b + REFERENCE_2] = zero
    ahead = zero
    for k in range(n):
        b = HEADER_ROWS + (n - 1 - k) * BODY_ROWS
        S[b + MEAN_ARM] = S[b + FIRST_MOMENT_SHARE] + ahead * S[b + LENGTH]
        ahead += S[b + MASS_SHARE]


@kernel
def turned(c, s, x, y):
    """Return a vector in axes that are turned by an angle, given its cosine and sine."""
    return c * x + s * y, c * y - s * x


@kernel
def compute_shape(S, n):
    """Set the rows of the shape from ANGLE, RATE and REFERENCE_2 of every joint.

    In the header they are those from TURN on, of a body those from JOINT_COS to ARM_N.
    """
    zero = zero_like(S[HEADING])
    c = 1.0 + zero
    s = zero
    arm_t = zero
    arm_n = zero
    rate = zero
    acceleration = zero
    turn = zero, zero, zero
    mean = zero, zero, zero, zero, zero, zero
    inertia = zero, zero, zero, zero, zero, zero
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        if i > 0:
            turn = add_turn(turn, S, b)
            rate += S[b + RATE]
            acceleration += S[b + REFERENCE_2]
            joint_s, joint_c = sincos(S[b + ANGLE])
            S[b + JOINT_COS] = joint_c
            S[b + JOINT_SIN] = joint_s
            c, s = c * joint_c - s * joint_s, s * joint_c + c * joint_s
            length_behind = S[b - BODY_ROWS + LENGTH]
            arm_t, arm_n = turned(joint_c, joint_s, arm_t + length_behind, arm_n)
        S[b + SHAPE_COS] = c
        S[b + SHAPE_SIN] = s
        S[b + ARM_T] = arm_t
        S[b + ARM_N] = arm_n
        mean = add_to_center(mean, S[b + MEAN_ARM], c, s, rate, acceleration)
        inertia = add_inertia(inertia, S, b, c, s, arm_t, arm_n)
    for k, number in enumerate((*turn, *mean)):
        S[TURN + k] = number
    for k, number in enumerate(inertia):
        S[STIFF_INERTIA + k] = number


@kernel
def add_turn(turn, S, b):
    """Return the mean angle of the links, its rate and acceleration, with what a joint adds to them."""
    angle, rate, acceleration = turn
    share = S[b + HEADING_SHARE]
    angle += share * S[b + ANGLE]
    rate += share * S[b + RATE]
    acceleration += share * S[b + REFERENCE_2]
    return angle, rate, acceleration


@kernel
def add_to_center(mean, arm, c, s, rate, acceleration):
    """Return the rows from MEAN_X to MEAN_AY with what a body adds to them, which lies `arm` along its direction."""
    x, y, v_x, v_y, a_x, a_y = mean
    swing = arm * rate
    along = swing * rate
    across = arm * acceleration
    x += arm * c
    y += arm * s
    v_x -= swing * s
    v_y += swing * c
    a_x -= across * s
    a_x -= along * c
    a_y += across * c
    a_y -= along * s
    return x, y, v_x, v_y, a_x, a_y


@kernel
def add_inertia(inertia, S, b, c, s, arm_t, arm_n):
    """Return the inertia about the tail end of body 0 with that of a body, whose tail end lies `arm` from there."""
    a00, a01, a02, a11, a12, a22 = inertia
    mass_t = S[b + MASS_T]
    mass_n = S[b + MASS_N]
    coupling = S[b + COUPLING]
    of_rotation_t = -mass_t * arm_n
    of_rotation_n = mass_n * arm_t + coupling
    a00 += S[b + INERTIA] + coupling * arm_t
    a00 += of_rotation_n * arm_t - of_rotation_t * arm_n
    a01 += c * of_rotation_t - s * of_rotation_n
    a02 += s * of_rotation_t + c * of_rotation_n
    difference = (mass_n - mass_t) * s
    a11 += mass_t + difference * s
    a12 -= difference * c
    a22 += mass_n - difference * s
    return a00, a01, a02, a11, a12, a22


@kernel
def accelerations(S, n, is_still, keep_all):
    """Compute the accelerations of heading and center of mass; with `keep_all` also what `holding_torques` needs."""
    root_s, root_c = sincos(S[HEADING] - S[TURN])
    spin = S[HEADING_RATE] - S[TURN_RATE]
    v_t, v_n = velocity_of_last(S, root_c, root_s, spin)
    V_x, V_y = turned(root_c, root_s, S[CURRENT_X], S[CURRENT_Y])
    zero = zero_like(spin)
    rate = spin
    acceleration = zero
    a_t = zero
    a_n = zero
    p0 = zero
    p1 = zero
    p2 = zero
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        joint_c = S[b + JOINT_COS]
        joint_s = S[b + JOINT_SIN]
        v_t, v_n = turned(joint_c, joint_s, v_t, v_n)
        a_t, a_n = turned(joint_c, joint_s, a_t, a_n)
        rate += S[b + RATE]
        acceleration += S[b + REFERENCE_2]
        c = S[b + SHAPE_COS]
        s = S[b + SHAPE_SIN]
        if is_still:
            water = loads.still_velocity_terms(S, b, v_t, v_n, rate)
        else:
            V_t, V_n = turned(c, s, V_x, V_y)
            water = loads.uniform_velocity_terms(S, b, V_t, V_n, v_t, v_n, rate)
        x = S[b + CENTER + POSITION_OF]
        drag = loads.drag_at(S, b + CENTER, x, (v_t, v_n + x * rate, rate))
        g, g_t, g_n = bias_of_body(S, b, a_t, a_n, acceleration, rate * rate, water, drag)
        if keep_all:
            S[b + P0] = g
            S[b + P1] = g_t
            S[b + P2] = g_n
        p0 += g
        p0 += S[b + ARM_T] * g_n - S[b + ARM_N] * g_t
        p1 += c * g_t - s * g_n
        p2 += s * g_t + c * g_n
        length = S[b + LENGTH]
        v_n += length * rate
        a_t -= length * (rate * rate)
        a_n += length * acceleration
    rotation, q_x, q_y = recursion.solved((*stiff_inertia(S), p0, p1, p2))
    S[HEADER_ROWS + LINK_ACCELERATION] = rotation
    S[HEADER_ROWS + QX] = q_x
    S[HEADER_ROWS + QY] = q_y
    S[HEADING_ACCELERATION] = rotation + S[TURN_ACCELERATION]
    c_x, c_y = acceleration_of_center(S, rotation, q_x, q_y, spin)
    S[AX], S[AY] = turned(root_c, -root_s, c_x, c_y)


@kernel
def velocity_of_last(S, root_c, root_s, spin):
    """Return the velocity of the tail end of body 0, which turns with the rate `spin`, relative to the current."""
    v_x, v_y = turned(root_c, root_s, S[VX] - S[CURRENT_X], S[VY] - S[CURRENT_Y])
    v_t = v_x - S[MEAN_VX]
    v_t += spin * S[MEAN_Y]
    v_n = v_y - S[MEAN_VY]
    v_n -= spin * S[MEAN_X]
    return v_t, v_n


@kernel
def bias_of_body(S, b, a_t, a_n, acceleration, square, water, drag):
    """Return what moment and force on a body would be if body 0 did not accelerate.

    Args:
        S: Rows.
        b: First row of the body's record.
        a_t: Acceleration of its tail end then, along it.
        a_n: The same across it.
        acceleration: Its angular acceleration then.
        square: Square of its rate.
        water: Load of the accelerated water at its velocity.
        drag: Drag on it.
    """
    f_t, f_n, moment = water
    drag_t, drag_n, drag_moment = drag
    coupling = S[b + COUPLING]
    g_t = S[b + MASS_T] * a_t - S[b + CENTRIPETAL] * square
    g_t -= f_t + drag_t
    g_n = S[b + MASS_N] * a_n + coupling * acceleration
    g_n -= f_n + drag_n
    g = S[b + INERTIA] * acceleration + coupling * a_n
    g -= moment + drag_moment
    return g, g_t, g_n


@kernel
def acceleration_of_center(S, rotation, q_x, q_y, spin):
    """Return the acceleration of the center of mass from that of body 0, at its tail end."""
    square = spin * spin
    twice = 2.0 * spin
    c_x = q_x + S[MEAN_AX]
    c_x -= rotation * S[MEAN_Y]
    c_x -= square * S[MEAN_X]
    c_x -= twice * S[MEAN_VY]
    c_y = q_y + S[MEAN_AY]
    c_y += rotation * S[MEAN_X]
    c_y -= square * S[MEAN_Y]
    c_y += twice * S[MEAN_VX]
    return c_x, c_y


@kernel
def holding_torques(S, n):
    """Compute TOTAL_TORQUE of every joint, after `accelerations` with `keep_all`.

    It is the moment about the joint of all bodies ahead.
    """
    b = HEADER_ROWS
    spin = S[b + LINK_ACCELERATION]
    q_x = S[b + QX]
    q_y = S[b + QY]
    zero = zero_like(spin)
    moment = zero
    f_t = zero
    f_n = zero
    for k in range(n - 1):
        b = HEADER_ROWS + (n - 1 - k) * BODY_ROWS
        a_t, a_n = turned(S[b + SHAPE_COS], S[b + SHAPE_SIN], q_x, q_y)
        a_t -= S[b + ARM_N] * spin
        a_n += S[b + ARM_T] * spin
        coupling = S[b + COUPLING]
        moment += S[b + LENGTH] * f_n  # the force of the bodies ahead acts at the head end
        moment += S[b + P0]
        moment += S[b + INERTIA] * spin + coupling * a_n
        f_t += S[b + P1]
        f_t += S[b + MASS_T] * a_t
        f_n += S[b + P2]
        f_n += S[b + MASS_N] * a_n + coupling * spin
        S[b + TOTAL_TORQUE] = moment
        f_t, f_n = turned(S[b + JOINT_COS], -S[b + JOINT_SIN], f_t, f_n)
