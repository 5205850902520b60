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

from numba import cfunc, config, njit
from numba.core.errors import NumbaError
from numba.extending import overload

from laticauda.values import scalars
from laticauda.values.arguments import explain
from laticauda.compiling import functions, lanes, ready
from laticauda.compiling.inner import INLINED, OPTIONS, inlined
from laticauda.compiling.lane_types import Lanes
from laticauda.values.files import locked


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


_kept_for_now = _find_folder()


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
    instead: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Replacements for names that the kernel templates import or define."""
    made: dict[Any, Any] = field(default_factory=dict[Any, Any])
    """Functions made for this target, keyed by what they were made from."""


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
            names[name] = _compiled_inner(names[name])
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    cells = [_compiled_inner(cell) if isinstance(cell, FunctionType) else cell for cell in cells]
    closure = tuple(CellType(cell) for cell in cells)
    # Numba does not support keyword-only arguments.
    code = code.replace(co_argcount=code.co_argcount + code.co_kwonlyargcount, co_kwonlyargcount=0)
    return kernel(FunctionType(code, names, function.__name__, function.__defaults__, closure))


def _compiled_inner(function: Callable[..., Any]) -> Any:
    return _target.get().formulas.get(function) or compile_scalar(function)


def for_python(function: FunctionType) -> Any:
    """Return a version that Python can call of a function that only kernels call.

    Args:
        function: Plain function, or the result of `compiled`.
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


def _kept(function: Callable[..., Any]) -> Any:
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
    if ready.FOLDER.is_dir():
        compiled._cache = ready.ReadyCache(function)
    compile_now = compiled.compile

    def compile_or_load(signature: Any) -> Any:
        with locked(
            Path(compiled.stats.cache_path) / f"{compiled.py_func.__qualname__}.lock", wait=True
        ):
            found = compile_now(signature)
        if (
            _kept_for_now and compiled.stats.cache_misses
        ):  # the code did not come with the installation
            warnings.warn(
                f"{_kept_for_now}; set NUMBA_CACHE_DIR to a writable folder", stacklevel=2
            )
        return found

    compiled.compile = compile_or_load
    return compiled


def for_c(signature: Any, function: FunctionType) -> Any:
    """Compile a function that C calls and cache the machine code on disk; processes take turns as in `in_turn`.

    Args:
        signature: Signature in Numba's types.
        function: Function whose name ends in a digest of everything that it is made of.
    """
    folder = Path(cast(Any, njit(cache=True)(function)).stats.cache_path)
    with locked(folder / f"{function.__qualname__}.lock", wait=True):
        return cfunc(signature, cache=True, **OPTIONS)(function)


PROCESSOR = Target(
    kernel=inlined,
    entry=_kept,
    in_lanes=_all_or_each,
    formulas={
        scalars.tanh: functions.tanh,
        **{
            one: getattr(lanes, one.__name__)
            for one in (scalars.where, scalars.magnitude, scalars.first_lane, scalars.table_row)
        },
    },
)
_target: ContextVar[Target] = ContextVar("target", default=PROCESSOR)


@contextmanager
def compiling_for(target: Target) -> Generator[None]:
    """Compile for a target other than this machine's processor within a `with` block.

    Args:
        target: Target to compile for.
    """
    before = _target.set(target)
    try:
        yield
    finally:
        _target.reset(before)


def fingerprint(function: Callable[..., Any]) -> str:
    """Return the digest of a function's code, the values it closes over and the functions and numbers it refers to.

    Args:
        function: Any Python function, or one that Numba has compiled.
    """
    digest = hashlib.sha256()
    for part in _parts(function, set()):
        digest.update(part.encode())
    return digest.hexdigest()


def _parts(value: Any, seen: set[int]) -> list[str]:
    function = getattr(value, "py_func", value)
    code = getattr(function, "__code__", None)
    if not isinstance(code, CodeType):
        # Modules and other objects are represented by their type, because their text would contain
        # an address.
        return [
            f"{value!r}" if isinstance(value, int | float | str | tuple) else type(value).__name__
        ]
    if id(code) in seen:
        return []
    seen.add(id(code))
    parts = [*_text_of(code), repr(function.__defaults__)]
    for cell in function.__closure__ or ():
        parts += _parts(cell.cell_contents, seen)
    for name in globals_of(code):
        if name in function.__globals__:
            parts += [name, *_parts(function.__globals__[name], seen)]
    return parts


def _text_of(code: CodeType) -> list[str]:
    constants = [c for c in code.co_consts if not isinstance(c, CodeType)]
    inner = [text for c in code.co_consts if isinstance(c, CodeType) for text in _text_of(c)]
    return [code.co_code.hex(), repr(constants), repr(code.co_names), *inner]


@cache
def globals_of(code: CodeType) -> list[str]:
    """Return the global names that code refers to, once each; attribute names, as in `self.exponent`, do not count.

    Args:
        code: Code of a function.
    """
    own = [one.argval for one in dis.get_instructions(code) if one.opname == "LOAD_GLOBAL"]
    inner = [name for c in code.co_consts if isinstance(c, CodeType) for name in globals_of(c)]
    return list(dict.fromkeys([*own, *inner]))


explain(globals())
