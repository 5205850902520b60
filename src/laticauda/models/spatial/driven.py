"""Steps of robots with free joints, by the semi-implicit Runge-Kutta method of order 3 of the planar model.

`dynamics.semi_implicit` has the method, `models.planar.driven` says how a stage is solved: MuJoCo
evaluates the loads and the inertias in the *explicit* state; laws of joints, skins and references
belong to the *implicit* one, and reach MuJoCo as a torque and an inertia per joint.

Scratch of a step: B has a number per degree of freedom in each row, G a row per robot. This is a
template (see `compiling.templates`).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

from laticauda.compiling import kernel
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics.semi_implicit import (
    EXPLICIT_WEIGHTS,
    GAMMA,
    IMPLICIT_WEIGHTS,
    N_STAGES,
    NODES,
    WEIGHTS,
)
from laticauda.models.spatial.rows import *
from laticauda.models.spatial.states import (
    HOLD,
    copy_numbers,
    evaluate,
    move,
    put_edges,
    put_on_reference,
    select_robot,
    turn_along,
)
from laticauda.water.mujoco import numbers

drives = bindings(__name__)["drives"]

LAST = N_STAGES - 1
"""The last stage, whose implicit state is that at the end of the step."""
NEAR = 0.01
"""Change of a joint's rate by which no law departs much from its tangent; an error that is tolerated [rad/s]."""
MOST_SOLUTIONS = 6
"""How often a stage is solved at most."""

# --- Rows of B
START = 0
"""qpos at the begin of the step."""
START_RATE = 1
CHANGE = 2
"""Change of position from the begin to the explicit state."""
COAST = 3
"""Rate in the implicit state without the acceleration of the stage."""
RATES = 4
"""Slopes of position of each stage."""
ACCELERATIONS = RATES + N_STAGES
"""Slopes of rate of each stage."""
SCRATCH_ROWS = ACCELERATIONS + N_STAGES

# --- Columns of G: the rows of a robot's state at the begin of the step, then these
EDGE_RATES = STATE_ROWS
"""Slopes of the state of its edge."""
SCRATCH_OF_ROBOT = EDGE_RATES + N_STAGES


@kernel
def advance(W, B, G, spins, hold, qpos, qvel, qacc, dt):
    """Advance all robots by one step."""
    keep_state(W, B, G, qpos, qvel)
    gamma_dt = GAMMA * dt
    for stage in range(N_STAGES):
        explicit = lengths(EXPLICIT_WEIGHTS[stage], dt)
        implicit = lengths(IMPLICIT_WEIGHTS[stage], dt)
        go_to_stage(W, G, NODES[stage] * dt, explicit)
        place(W[0][0], B, qpos, qvel, explicit, implicit)
        lay_tangents(W, B, hold, qpos, qvel, implicit, stage, gamma_dt)
        for _ in range(MOST_SOLUTIONS):
            evaluate(W[0][0])
            if not turn_tangents(W, hold, qpos, qvel, qacc, gamma_dt):
                break
        keep_slopes(W, B, G, spins, qacc, stage, gamma_dt)
        add_work(W, qvel, qacc, gamma_dt, WEIGHTS[stage] * dt)
    finish(W, B, G, hold, qpos, qvel, dt)


@kernel
def lengths(weights, dt):
    """Return the times for which the slopes of the first three stages act; 0 for those that are not yet known."""
    first, second, third = weights
    return dt * first, dt * second, dt * third


@kernel
def change_by(slopes, first_row, k, lengths):
    """Return the change of number k by the slopes of three stages, in the rows from `first_row` on."""
    first, second, third = lengths
    change = first * slopes[first_row, k]
    change += second * slopes[first_row + 1, k]
    change += third * slopes[first_row + 2, k]
    return change


@kernel
def keep_state(W, B, G, qpos, qvel):
    """Store the state at the begin of the step."""
    copy_numbers(qpos, B[START])
    for k in range(len(qvel)):
        B[START_RATE, k] = qvel[k]
    for r in range(len(W[0])):
        _, X, _, _, _, _, _, _, _ = select_robot(W, r)
        copy_numbers(X, G[r, :STATE_ROWS])


@kernel
def go_to_stage(W, G, elapsed, explicit):
    """Advance generators and clocks from the begin of the step to a stage, and the edges to its explicit state."""
    for r in range(len(W[0])):
        N, X, C, J, R, _, _, _, _ = select_robot(W, r)
        copy_numbers(G[r, :WORK_ABSOLUTE], X[:WORK_ABSOLUTE])
        copy_numbers(G[r, PITCH:EDGE_MEMORY], X[PITCH:EDGE_MEMORY])
        drives.advance_generator(N, X, C, J, R, elapsed)
        edge_change = 0.0
        for stage in range(LAST):
            edge_change += explicit[stage] * G[r, EDGE_RATES + stage]
        X[EDGE_MEMORY] = G[r, EDGE_MEMORY] + edge_change
    put_edges(W)


@kernel
def place(N, B, qpos, qvel, explicit, implicit):
    """Put the robots into their explicit state, and store their rates if they coast to the implicit one."""
    for k in range(len(qvel)):
        B[CHANGE, k] = change_by(B, RATES, k, explicit)
        qvel[k] = B[START_RATE, k] + change_by(B, ACCELERATIONS, k, explicit)
        B[COAST, k] = B[START_RATE, k] + change_by(B, ACCELERATIONS, k, implicit)
    move(N, qpos, B[START], B[CHANGE])


