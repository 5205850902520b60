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
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, cast

from numba.core.errors import NumbaError

from laticauda.compiling import PROCESSOR, Target, compiled, compiling_for, fingerprint
from laticauda.compiling.sources import is_kept, sources_digest
from laticauda.fluid import laws

FluidLaw = Callable[..., tuple[float, float, float]]


TEMPLATES = ("loads", "recursion", "drives", "stepping")  # each may use those before it
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
    rule = "`fluid_law` must be a function of the eleven numbers of `fluid.laws.polynomial_drag` that Numba can compile"
    if not callable(fluid_law) or not hasattr(getattr(fluid_law, "py_func", fluid_law), "__code__"):
        raise ValueError(f"{rule}, got {fluid_law!r}.")
    try:
        loads: object = compiled(fluid_law)(0.3, -0.2, 0.5, 1.0, 10.0, 0.1, 0.01, 1.0, 1.0, 1.0, 0.5)
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
    return is_kept(specialize(width, fluid_law).run)


@functools.cache
def _specialize(width: int, fluid_law: FluidLaw, law_digest: str, target: Target) -> ModuleType:
    other = "" if target is PROCESSOR else id(target)
    sources = sources_digest(__name__, *(f"laticauda.planar.{template}" for template in TEMPLATES))
    key = hashlib.sha256(f"{width} {law_digest} {sources} {other}".encode()).hexdigest()[:16]
    names: dict[str, Any] = {"WIDTH": width, "fluid_law": fluid_law}
    with compiling_for(target):
        for template in TEMPLATES:
            names[template] = _load(template, key, names)
            for name, value in target.instead.items():
                if hasattr(names[template], name):
                    setattr(names[template], name, value)
    return names["stepping"]


def bindings(module_name: str) -> dict[str, Any]:
    """What the template that is being loaded under this name is specialized for."""
    return _loading[module_name]


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
