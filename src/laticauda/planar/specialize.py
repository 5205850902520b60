"""Compile the kernels for a lane width and a fluid law.

`loads`, `recursion`, `drives` and `stepping` are templates: each reads `WIDTH`, the fluid law and the templates before
it from here while it is loaded, and `specialize` loads them once per combination. A specialization's name carries a
digest of all sources it is made of and of the law's own code, so compiled code on disk is found again by the next
process and is never stale: an edited law, or an edited kernel, has another name and compiles anew.
"""

import functools
import hashlib
import importlib.util
import math
import sys
import threading
from collections.abc import Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any, cast, no_type_check

from numba import njit
from numba.core.errors import NumbaError
from numba.extending import overload

from laticauda import scalars
from laticauda.fluid import laws
from laticauda.planar import lanes
from laticauda.planar.lanes import INLINED, OPTIONS

FluidLaw = Callable[..., tuple[float, float, float]]


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """What the templates are compiled for: how, and what stands in the place of some functions."""

    kernel: Callable[[Callable[..., Any]], Any]
    """Decorator of inner functions."""
    entry: Callable[[Callable[..., Any]], Any]
    """Decorator of entry points."""
    in_lanes: Callable[[Any], Any]
    """Makes of a compiled function of numbers one of lanes."""
    where: Any
    """Of laws, see `scalars.where`."""
    magnitude: Any
    """Of laws, see `scalars.magnitude`."""
    instead: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """What stands in the place of names that the templates import or define."""


_PACKAGE = Path(__file__).parent.parent
_SOURCES = (
    "planar/rows.py",
    "planar/lanes.py",
    "planar/duals.py",
    "planar/functions.py",
    "planar/loads.py",
    "planar/recursion.py",
    "planar/drives.py",
    "planar/stepping.py",
    "planar/specialize.py",
    "scalars.py",
    "fluid/laws.py",
    "actuation/laws.py",
    "gaits/reference.py",
)
_one_at_a_time = threading.Lock()
_loading: dict[str, dict[str, Any]] = {}


def specialize(width: int = 1, fluid_law: FluidLaw = laws.polynomial_drag, target: Target | None = None) -> ModuleType:
    """The stepping kernels for `width` lanes and one fluid law.

    Args:
        width: Number of trials that run side by side in one set of vector registers.
        fluid_law: Function with the signature of `laticauda.fluid.laws.polynomial_drag`; plain Python that Numba can
            compile. What it closes over, and the functions it calls, count as part of it.
        target: What to compile for; None for this machine's processor.

    Returns:
        The module `laticauda.planar.stepping`, compiled for them on first call.
    """
    with _one_at_a_time:
        return _specialize(width, fluid_law, fingerprint(fluid_law), target or PROCESSOR)


def check_law(fluid_law: FluidLaw) -> None:
    """Refuse a fluid law that cannot be compiled, or does not return three finite numbers.

    Raises:
        ValueError: With the reason.
    """
    rule = "`fluid_law` must be a function of the ten numbers of `fluid.laws.polynomial_drag` that Numba can compile"
    if not callable(fluid_law) or not hasattr(getattr(fluid_law, "py_func", fluid_law), "__code__"):
        raise ValueError(f"{rule}, got {fluid_law!r}.")
    try:
        loads: object = compiled(fluid_law)(0.3, -0.2, 0.5, 1.0, 10.0, 0.1, 0.01, 1.0, 1.0, 1.0)
    except (NumbaError, TypeError) as err:
        reason = next((line.strip() for line in reversed(str(err).splitlines()) if line.strip()), type(err).__name__)
        raise ValueError(f"{rule}; `{fluid_law.__name__}` cannot be: {reason}") from err
    if (
        not isinstance(loads, tuple)
        or [isinstance(x, float) and math.isfinite(x) for x in cast(tuple[object, ...], loads)] != [True] * 3
    ):
        raise ValueError(f"`fluid_law` must return three finite numbers, f_t [N], f_n [N] and tau [N m], got {loads}.")


def is_compiled(width: int = 1, fluid_law: FluidLaw = laws.polynomial_drag) -> bool:
    """Whether the machine code for this combination is at hand or on disk; if not, the first run takes seconds."""
    march = specialize(width, fluid_law).run
    return bool(march.signatures) or any(Path(march.stats.cache_path).glob(f"*{march.py_func.__qualname__}-*.nbi"))


