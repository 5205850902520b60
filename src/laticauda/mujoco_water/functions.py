"""Laws that a user brings along, compiled to functions that the water's callback calls by their address."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false

import math
from collections.abc import Callable
from functools import cache
from typing import Any, TypeAlias

import numpy as np
from numba import (
    carray,  # pyright: ignore[reportPrivateImportUsage]
    cfunc,
    types,
)
from numba.core.errors import NumbaError

from laticauda.compiling import compiled, fingerprint
from laticauda.compiling.lanes import OPTIONS
from laticauda.fluid import laws

FluidLaw: TypeAlias = Callable[..., tuple[float, float, float]]
Current: TypeAlias = Callable[[float, float, float, float], tuple[float, float, float]]
_SIGNATURE = types.void(types.CPointer(types.float64))


def compiled_law(fluid_law: FluidLaw) -> Any:
    """A cfunc of an array: the eleven arguments of a fluid law, and behind them its three results."""
    return _compiled("fluid_law", fluid_law, 11, (0.3, -0.2, 0.5, 1.0, 10.0, 0.1, 0.01, 1.0, 1.0, 1.0, 0.5))


def compiled_current(current: Current) -> Any:
    """A cfunc of an array: x, y, z and t, and behind them the velocity of the water."""
    return _compiled("current", current, 4, (0.0, 0.0, 0.0, 0.0))


def _compiled(name: str, function: Callable[..., Any], n: int, example: tuple[float, ...]) -> Any:
    rule = f"`{name}` must be a function of {n} numbers that Numba can compile and that returns three numbers"
    if not hasattr(getattr(function, "py_func", function), "__code__"):
        raise ValueError(f"{rule}, got {function!r}.")
    try:
        result = function(*example) if function in _BUILT_IN else compiled(function)(*example)
        if len(result) != 3 or not all(math.isfinite(x) for x in result):
            raise ValueError(f"{rule}, got {result!r} from it.")
        return _entry(function, n)
    except (NumbaError, TypeError) as error:
        raise ValueError(f"{rule}; `{function.__name__}` is not one: {str(error).splitlines()[0]}") from error


@cache
def _entry(function: Callable[..., Any], n: int) -> Any:
    if function in _BUILT_IN:
        return cfunc(_SIGNATURE, cache=True, **OPTIONS)(_BUILT_IN[function])
    inner = compiled(function)
    if n == 4:

        def call(where):
            a = carray(where, (7,), np.float64)
            a[4], a[5], a[6] = inner(a[0], a[1], a[2], a[3])

    else:

        def call(where):
            a = carray(where, (14,), np.float64)
            a[11], a[12], a[13] = inner(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10])

    return cfunc(_SIGNATURE, **OPTIONS)(call)


# The laws that come with laticauda have functions of their own, which can be kept on disk.

_polynomial_drag = compiled(laws.polynomial_drag)
_coulomb_friction = compiled(laws.coulomb_friction)


def _call_polynomial_drag(where):
    a = carray(where, (14,), np.float64)
    a[11], a[12], a[13] = _polynomial_drag(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10])


def _call_coulomb_friction(where):
    a = carray(where, (14,), np.float64)
    a[11], a[12], a[13] = _coulomb_friction(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10])


_BUILT_IN: dict[Any, Any] = {
    laws.polynomial_drag: _call_polynomial_drag,
    laws.coulomb_friction: _call_coulomb_friction,
}
for _law, _call in _BUILT_IN.items():
    # Numba files compiled code under the function's qualified name and does not look at what it calls.
    _call.__qualname__ += f"_{fingerprint(_law)[:16]}"
