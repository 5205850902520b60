"""Which models have water: the one callback of the process, and the tables that it finds by the marks of the models."""

import ctypes
import secrets
import weakref
from threading import Lock
from typing import Any

import numpy as np

from laticauda.extras import load_mujoco
from laticauda.mujoco_water import loads, native

MOST_GONE = 4096  # so many models' tables are kept when the models are gone or have another water, for their copies
_LOST = ctypes.create_string_buffer(
    b"this model has lost its water: an MJB file and a copy of a model that is long gone keep its mark alone; attach "
    b"the water again (a pickled model keeps it), or set model.opt.o_margin = 0 for a model without"
)
_FLOW_LOST = ctypes.create_string_buffer(
    b"this model has lost the flow of its water, which keeps the last 64 that it and its copies were given: set it anew"
)
FLOW_LOST = ctypes.addressof(_FLOW_LOST)
_lock = Lock()
_previous: list[Any] = []
_rows = [np.zeros((64, 2), dtype=np.int64)]  # the last array holds; threads may still read the ones before
_entries: dict[int, tuple[Any, Any]] = {}  # by mark: the water, and what watches for the end of its model
_gone: list[int] = []


def is_installed() -> bool:
    """Whether the callback is in place: another package may have put its own there."""
    return _current_callback() == loads.callback().address


def _current_callback() -> int:
    return ctypes.c_void_p.in_dll(native.library(), "mjcb_passive").value or 0


def install() -> None:
    """Put the callback in place, in front of one that is there already if that one is compiled too."""
    mujoco = load_mujoco()
    with _lock:
        before = _current_callback()
        if before == loads.callback().address:
            return
        there = mujoco.get_mjcb_passive()
        if there is not None and not hasattr(there, "argtypes"):
            raise ValueError("mjcb_passive must be free or compiled, but a Python function is set there.")
        _rows[-1][0, 0] = len(_rows[-1])
        mark_at = native.model_offsets()["o_margin"]
        loads.registry[:4] = before, mark_at, _rows[-1].ctypes.data, ctypes.addressof(_LOST)
        _previous[:] = [there]
        mujoco.set_mjcb_passive(loads.callback().ctypes)


def entry(model: Any) -> Any:
    """The water whose mark a model has, which may be that of a model that this one is a copy of; None: none."""
    return _entries.get(_mark(model), (None, None))[0]


def enter(model: Any, water: Any) -> None:
    """Set the mark of a water in a model; what was entered for this model before is gone.

    Args:
        model: The `mujoco.MjModel`.
        water: With its `model` and its `table`; it lives as long as its mark holds.
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
            loads.registry[2] = rows.ctypes.data
        mark = (secrets.randbits(loads.MARK_BITS - loads.PLACE_BITS - 1) + 1) << loads.PLACE_BITS | place
        rows[place] = mark, water.table.ctypes.data
        _entries[mark] = water, weakref.finalize(model, _gone.append, mark)
    # A margin of less than 1e-307 m is none, should anyone use it; it goes with every copy of the model.
    model.opt.o_margin = np.int64(mark).view(np.float64)


def leave(model: Any) -> None:
    """Take the mark out of a model; its copies keep theirs."""
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
    _rows[-1][mark & ((1 << loads.PLACE_BITS) - 1)] = 0
    _entries.pop(mark, None)
