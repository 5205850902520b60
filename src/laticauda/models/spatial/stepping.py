"""Advance a robot in MuJoCo through time with two fixed-step integrators.

MuJoCo evaluates the dynamics (`mj_forward`: kinematics, inertia with the water's callback,
contacts, accelerations); with free joints, the steps are those of the planar model:

- All joints prescribed: classic Runge-Kutta of order 4. At every stage the joints are exactly on
  the reference. Each of them is held by an inertia so large (HOLD) that it accelerates as the
  reference does, whatever acts on it; the residual of its acceleration times that inertia is the
  joint's torque.
- Any joint free (pd, servo, the hinges of a fin that bends): ROS2 (see `dynamics.stages`), linearly
  implicit in the joint law, in M + A.

`rows` defines the layout of the arrays; `drives` defines what moves the joints. This is a template
(see `compiling.templates`).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

import numpy as np

from laticauda.compiling import entry, kernel
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics import stages
from laticauda.models.dynamics.stages import FARTHEST, GAMMA, STRONGEST
from laticauda.models.spatial.rows import *
from laticauda.water.mujoco import field, forces_after, forward_skip, integrate_positions, numbers
from laticauda.water.mujoco.native import contact_force, flags_at, word_at

_drives = bindings(__name__)["drives"]
drive_joint = _drives.drive_joint
count_work = _drives.count_work
advance_reference = _drives.advance_reference
set_reference = _drives.set_reference

shared = _drives.shared
W_1 = stages.WEIGHTS[0]
W_2 = stages.WEIGHTS[1]
HOLD = 1e8
"""Inertia by which a prescribed joint is held to its reference [kg m^2]."""


@kernel
def copy_numbers(values, target):
    """Copy numbers one by one: with slices, a third of the compiled code would be Numba's messages on unequal sizes."""
    for i in range(len(target)):
        target[i] = values[i]


@kernel
def evaluate(N):
    """Compute the accelerations at the state in the data."""
    forward_skip(N[MODEL], N[DATA], 0, 1)


@kernel
def put_on_reference(N, qpos, qvel, J, R, hold):
    """Put prescribed joints on the reference and hold them to its acceleration."""
    nq = N[N_BASE_QPOS]
    nv = N[N_BASE_QVEL]
    for i in range(J.shape[0]):
        if J[i, LAW] == PRESCRIBED:
            qpos[nq + i] = R[0, i]
            qvel[nv + i] = R[1, i]
            hold[nv + i] = HOLD
            hold[N[N_QVEL] + nv + i] = HOLD * R[2, i]


@kernel
def set_first_stage(N, qpos, qvel, C, J, R, hold, U, K, gamma_dt):
    """Set torques and implicit terms of the first stage; K stores the slope over angle and the implicit inertia."""
    nq = N[N_BASE_QPOS]
    nv = N[N_BASE_QVEL]
    total = N[N_QVEL]
    for i in range(J.shape[0]):
        if J[i, LAW] == PRESCRIBED:
            continue
        rate = qvel[nv + i]
        torque, slope_p, slope_d = drive_joint(C, J, i, qpos[nq + i], rate, R)
        slope_p += J[i, STIFFNESS]
        slope_d += J[i, DAMPING]
        U[i] = torque
        K[0, i] = slope_p
        K[1, i] = shared.implicit_inertia(slope_p, slope_d, gamma_dt)
        hold[nv + i] = K[1, i]
        hold[total + nv + i] = torque - gamma_dt * slope_p * rate


@kernel
def set_second_stage(N, qpos, qvel, C, J, R, hold, K, first, slope, gamma_dt):
    """Set the torques of the second stage, which is solved for a = k2 + 2 k1."""
    nq = N[N_BASE_QPOS]
    nv = N[N_BASE_QVEL]
    total = N[N_QVEL]
    put_on_reference(N, qpos, qvel, J, R, hold)
    for i in range(J.shape[0]):
        if J[i, LAW] == PRESCRIBED:
            continue
        torque, _, _ = drive_joint(C, J, i, qpos[nq + i], qvel[nv + i], R)
        k = nv + i
        hold[total + k] = shared.second_torque(
            torque, K[0, i], K[1, i], qvel[k], slope[k], first[k], gamma_dt
        )


@kernel
def move(N, qpos, start, velocity, dt):
    """Set qpos to `start` moved with a velocity for dt."""
    copy_numbers(start, qpos)
    integrate_positions(N[MODEL], qpos.ctypes.data, velocity.ctypes.data, dt)


