"""Values of ``S[row]`` in the kernels: one number per lane, so that the physics reads as if there were a single trial.

With one lane it is a plain float or complex number. With more it is a vector of floats that the
compiler keeps in a vector register: every statement of the kernels becomes a vector instruction,
independent of whether a compiler would vectorize a loop. Rows of records (`lane_types.dual_row`) hold
`Duals`, in every lane a number with one or several derivatives: complex steps whose squares are
negligible. Arithmetic,
comparisons, `abs`, `min`, `max`, ``** 0.5``, `np.sqrt` and `np.floor` work on such `Lanes`; a
comparison gives a `Mask`, by which `where` selects. A function that branches cannot take lanes;
`each_lane` calls it once per lane.

This is the interface to Numba's extension API; no other module depends on how lanes are
implemented.
"""

# pyright: basic

import functools
import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, lower_cast, overload_attribute, type_callable

from laticauda.compiling import duals
from laticauda.compiling.lane_types import Duals, Lanes, Mask, joined, parted, vector

# ---- arithmetic ----------------------------------------------------------------------------------


@lower_cast(types.Float, Lanes)
@lower_cast(types.Integer, Lanes)
@lower_cast(types.Boolean, Mask)
@lower_cast(Lanes, Duals)
def _broadcast(context, builder, fromty, toty, value):
    if isinstance(toty, Duals):
        real, _ = parted(context, builder, fromty, toty, value)
        return joined(context, builder, toty, (real, None))
    if not isinstance(toty, Mask):
        value = context.cast(builder, value, fromty, toty.dtype)
    return _splat(builder, vector(toty), value)


def _splat(builder, vector, scalar):
    undefined = ir.Constant(vector, ir.Undefined)
    index = ir.IntType(32)
    first = builder.insert_element(undefined, scalar, ir.Constant(index, 0))
    all_first = ir.Constant(ir.VectorType(index, vector.count), None)
    return builder.shuffle_vector(first, undefined, all_first)


def _lanes_among(args):
    """Return the type of the lanes if there are any among the types and all others are numbers; else None."""
    kinds = {a for a in args if isinstance(a, Lanes)}
    if any(isinstance(a, Duals) for a in kinds):
        kinds -= {a.part for a in kinds if isinstance(a, Duals)}
    if len(kinds) == 1 and all(isinstance(a, Lanes | types.Float | types.Integer) for a in args):
        return kinds.pop()
    return None


def _define(function, emit, result=lambda kind: kind, arity=2, dual=None):
    """Define a function of lanes, or of lanes and plain numbers, for the compiler; `emit(builder, kind, *vectors)`.

    `dual(builder, emit, *parts)` does the same for duals; without it the function uses the real
    parts only.
    """

    def typed(*args):
        kind = _lanes_among(args)
        return kind and result(kind)

    @type_callable(function)
    def typing(context):
        if arity == 1:
            return lambda a: typed(a)
        return lambda a, b: typed(a, b)

    def lower(context, builder, sig, args):
        kind = _lanes_among(sig.args)
        if isinstance(kind, Duals):
            parts = [
                parted(context, builder, t, kind, v) for v, t in zip(args, sig.args, strict=True)
            ]
            if dual is None:
                return emit(builder, kind.part, *(real for real, _ in parts))
            emit_part = functools.partial(emit, builder, kind.part)
            return joined(context, builder, kind, dual(builder, emit_part, *parts))
        vectors = [context.cast(builder, v, t, kind) for v, t in zip(args, sig.args, strict=True)]
        return emit(builder, kind, *vectors)

    if arity == 1:
        lower_builtin(function, Lanes)(lower)
        return
    lower_builtin(function, Lanes, Lanes)(lower)
    lower_builtin(function, Lanes, types.Number)(lower)
    lower_builtin(function, types.Number, Lanes)(lower)


