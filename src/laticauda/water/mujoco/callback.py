"""The one passive callback of the process, compiled: how the water acts on the models that have it.

It finds a model's table by the mark in the model (`registry`). All vectors of one tree are taken about
the tree's center of mass, in world directions, rotation first, like MuJoCo's own `cdof`, `cvel` and
`crb`.

The scratch array S has, for each body in turn, its acceleration for zero joint accelerations (6
numbers), then, after those of all bodies, its load (6), then its inertia (21): the upper triangle of
K, all of B and the upper triangle of N of [[K, B], [B^T, N]].
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

import ctypes
import warnings
from functools import cache, wraps
from threading import Lock
from typing import Any

from numba import types

from laticauda.compiling import for_c, kernel
from laticauda.compiling.templates import named_after
from laticauda.values import load_mujoco
from laticauda.values.sources import sources_digest
from laticauda.water.mujoco import native
from laticauda.water.mujoco.element_loads import element_load
from laticauda.water.mujoco.registry import (
    PREVIOUS_PASSIVE,
    REGISTRY_SIZE,
    has_waters,
    publish_rows,
    registry,
    registry_address,
    table_of,
)
from laticauda.water.mujoco.table import *
from laticauda.water.mujoco.vectors import field, integers, numbers

SCRATCH = 33
"""Numbers of the scratch array per body."""
LAW_SCRATCH = 16
"""Numbers after those of all bodies: input and output of one law or flow."""


@kernel
def velocity_accelerations(T, data, S):
    """Compute the spatial acceleration of every body for zero joint accelerations."""
    n_bodies = T[N_BODIES]
    n_dofs = T[N_DOFS]
    qvel = field(data, T[AT.qvel], n_dofs)
    cdof_dot = field(data, T[AT.cdof_dot], 6 * n_dofs)
    parent = integers(T[PARENT], n_bodies)
    first = integers(T[FIRST_DOF], n_bodies + 1)
    for k in range(6):
        S[k] = 0.0
    for b in range(1, n_bodies):
        for k in range(6):
            S[6 * b + k] = S[6 * parent[b] + k]
        for j in range(first[b], first[b + 1]):
            for k in range(6):
                S[6 * b + k] += cdof_dot[6 * j + k] * qvel[j]


@kernel
def gather(T, data, S):
    """Sum forces and inertia from the leaves to the root, and apply the forces to the degrees of freedom."""
    n_bodies = T[N_BODIES]
    n_dofs = T[N_DOFS]
    parent = integers(T[PARENT], n_bodies)
    for b in range(n_bodies - 1, 0, -1):
        p = parent[b]
        if p > 0:
            for k in range(6):
                S[6 * (n_bodies + p) + k] += S[6 * (n_bodies + b) + k]
            if T[HAS_INERTIA]:
                for k in range(21):
                    S[12 * n_bodies + 21 * p + k] += S[12 * n_bodies + 21 * b + k]
    body = integers(T[DOF_BODY], n_dofs)
    cdof = field(data, T[AT.cdof], 6 * n_dofs)
    passive = field(data, T[AT.qfrc_passive], n_dofs)
    fluid = field(data, T[AT.qfrc_fluid], n_dofs)
    for j in range(n_dofs):
        force = 0.0
        for k in range(6):
            force += cdof[6 * j + k] * S[6 * (n_bodies + body[j]) + k]
        passive[j] += force
        fluid[j] += force


@kernel
def write_inertia(T, model, data, S):
    """Write M + A into MuJoCo's matrix, from MuJoCo's composite inertias, so that repeating it does no harm."""
    n_bodies = T[N_BODIES]
    n_dofs = T[N_DOFS]
    body = integers(T[DOF_BODY], n_dofs)
    above = integers(T[DOF_PARENT], n_dofs)
    end = integers(T[ROW_END], n_dofs)
    length = integers(T[ROW_LENGTH], n_dofs)
    cdof = field(data, T[AT.cdof], 6 * n_dofs)
    crb = field(data, T[AT.crb], 10 * n_bodies)
    armature = field(model, T[IN_MODEL.dof_armature], n_dofs)
    M = field(data, T[AT.M], end[n_dofs - 1] + 1)
    for i in range(n_dofs):
        c = 6 * i
        C = 10 * body[i]
        A = 12 * n_bodies + 21 * body[i]
        w0 = cdof[c]
        w1 = cdof[c + 1]
        w2 = cdof[c + 2]
        v0 = cdof[c + 3]
        v1 = cdof[c + 4]
        v2 = cdof[c + 5]
        # MuJoCo's composite inertia, and to its off-diagonal parts that of the water
        m0 = crb[C + 6]
        m1 = crb[C + 7]
        m2 = crb[C + 8]
        m = crb[C + 9]
        K01 = crb[C + 3] + S[A + 1]
        K02 = crb[C + 4] + S[A + 2]
        K12 = crb[C + 5] + S[A + 4]
        B00 = S[A + 6]
        B01 = S[A + 7] - m2
        B02 = S[A + 8] + m1
        B10 = S[A + 9] + m2
        B11 = S[A + 10]
        B12 = S[A + 11] - m0
        B20 = S[A + 12] - m1
        B21 = S[A + 13] + m0
        B22 = S[A + 14]
        N01 = S[A + 16]
        N02 = S[A + 17]
        N12 = S[A + 19]
        # angular momentum h and momentum l of all that moves, for a unit velocity of this degree of freedom
        h0 = (crb[C] + S[A]) * w0 + K01 * w1 + K02 * w2 + B00 * v0 + B01 * v1 + B02 * v2
        h1 = K01 * w0 + (crb[C + 1] + S[A + 3]) * w1 + K12 * w2 + B10 * v0 + B11 * v1 + B12 * v2
        h2 = K02 * w0 + K12 * w1 + (crb[C + 2] + S[A + 5]) * w2 + B20 * v0 + B21 * v1 + B22 * v2
        l0 = B00 * w0 + B10 * w1 + B20 * w2 + (m + S[A + 15]) * v0 + N01 * v1 + N02 * v2
        l1 = B01 * w0 + B11 * w1 + B21 * w2 + N01 * v0 + (m + S[A + 18]) * v1 + N12 * v2
        l2 = B02 * w0 + B12 * w1 + B22 * w2 + N02 * v0 + N12 * v1 + (m + S[A + 20]) * v2
        j = i
        for back in range(length[i]):
            d = 6 * j
            value = cdof[d] * h0 + cdof[d + 1] * h1 + cdof[d + 2] * h2
            value += cdof[d + 3] * l0 + cdof[d + 4] * l1 + cdof[d + 5] * l2
            M[end[i] - back] = value
            j = above[j]
        M[end[i]] += armature[i]


@kernel
def add_hold(T, data):
    """Add what the joints' drives require: inertia on the diagonal, and a force, per degree of freedom."""
    n_dofs = T[N_DOFS]
    hold = numbers(T[HOLD], 2 * n_dofs)
    end = integers(T[ROW_END], n_dofs)
    passive = field(data, T[AT.qfrc_passive], n_dofs)
    M = field(data, T[AT.M], end[n_dofs - 1] + 1)
    for i in range(n_dofs):
        M[end[i]] += hold[i]
        passive[i] += hold[n_dofs + i]


