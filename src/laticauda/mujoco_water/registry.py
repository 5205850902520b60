"""Which models have water: the one callback of the process, and the tables that it finds by the marks of the models."""

import ctypes
import secrets
import weakref
from threading import Lock
from typing import Any

import numpy as np

from laticauda.errors import BadArgument
from laticauda.extras import load_mujoco
from laticauda.mujoco_water import loads, native

_lock = Lock()
_previous: list[Any] = []
_kept: dict[int, Any] = {}  # what the compiled code reads, by the mark of its model
_gone: list[int] = []  # marks of models that no longer exist; copies of them may


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
            raise ValueError(
                "mjcb_passive must be free or hold a compiled function, but a Python function is set there."
            )
        loads.registry[0] = before
        _previous[:] = [there]
        mujoco.set_mjcb_passive(loads.callback().ctypes)


def enter(model: Any, table: np.ndarray, keep: Any) -> int:
    """Enter a table into the registry, and set its mark in the model.

    Args:
        model: The `mujoco.MjModel`.
        table: See `loads`.
        keep: What must live as long as the table.

    Returns:
        The mark.
    """
    rows = loads.registry[2:-1].reshape(-1, 2)
    with _lock:
        free = np.flatnonzero(rows[1:, 0] == 0) + 1
        if not free.size and _gone:
            _forget(_gone[0])
            free = np.flatnonzero(rows[1:, 0] == 0) + 1
        if not free.size:
            raise BadArgument("model", f"must be one of less than {loads.MOST_MODELS} models with water at a time")
        place = int(free[0])
        mark = secrets.randbits(52 - loads.PLACE_BITS) << loads.PLACE_BITS | place
        rows[place] = mark, table.ctypes.data
        _kept[mark] = (table, keep)
        loads.registry[1] = native.model_offsets()["o_margin"]
    # A margin of less than 1e-307 m is none, should anyone use it; it goes with every copy of the model.
    model.opt.o_margin = np.int64(mark).view(np.float64)
    weakref.finalize(model, _gone.append, mark)
    return mark


def forget(mark: int) -> None:
    """Take the table with this mark out of the registry."""
    with _lock:
        _forget(mark)


def _forget(mark: int) -> None:
    row = loads.registry[2:-1].reshape(-1, 2)[mark & (loads.MOST_MODELS - 1)]
    if row[0] == mark:
        row[:] = 0
    _kept.pop(mark, None)
    if mark in _gone:
        _gone.remove(mark)