def _elementwise(name):
    """Return a function that emits a call to an LLVM intrinsic for floats or vectors of floats."""

    def emit(builder, kind, *values):
        suffix = "f32" if getattr(kind, "dtype", kind) == types.float32 else "f64"
        if isinstance(kind, Lanes):  # a lane of duals alone is a float
            suffix = f"v{kind.width}{suffix}"
        signature = ir.FunctionType(values[0].type, [v.type for v in values])
        return builder.call(
            cgutils.get_or_insert_function(builder.module, signature, f"llvm.{name}.{suffix}"),
            values,
        )

    return emit


def _truth(kind):
    """Return the result type of a comparison of lanes."""
    if kind.width > 1:
        return Mask(kind.width)
    return types.boolean


def _binary(name):
    return lambda builder, kind, a, b: getattr(builder, name)(a, b)


def _comparison(sign):
    compare = "fcmp_unordered" if sign == "!=" else "fcmp_ordered"
    return lambda builder, kind, a, b: getattr(builder, compare)(sign, a, b)


def _picked(sign):
    return lambda builder, kind, a, b: builder.select(builder.fcmp_ordered(sign, a, b), a, b)


for _name, _plain, _in_place, _dual in (
    ("fadd", operator.add, operator.iadd, duals.add),
    ("fsub", operator.sub, operator.isub, duals.subtract),
    ("fmul", operator.mul, operator.imul, duals.multiply),
    ("fdiv", operator.truediv, operator.itruediv, duals.divide),
):
    _define(_plain, _binary(_name), dual=_dual)
    _define(_in_place, _binary(_name), dual=_dual)
_define(operator.pow, _elementwise("pow"), dual=duals.power)
_define(operator.neg, lambda builder, kind, a: builder.fneg(a), arity=1, dual=duals.negate)
_define(operator.pos, lambda builder, kind, a: a, arity=1, dual=lambda builder, emit, a: a)
for _function, _name, _dual in (
    (abs, "fabs", duals.magnitude),
    (np.abs, "fabs", duals.magnitude),
    (np.sqrt, "sqrt", duals.square_root),
    (np.floor, "floor", duals.step),
):
    _define(_function, _elementwise(_name), arity=1, dual=_dual)
for _sign in ("lt", "le", "gt", "ge", "eq", "ne"):
    _symbol = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}[_sign]
    _define(getattr(operator, _sign), _comparison(_symbol), _truth)
_define(min, _picked("<"), dual=duals.pick("<"))
_define(max, _picked(">"), dual=duals.pick(">"))


@intrinsic
def _real_part(typingctx, x):
    return x.part(x), lambda context, builder, sig, args: parted(context, builder, x, x, args[0])[0]


@overload_attribute(Lanes, "real", inline="always")
def _real(x):
    if isinstance(x, Duals):
        return lambda x: _real_part(x)  # pyright: ignore[reportCallIssue]
    return lambda x: x


@intrinsic
def differs(typingctx, x, number):
    """Return whether x differs from a constant: by its value, or because it has a derivative that is not 0."""

    def codegen(context, builder, sig, args):
        real, slopes = args[0], None
        if isinstance(x, types.Complex | Duals):
            real, slopes = parted(context, builder, x, x, args[0])
        constant = context.cast(builder, args[1], number, _type_of_real(x))
        answer = builder.fcmp_unordered("!=", real, constant)
        if slopes is not None:
            zero = ir.Constant(slopes.type, None)
            for has_slope in _by_slope(builder, x, builder.fcmp_unordered("!=", slopes, zero)):
                answer = builder.or_(answer, has_slope)
        return answer

    result = _truth(x) if isinstance(x, Lanes) else types.boolean
    return result(x, number), codegen


def _type_of_real(kind):
    """Return the type of a number without its derivatives."""
    if isinstance(kind, Duals):
        return kind.part
    if isinstance(kind, types.Complex):
        return kind.underlying_float
    return kind