@kernel
def collect(T, model, data, S):
    """Compute all bodies' accelerations for zero joint accelerations, and the loads and inertia of all elements."""
    n_bodies = T[N_BODIES]
    n = T[N_ELEMENTS]
    law_io = S[SCRATCH * n_bodies :]
    for k in range(6 * n_bodies, SCRATCH * n_bodies):
        S[k] = 0.0
    velocity_accelerations(T, data, S)
    body = integers(T[ELEMENT_BODY], n)
    E = numbers(T[ELEMENTS], n * ELEMENT_SIZE)
    P = numbers(T[WATER], WATER_SIZE)
    step = native.number_at(model + T[IN_MODEL.timestep])
    for e in range(n):
        element_load(E, e * ELEMENT_SIZE, T, P, S, body[e], model, data, law_io, step)


@kernel
def apply(model, data, table):
    """Apply all loads of one model's water."""
    T = integers(table, TABLE_SIZE)
    native.mark_stack(data)
    n_scratch = SCRATCH * T[N_BODIES] + LAW_SCRATCH
    S = numbers(native.allocate(data, n_scratch), n_scratch)
    collect(T, model, data, S)
    gather(T, data, S)
    if T[HAS_INERTIA]:
        write_inertia(T, model, data, S)
        if T[HOLD] != 0:
            add_hold(T, data)
        native.factor_inertia(model, data)
    native.free_stack(data)


def _passive(model, data):
    previous = integers(registry_address(), REGISTRY_SIZE)[PREVIOUS_PASSIVE]
    table = table_of(model)
    if previous != 0:
        native.call_2(previous, model, data)
    if table != 0:
        apply(model, data, table)


@cache
def callback() -> Any:
    """Return the passive callback for all models with water: a compiled function of the addresses of model and data."""
    return for_c(
        types.void(types.int64, types.int64), named_after(sources_digest(__name__), _passive)
    )


_lock = Lock()
_previous: list[Any] = []
"""The callback that was there before, which must live as long as this one."""


def is_installed() -> bool:
    """Return whether the callback is installed: another package may have replaced it."""
    return _address_of_current_callback() == callback().address


def _address_of_current_callback() -> int:
    return ctypes.c_void_p.in_dll(native.library(), "mjcb_passive").value or 0


def install() -> None:
    """Install the callback, chaining to an existing one if that is compiled too."""
    mujoco = load_mujoco()
    with _lock:
        current_address = _address_of_current_callback()
        if current_address == callback().address:
            return
        previous = mujoco.get_mjcb_passive()
        if previous is not None and not hasattr(previous, "argtypes"):
            raise ValueError(
                "mjcb_passive must be unset or a compiled function, but a Python function is set there."
            )
        publish_rows()
        registry[PREVIOUS_PASSIVE] = current_address
        _previous[:] = [previous]
        mujoco.set_mjcb_passive(callback().ctypes)
        _watch(mujoco)


def _watch(mujoco: Any) -> None:
    """Let `mujoco.set_mjcb_passive` warn when it replaces this callback: no code of ours runs after that."""
    set_callback = mujoco.set_mjcb_passive
    if hasattr(set_callback, "__wrapped__"):
        return

    @wraps(set_callback)
    def set_and_warn(new: Any) -> None:
        was_installed = is_installed()
        set_callback(new)
        if was_installed and not is_installed() and has_waters():
            warnings.warn(
                "models with water have lost it: another callback replaces `mjcb_passive`, through which it acts; "
                "unset that and attach the water again, or let that callback call the one before it",
                stacklevel=2,
            )

    mujoco.set_mjcb_passive = set_and_warn
