"""The one passive callback of the process, compiled: which models have water, and how it acts on them.

It finds a model's table by the mark in the model. All vectors of one tree are taken about the
tree's center of mass, in world directions, rotation first, like MuJoCo's own `cdof`, `cvel` and
`crb`.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

import ctypes
import secrets
import weakref
from functools import cache
from threading import Lock
from typing import Any

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from laticauda.compiling import for_c, kernel
from laticauda.compiling.templates import named_after, sources_digest
from laticauda.values import load_mujoco
from laticauda.water.mujoco import native
from laticauda.water.mujoco.element_loads import element_load
from laticauda.water.mujoco.table import *
from laticauda.water.mujoco.vectors import field, integers, numbers

# --- The registry: the previous passive callback, the offset of the mark in a model, the address of
# the rows, that of the message for a mark without a row, and the previous sensor callback. A row is
# a mark and the address of a table; the first holds the number of rows. A mark is an integer below
# 2^52, stored in the model as a denormal, so that copies of the model have it too; its last bits
# are the index of its row.
PLACE_BITS, MARK_BITS = 24, 52
REGISTRY_SIZE = 5
registry = np.zeros(REGISTRY_SIZE, dtype=np.int64)
SCRATCH = 33  # numbers per body: acceleration and load (6 each), inertia (21)

_SYMBOL = "laticauda_water_registry"
llvmlite.binding.add_symbol(_SYMBOL, registry.ctypes.data)


@intrinsic
def registry_address(typingctx):
    """Return the address of the registry; the linker fills it in, so that compiled code can be cached on disk."""
    del typingctx

    def codegen(context, builder, signature, arguments):
        module = builder.module
        symbol = module.globals.get(_SYMBOL)
        if symbol is None:
            symbol = ir.GlobalVariable(module, ir.IntType(64), _SYMBOL)
            symbol.linkage = "external"
        return builder.ptrtoint(symbol, ir.IntType(64))

    return types.int64(), codegen


@kernel
def velocity_accelerations(T, data, S):
    """Compute the spatial acceleration of every body for zero joint accelerations."""
    n_bodies, n_dofs = T[N_BODIES], T[N_DOFS]
    qvel, cdof_dot = field(data, T[AT.qvel], n_dofs), field(data, T[AT.cdof_dot], 6 * n_dofs)
    parent, first = integers(T[PARENT], n_bodies), integers(T[FIRST_DOF], n_bodies + 1)
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
    n_bodies, n_dofs = T[N_BODIES], T[N_DOFS]
    parent = integers(T[PARENT], n_bodies)
    for b in range(n_bodies - 1, 0, -1):
        p = parent[b]
        if p > 0:
            for k in range(6):
                S[6 * (n_bodies + p) + k] += S[6 * (n_bodies + b) + k]
            if T[HAS_INERTIA]:
                for k in range(21):
                    S[12 * n_bodies + 21 * p + k] += S[12 * n_bodies + 21 * b + k]
    body, cdof = integers(T[DOF_BODY], n_dofs), field(data, T[AT.cdof], 6 * n_dofs)
    passive, fluid = field(data, T[AT.qfrc_passive], n_dofs), field(data, T[AT.qfrc_fluid], n_dofs)
    for j in range(n_dofs):
        force = 0.0
        for k in range(6):
            force += cdof[6 * j + k] * S[6 * (n_bodies + body[j]) + k]
        passive[j] += force
        fluid[j] += force


@kernel
def write_inertia(T, model, data, S):
    """Write M + A into MuJoCo's matrix, from MuJoCo's composite inertias, so that repeating it does no harm."""
    n_bodies, n_dofs = T[N_BODIES], T[N_DOFS]
    body, above = integers(T[DOF_BODY], n_dofs), integers(T[DOF_PARENT], n_dofs)
    end, length = integers(T[ROW_END], n_dofs), integers(T[ROW_LENGTH], n_dofs)
    cdof, crb = field(data, T[AT.cdof], 6 * n_dofs), field(data, T[AT.crb], 10 * n_bodies)
    armature = field(model, T[IN_MODEL.dof_armature], n_dofs)
    M = field(data, T[AT.M], end[n_dofs - 1] + 1)
    for i in range(n_dofs):
        c, C, A = 6 * i, 10 * body[i], 12 * n_bodies + 21 * body[i]
        w0, w1, w2, v0, v1, v2 = (
            cdof[c],
            cdof[c + 1],
            cdof[c + 2],
            cdof[c + 3],
            cdof[c + 4],
            cdof[c + 5],
        )
        m0, m1, m2, m = crb[C + 6], crb[C + 7], crb[C + 8], crb[C + 9]
        K01, K02, K12 = crb[C + 3] + S[A + 1], crb[C + 4] + S[A + 2], crb[C + 5] + S[A + 4]
        B00, B01, B02 = S[A + 6], S[A + 7] - m2, S[A + 8] + m1
        B10, B11, B12 = S[A + 9] + m2, S[A + 10], S[A + 11] - m0
        B20, B21, B22 = S[A + 12] - m1, S[A + 13] + m0, S[A + 14]
        N01, N02, N12 = S[A + 16], S[A + 17], S[A + 19]
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
    end, passive = integers(T[ROW_END], n_dofs), field(data, T[AT.qfrc_passive], n_dofs)
    M = field(data, T[AT.M], end[n_dofs - 1] + 1)
    for i in range(n_dofs):
        M[end[i]] += hold[i]
        passive[i] += hold[n_dofs + i]


@kernel
def collect(T, model, data, S):
    """Compute all bodies' accelerations for zero joint accelerations, and the loads and inertia of all elements."""
    n_bodies, n = T[N_BODIES], T[N_ELEMENTS]
    law_io = S[SCRATCH * n_bodies :]
    for k in range(6 * n_bodies, SCRATCH * n_bodies):
        S[k] = 0.0
    velocity_accelerations(T, data, S)
    body, E, P = (
        integers(T[ELEMENT_BODY], n),
        numbers(T[ELEMENTS], n * ELEMENT_SIZE),
        numbers(T[WATER], WATER_SIZE),
    )
    step = native.number_at(model + T[IN_MODEL.timestep])
    for e in range(n):
        element_load(E, e * ELEMENT_SIZE, T, P, S, body[e], model, data, law_io, step)