@functools.cache
def _specialize(width: int, fluid_law: FluidLaw, law_digest: str, target: Target) -> ModuleType:
    other = "" if target is PROCESSOR else id(target)
    key = hashlib.sha256(f"{width} {law_digest} {_sources_digest()} {other}".encode()).hexdigest()[:16]
    names: dict[str, Any] = {"WIDTH": width, "fluid_law": fluid_law}
    before = _target.set(target)
    try:
        for template in ("loads", "recursion", "drives", "stepping"):
            names[template] = _load(template, key, names)
            for name, value in target.instead.items():
                if hasattr(names[template], name):
                    setattr(names[template], name, value)
    finally:
        _target.reset(before)
    return names["stepping"]


def bindings(module_name: str) -> dict[str, Any]:
    """What the template that is being loaded under this name is specialized for."""
    return _loading[module_name]


def kernel(function: Callable[..., Any]) -> Any:
    """Decorator of a template's inner functions: compiled into whatever calls them."""
    return _target.get().kernel(function)


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a plain scalar function together with the plain functions that it calls.

    Numba itself asks for each of them to be decorated; this way laws stay ordinary Python.
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


def _compiled_inner(function: Callable[..., Any]) -> Any:
    if function is scalars.where or function is scalars.magnitude:
        return getattr(_target.get(), function.__name__)
    return compiled(function)


def in_lanes(function: Any) -> Any:
    """A compiled function of floats that takes lanes too."""
    return _target.get().in_lanes(function)


def _all_or_each(function: Any) -> Any:
    """A compiled function of floats that takes lanes too: all at once if it can, one after the other if it branches."""

    def call(*arguments: Any) -> Any:
        raise NotImplementedError("only kernels call this")

    @overload(call, jit_options=INLINED)
    @no_type_check  # Numba compares this signature with that of the lambdas
    def choose(*arguments):  # pyright: ignore[reportUnusedFunction]
        if any(isinstance(kind, lanes.Lanes) for kind in arguments):
            try:
                function.get_call_template(arguments, {})
            except NumbaError:
                return lambda *arguments: lanes.each_lane(function, arguments)
        return lambda *arguments: function(*arguments)

    return call


def entry(function: Callable[..., Any]) -> Any:
    """Decorator of a template's entry points: what Python calls."""
    return _target.get().entry(function)


def _kept(function: Callable[..., Any]) -> Any:
    """Compile, and keep the machine code on disk.

    Numba files it under the function's qualified name and does not look at what the function calls, so the digest,
    which is the end of the module's name, goes into that name.
    """
    function.__qualname__ += function.__module__[function.__module__.rindex("_") :]
    return njit(cache=True, nogil=True, **OPTIONS)(function)


PROCESSOR = Target(
    kernel=njit(**INLINED),
    entry=_kept,
    in_lanes=_all_or_each,
    where=cast(Any, lanes).where,
    magnitude=cast(Any, lanes).magnitude,
)
_target: ContextVar[Target] = ContextVar("target", default=PROCESSOR)


def fingerprint(function: Callable[..., Any]) -> str:
    """Digest of a function's code, of the values it closes over and of the functions and numbers it refers to."""
    digest = hashlib.sha256()
    for part in _parts(function, set()):
        digest.update(part.encode())
    return digest.hexdigest()


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


@functools.cache
def _sources_digest() -> str:
    digest = hashlib.sha256()
    for source in _SOURCES:
        digest.update((_PACKAGE / source).read_bytes())
    return digest.hexdigest()


def _load(template: str, key: str, names: dict[str, Any]) -> ModuleType:
    name = f"laticauda_{template}_{key}"
    spec = importlib.util.spec_from_file_location(name, Path(__file__).parent / f"{template}.py")
    if spec is None or spec.loader is None:  # pragma: no cover - the file is part of the package
        raise ImportError(f"cannot load the kernel template {template}")
    module = importlib.util.module_from_spec(spec)
    _loading[name] = names
    sys.modules[name] = module
    spec.loader.exec_module(module)
    del _loading[name]
    return module