def _by_slope(builder, kind, vector):
    """Return what belongs to the first slopes of all lanes, to the second ones, and so on."""
    n_slopes, width = getattr(kind, "n_slopes", 1), getattr(kind, "width", 1)
    if n_slopes == 1:
        return [vector]
    parts = []
    for k in range(n_slopes):
        places = range(k * width, (k + 1) * width)
        parts.append(_some_of(builder, vector, places))
    return parts


def _some_of(builder, vector, places):
    """Return the elements of a vector at some places: a vector, or the only element."""
    index = ir.IntType(32)
    if len(places) == 1:
        return builder.extract_element(vector, ir.Constant(index, places[0]))
    order = ir.Constant(ir.VectorType(index, len(places)), list(places))
    return builder.shuffle_vector(vector, ir.Constant(vector.type, ir.Undefined), order)


# ---- choices -------------------------------------------------------------------------------------


for _operator, _name in ((operator.and_, "and_"), (operator.or_, "or_"), (operator.xor, "xor")):

    @type_callable(_operator)
    def _type_logic(context):
        return lambda a, b: a if isinstance(a, Mask) and a == b else None

    lower_builtin(_operator, Mask, Mask)(
        lambda context, builder, sig, args, name=_name: getattr(builder, name)(*args)
    )


@type_callable(operator.invert)
def _type_invert(context):
    return lambda a: a if isinstance(a, Mask) else None


@lower_builtin(operator.invert, Mask)
def _invert(context, builder, sig, args):
    return builder.not_(args[0])


@intrinsic
def where(typingctx, condition, a, b):
    """Return `a` in the lanes where the condition holds, else `b`; both are computed."""
    kind = _lanes_among((a, b)) or typingctx.unify_types(a, b)
    if isinstance(condition, Mask) and not isinstance(kind, Lanes):
        kind = Lanes(kind, condition.width)

    def codegen(context, builder, sig, args):
        value_a = context.cast(builder, args[1], sig.args[1], kind)
        value_b = context.cast(builder, args[2], sig.args[2], kind)
        if not isinstance(kind, types.Complex | Duals):
            return builder.select(args[0], value_a, value_b)
        real_a, imag_a = parted(context, builder, kind, kind, value_a)
        real_b, imag_b = parted(context, builder, kind, kind, value_b)
        real = builder.select(args[0], real_a, real_b)
        imag = duals.choose(builder, args[0], imag_a, imag_b)
        return joined(context, builder, kind, [real, imag])

    return kind(condition, a, b), codegen


@intrinsic
def magnitude(typingctx, x):
    """Return |x|; the sign of the real part decides for a complex number, whose imaginary part carries a derivative."""

    def codegen(context, builder, sig, args):
        if not isinstance(x, types.Complex | Duals):
            return _elementwise("fabs")(builder, x, args[0])
        parts = parted(context, builder, x, x, args[0])
        return joined(context, builder, x, duals.magnitude(builder, None, parts))

    return x(x), codegen


@intrinsic
def chained(typingctx, value, slope, x):
    """Return the value of a function of x, with the derivative that x and the function's slope give it, if x has one.

    Value and slope have no derivative themselves.
    """

    def codegen(context, builder, sig, args):
        if not isinstance(x, types.Complex | Duals):
            return args[0]
        _, derivative = parted(context, builder, x, x, args[2])
        slope = duals.repeated(builder, args[1], derivative)
        return joined(context, builder, x, [args[0], builder.fmul(slope, derivative)])

    return x(value, slope, x), codegen


@intrinsic
def any_lane(typingctx, condition):
    """Return whether a condition holds in at least one lane."""

    def codegen(context, builder, sig, args):
        if not isinstance(condition, Mask):
            return args[0]
        signature = ir.FunctionType(ir.IntType(1), [vector(condition)])
        name = f"llvm.vector.reduce.or.v{condition.width}i1"
        return builder.call(cgutils.get_or_insert_function(builder.module, signature, name), args)

    return types.boolean(condition), codegen