@kernel
def apply(model, data, table):
    """Apply all loads of one model's water."""
    T = integers(table, TABLE_SIZE)
    native.mark_stack(data)
    S = numbers(native.allocate(data, SCRATCH * T[N_BODIES] + 16), SCRATCH * T[N_BODIES] + 16)
    collect(T, model, data, S)
    gather(T, data, S)
    if T[HAS_INERTIA]:
        write_inertia(T, model, data, S)
        if T[HOLD] != 0:
            add_hold(T, data)
        native.factor_inertia(model, data)
    native.free_stack(data)


@kernel
def table_of(model):
    """Return the address of a model's table; 0: no water. A mark without a table ends the step with an error."""
    R = integers(registry_address(), REGISTRY_SIZE)
    mark = native.word_at(model + R[1])
    if not 0 < mark < (1 << MARK_BITS):
        return 0
    place = mark & ((1 << PLACE_BITS) - 1)
    row = R[2] + 16 * place
    if place >= native.word_at(R[2]) or native.word_at(row) != mark:
        native.stop(R[3])
    return native.word_at(row + 8)


def _passive(model, data):
    before, table = native.word_at(registry_address()), table_of(model)
    if before != 0:
        native.call_2(before, model, data)
    if table != 0:
        apply(model, data, table)


@cache
def callback() -> Any:
    """Return the passive callback for all models with water: a compiled function of the addresses of model and data."""
    return for_c(
        types.void(types.int64, types.int64), named_after(sources_digest(__name__), _passive)
    )


