"""Functions that only kernels call: inlined into the kernels, without any code of their own.

Numba prepares every function to be called on its own: machine code, wrappers for calls from Python
and from C, and all of these again for each constant that is passed. Inlined functions need none of
this; without it a kernel compiles in five sixths of the time.

With `laticauda.compiling.lanes`, this is the interface to Numba's compiler.
"""

# pyright: basic

from types import FunctionType, SimpleNamespace
from typing import Any

from numba import config, njit
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.dispatcher import Dispatcher
from numba.core.types import unliteral

from laticauda.values import LaticaudaError

OPTIONS: Any = {"error_model": "numpy", "fastmath": {"contract"}}
"""Options of Numba for all code: of "fast math" only fused multiply-adds, which reorder no operations."""
INLINED: Any = {"forceinline": True, **OPTIONS}
"""Options for functions that are inlined, which lets the compiler optimize whole loops."""


class CompilerIsOff(LaticaudaError, RuntimeError):
    """Raised if the environment keeps Numba from compiling: without its kernels nothing swims."""


class _Code(JITCodeLibrary):
    """Optimized LLVM code without machine code, which is made only for the callers that inline it."""

    # Python objects that machine code would look up at an address.
    codegen: Any = SimpleNamespace(set_env=lambda name, objects: None)

    def _finalize_final_module(self):
        self._finalized = True


class _Compiler(Compiler):
    def define_pipelines(self):
        self.state.library = _Code(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()


def inlined(function: FunctionType, **options: Any) -> Any:
    """Decorate a function that is compiled into its callers and cannot be called from Python.

    Args:
        function: Function of numbers, lanes and rows.
        **options: Further options of Numba.

    Raises:
        CompilerIsOff: If the environment keeps Numba from compiling.
    """
    settings: Any = config
    if settings.DISABLE_JIT:
        raise CompilerIsOff("NUMBA_DISABLE_JIT is set, but kernels must be compiled: unset it.")
    wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    inner: Any = njit(pipeline_class=_Compiler, **wrappers, **INLINED, **options)(function)
    template_of = inner.get_call_template
    # Constants are passed like any numbers, so that the function is not compiled for each of them.
    inner.get_call_template = lambda args, kws: template_of(tuple(map(unliteral, args)), kws)
    return inner


def is_inner(value: Any) -> bool:
    """Return whether an object was returned by `inlined`.

    Args:
        value: Any object.
    """
    return isinstance(value, Dispatcher) and "no_cfunc_wrapper" in value.targetoptions