@intrinsic
def first_lane(typingctx, x):
    """Return the number in the first lane, for floats that are the same in all lanes."""

    def codegen(context, builder, sig, args):
        return _picked_lane(context, builder, x, args[0], 0)

    return _alone(x)(x), codegen


@intrinsic
def table_row(typingctx, address, index, further):
    """Return the four numbers of a row of a table at an address, for a plain number or each of eight lanes."""
    kind = _lanes_among((address, index)) or types.float64
    row = ir.VectorType(ir.DoubleType(), 4)

    def codegen(context, builder, sig, args):
        start = context.cast(builder, args[0], sig.args[0], kind)
        count = context.cast(builder, args[1], sig.args[1], kind)
        offset = context.cast(builder, args[2], sig.args[2], types.int64)
        row_bytes = ir.Constant(ir.DoubleType(), 32.0)
        size = context.cast(builder, row_bytes, types.float64, kind)
        address_number = builder.fadd(start, builder.fmul(count, size))
        address = builder.fptosi(address_number, _word_type(kind))
        rows = []
        # Gather instructions are slower than loads of rows.
        for lane in range(getattr(kind, "width", 1)):
            lane_address = _picked_lane(context, builder, kind, address, lane)
            pointer = builder.inttoptr(lane_address, row.as_pointer())
            loaded = builder.load(builder.gep(pointer, [offset]), align=8)
            loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
            rows.append(loaded)
        if isinstance(kind, Lanes):
            numbers = _columns(builder, rows)
        else:
            numbers = [
                builder.extract_element(rows[0], ir.Constant(ir.IntType(32), k)) for k in range(4)
            ]
        return context.make_tuple(builder, sig.return_type, numbers)

    return types.UniTuple(kind, 4)(address, index, further), codegen


def _word_type(kind):
    """Return the LLVM type of the integers in lanes, or of one integer."""
    word = ir.IntType(64)
    if isinstance(kind, Lanes):
        return ir.VectorType(word, kind.width)
    return word


EVEN = (0, 8, 2, 10, 4, 12, 6, 14)
"""Order that takes the numbers at even places of two vectors, in turns."""
ODD = (1, 9, 3, 11, 5, 13, 7, 15)
"""Order that takes those at odd places."""
FIRST_PAIRS = (0, 1, 8, 9, 4, 5, 12, 13)
"""Order that takes the first pairs of each four numbers of two vectors."""
SECOND_PAIRS = (2, 3, 10, 11, 6, 7, 14, 15)
"""Order that takes the second pairs."""


def _columns(builder, rows):
    """Transpose rows of four numbers, one for each of eight lanes, to four vectors of lanes."""

    def shuffle(a, b, order):
        indices = ir.Constant(ir.VectorType(ir.IntType(32), len(order)), order)
        return builder.shuffle_vector(a, b, indices)

    a, b, c, d = (shuffle(rows[i], rows[i + 4], tuple(range(8))) for i in range(4))
    even_ab = shuffle(a, b, EVEN)
    even_cd = shuffle(c, d, EVEN)
    odd_ab = shuffle(a, b, ODD)
    odd_cd = shuffle(c, d, ODD)
    return [
        shuffle(even_ab, even_cd, FIRST_PAIRS),
        shuffle(odd_ab, odd_cd, FIRST_PAIRS),
        shuffle(even_ab, even_cd, SECOND_PAIRS),
        shuffle(odd_ab, odd_cd, SECOND_PAIRS),
    ]


@intrinsic
def bit(typingctx, shifted, position):
    """Return whether a bit of the integer in the last bits of a float is set (see `functions.SHIFT`)."""

    def codegen(context, builder, sig, args):
        bits = _bits(context, builder, shifted, args[0])
        unit = ir.Constant(ir.IntType(64), 1)
        place = context.cast(builder, args[1], sig.args[1], types.int64)
        mask = _same(builder, shifted, builder.shl(unit, place))
        return builder.icmp_unsigned("!=", builder.and_(bits, mask), ir.Constant(bits.type, None))

    result = Mask(shifted.width) if isinstance(shifted, Lanes) else types.boolean
    return result(shifted, position), codegen


