"""Planar kernels without Python: one function with plain pointers, as LLVM code.

The templates that `swim` runs (`laticauda.models.planar.model`) are compiled again, without any part of
Numba's runtime; `laticauda.connect.native.platforms` generates machine code from the result. The
function does not depend on the robot: the two arrays of `laticauda.connect.native.tables` describe
the robot, and map its numbers to variables.

This module and `laticauda.compiling.lanes` are the interface to the code generation of Numba and
LLVM.
"""

# pyright: basic
# pyright: reportCallIssue=false

import functools
import math
from typing import Any

import llvmlite.binding as llvm
from numba import cfunc, types
from numba.core.errors import NumbaError
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from laticauda.compiling import INLINED, PROCESSOR, Target, compiling_for, inlined
from laticauda.compiling.formulas import in_numbers, reason_of
from laticauda.models.planar.model import specialize
from laticauda.models.planar.rows import VX, VY
from laticauda.motion.joints.laws import JointLaw
from laticauda.values import formulas, scalars
from laticauda.water.fluid.laws import MOTION, DragLaw, Element

NAME = "laticauda_move"
"""Name of the function."""

# Positions in the array of integers: shape of the chain, variables, and where other arrays begin in
# it.
N_BODIES, TAIL_LINK, HAS_EXTRAS, IS_IMPLICIT, N_ROWS = range(5)
DT, HEADING, VELOCITY = range(5, 8)
FIRST_STRIP, FIRST_PLATE, LAW = range(8, 11)
# A piece is three numbers: where its pairs begin in that array, where their factors begin in the
# array of reals, and the number of pairs. Products of water coefficients, and their values in the
# template; how rows depend on them; rows that variables set at the start; rows that they set at
# every step; variables that are sums of rows.
TERMS, SLOPES, STARTED, HELD, SEEN, HEADER = range(11, 27, 3)
NONE = -1  # in place of a variable: the number 1
# After the rows: what the kernel logs at the two ends of a step, namely the time.
SCRATCH = 2

