"""Functions that only kernels call: inlined into these, and nothing else is made of them.

Numba makes every function ready to be called by itself: machine code, wrappers for calls from Python and from C, and
all of it once more for each constant that somebody passes. Of what is inlined nobody needs any; without it a kernel
compiles in five sixths of the time.

A door to Numba's compiler, with `laticauda.compiling.lanes`.
"""

# pyright: basic

from types import FunctionType, SimpleNamespace
from typing import Any

from numba import njit
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.dispatcher import Dispatcher
from numba.core.types import unliteral

# Contraction to fused multiply-adds is all of "fast math" that is wanted: it does not reorder anything.
OPTIONS: Any = {"error_model": "numpy", "fastmath": {"contract"}}
# Inlining lets the compiler see whole loops.
INLINED: Any = {"forceinline": True, **OPTIONS}


class _Code(JITCodeLibrary):
    """LLVM's code, optimized: of what calls it and holds it, machine code is made."""

    # Python objects that machine code would find at an address.
    codegen: Any = SimpleNamespace(set_env=lambda name, objects: None)

    def _finalize_final_module(self):
        self._finalized = True


class _Compiler(Compiler):
    def define_pipelines(self):
        self.state.library = _Code(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()


def inlined(function: FunctionType, **options: Any) -> Any:
    """Decorator of a function that is compiled into whatever calls it, and not to be called from Python.

    Args:
        function: Of numbers, lanes and rows.
        **options: Further ones of Numba's.
    """
    wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    made: Any = njit(pipeline_class=_Compiler, **wrappers, **INLINED, **options)(function)
    template_of = made.get_call_template
    made.get_call_template = lambda args, kws: template_of(tuple(map(unliteral, args)), kws)
    return made


def is_inner(one: Any) -> bool:
    """Whether it is what `inlined` returned.

    Args:
        one: Anything.
    """
    return isinstance(one, Dispatcher) and "no_cfunc_wrapper" in one.targetoptions
