"""Compile scalar laws, which are plain Python functions, for the kernels of every model."""

import atexit
import dis
import hashlib
import os
import shutil
import tempfile
import warnings
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import CellType, CodeType, FunctionType
from typing import Any, cast, no_type_check

# Before Numba: it catches what Numba says of its variables while it is imported.
from laticauda.compiling.numba_variables import say_unread_variables

from numba import cfunc, config, njit
from numba.core.errors import NumbaError
from numba.extending import overload

from laticauda.values import scalars
from laticauda.values import explain
from laticauda.compiling import functions, lanes
from laticauda.compiling.inner import INLINED, OPTIONS, inlined
from laticauda.compiling.lane_types import Lanes
from laticauda.values import locked


def _find_folder() -> str:
    """Make Numba cache code in a temporary folder of this program and its children if it has no writable folder.

    The folder is deleted when the program ends; returns a message about that, empty if Numba uses
    its own folder.
    """
    try:
        njit(cache=True)(_find_folder)
    except RuntimeError:
        folder = tempfile.mkdtemp(prefix="laticauda-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        os.environ["NUMBA_CACHE_DIR"] = cast(Any, config).CACHE_DIR = folder
        return f"compiled kernels are kept in {folder} only until this program ends"
    return ""


say_unread_variables()
_temporary_folder_message = _find_folder()


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """Compilation target of kernels: its decorators, and replacements for some functions."""

    kernel: Callable[[Callable[..., Any]], Any]
    """Decorator of inner functions and scalar laws, which only kernels call."""
    entry: Callable[[Callable[..., Any]], Any]
    """Decorator of entry points."""
    in_lanes: Callable[[Any], Any]
    """Converts a compiled function of numbers to one of lanes."""
    formulas: Mapping[Any, Any]
    """Replacements for functions that laws call, such as those of `scalars`."""
    replacements: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Replacements for names that the kernel templates import or define."""
    functions: dict[Any, Any] = field(default_factory=dict[Any, Any])
    """Functions compiled for this target, keyed by what they were made from."""


def kernel(function: FunctionType) -> Any:
    """Decorate an inner function: it is compiled into its callers and cannot be called from Python.

    Args:
        function: Inner function of a kernel.
    """
    return _target.get().kernel(function)


def compile_scalar(function: FunctionType) -> Any:
    """Compile a plain scalar function for kernels, together with the plain functions that it calls.

    Numba itself requires each of them to be decorated; with this function, laws stay ordinary
    Python.

    Args:
        function: Function of numbers; it may close over numbers and call functions of the same
            kind.
    """
    function = getattr(function, "py_func", function)
    code = function.__code__
    # Machine code on disk names the module of every function in it; all of these must exist when it
    # is loaded.
    names: dict[str, Any] = {**function.__globals__, "__name__": __name__}
    for name in globals_of(code):
        if isinstance(names.get(name), FunctionType):
            names[name] = _compile_inner(names[name])
    closure: list[CellType] = []
    for cell in function.__closure__ or ():
        content = cell.cell_contents
        if isinstance(content, FunctionType):
            content = _compile_inner(content)
        closure.append(CellType(content))
    # Numba does not support keyword-only arguments.
    code = code.replace(co_argcount=code.co_argcount + code.co_kwonlyargcount, co_kwonlyargcount=0)
    return kernel(
        FunctionType(code, names, function.__name__, function.__defaults__, tuple(closure))
    )


def _compile_inner(function: Callable[..., Any]) -> Any:
    return _target.get().formulas.get(function) or compile_scalar(function)


def for_python(function: FunctionType) -> Any:
    """Return a version that Python can call of a function that only kernels call.

    Args:
        function: Plain function, or the result of `compile_scalar`.
    """
    return njit(**INLINED)(getattr(function, "py_func", function))


def current_target() -> Target:
    """Return the current compilation target."""
    return _target.get()


def _all_or_each(function: Any) -> Any:
    """Make a compiled function of floats accept lanes: all at once if possible, one by one if the function branches."""

    def call(*arguments: Any) -> Any:
        raise NotImplementedError("only kernels call this")

    @overload(call, jit_options=INLINED)
    @no_type_check  # Numba compares this signature with that of the lambdas
    def choose(*arguments):  # pyright: ignore[reportUnusedFunction]
        if any(isinstance(kind, Lanes) for kind in arguments):
            try:
                function.get_call_template(arguments, {})
            except NumbaError:
                return lambda *arguments: lanes.each_lane(function, arguments)
        return lambda *arguments: function(*arguments)

    return call


def entry(function: FunctionType) -> Any:
    """Decorate an entry point, which Python calls.

    Args:
        function: Function of a module whose name ends in a digest of everything that it is made of.
    """
    return _target.get().entry(function)


def _compile_and_cache(function: Callable[..., Any]) -> Any:
    """Compile a function and cache the machine code on disk.

    Numba stores the code under the function's qualified name and ignores what the function calls,
    so the digest at the end of the module's name is added to that name.
    """
    function.__qualname__ += "_" + function.__module__.rpartition("_")[2]
    return compile_once_across_processes(cast(FunctionType, function))


def compile_once_across_processes(function: FunctionType) -> Any:
    """Compile a function only once if several processes need it at the same time; the others load the cached code.

    Args:
        function: Function whose machine code is cached on disk.
    """
    compiled: Any = njit(cache=True, nogil=True, **OPTIONS)(function)
    compile_now = compiled.compile

    def compile_or_load(signature: Any) -> Any:
        lock = Path(compiled.stats.cache_path) / f"{compiled.py_func.__qualname__}.lock"
        with locked(lock, wait=True):
            machine_code = compile_now(signature)
        if _temporary_folder_message and compiled.stats.cache_misses:
            warnings.warn(
                f"{_temporary_folder_message}; set NUMBA_CACHE_DIR to a writable folder",
                stacklevel=2,
            )
        return machine_code

    compiled.compile = compile_or_load
    return compiled


def for_c(signature: Any, function: FunctionType) -> Any:
    """Compile a function that C calls and cache the machine code on disk.

    Processes take turns, see `compile_once_across_processes`.

    Args:
        signature: Signature in Numba's types.
        function: Function whose name ends in a digest of everything that it is made of.
    """
    folder = Path(cast(Any, njit(cache=True)(function)).stats.cache_path)
    with locked(folder / f"{function.__qualname__}.lock", wait=True):
        return cfunc(signature, cache=True, **OPTIONS)(function)


_DEFINED_FOR_LANES = (
    scalars.where,
    scalars.magnitude,
    scalars.first_lane,
    scalars.table_row,
)
"""Functions that `lanes` defines anew, under the same names."""
PROCESSOR = Target(
    kernel=inlined,
    entry=_compile_and_cache,
    in_lanes=_all_or_each,
    formulas={
        scalars.tanh: functions.tanh,
        **{function: getattr(lanes, function.__name__) for function in _DEFINED_FOR_LANES},
    },
)
"""This machine's processor."""
_target: ContextVar[Target] = ContextVar("target", default=PROCESSOR)


@contextmanager
def compiling_for(target: Target) -> Generator[None]:
    """Compile for a target other than this machine's processor within a `with` block.

    Args:
        target: Target to compile for.
    """
    token = _target.set(target)
    try:
        yield
    finally:
        _target.reset(token)


def fingerprint(function: Callable[..., Any]) -> str:
    """Return the digest of a function's code, the values it closes over and the functions and numbers it refers to.

    Args:
        function: Any Python function, or one that Numba has compiled.
    """
    digest = hashlib.sha256()
    for part in _parts(function, set()):
        digest.update(part.encode())
    return digest.hexdigest()


def _parts(value: Any, visited: set[int]) -> list[str]:
    """Return texts that represent a function, or anything that it refers to."""
    function = getattr(value, "py_func", value)
    code = getattr(function, "__code__", None)
    if not isinstance(code, CodeType):
        if isinstance(value, int | float | str | tuple):
            return [f"{value!r}"]
        # Modules and other objects are represented by their type, because their text would contain
        # an address.
        return [type(value).__name__]
    if id(code) in visited:
        return []
    visited.add(id(code))
    parts = [*_text_of(code), repr(function.__defaults__)]
    for cell in function.__closure__ or ():
        parts += _parts(cell.cell_contents, visited)
    for name in globals_of(code):
        if name in function.__globals__:
            parts += [name, *_parts(function.__globals__[name], visited)]
    return parts


def _text_of(code: CodeType) -> list[str]:
    constants = [constant for constant in code.co_consts if not isinstance(constant, CodeType)]
    parts = [code.co_code.hex(), repr(constants), repr(code.co_names)]
    for inner_code in _inner_codes(code):
        parts += _text_of(inner_code)
    return parts


def _inner_codes(code: CodeType) -> list[CodeType]:
    """Return the code of functions that are defined inside a function."""
    return [constant for constant in code.co_consts if isinstance(constant, CodeType)]


@cache
def globals_of(code: CodeType) -> list[str]:
    """Return the global names that code refers to, once each; attribute names, as in `self.exponent`, do not count.

    Args:
        code: Code of a function.
    """
    names = [
        instruction.argval
        for instruction in dis.get_instructions(code)
        if instruction.opname == "LOAD_GLOBAL"
    ]
    for inner_code in _inner_codes(code):
        names += globals_of(inner_code)
    return list(dict.fromkeys(names))


explain(globals())