@kernel
def select_robot(W, r):
    """Return one robot's arguments for the functions above; W holds the arguments of `run` for all, and R, U and K."""
    N, S, Y, C, J, R, U, K = W
    s = S[r]
    e = S[r + 1]
    a = s[FIRST_JOINT]
    b = e[FIRST_JOINT]
    state = Y[s[FIRST_STATE] : e[FIRST_STATE]]
    command = C[s[FIRST_COMMAND] : e[FIRST_COMMAND]]
    return N[r], state, command, J[a:b], R[:, a:b], U[a:b], K[:, a:b], s[FIRST_QPOS], s[FIRST_QVEL]


@kernel
def advance(N, X, C, J, R, dt):
    """Advance one robot's generator, and the time in the data, at which the water is evaluated."""
    advance_reference(X, C, J, R, dt)
    numbers(N[DATA] + N[AT.time], 1)[0] = X[TIME]


@kernel
def put_all_on_reference(W, qpos, qvel, hold, dt):
    """Apply `put_on_reference` to all robots, after advancing their generators by dt."""
    for r in range(len(W[0])):
        N, X, C, J, R, _, _, q, v = select_robot(W, r)
        if dt > 0.0:
            advance(N, X, C, J, R, dt)
        put_on_reference(N, qpos[q:], qvel[v:], J, R, hold[v:])


@kernel
def set_first_stage_of_all(W, qpos, qvel, hold, gamma_dt):
    """Apply `set_first_stage` to all robots."""
    for r in range(len(W[0])):
        N, _, C, J, R, U, K, q, v = select_robot(W, r)
        set_first_stage(N, qpos[q:], qvel[v:], C, J, R, hold[v:], U, K, gamma_dt)


@kernel
def put_edges(W):
    """Put the states of the edges of finite span where the water finds them."""
    for r in range(len(W[0])):
        N, X, _, _, _, _, _, _, _ = select_robot(W, r)
        if N[EDGE_RECORD] != 0:
            numbers(N[EDGE_RECORD], 2)[0] = X[EDGE_MEMORY]


@kernel
def keep_edges(W, Z):
    """Store the states of the edges at the start of a step, in Z; the sums of their changes begin at 0."""
    for r in range(len(W[0])):
        _, X, _, _, _, _, _, _, _ = select_robot(W, r)
        Z[r, 0] = X[EDGE_MEMORY]
        Z[r, 1] = 0.0


@kernel
def move_edges(W, Z, weight, ahead):
    """Add the weighted rates of the edges to the sums, and set their states to those at the start moved ahead."""
    for r in range(len(W[0])):
        N, X, _, _, _, _, _, _, _ = select_robot(W, r)
        if N[EDGE_RECORD] != 0:
            rate = numbers(N[EDGE_RECORD], 2)[1]
            Z[r, 1] += weight * rate
            X[EDGE_MEMORY] = Z[r, 0] + ahead * rate
    put_edges(W)


@kernel
def finish_edges(W, Z):
    """Set the states of the edges to those at the start plus the sums."""
    for r in range(len(W[0])):
        _, X, _, _, _, _, _, _, _ = select_robot(W, r)
        X[EDGE_MEMORY] = Z[r, 0] + Z[r, 1]
    put_edges(W)


@kernel
def finish_rk4(W, hold, qpos, qvel, qacc, B, Z, dt):
    """Finish the step with stages 2 to 4; the accelerations of the first are already in the data. B, Z: scratch."""
    N = W[0][0]
    q0 = B[0]
    v0 = B[1]
    sum_v = B[2]
    sum_a = B[3]
    now = B[4]
    n = N[N_QVEL]
    copy_numbers(qpos, q0)
    keep_edges(W, Z)
    for i in range(n):
        v0[i] = qvel[i]
        sum_v[i] = 0.0
        sum_a[i] = 0.0
    for stage in range(4):
        weight = dt / 6.0 if stage == 0 or stage == 3 else dt / 3.0
        ahead = 0.5 * dt if stage < 2 else dt
        for i in range(n):
            sum_v[i] += weight * qvel[i]
            sum_a[i] += weight * qacc[i]
            now[i] = qvel[i]
        move_edges(W, Z, weight, ahead)
        if stage == 3:
            break
        move(N, qpos, q0, now, ahead)
        for i in range(n):
            qvel[i] = v0[i] + ahead * qacc[i]
        put_all_on_reference(W, qpos, qvel, hold, 0.5 * dt if stage != 1 else 0.0)
        evaluate(N)
    finish_edges(W, Z)
    move(N, qpos, q0, sum_v, 1.0)
    for i in range(n):
        qvel[i] = v0[i] + sum_a[i]
    put_all_on_reference(W, qpos, qvel, hold, 0.0)