@intrinsic
def power_of_two(typingctx, shifted):
    """Return 2^(k - 1023) for the integer k, 1 to 2046, in the last bits of a float, by moving it to the exponent."""

    def codegen(context, builder, sig, args):
        bits = _bits(context, builder, shifted, args[0])
        places = _same(builder, shifted, ir.Constant(ir.IntType(64), 52))
        return builder.bitcast(builder.shl(bits, places), args[0].type)

    return shifted(shifted), codegen


def _bits(context, builder, kind, value):
    return builder.bitcast(value, _word_type(kind))


def _same(builder, kind, scalar):
    """Return a scalar for a single lane, or a vector with the scalar in all lanes."""
    if isinstance(kind, Lanes):
        return _splat(builder, ir.VectorType(scalar.type, kind.width), scalar)
    return scalar


# ---- functions that cannot take lanes ------------------------------------------------------------


@intrinsic
def each_lane(typingctx, function, arguments):
    """Call a compiled scalar function once per lane; `arguments` is a tuple of lanes and plain numbers."""
    kind: Any = _lanes_among(arguments)
    scalars = tuple(_alone(a) for a in arguments)
    inner = function.get_call_type(typingctx, scalars, {})
    results = tuple(inner.return_type)
    out = types.Tuple([kind] * len(results))

    def codegen(context, builder, sig, args):
        call = context.get_function(function, inner)
        values = cgutils.unpack_tuple(builder, args[1])
        columns = [context.get_constant_undef(kind) for _ in results]
        for lane in range(kind.width):
            lane_values = [
                _picked_lane(context, builder, a, v, lane)
                for v, a in zip(values, arguments, strict=True)
            ]
            # Arguments of a function of *numbers are one tuple.
            if len(inner.args) < len(lane_values):
                lane_values = [context.make_tuple(builder, inner.args[0], lane_values)]
            lane_results = cgutils.unpack_tuple(builder, call(builder, lane_values))
            for j, (value, result) in enumerate(zip(lane_results, results, strict=True)):
                scalar = context.cast(builder, value, result, _alone(kind))
                columns[j] = _with_lane(context, builder, kind, columns[j], scalar, lane)
        return context.make_tuple(builder, out, columns)

    return out(function, arguments), codegen


def _alone(kind):
    """Return the type of a single lane."""
    if isinstance(kind, Duals):
        return Duals(kind.dtype, 1, kind.n_slopes)
    if isinstance(kind, Lanes):
        return kind.dtype
    return kind


def _picked_lane(context, builder, kind, value, lane):
    index = ir.Constant(ir.IntType(32), lane)
    if isinstance(kind, Duals):
        real, slopes = parted(context, builder, kind, kind, value)
        places = range(lane, kind.width * kind.n_slopes, kind.width)
        parts = [builder.extract_element(real, index), _some_of(builder, slopes, places)]
        return joined(context, builder, _alone(kind), parts)
    if isinstance(kind, Lanes):
        return builder.extract_element(value, index)
    return value


def _with_lane(context, builder, kind, value, scalar, lane):
    index = ir.Constant(ir.IntType(32), lane)
    if not isinstance(kind, Duals):
        return builder.insert_element(value, scalar, index)
    real, imag = parted(context, builder, kind, kind, value)
    new_real, new_slopes = parted(context, builder, _alone(kind), _alone(kind), scalar)
    for k, slope in enumerate(_by_slope(builder, _alone(kind), new_slopes)):
        place = ir.Constant(ir.IntType(32), lane + k * kind.width)
        imag = builder.insert_element(imag, slope, place)
    real = builder.insert_element(real, new_real, index)
    return joined(context, builder, kind, [real, imag])
