"""Advance a robot in MuJoCo through time with two fixed-step integrators.

MuJoCo evaluates the dynamics (`mj_forward`: kinematics, inertia with the water's callback,
contacts, accelerations):

- All joints prescribed: classic Runge-Kutta of order 4. At every stage the joints are exactly on
  the reference. Each of them is held by an inertia so large (HOLD) that it accelerates as the
  reference does, whatever acts on it; the residual of its acceleration times that inertia is the
  joint's torque.
- Any joint free (pd, servo, the hinges of a fin that bends): the semi-implicit method of order 3 of
  the planar model (`driven`), which integrates the works too. The first step of a run is divided into
  parts.

`rows` defines the layout of the arrays, `states` how they are moved; `drives` defines what moves the
joints. This is a template (see `compiling.templates`).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

import numpy as np

from laticauda.compiling import entry, kernel
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics.bounds import FARTHEST, STRONGEST
from laticauda.models.spatial.rows import *
from laticauda.models.spatial.states import (
    HOLD,
    copy_numbers,
    evaluate,
    move,
    put_edges,
    select_robot,
    turn_along,
)
from laticauda.water.mujoco import field, forces_after, numbers
from laticauda.water.mujoco.native import contact_force, flags_at, word_at

_specialization = bindings(__name__)
_drives = _specialization["drives"]
driven = _specialization["driven"]
count_work = _drives.count_work
set_reference = _drives.set_reference
set_torques = _drives.set_torques
put_all_on_reference = _drives.put_all_on_reference
count_parts = _drives.shared.count_parts
length_of_part = _drives.shared.length_of_part


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
def finish_rk4(W, spins, hold, qpos, qvel, qacc, B, Z, dt):
    """Finish the step with stages 2 to 4; the accelerations of the first are already in the data. B, Z: scratch."""
    N = W[0][0]
    q0 = B[0]
    v0 = B[1]
    sum_v = B[2]
    sum_a = B[3]
    slope = B[4]
    change = B[5]
    n = N[N_QVEL]
    copy_numbers(qpos, q0)
    keep_edges(W, Z)
    for i in range(n):
        v0[i] = qvel[i]
        sum_v[i] = 0.0
        sum_a[i] = 0.0
        change[i] = 0.0
    for stage in range(4):
        weight = dt / 6.0 if stage == 0 or stage == 3 else dt / 3.0
        ahead = 0.5 * dt if stage < 2 else dt
        for i in range(n):
            slope[i] = qvel[i]
        turn_along(slope, change, spins)
        for i in range(n):
            sum_v[i] += weight * slope[i]
            sum_a[i] += weight * qacc[i]
            change[i] = ahead * slope[i]
        move_edges(W, Z, weight, ahead)
        if stage == 3:
            break
        move(N, qpos, q0, change)
        for i in range(n):
            qvel[i] = v0[i] + ahead * qacc[i]
        put_all_on_reference(W, qpos, qvel, hold, 0.5 * dt if stage != 1 else 0.0)
        evaluate(N)
    finish_edges(W, Z)
    move(N, qpos, q0, sum_v)
    for i in range(n):
        qvel[i] = v0[i] + sum_a[i]
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
def follow_links_of_all(W, order, qpos):
    """Apply `follow_links` to all robots."""
    S = W[1]
    for r in range(len(W[0])):
        N, Y, _, _, _, _, _, q, _ = select_robot(W, r)
        bodies = order[S[r, FIRST_BODY] : S[r + 1, FIRST_BODY]]
        follow_links(N, bodies, qpos[q:], Y[STATE_ROWS : STATE_ROWS + N[N_LINKS]])


@kernel
def measure_holding_torques(W, qacc):
    """Set the torques of prescribed joints, which must overcome the skin, too: it is in MuJoCo's passive forces."""
    for r in range(len(W[0])):
        N, _, _, J, R, U, _, _, v = select_robot(W, r)
        for i in range(len(J)):
            if J[i, LAW] == PRESCRIBED:
                U[i] = HOLD * (R[2, i] - qacc[v + N[N_BASE_QVEL] + i])