@kernel
def finish_ros2(W, hold, qpos, qvel, qacc, B, Z, dt):
    """Finish the step, y + h (3/2 k1 + 1/2 k2), from both stages; the accelerations of k1 are already in the data."""
    N = W[0][0]
    q0 = B[0]
    v0 = B[1]
    slope = B[2]
    first = B[3]
    total = B[4]
    n = N[N_QVEL]
    gamma_dt = GAMMA * dt
    copy_numbers(qpos, q0)
    keep_edges(W, Z)
    move_edges(W, Z, 0.5 * dt, dt)  # explicit: the same formula without implicit terms
    for i in range(n):
        v0[i] = qvel[i]
        first[i] = qacc[i]
        slope[i] = qvel[i] + gamma_dt * qacc[i]
    move(N, qpos, q0, slope, dt)
    for i in range(n):
        qvel[i] = v0[i] + dt * first[i]
    for r in range(len(W[0])):
        M, X, C, J, R, _, K, q, v = select_robot(W, r)
        advance(M, X, C, J, R, dt)
        set_second_stage(
            M, qpos[q:], qvel[v:], C, J, R, hold[v:], K, first[v:], slope[v:], gamma_dt
        )
    evaluate(N)
    move_edges(W, Z, 0.5 * dt, 0.0)
    finish_edges(W, Z)
    for i in range(n):
        # As `stages.combined`; a call to it would be contracted differently here and change the
        # last digit.
        second = qacc[i] - 2.0 * first[i]
        second_slope = qvel[i] - 2.0 * slope[i] + gamma_dt * second
        total[i] = W_1 * slope[i] + W_2 * second_slope
        v0[i] += dt * (W_1 * first[i] + W_2 * second)
    move(N, qpos, q0, total, dt)
    copy_numbers(v0, qvel)
    put_all_on_reference(W, qpos, qvel, hold, 0.0)


@kernel
def are_within(values, most):
    """Return whether all values are still plausible for a swimming robot."""
    for i in range(len(values)):
        if not abs(values[i]) < most:
            return False
    return True


@kernel
def follow_links(N, order, qpos, links):
    """Update the angle of every link about the vertical, unwrapped: by less than half a turn."""
    n = N[N_LINKS]
    if N[IS_PLANAR]:
        links[0] = qpos[2]
        for i in range(1, n):
            links[i] = links[i - 1] + qpos[N[N_BASE_QPOS] + i - 1]
        return
    xmat = field(N[DATA], N[AT.xmat], 9 * N[N_BODIES])
    for i in range(n):
        b = 9 * order[i]
        gap = np.arctan2(xmat[b + 3], xmat[b]) - links[i]
        links[i] += gap - 2.0 * np.pi * np.floor(gap / (2.0 * np.pi) + 0.5)


@kernel
def sum_contacts(N, order, forces):
    """Sum the solver's contact forces on every link, world axes; those on the fin count toward the tail link."""
    forces_after(N[MODEL], N[DATA])
    on_body = field(N[DATA], N[AT.cfrc_ext], 6 * N[N_BODIES])
    n = N[N_LINKS]
    forces[:] = 0.0
    for i in range(n + N[N_FIN_BODIES]):
        link = i if i < n else 0
        for k in range(3):
            forces[3 * link + k] += on_body[6 * order[i] + 3 + k]
    if N[N_FLEXES] > 0:
        add_contacts_with_flexes(N, order, forces)


@kernel
def add_contacts_with_flexes(N, order, forces):
    """Add the forces of the contacts whose other side is a flex, which has no geom, to those on every link."""
    first, count, size, geom_offset, frame_offset = N[CONTACTS:GEOM_BODY]
    start = word_at(N[DATA] + first)
    load = np.zeros(6)
    for c in range(flags_at(N[DATA] + count)):
        contact = start + c * size
        geom_1 = flags_at(contact + geom_offset)
        geom_2 = flags_at(contact + geom_offset + 4)
        if (geom_1 < 0) == (geom_2 < 0):
            continue
        body = flags_at(N[GEOM_BODY] + 4 * max(geom_1, geom_2))
        sign = 1.0 if geom_1 < 0 else -1.0  # the load acts on the second side
        contact_force(N[MODEL], N[DATA], np.int32(c), load.ctypes.data)
        frame = numbers(contact + frame_offset, 9)
        for i in range(N[N_LINKS] + N[N_FIN_BODIES]):
            if order[i] == body:
                link = i if i < N[N_LINKS] else 0
                for k in range(3):
                    along = frame[k] * load[0] + frame[3 + k] * load[1] + frame[6 + k] * load[2]
                    forces[3 * link + k] += sign * along


