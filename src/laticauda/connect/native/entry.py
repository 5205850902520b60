"""Planar kernels without Python: one function with plain pointers, as LLVM code.

The templates that `swim` runs (`laticauda.models.planar.model`) are compiled again, without any part of
Numba's runtime; `laticauda.connect.native.machine_code` generates machine code from the result. The
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
from laticauda.connect.native import link_formulas, sensor_formulas
from laticauda.models.planar import VX, VY, specialize
from laticauda.motion.joints import JointLaw
from laticauda.values import formulas, scalars
from laticauda.water.fluid import MOTION, DragLaw, Element

ENTRY_FUNCTION = "laticauda_move"
"""Name of the function."""

# The array of integers begins with a header. Its first numbers are the shape of the chain.
N_BODIES = 0
"""Position of the number of bodies."""
TAIL_LINK = 1
"""Position of the index of the tail-most link; bodies before it are pieces of the fin."""
HAS_EXTRAS = 2
"""Position of whether any body has loads in addition to its own drag."""
IS_IMPLICIT = 3
"""Position of whether joints are integrated implicitly."""
N_ROWS = 4
"""Position of the number of rows."""

# Then come numbers of variables.
DT = 5
"""Position of the number of the variable that holds the step of the integration."""
HEADING = 6
"""Position of the number of the variable that holds the heading at the start."""
VELOCITY = 7
"""Position of the number of the variable that holds the speed at the start."""

# Then, where other arrays begin in the same array.
FIRST_STRIP = 8
"""Position of where the first strip of every body stands."""
FIRST_PLATE = 9
"""Position of where the first plate of every body stands."""
LAW = 10
"""Position of where the joint laws stand."""

# Then, pieces. A piece is three numbers: where its pairs begin in that array, where their factors
# begin in the array of reals, and the number of pairs.
PIECE_SIZE = 3
TERMS = 11
"""Piece of the products of water coefficients, with their values in the template."""
SLOPES = 14
"""Piece of how rows depend on these products."""
START_ROWS = 17
"""Piece of the rows that variables set at the start."""
INPUT_ROWS = 20
"""Piece of the rows that variables set at every step."""
OUTPUT_ROWS = 23
"""Piece of the variables that are sums of rows."""
SENSORS = 26
"""Position of where the outputs of sensors stand, see `laticauda.connect.native.sensors`."""
LINKS = 27
"""Position of where it stands how links follow from their modules, see `laticauda.connect.native.link_formulas`."""
HEADER = 28
"""Size of the header."""

NONE = -1
"""In place of the number of a variable: the number 1."""
SCRATCH = 2
"""Numbers after the rows: what the kernel logs at the two ends of a step, namely the time."""

OWN: Any = {"_nrt": False}
"""Numba options: nothing may need Numba's runtime."""
_inner = functools.partial(inlined, **OWN)
_ANGLE_FUNCTIONS = frozenset({"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "hypot"})
_POWER_FUNCTIONS = frozenset(
    {
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
)
_OTHER_FUNCTIONS = frozenset({"erf", "fabs", "floor", "fmod", "memcpy", "memset"})
_C_FUNCTIONS = _ANGLE_FUNCTIONS | _POWER_FUNCTIONS | _OTHER_FUNCTIONS
"""Functions that the C library provides."""


def compile_bitcode(
    law: DragLaw, joints: JointLaw, flow: tuple[formulas.Formula, ...] = ()
) -> bytes:
    """Return the LLVM module with the function, for any processor; compiles for seconds, without caching.

    Args:
        law: Law of the loads on one element.
        joints: Law by which the joints follow their references.
        flow: Kinds of parts of the water's flow.

    Raises:
        ValueError: If the law is not plain arithmetic.
    """
    rule = f"a drag law must be plain arithmetic, which needs no Python; `{law.formula.name}`"
    try:
        _compile_law(law)  # the law alone first, which is fast
        move = _build_move(specialize(1, law, joints, flow, native_target()).run)
    except NumbaError as error:
        raise ValueError(f"{rule} is not: {reason_of(error)}.") from error
    missing_functions = _list_missing_functions(move)
    if missing_functions:
        raise ValueError(f"{rule} needs {', '.join(missing_functions)}.")
    return write_bitcode(move, ENTRY_FUNCTION)


def _compile_law(law: DragLaw) -> None:
    n_numbers = MOTION + len(Element._fields) + len(law.formula.fields)
    signature = (types.StarArgUniTuple(types.float64, n_numbers),)
    with compiling_for(native_target()):
        in_numbers(law.formula, Element, MOTION).compile(signature)


def _list_missing_functions(function: Any) -> list[str]:
    """Return the functions that a compiled function needs, and that neither LLVM nor the C library has."""
    module = llvm.parse_assembly(function.inspect_llvm())
    missing_names: set[str] = set()
    for called in module.functions:
        is_intrinsic = called.name.startswith("llvm.")
        if called.is_declaration and not is_intrinsic and called.name not in _C_FUNCTIONS:
            missing_names.add(called.name)
    return sorted(missing_names)


def write_bitcode(function: Any, name: str) -> bytes:
    """Return the LLVM module of a compiled function, with everything else in it internal.

    Args:
        function: Function as returned by Numba's `cfunc` with `OWN`.
        name: Name of the function in the module.
    """
    module = llvm.parse_assembly(function.inspect_llvm())
    for symbol in (*module.functions, *module.global_variables):
        if symbol.is_declaration:
            continue
        is_entry = symbol.name == function.native_name
        symbol.linkage = "external" if is_entry else "internal"
    entry = module.get_function(function.native_name)
    entry.name = name
    entry.visibility = "hidden"
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
        single = context.get_constant(types.intp, 1)
        n_samples = context.get_constant(types.intp, 2)
        size = context.get_constant(types.intp, 8)
        populate_array(
            array,
            data=args[0],
            shape=[n_samples, single, single],
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
        # The flags follow the laws, which are preceded by their number.
        return _beyond(law, law[-1])

    formulas_in_kernels = dict(PROCESSOR.formulas)
    formulas_in_kernels.pop(scalars.table_row, None)
    return Target(
        kernel=_inner,
        entry=_inner,
        in_lanes=PROCESSOR.in_lanes,
        formulas=formulas_in_kernels,
        replacements={"free_joints": free_joints},
    )


# ---- the function --------------------------------------------------------------------------------


write_sensors = _inner(sensor_formulas.write_sensors)
change_links = link_formulas.change_links


@_inner
def _assign(whole, real, piece, v, rows):
    """Set rows that are multiples of variables."""
    pairs = whole[piece]
    factors = whole[piece + 1]
    for k in range(whole[piece + 2]):
        rows[whole[pairs + 2 * k + 1]] = real[factors + k] * v[whole[pairs + 2 * k]]


@_inner
def _begin(whole, real, v, rows):
    """Fill all rows: the template, the terms that depend on water and modules, and the initial state."""
    for q in range(whole[N_ROWS]):
        rows[q] = real[q]
    terms = whole[TERMS]
    values = whole[TERMS + 1]
    pairs = whole[SLOPES]
    slopes = whole[SLOPES + 1]
    for k in range(whole[SLOPES + 2]):
        term = whole[pairs + 2 * k]
        now = v[whole[terms + 2 * term + 1]]
        if whole[terms + 2 * term] != NONE:
            now *= v[whole[terms + 2 * term]]
        rows[whole[pairs + 2 * k + 1]] += real[slopes + k] * (now - real[values + term])
    _assign(whole, real, START_ROWS, v, rows)
    change_links(whole, real, whole[LINKS], v, rows)
    rows[VX] = v[whole[VELOCITY]] * math.cos(v[whole[HEADING]])
    rows[VY] = v[whole[VELOCITY]] * math.sin(v[whole[HEADING]])


@_inner
def _write_outputs(whole, real, rows, v):
    """Set the variables that are sums of rows."""
    pairs = whole[OUTPUT_ROWS]
    factors = whole[OUTPUT_ROWS + 1]
    for k in range(whole[OUTPUT_ROWS + 2]):
        v[whole[pairs + 2 * k]] = 0.0
    for k in range(whole[OUTPUT_ROWS + 2]):
        v[whole[pairs + 2 * k]] += real[factors + k] * rows[whole[pairs + 2 * k + 1]]


def _build_move(run: Any) -> Any:
    """Build the function that reads a robot's variables, runs the kernel's steps, and writes the variables.

    Args:
        run: Kernel that advances the motion.
    """
    reals = types.CPointer(types.float64)
    wholes = types.CPointer(types.int64)
    signature = types.int64(wholes, reals, reals, reals, types.float64)

    @cfunc(signature, **INLINED, **OWN)
    def move(whole, real, v, rows, interval):
        """Start (interval 0), or advance by the interval; return 1, or 0 if the motion diverged."""
        steps = 0
        dt = v[whole[DT]]
        if interval == 0.0:
            _begin(whole, real, v, rows)
        else:
            steps = max(1, math.ceil(interval / dt - 1e-9))
            dt = interval / steps
        _assign(whole, real, INPUT_ROWS, v, rows)
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
        _write_outputs(whole, real, rows, v)
        write_sensors(whole, real, whole[SENSORS], rows, v)
        n_samples = 1 if steps == 0 else 2
        return 1 if written == n_samples else 0

    return move
