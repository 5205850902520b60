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

Current: TypeAlias = Callable[[float, float, float, float], tuple[float, float, float]]
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
    """A cfunc of an array: x, y, z and t, and behind them the velocity of the water.

    Raises:
        ValueError: If it cannot be compiled.
    """
    rule = "`current` must be a function of 4 numbers that Numba can compile and that returns three numbers"
    if not hasattr(getattr(current, "py_func", current), "__code__"):
        raise ValueError(f"{rule}, got {current!r}.")
    try:
        inner = compiled(current)
        result = for_python(inner)(0.0, 0.0, 0.0, 0.0)
        if len(result) != 3 or not all(math.isfinite(x) for x in result):
            raise ValueError(f"{rule}, got {result!r} from it.")
    except (NumbaError, TypeError) as error:
        raise ValueError(f"{rule}; `{current.__name__}` is not one: {str(error).splitlines()[0]}") from error

    def call(where):
        a = carray(where, (7,), np.float64)
        a[4], a[5], a[6] = inner(a[0], a[1], a[2], a[3])

    return cfunc(types.void(types.CPointer(types.float64)), **OPTIONS)(call)