@kernel
def write_sample(N, X, J, R, U, mass, order, qpos, qvel, links, forces, sample):
    """Write one sample of the log: the state's rows, the motion of mass and body, the joints, the forces.

    `mass` is that of every body, 0 for those that are not the robot's; `order` holds the body of
    each link.
    """
    copy_numbers(X, sample[:STATE_ROWS])
    write_center_of_mass(N, mass, order[0], sample[STATE_ROWS:])
    write_attitude(N, order, qpos, links, sample[STATE_ROWS:])
    first_joint = STATE_ROWS + SAMPLE_HEADER + N[N_LINKS]
    copy_numbers(links[: N[N_LINKS]], sample[STATE_ROWS + SAMPLE_HEADER : first_joint])
    first_force = first_joint + 4 * J.shape[0]
    write_joints(N, R, U, qpos, qvel, sample[first_joint:first_force])
    copy_numbers(forces, sample[first_force:])


@kernel
def write_center_of_mass(N, mass, root, motion):
    """Write the center of mass of the robot, whose first body is `root`, and its velocity."""
    bodies = N[N_BODIES]
    com = field(N[DATA], N[AT.subtree_com], 3 * bodies)
    cvel = field(N[DATA], N[AT.cvel], 6 * bodies)
    xipos = field(N[DATA], N[AT.xipos], 3 * bodies)
    c = 3 * root
    total = 0.0
    for k in range(3):
        motion[COM + k] = com[c + k]
        motion[COM_RATE + k] = 0.0
    for b in range(1, bodies):
        rx = xipos[3 * b] - com[c]
        ry = xipos[3 * b + 1] - com[c + 1]
        rz = xipos[3 * b + 2] - com[c + 2]
        wx = cvel[6 * b]
        wy = cvel[6 * b + 1]
        wz = cvel[6 * b + 2]
        motion[COM_RATE] += mass[b] * (cvel[6 * b + 3] + wy * rz - wz * ry)
        motion[COM_RATE + 1] += mass[b] * (cvel[6 * b + 4] + wz * rx - wx * rz)
        motion[COM_RATE + 2] += mass[b] * (cvel[6 * b + 5] + wx * ry - wy * rx)
        total += mass[b]
    for k in range(3):
        motion[COM_RATE + k] /= total


@kernel
def write_attitude(N, order, qpos, links, motion):
    """Write heading, its rate and pitch, which are means over the links, and the orientation of module 0."""
    n = N[N_LINKS]
    cvel = field(N[DATA], N[AT.cvel], 6 * N[N_BODIES])
    xmat = field(N[DATA], N[AT.xmat], 9 * N[N_BODIES])
    heading = 0.0
    heading_rate = 0.0
    pitch = 0.0
    for i in range(n):
        b = order[i]
        x = xmat[9 * b]
        y = xmat[9 * b + 3]
        z = xmat[9 * b + 6]
        wx = cvel[6 * b]
        wy = cvel[6 * b + 1]
        wz = cvel[6 * b + 2]
        heading += links[i]
        pitch -= np.arctan2(z, (x * x + y * y) ** 0.5)
        heading_rate += (x * (wz * x - wx * z) - y * (wy * z - wz * y)) / (x * x + y * y)
    motion[HEADING] = heading / n
    motion[HEADING_RATE] = heading_rate / n
    motion[MEAN_PITCH] = pitch / n
    if N[IS_PLANAR]:
        motion[ORIENTATION] = np.cos(0.5 * links[0])
        motion[ORIENTATION + 1] = 0.0
        motion[ORIENTATION + 2] = 0.0
        motion[ORIENTATION + 3] = np.sin(0.5 * links[0])
    else:
        for k in range(4):
            motion[ORIENTATION + k] = qpos[3 + k]


@kernel
def write_joints(N, R, U, qpos, qvel, joints):
    """Write angle, rate, reference and torque: of all joints between links, then of all others."""
    between_links = N[N_LINKS] - 1
    at = 0
    for first, count in ((0, between_links), (between_links, R.shape[1] - between_links)):
        for i in range(count):
            joints[at + i] = qpos[N[N_BASE_QPOS] + first + i]
            joints[at + count + i] = qvel[N[N_BASE_QVEL] + first + i]
            joints[at + 2 * count + i] = R[0, first + i]
            joints[at + 3 * count + i] = U[first + i]
        at += 4 * count