OWN: Any = {"_nrt": False}
"""Numba options: nothing may need Numba's runtime."""
_inner = functools.partial(inlined, **OWN)
# Functions that the C library provides.
_ANGLES = {"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "hypot"}
_POWERS = {
    "exp",
    "exp2",
    "expm1",
    "log",
    "log2",
    "log10",
    "log1p",
    "pow",
    "sqrt",
    "cbrt",
    "sinh",
    "cosh",
    "tanh",
}
_OF_C = _ANGLES | _POWERS | {"erf", "fabs", "floor", "fmod", "memcpy", "memset"}


def bitcode(law: DragLaw, joints: JointLaw, flow: tuple[formulas.Formula, ...] = ()) -> bytes:
    """Return the LLVM module with the function `NAME`, for any processor; compiles for seconds, without caching.

    Args:
        law: Law of the loads on one element.
        joints: Law by which the joints follow their references.
        flow: Kinds of parts of the water's flow.

    Raises:
        ValueError: If the law is not plain arithmetic.
    """
    rule = f"a drag law must be plain arithmetic, which needs no Python; `{law.formula.name}`"
    try:
        with compiling_for(native_target()):  # the law alone first, which is fast
            count = MOTION + len(Element._fields) + len(law.formula.fields)
            in_numbers(law.formula, Element, MOTION).compile(
                (types.StarArgUniTuple(types.float64, count),)
            )
        move = _move(specialize(1, law, joints, flow, native_target()).run)
    except NumbaError as err:
        raise ValueError(f"{rule} is not: {reason_of(err)}.") from err
    module = llvm.parse_assembly(move.inspect_llvm())
    foreign = {
        f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")
    } - _OF_C
    if foreign:
        raise ValueError(f"{rule} needs {', '.join(sorted(foreign))}.")
    return exported(move, NAME)


def exported(function: Any, name: str) -> bytes:
    """Return the LLVM module of a compiled function, with everything else in it internal.

    Args:
        function: Function as returned by Numba's `cfunc` with `OWN`.
        name: Name of the function in the module.
    """
    module = llvm.parse_assembly(function.inspect_llvm())
    for one in (*module.functions, *module.global_variables):
        if not one.is_declaration:
            one.linkage = "external" if one.name == function.native_name else "internal"
    entry = module.get_function(function.native_name)
    entry.name, entry.visibility = name, "hidden"
    return module.as_bitcode()


# ---- target of the compilation -------------------------------------------------------------------


@intrinsic
def _beyond(typingctx, pointer, count):
    """Return the address `count` numbers further on."""

    def codegen(context, builder, sig, args):
        return builder.gep(args[0], [context.cast(builder, args[1], sig.args[1], types.intp)])

    return pointer(pointer, count), codegen


_LOG = types.Array(types.float64, 3, "C")


@intrinsic
def _log_at(typingctx, numbers):
    """Return a log of two samples of the first logged row at an address: an array that owns no memory."""

    def codegen(context, builder, sig, args):
        array = context.make_array(_LOG)(context, builder)
        one, two, size = (context.get_constant(types.intp, number) for number in (1, 2, 8))
        populate_array(
            array,
            data=args[0],
            shape=[two, one, one],
            strides=[size, size, size],
            itemsize=size,
            meminfo=None,
        )
        return array._getvalue()

    return _LOG(numbers), codegen


@functools.cache
def native_target() -> Target:
    """Return this processor without Python as target; chains are addresses: arrays need Numba's memory management."""

    @_inner
    def free_joints(law):
        return _beyond(
            law, law[-1]
        )  # the flags follow the laws, which are preceded by their number

    return Target(
        kernel=_inner,
        entry=_inner,
        in_lanes=PROCESSOR.in_lanes,
        formulas={
            one: how for one, how in PROCESSOR.formulas.items() if one is not scalars.table_row
        },
        replacements={"free_joints": free_joints},
    )


# ---- the function --------------------------------------------------------------------------------


@_inner
def _assign(whole, real, piece, v, rows):
    """Set rows that are multiples of variables."""
    pairs, factors = whole[piece], whole[piece + 1]
    for k in range(whole[piece + 2]):
        rows[whole[pairs + 2 * k + 1]] = real[factors + k] * v[whole[pairs + 2 * k]]


@_inner
def _begin(whole, real, v, rows):
    """Fill all rows: the template, the terms that depend on the water's coefficients, and the initial state."""
    for q in range(whole[N_ROWS]):
        rows[q] = real[q]
    terms, values, pairs, slopes = whole[TERMS], whole[TERMS + 1], whole[SLOPES], whole[SLOPES + 1]
    for k in range(whole[SLOPES + 2]):
        term = whole[pairs + 2 * k]
        now = v[whole[terms + 2 * term + 1]]
        if whole[terms + 2 * term] != NONE:
            now *= v[whole[terms + 2 * term]]
        rows[whole[pairs + 2 * k + 1]] += real[slopes + k] * (now - real[values + term])
    _assign(whole, real, STARTED, v, rows)
    rows[VX] = v[whole[VELOCITY]] * math.cos(v[whole[HEADING]])
    rows[VY] = v[whole[VELOCITY]] * math.sin(v[whole[HEADING]])


@_inner
def _look(whole, real, rows, v):
    """Set the variables that are sums of rows."""
    pairs, factors = whole[SEEN], whole[SEEN + 1]
    for k in range(whole[SEEN + 2]):
        v[whole[pairs + 2 * k]] = 0.0
    for k in range(whole[SEEN + 2]):
        v[whole[pairs + 2 * k]] += real[factors + k] * rows[whole[pairs + 2 * k + 1]]


def _move(run: Any) -> Any:
    """Build the function that reads a robot's variables, runs the kernel's steps, and writes the variables.

    Args:
        run: Kernel that advances the motion.
    """
    reals, wholes = types.CPointer(types.float64), types.CPointer(types.int64)

    @cfunc(types.int64(wholes, reals, reals, reals, types.float64), **INLINED, **OWN)
    def move(whole, real, v, rows, interval):
        """Start (interval 0), or advance by the interval; return 1, or 0 if the motion diverged."""
        steps, dt = 0, v[whole[DT]]
        if interval == 0.0:
            _begin(whole, real, v, rows)
        else:
            steps = max(1, math.ceil(interval / dt - 1e-9))
            dt = interval / steps
        _assign(whole, real, HELD, v, rows)
        written = run(
            rows,
            whole[N_BODIES],
            _beyond(whole, whole[FIRST_STRIP]),
            _beyond(whole, whole[FIRST_PLATE]),
            _beyond(whole, whole[LAW]),
            whole[TAIL_LINK],
            whole[HAS_EXTRAS] != 0,
            whole[IS_IMPLICIT] != 0,
            steps,
            dt,
            max(1, steps),
            _log_at(_beyond(rows, whole[N_ROWS])),
        )
        _look(whole, real, rows, v)
        return 1 if written == (1 if steps == 0 else 2) else 0

    return move
