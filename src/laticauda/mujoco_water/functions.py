"""Laws that a user brings along, compiled to functions that the water's callback calls by their address."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false

import hashlib
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numba import (
    carray,  # pyright: ignore[reportPrivateImportUsage]
    cfunc,
    types,
)
from numba.core.errors import NumbaError

from laticauda.compiling import compiled, for_python
from laticauda.compiling.formulas import digest_of
from laticauda.compiling.lanes import OPTIONS
from laticauda.compiling.templates import load, sources_digest
from laticauda.fluid.laws import DragLaw

Current: TypeAlias = Callable[[float, float, float, float], tuple[float, ...]]
STEP = 1e-4  # of a field's differences, in m and s
_entries: dict[str, Any] = {}


def compiled_law(law: DragLaw) -> Any:
    """A cfunc of two addresses: of what `table.LOADS` numbers a law gets, its loads behind them, and of its own.

    Raises:
        ValueError: If it cannot be compiled.
    """
    made_of = f"{digest_of(law.formula)} {sources_digest('laticauda.mujoco_water.law_entry')}"
    key = hashlib.sha256(made_of.encode()).hexdigest()[:16]
    if key not in _entries:
        law.check()
        _entries[key] = load(Path(__file__).with_name("law_entry.py"), key, {"law": law.formula}).call
    return _entries[key]


@cache
def compiled_current(current: Current) -> Any:
    """A cfunc of an array: x, y, z, t, and behind them the water's velocity, material acceleration and rotation.

    A function of the velocity alone is differentiated by central differences over `STEP`. For waves of number k that
    is right to (k STEP)^2 / 6 of a derivative, and 1e-12 / STEP of the velocity.

    Raises:
        ValueError: If it cannot be compiled.
    """
    rule = (
        "`current` must be a function of 4 numbers that Numba can compile and that returns 3 numbers, the velocity, or "
        "9: velocity, material acceleration and half the vorticity"
    )
    if not hasattr(getattr(current, "py_func", current), "__code__"):
        raise ValueError(f"{rule}, got {current!r}.")
    try:
        inner = compiled(current)
        result = for_python(inner)(0.0, 0.0, 0.0, 0.0)
        if len(result) not in (3, 9) or not all(math.isfinite(x) for x in result):
            raise ValueError(f"{rule}, got {result!r} from it.")
    except (NumbaError, TypeError) as error:
        raise ValueError(f"{rule}; `{current.__name__}` is not one: {str(error).splitlines()[0]}") from error
    complete = inner if len(result) == 9 else compiled(_differentiated(inner))

    def call(where):
        a = carray(where, (13,), np.float64)
        a[4], a[5], a[6], a[7], a[8], a[9], a[10], a[11], a[12] = complete(a[0], a[1], a[2], a[3])

    return cfunc(types.void(types.CPointer(types.float64)), **OPTIONS)(call)


def _differentiated(flow: Any) -> Callable[..., Any]:
    """Velocity, material acceleration and rotation of a field that gives its velocity."""

    def slopes(x, y, z, t, dx, dy, dz, dt):
        u_1, v_1, w_1 = flow(x + dx, y + dy, z + dz, t + dt)
        u_0, v_0, w_0 = flow(x - dx, y - dy, z - dz, t - dt)
        return 0.5 * (u_1 - u_0) / STEP, 0.5 * (v_1 - v_0) / STEP, 0.5 * (w_1 - w_0) / STEP

    over = compiled(slopes)

    def complete(x, y, z, t):
        u, v, w = flow(x, y, z, t)
        u_x, v_x, w_x = over(x, y, z, t, STEP, 0.0, 0.0, 0.0)
        u_y, v_y, w_y = over(x, y, z, t, 0.0, STEP, 0.0, 0.0)
        u_z, v_z, w_z = over(x, y, z, t, 0.0, 0.0, STEP, 0.0)
        u_t, v_t, w_t = over(x, y, z, t, 0.0, 0.0, 0.0, STEP)
        along_x, along_y = u_t + u * u_x + v * u_y + w * u_z, v_t + u * v_x + v * v_y + w * v_z
        along_z = w_t + u * w_x + v * w_y + w * w_z
        return u, v, w, along_x, along_y, along_z, 0.5 * (w_y - v_z), 0.5 * (u_z - w_x), 0.5 * (v_x - u_y)

    return complete