@kernel
def log_robot(W, r, mass, order, qpos, qvel, qacc, P, dt, sample):
    """Count one robot's work and write its sample (empty between samples); return whether its numbers are in bounds."""
    n, y, C, J, R, U, _, q, v = select_robot(W, r)
    is_led = C[IS_LED] != 0.0
    nv = v + n[N_BASE_QVEL]
    links = y[STATE_ROWS : STATE_ROWS + n[N_LINKS]]
    for i in range(J.shape[0]):
        if is_led and J[i, LAW] == PRESCRIBED:
            # The resistance of the joint's skin is in MuJoCo's passive forces, so the actuator has
            # to overcome it.
            U[i] = HOLD * (R[2, i] - qacc[nv + i])
    follow_links(n, order, qpos[q:], links)
    count_work(n, y, C, J, U, P, qvel[v:], dt)
    if not sample.size:
        return True
    forces = y[STATE_ROWS + n[N_LINKS] :]
    if n[HAS_SCENE] != 0 and is_led:
        sum_contacts(n, order, forces)
    write_sample(n, y, J, R, U, mass, order, qpos[q:], qvel[v:], links, forces, sample)
    return are_within(qpos, FARTHEST) and are_within(qvel, FARTHEST) and are_within(U, STRONGEST)


@entry
def run(N, S, Y, moving, C, J, mass, order, hold, steps, dt, every, log):
    """Advance all robots of a model by `steps` steps of `dt` and log every `every`-th one, first and last included.

    N has a row of integers per robot; S holds the start of each robot's part in Y (rows, link
    angles, forces), C, J, order and the log's columns; `moving` is qpos and qvel of all. Returns
    the number of samples written: fewer than requested if numbers left the finite range. The
    trapezoidal rule for the work starts from the powers at the start.
    """
    M = N[0]
    n_robots = len(N)
    n_q = M[N_QPOS]
    n_v = M[N_QVEL]
    qpos = field(M[DATA], M[AT.qpos], n_q)
    qvel = field(M[DATA], M[AT.qvel], n_v)
    qacc = field(M[DATA], M[AT.qacc], n_v)
    copy_numbers(moving[:n_q], qpos)
    copy_numbers(moving[n_q:], qvel)
    R = np.zeros((3, len(J)))
    U = np.zeros(len(J))
    K = np.zeros((2, len(J)))
    P = np.zeros((n_robots, 4))
    B = np.zeros((5, n_q))
    Z = np.zeros((n_robots, 2))
    W = (N, S, Y, C, J, R, U, K)
    hold[:] = 0.0
    is_led = C[IS_LED] != 0.0
    implicit = False
    for r in range(n_robots):
        implicit = implicit or N[r, IS_IMPLICIT] != 0
        _, X, C_r, J_r, R_r, _, _, _, _ = select_robot(W, r)
        set_reference(X, C_r, J_r, R_r)
        numbers(M[DATA] + M[AT.time], 1)[0] = X[TIME]
    two_ways = implicit and np.any(J[:, LAW] == PRESCRIBED)
    if is_led:
        put_all_on_reference(W, qpos, qvel, hold, 0.0)
    put_edges(W)
    written = 0
    for step in range(steps + 1):
        if is_led:
            gamma_dt = GAMMA * dt if implicit and not two_ways else 0.0
            set_first_stage_of_all(W, qpos, qvel, hold, gamma_dt)
        evaluate(M)
        for r in range(n_robots):
            a = S[r, FIRST_COLUMN]
            b = S[r + 1, FIRST_COLUMN] if step % every == 0 else a
            bodies = order[S[r, FIRST_BODY] : S[r + 1, FIRST_BODY]]
            sample = log[step // every, a:b]
            past = dt if step > 0 else 0.0
            if not log_robot(W, r, mass[r], bodies, qpos, qvel, qacc, P[r], past, sample):
                return written
        written += step % every == 0
        if step == steps:
            break
        if not implicit:
            finish_rk4(W, hold, qpos, qvel, qacc, B, Z, dt)
        else:
            if two_ways:
                # The torques above follow from accelerations, which must not be those of an
                # implicit step.
                set_first_stage_of_all(W, qpos, qvel, hold, GAMMA * dt)
                evaluate(M)
            finish_ros2(W, hold, qpos, qvel, qacc, B, Z, dt)
    copy_numbers(qpos, moving[:n_q])
    copy_numbers(qvel, moving[n_q:])
    return written