@kernel
def count_work_of_all(W, P, qvel, dt):
    """Apply `count_work` to all robots."""
    for r in range(len(W[0])):
        N, X, C, J, _, U, _, _, v = select_robot(W, r)
        count_work(N, X, C, J, U, P[r], qvel[v:], dt)


@kernel
def log_robot(W, r, mass, order, qpos, qvel, sample):
    """Write one robot's sample; return whether its numbers are in bounds."""
    n, y, C, J, R, U, _, q, v = select_robot(W, r)
    links = y[STATE_ROWS : STATE_ROWS + n[N_LINKS]]
    forces = y[STATE_ROWS + n[N_LINKS] :]
    if n[HAS_SCENE] != 0 and C[IS_LED] != 0.0:
        sum_contacts(n, order, forces)
    write_sample(n, y, J, R, U, mass, order, qpos[q:], qvel[v:], links, forces, sample)
    return are_within(qpos, FARTHEST) and are_within(qvel, FARTHEST) and are_within(U, STRONGEST)


@entry
def run(N, S, Y, moving, C, J, mass, order, spins, hold, steps, dt, every, log):
    """Advance all robots of a model by `steps` steps of `dt` and log every `every`-th one, first and last included.

    N has a row of integers per robot; S holds the start of each robot's part in Y (rows, link
    angles, forces), C, J, order and the log's columns; `moving` is qpos and qvel of all, `spins` the
    first rate of every rotation in them. Returns the number of samples written: fewer than requested
    if numbers left the finite range. With prescribed joints alone, work is counted by the trapezoidal
    rule, from the powers at the start.
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
    K = np.zeros((STAGE_ROWS, len(J)))
    P = np.zeros((n_robots, 4))
    B = np.zeros((driven.SCRATCH_ROWS, n_q))
    G = np.zeros((n_robots, driven.SCRATCH_OF_ROBOT))
    W = (N, S, Y, C, J, R, U, K)
    hold[:] = 0.0
    is_led = C[IS_LED] != 0.0
    implicit = False
    for r in range(n_robots):
        implicit = implicit or N[r, IS_IMPLICIT] != 0
        _, X, C_r, J_r, R_r, _, _, _, _ = select_robot(W, r)
        set_reference(X, C_r, J_r, R_r)
        numbers(M[DATA] + M[AT.time], 1)[0] = X[TIME]
    if is_led:
        put_all_on_reference(W, qpos, qvel, hold, 0.0)
    put_edges(W)
    written = 0
    for step in range(steps + 1):
        is_sample = step % every == 0
        # With prescribed joints alone, this is also the first stage of a step, and work is counted.
        if is_sample or not implicit:
            if is_led:
                set_torques(W, qpos, qvel, hold)
            evaluate(M)
            if is_led:
                measure_holding_torques(W, qacc)
            if not implicit:
                count_work_of_all(W, P, qvel, dt if step > 0 else 0.0)
        follow_links_of_all(W, order, qpos)
        if is_sample:
            for r in range(n_robots):
                bodies = order[S[r, FIRST_BODY] : S[r + 1, FIRST_BODY]]
                sample = log[step // every, S[r, FIRST_COLUMN] : S[r + 1, FIRST_COLUMN]]
                if not log_robot(W, r, mass[r], bodies, qpos, qvel, sample):
                    return written
            written += 1
        if step == steps:
            break
        if not implicit:
            finish_rk4(W, spins, hold, qpos, qvel, qacc, B, G, dt)
            continue
        n_parts = count_parts(Y[TIME], dt)
        for part in range(n_parts):
            length = length_of_part(part, n_parts, dt)
            driven.advance(W, B, G, spins, hold, qpos, qvel, qacc, length)
    copy_numbers(qpos, moving[:n_q])
    copy_numbers(qvel, moving[n_q:])
    return written
