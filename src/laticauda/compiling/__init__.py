"""Compile scalar laws, which are plain Python functions, for the kernels of every model."""

import hashlib
from collections.abc import Callable
from types import CellType, CodeType, FunctionType
from typing import Any, cast

from numba import njit

from laticauda import scalars
from laticauda.compiling import lanes
from laticauda.compiling.lanes import INLINED

# What kernels compute with instead of these, for floats, complex steps and lanes.
_INSTEAD: dict[Any, Any] = {scalars.where: cast(Any, lanes).where, scalars.magnitude: cast(Any, lanes).magnitude}


def kernel(function: Callable[..., Any]) -> Any:
    """Decorator of inner functions: compiled into whatever calls them.

    Args:
        function: Of a kernel.
    """
    return njit(**INLINED)(function)


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a plain scalar function together with the plain functions that it calls.

    Numba itself asks for each of them to be decorated; this way laws stay ordinary Python.

    Args:
        function: Of numbers; it may close over numbers and call functions like itself.
    """
    function = getattr(function, "py_func", function)
    code = function.__code__
    names = dict(function.__globals__)
    for name in code.co_names:
        if isinstance(names.get(name), FunctionType):
            names[name] = _compiled_inner(names[name])
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    cells = [_compiled_inner(cell) if isinstance(cell, FunctionType) else cell for cell in cells]
    closure = tuple(CellType(cell) for cell in cells)
    return kernel(FunctionType(code, names, function.__name__, function.__defaults__, closure))


def fingerprint(function: Callable[..., Any]) -> str:
    """Digest of a function's code, of the values it closes over and of the functions and numbers it refers to.

    Args:
        function: Any Python function, or one that Numba has compiled.
    """
    digest = hashlib.sha256()
    for part in _parts(function, set()):
        digest.update(part.encode())
    return digest.hexdigest()


def _compiled_inner(function: Callable[..., Any]) -> Any:
    return _INSTEAD[function] if function in _INSTEAD else compiled(function)


def _parts(value: Any, seen: set[int]) -> list[str]:
    function = getattr(value, "py_func", value)
    code = getattr(function, "__code__", None)
    if not isinstance(code, CodeType):
        # Modules and other objects count by their type: their text would hold an address.
        return [f"{value!r}" if isinstance(value, int | float | str | tuple) else type(value).__name__]
    if id(code) in seen:
        return []
    seen.add(id(code))
    constants = [c for c in code.co_consts if not isinstance(c, CodeType)]
    parts = [code.co_code.hex(), repr(constants), repr(code.co_names), repr(function.__defaults__)]
    for cell in function.__closure__ or ():
        parts += _parts(cell.cell_contents, seen)
    for name in code.co_names:
        if name in function.__globals__:
            parts += [name, *_parts(function.__globals__[name], seen)]
    return parts
