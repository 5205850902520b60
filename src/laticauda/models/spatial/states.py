"""The state of all robots in one model, as the kernels find it, move it and evaluate it; `rows` defines the layout."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

from laticauda.compiling import kernel
from laticauda.models.spatial.rows import *
from laticauda.water.mujoco import forward_skip, integrate_positions, numbers

HOLD = 1e8
"""Inertia by which a prescribed joint is held to its reference [kg m^2]."""


@kernel
def copy_numbers(values, target):
    """Copy numbers one by one: with slices, a third of the compiled code would be Numba's messages on unequal sizes."""
    for i in range(len(target)):
        target[i] = values[i]


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
def evaluate(N):
    """Compute the accelerations at the state in the data."""
    forward_skip(N[MODEL], N[DATA], 0, 1)


@kernel
def move(N, qpos, start, change):
    """Set qpos to `start` after a change of position."""
    copy_numbers(start, qpos)
    integrate_positions(N[MODEL], qpos.ctypes.data, change.ctypes.data, 1.0)


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
def put_edges(W):
    """Put the states of the edges of finite span where the water finds them."""
    for r in range(len(W[0])):
        N, X, _, _, _, _, _, _, _ = select_robot(W, r)
        if N[EDGE_RECORD] != 0:
            numbers(N[EDGE_RECORD], 2)[0] = X[EDGE_MEMORY]


@kernel
def turn_along(rate, change, spins):
    """Turn rates of rotations so that they are slopes of the change of orientation since the begin of a step.

    While a body turns about one axis of its own and then about another, the change c of its
    orientation is not the integral of its rate w but of w + c x w / 2 + c x (c x w) / 12; the next
    term is of order 4 in c (Munthe-Kaas, BIT 38, 1998).
    """
    for first in spins:
        c = change[first], change[first + 1], change[first + 2]
        once = cross(c, (rate[first], rate[first + 1], rate[first + 2]))
        twice = cross(c, once)
        for k in range(3):
            rate[first + k] += 0.5 * once[k] + twice[k] / 12.0


@kernel
def cross(a, b):
    """Return the cross product of two vectors."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    return x, y, z
