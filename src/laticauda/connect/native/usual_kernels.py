"""Machine code of the kernels of single runs for the usual laws, for `laticauda.models.planar.kernel_library`.

It is made of what `swim` itself runs, not of `entry`, so that its numbers are the same to the last
digit. LLVM optimizes as it does for `swim`, for the processor of this machine, and only the
instructions are those of a whole family: optimized for the family, other products would be
contracted to fused multiply-adds.
"""

# pyright: basic
# pyright: reportCallIssue=false

from dataclasses import replace
from typing import Any, NamedTuple

import llvmlite.binding as llvm
from numba import njit, types

from laticauda.compiling import PROCESSOR
from laticauda.compiling.inner import OPTIONS
from laticauda.connect.native.linking import link_library
from laticauda.connect.native.machine_code import compile_to_object
from laticauda.connect.native.platforms import C_FOLDER, Platform
from laticauda.models.planar import kernel_library, specialize
from laticauda.models.planar.model import RUN, RUN_PRESCRIBED, TEMPLATES
from laticauda.motion.joints import JointLaw, Prescribed, SpeedServo
from laticauda.values.sources import SourceRecord
from laticauda.water.fluid import DragLaw, PolynomialDrag
from laticauda.water.fluid.laws import CoulombFriction, TotalSpeedDrag, ViscousFriction


class UsualKernel(NamedTuple):
    """A kernel, and the laws that it is compiled for."""

    run_name: str
    """Its name in `stepping`."""
    drag: DragLaw
    """Law of the loads on one element."""
    joints: JointLaw
    """Law by which the joints follow their references."""


PRESCRIBED = Prescribed()
USUAL_KERNELS = (
    UsualKernel(
        run_name=RUN_PRESCRIBED,
        drag=PolynomialDrag(),
        joints=PRESCRIBED,
    ),
    UsualKernel(
        run_name=RUN_PRESCRIBED,
        drag=TotalSpeedDrag(),
        joints=PRESCRIBED,
    ),
    UsualKernel(
        run_name=RUN_PRESCRIBED,
        drag=ViscousFriction(),
        joints=PRESCRIBED,
    ),
    UsualKernel(
        run_name=RUN_PRESCRIBED,
        drag=CoulombFriction(),
        joints=PRESCRIBED,
    ),
    UsualKernel(
        run_name=RUN,
        drag=PolynomialDrag(),
        joints=PRESCRIBED,
    ),
    UsualKernel(
        run_name=RUN,
        drag=TotalSpeedDrag(),
        joints=PRESCRIBED,
    ),
    UsualKernel(
        run_name=RUN,
        drag=TotalSpeedDrag(),
        joints=SpeedServo(),
    ),
    UsualKernel(
        run_name=RUN,
        drag=ViscousFriction(),
        joints=PRESCRIBED,
    ),
    UsualKernel(
        run_name=RUN,
        drag=CoulombFriction(),
        joints=PRESCRIBED,
    ),
)
"""Kernels for the laws that the waters, the grounds and the identified parameters of the presets have.

What is compiled as `RUN` for prescribed joints includes pd control and servos."""
_INTEGERS = types.Array(types.int64, 1, "C")
_LOG = types.Array(types.float64, 3, "C")


def signature_of(n_axes: int) -> tuple[types.Type, ...]:
    """Return the types of the arguments of `stepping.run`.

    Args:
        n_axes: Number of axes of the rows: 1 for one robot, 2 for many.
    """
    return (
        types.Array(types.float64, n_axes, "C"),
        types.int64,
        _INTEGERS,
        _INTEGERS,
        _INTEGERS,
        types.int64,
        types.boolean,
        types.boolean,
        types.int64,
        types.float64,
        types.int64,
        _LOG,
    )


SIGNATURE = signature_of(1)
"""Types for one robot; `kernels.c` passes the same."""


def build_library(
    platform: Platform, features: str, maker: str
) -> tuple[bytes, kernel_library.Contents]:
    """Return the library, and what is in it.

    Args:
        platform: Platform of this machine.
        features: Features of the processors that may use the library, in LLVM's words.
        maker: Digest of the sources of the maker, which the contents state.

    Raises:
        MissingProgram: If there is no C compiler.
        LinkingFailed: If the C compiler fails.
    """
    bitcode = _compile_kernels().as_bitcode()
    machine_code = compile_to_object(bitcode, platform._replace(features=features))
    functions = " ".join(f"F({k})" for k in range(len(USUAL_KERNELS)))
    library = link_library(
        machine_code,
        platform,
        sources=[C_FOLDER / "kernels.c"],
        headers={"kernels.h": f"#define KERNELS {functions}\n"},
    )
    kernels: list[str] = []
    for run_name, drag, joints in USUAL_KERNELS:
        kernels.append(kernel_library.describe_kernel(run_name, drag.formula, joints.own))
    record = SourceRecord.of(*_list_modules())
    return library, kernel_library.Contents(kernels=kernels, record=record, maker=maker)


def _compile_kernels() -> llvm.ModuleRef:
    """Return one LLVM module with all of `USUAL_KERNELS`."""
    target = replace(PROCESSOR, entry=_without_python, functions={})
    modules: list[llvm.ModuleRef] = []
    for k, (run_name, drag, joints) in enumerate(USUAL_KERNELS):
        run: Any = getattr(specialize(1, drag, joints, (), target), run_name)
        run.compile(SIGNATURE)
        modules.append(_module_of(run, f"laticauda_kernel_{k}"))
    linked_module = modules.pop()
    for module in modules:
        linked_module.link_in(module)
    return linked_module


def _list_modules() -> list[str]:
    """Return the modules that the library is made of, with their imports."""
    modules = {f"laticauda.models.planar.{template}" for template in TEMPLATES}
    modules.add(kernel_library.__name__)
    for _, drag, joints in USUAL_KERNELS:
        modules.add(drag.formula.function.__module__)
        modules.add(joints.formula.function.__module__)
    return sorted(modules)


def _without_python(function: Any) -> Any:
    """Decorate an entry point that Python does not call."""
    return njit(nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, **OPTIONS)(function)


def _module_of(run: Any, name: str) -> llvm.ModuleRef:
    """Return the LLVM module of a compiled function, optimized, with everything else in it internal."""
    ((_, result),) = run.overloads.items()
    module = llvm.parse_bitcode(result.library._final_module.as_bitcode())
    native_name = result.fndesc.llvm_func_name
    for symbol in (*module.functions, *module.global_variables):
        if symbol.is_declaration:
            continue
        is_entry = symbol.name == native_name
        symbol.linkage = "external" if is_entry else "internal"
    function = module.get_function(native_name)
    function.name = name
    function.visibility = "hidden"
    return module
