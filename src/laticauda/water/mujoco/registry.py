"""Which models have water: a mark in the model leads to the table of its water.

A mark is an integer below 2^52 that is stored in the model as a denormal number, so that copies of
the model have it too; its last bits are the index of its row. A row is a mark and the address of a
table. Compiled code finds the rows through the `registry`, whose address the linker fills in.

The table of a model that is gone, or has other water, is kept for a while: its copies still have its
mark.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportCallIssue=false

import ctypes
import secrets
import weakref
from threading import Lock
from typing import Any, NamedTuple

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from laticauda.compiling import kernel
from laticauda.water.mujoco import native
from laticauda.water.mujoco.table import WORD
from laticauda.water.mujoco.vectors import integers

# --- The registry: 64-bit integers of the whole process
PREVIOUS_PASSIVE = 0
"""Address of the passive callback that was there before; 0: none."""
MARK_OFFSET = 1
"""Offset of the mark in a model [bytes]."""
ROWS = 2
"""Address of the rows."""
LOST_WATER = 3
"""Address of the message for a mark without a row."""
PREVIOUS_SENSOR = 4
"""Address of the sensor callback that was there before; 0: none."""
REGISTRY_SIZE = 5
"""Number of its integers."""
registry = np.zeros(REGISTRY_SIZE, dtype=np.int64)

# --- One row; the first row holds the number of rows in place of a mark
MARK = 0
"""Mark of a model; 0: the row is free."""
TABLE = 1
"""Address of the table."""
ROW_COLUMNS = 2
"""Number of integers of a row."""
PLACE_BITS = 24
"""Last bits of a mark: the index of its row."""
MARK_BITS = 52
"""Bits of a mark: so many does the fraction of a denormal number have."""
FIRST_ROWS = 64
"""Number of rows at first; it doubles whenever all are taken."""
MOST_GONE = 4096
"""Number of tables kept, for copies, of models that are gone or have other water."""

_SYMBOL = "laticauda_water_registry"
llvmlite.binding.add_symbol(_SYMBOL, registry.ctypes.data)
_LOST = ctypes.create_string_buffer(
    b"this model has lost its water: an MJB file and a copy of a model that is long gone keep its mark alone; attach "
    b"the water again (a pickled model keeps it), or set model.opt.o_margin = 0 for a model without"
)
_FLOW_LOST = ctypes.create_string_buffer(
    b"this model has lost the flow of its water, which keeps the last 64 that it and its copies were given: set it anew"
)
LOST_FLOW = ctypes.addressof(_FLOW_LOST)
"""Address of the message for a model whose flow is forgotten."""


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
def table_of(model):
    """Return the address of a model's table; 0: no water. A mark without a table ends the step with an error."""
    R = integers(registry_address(), REGISTRY_SIZE)
    mark = native.word_at(model + R[MARK_OFFSET])
    if not 0 < mark < (1 << MARK_BITS):
        return 0
    place = mark & ((1 << PLACE_BITS) - 1)
    row = R[ROWS] + ROW_COLUMNS * WORD * place
    if place >= native.word_at(R[ROWS]) or native.word_at(row) != mark:
        native.stop(R[LOST_WATER])
    return native.word_at(row + TABLE * WORD)


class _Entry(NamedTuple):
    """Water that is registered."""

    water: Any
    """The water, which keeps its table alive."""
    finalizer: Any
    """Finalizer of its model, which adds the mark to those of models that are gone."""


_lock = Lock()
_rows = [np.zeros((FIRST_ROWS, ROW_COLUMNS), dtype=np.int64)]
"""The last array is valid; threads may still read earlier ones."""
_entries: dict[int, _Entry] = {}
"""Registered water by mark."""
_gone: list[int] = []
"""Marks of models that are gone or have other water, the oldest first."""


def publish_rows() -> None:
    """Write into the registry what compiled code needs to find the rows."""
    with _lock:
        _rows[-1][0, MARK] = len(_rows[-1])
        registry[MARK_OFFSET] = native.model_offsets()["o_margin"]
        registry[ROWS] = _rows[-1].ctypes.data
        registry[LOST_WATER] = ctypes.addressof(_LOST)


def find_water(model: Any) -> Any:
    """Return the water whose mark a model has, possibly that of the model it was copied from; None: no water."""
    entry = _entries.get(_mark(model))
    if entry is None:
        return None
    return entry.water


def has_waters() -> bool:
    """Return whether any model that still exists has water."""
    return any(entry.finalizer.alive for entry in list(_entries.values()))


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
        place = _free_place()
        random_bits = secrets.randbits(MARK_BITS - PLACE_BITS - 1) + 1
        mark = random_bits << PLACE_BITS | place
        finalizer = weakref.finalize(model, _gone.append, mark)
        _rows[-1][place] = mark, water.table.ctypes.data
        _entries[mark] = _Entry(water=water, finalizer=finalizer)
    # A margin of less than 1e-307 m has no effect, should anyone use it; every copy of the model
    # keeps it.
    model.opt.o_margin = np.int64(mark).view(np.float64)


def remove_mark(model: Any) -> None:
    """Remove the mark from a model; its copies keep theirs."""
    with _lock:
        _leave(model)
    model.opt.o_margin = 0.0


def _free_place() -> int:
    """Return the index of a free row; if there is none, the rows are copied to an array of twice the size."""
    rows = _rows[-1]
    free = np.flatnonzero(rows[:, MARK] == 0)
    if free.size:
        return int(free[0])
    place = len(rows)
    rows = np.concatenate([rows, np.zeros_like(rows)])
    rows[0, MARK] = len(rows)
    _rows.append(rows)
    registry[ROWS] = rows.ctypes.data
    return place


def _leave(model: Any) -> None:
    """Count a model's water as gone, if the model is the one that the water was attached to."""
    mark = _mark(model)
    entry = _entries.get(mark)
    if entry is not None and entry.water.model() is model and entry.finalizer.detach():
        _gone.append(mark)


def _mark(model: Any) -> int:
    return int(np.float64(model.opt.o_margin).view(np.int64))


def _forget(mark: int) -> None:
    place = mark & ((1 << PLACE_BITS) - 1)
    _rows[-1][place] = 0
    _entries.pop(mark, None)