@kernel
def lay_tangents(W, B, hold, qpos, qvel, implicit, stage, gamma_dt):
    """Put prescribed joints on their references, and lay the tangents to the laws of all others."""
    for r in range(len(W[0])):
        N, _, C, J, R, _, K, q, v = select_robot(W, r)
        put_on_reference(N, qpos[q:], qvel[v:], J, R, hold[v:])
        for i in range(len(J)):
            if J[i, LAW] == PRESCRIBED:
                continue
            angle = q + N[N_BASE_QPOS] + i
            k = v + N[N_BASE_QVEL] + i
            K[COAST_RATE, i] = B[COAST, k]
            start = B[START, angle] + change_by(B, RATES, k, implicit)
            K[COAST_ANGLE, i] = start + gamma_dt * B[COAST, k]
            K[GUESS, i] = 0.0
            if stage > 0:
                K[GUESS, i] = B[ACCELERATIONS + stage - 1, k]
            drives.lay_tangent(C, J, i, R, K, gamma_dt)
            push(N, J, i, K, hold, k, qpos[angle], qvel[k])


@kernel
def push(N, J, i, K, hold, k, angle, rate):
    """Give MuJoCo a joint's inertia and torque; it takes the skin of the explicit state off itself."""
    hold[k] = K[IMPLICIT, i]
    hold[N[N_QVEL] + k] = K[TOTAL_TORQUE, i] + drives.skin(J, i, angle, rate)


@kernel
def turn_tangents(W, hold, qpos, qvel, qacc, gamma_dt):
    """Turn tangents that laws are off into chords; return whether there were any."""
    is_any_off = False
    for r in range(len(W[0])):
        N, _, C, J, R, _, K, q, v = select_robot(W, r)
        for i in range(len(J)):
            if not drives.is_curved(J[i, LAW]):
                continue
            k = v + N[N_BASE_QVEL] + i
            acceleration = qacc[k]
            if not gamma_dt * abs(acceleration - K[GUESS, i]) > NEAR:
                continue
            torque = drives.torque_along(C, J, i, R, K, acceleration, gamma_dt)
            error = torque - drives.torque_on_tangent(K, i, acceleration)
            inertia = abs(K[IMPLICIT, i]) + J[i, OWN_INERTIA]
            if gamma_dt * abs(error) > NEAR * inertia:
                drives.lay_chord(K, i, acceleration, torque)
                push(N, J, i, K, hold, k, qpos[q + N[N_BASE_QPOS] + i], qvel[k])
                is_any_off = True
    return is_any_off


@kernel
def keep_slopes(W, B, G, spins, qacc, stage, gamma_dt):
    """Store the slopes of the stage: rates in the implicit state along the axes of the begin, and accelerations."""
    for k in range(len(qacc)):
        B[ACCELERATIONS + stage, k] = qacc[k]
        B[RATES + stage, k] = B[COAST, k] + gamma_dt * qacc[k]
    turn_along(B[RATES + stage], B[CHANGE], spins)
    for r in range(len(W[0])):
        N, _, _, _, _, _, _, _, _ = select_robot(W, r)
        if N[EDGE_RECORD] != 0:
            G[r, EDGE_RATES + stage] = numbers(N[EDGE_RECORD], 2)[1]


@kernel
def add_work(W, qvel, qacc, gamma_dt, duration):
    """Add the work at the powers of a stage for a duration."""
    for r in range(len(W[0])):
        N, X, C, J, R, U, K, _, v = select_robot(W, r)
        for i in range(len(J)):
            k = v + N[N_BASE_QVEL] + i
            if J[i, LAW] == PRESCRIBED:
                U[i] = HOLD * (R[2, i] - qacc[k])
                K[RATE, i] = qvel[k]
            else:
                angle, rate = drives.implicit_state(K, i, qacc[k], gamma_dt)
                torque = drives.torque_on_tangent(K, i, qacc[k])
                U[i] = torque + drives.skin(J, i, angle, rate)
                K[RATE, i] = rate
        for number, power in enumerate(drives.powers(C, J, U, K[RATE])):
            X[WORK_ABSOLUTE + number] += duration * power


@kernel
def finish(W, B, G, hold, qpos, qvel, dt):
    """Put all robots into the implicit state of the last stage, where the step ends."""
    for k in range(len(qvel)):
        change, change_of_rate = 0.0, 0.0
        for stage in range(N_STAGES):
            change += WEIGHTS[stage] * B[RATES + stage, k]
            change_of_rate += WEIGHTS[stage] * B[ACCELERATIONS + stage, k]
        B[CHANGE, k] = dt * change
        qvel[k] = B[START_RATE, k] + dt * change_of_rate
    move(W[0][0], qpos, B[START], B[CHANGE])
    for r in range(len(W[0])):
        N, X, _, J, R, _, _, q, v = select_robot(W, r)
        change = 0.0
        for stage in range(N_STAGES):
            change += WEIGHTS[stage] * G[r, EDGE_RATES + stage]
        X[EDGE_MEMORY] = G[r, EDGE_MEMORY] + dt * change
        put_on_reference(N, qpos[q:], qvel[v:], J, R, hold[v:])
    put_edges(W)