MOST_GONE = 4096  # number of tables kept, for copies, of models that are gone or have other water
_LOST = ctypes.create_string_buffer(
    b"this model has lost its water: an MJB file and a copy of a model that is long gone keep its mark alone; attach "
    b"the water again (a pickled model keeps it), or set model.opt.o_margin = 0 for a model without"
)
_FLOW_LOST = ctypes.create_string_buffer(
    b"this model has lost the flow of its water, which keeps the last 64 that it and its copies were given: set it anew"
)
LOST_FLOW = ctypes.addressof(_FLOW_LOST)
_lock = Lock()
_previous: list[Any] = []
_rows = [
    np.zeros((64, 2), dtype=np.int64)
]  # the last array is valid; threads may still read earlier ones
_entries: dict[int, tuple[Any, Any]] = {}  # by mark: the water, and the finalizer of its model
_gone: list[int] = []


def is_installed() -> bool:
    """Return whether the callback is installed: another package may have replaced it."""
    return _current_callback() == callback().address


def _current_callback() -> int:
    return ctypes.c_void_p.in_dll(native.library(), "mjcb_passive").value or 0


def install() -> None:
    """Install the callback, chaining to an existing one if that is compiled too."""
    mujoco = load_mujoco()
    with _lock:
        before = _current_callback()
        if before == callback().address:
            return
        there = mujoco.get_mjcb_passive()
        if there is not None and not hasattr(there, "argtypes"):
            raise ValueError(
                "mjcb_passive must be unset or a compiled function, but a Python function is set there."
            )
        _rows[-1][0, 0] = len(_rows[-1])
        mark_at = native.model_offsets()["o_margin"]
        registry[:4] = before, mark_at, _rows[-1].ctypes.data, ctypes.addressof(_LOST)
        _previous[:] = [there]
        mujoco.set_mjcb_passive(callback().ctypes)


def find_water(model: Any) -> Any:
    """Return the water whose mark a model has, possibly that of the model it was copied from; None: no water."""
    return _entries.get(_mark(model), (None, None))[0]


def enter(model: Any, water: Any) -> None:
    """Set the mark of a water in a model, replacing any previous entry of this model.

    Args:
        model: The `mujoco.MjModel`.
        water: Water with its `model` and `table`; it lives as long as its mark is valid.
    """
    with _lock:
        _leave(model)
        while len(_gone) > MOST_GONE:
            _forget(_gone.pop(0))
        rows = _rows[-1]
        free = np.flatnonzero(rows[:, 0] == 0)
        place = int(free[0]) if free.size else len(rows)
        if place == len(rows):
            rows = np.concatenate([rows, np.zeros_like(rows)])
            rows[0, 0] = len(rows)
            _rows.append(rows)
            registry[2] = rows.ctypes.data
        mark = (secrets.randbits(MARK_BITS - PLACE_BITS - 1) + 1) << PLACE_BITS | place
        rows[place] = mark, water.table.ctypes.data
        _entries[mark] = water, weakref.finalize(model, _gone.append, mark)
    # A margin of less than 1e-307 m has no effect, should anyone use it; every copy of the model
    # keeps it.
    model.opt.o_margin = np.int64(mark).view(np.float64)


def remove_mark(model: Any) -> None:
    """Remove the mark from a model; its copies keep theirs."""
    with _lock:
        _leave(model)
    model.opt.o_margin = 0.0


def _leave(model: Any) -> None:
    mark = _mark(model)
    water, end = _entries.get(mark, (None, None))
    if water is not None and water.model() is model and end.detach():
        _gone.append(mark)


def _mark(model: Any) -> int:
    return int(np.float64(model.opt.o_margin).view(np.int64))


def _forget(mark: int) -> None:
    _rows[-1][mark & ((1 << PLACE_BITS) - 1)] = 0
    _entries.pop(mark, None)
