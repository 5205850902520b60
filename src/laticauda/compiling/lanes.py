"""Values of ``S[row]`` in the kernels: one number per lane, so that the physics reads as if there were a single trial.

With one lane it is a plain float or complex number. With more it is a vector of floats that the
compiler keeps in a vector register: every statement of the kernels becomes a vector instruction,
independent of whether a compiler would vectorize a loop. Rows of complex numbers hold `Duals`, one
number with its derivative per lane: a complex step whose square is negligible. Arithmetic,
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
        return joined(context, builder, toty, (real, ir.Constant(real.type, None)))
    scalar = value if isinstance(toty, Mask) else context.cast(builder, value, fromty, toty.dtype)
    return _splat(builder, vector(toty), scalar)


def _splat(builder, vector, scalar):
    nothing, index = ir.Constant(vector, ir.Undefined), ir.IntType(32)
    first = builder.insert_element(nothing, scalar, ir.Constant(index, 0))
    return builder.shuffle_vector(
        first, nothing, ir.Constant(ir.VectorType(index, vector.count), None)
    )


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
        return (lambda a: typed(a)) if arity == 1 else (lambda a, b: typed(a, b))

    def lower(context, builder, sig, args):
        kind = _lanes_among(sig.args)
        if isinstance(kind, Duals):
            parts = [
                parted(context, builder, t, kind, v) for v, t in zip(args, sig.args, strict=True)
            ]
            if dual is None:
                return emit(builder, kind.part, *(real for real, _ in parts))
            return joined(
                context,
                builder,
                kind,
                dual(builder, functools.partial(emit, builder, kind.part), *parts),
            )
        vectors = [context.cast(builder, v, t, kind) for v, t in zip(args, sig.args, strict=True)]
        return emit(builder, kind, *vectors)

    for arguments in (
        ((Lanes,),)
        if arity == 1
        else ((Lanes, Lanes), (Lanes, types.Number), (types.Number, Lanes))
    ):
        lower_builtin(function, *arguments)(lower)


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
    return Mask(kind.width) if kind.width > 1 else types.boolean


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
        one, other = (
            context.cast(builder, v, t, kind) for v, t in zip(args[1:], sig.args[1:], strict=True)
        )
        if not isinstance(kind, types.Complex | Duals):
            return builder.select(args[0], one, other)
        both = zip(*(parted(context, builder, kind, kind, v) for v in (one, other)), strict=True)
        return joined(context, builder, kind, [builder.select(args[0], *parts) for parts in both])

    return kind(condition, a, b), codegen


@intrinsic
def magnitude(typingctx, x):
    """Return |x|; the sign of the real part decides for a complex number, whose imaginary part carries a derivative."""

    def codegen(context, builder, sig, args):
        if not isinstance(x, types.Complex | Duals):
            return _elementwise("fabs")(builder, x, args[0])
        return joined(
            context,
            builder,
            x,
            duals.magnitude(builder, None, parted(context, builder, x, x, args[0])),
        )

    return x(x), codegen


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
        start, count = (
            context.cast(builder, v, t, kind) for v, t in zip(args[:2], sig.args[:2], strict=True)
        )
        beyond = context.cast(builder, args[2], sig.args[2], types.int64)
        size, word = (
            context.cast(builder, ir.Constant(ir.DoubleType(), 32.0), types.float64, kind),
            ir.IntType(64),
        )
        place = builder.fadd(start, builder.fmul(count, size))
        place = builder.fptosi(
            place, ir.VectorType(word, kind.width) if isinstance(kind, Lanes) else word
        )
        rows = []
        for lane in range(
            getattr(kind, "width", 1)
        ):  # gather instructions are slower than loads of rows
            at = builder.inttoptr(
                _picked_lane(context, builder, kind, place, lane), row.as_pointer()
            )
            rows.append(builder.load(builder.gep(at, [beyond]), align=8))
            rows[-1].set_metadata("invariant.load", builder.module.add_metadata([]))
        if not isinstance(kind, Lanes):
            found = [
                builder.extract_element(rows[0], ir.Constant(ir.IntType(32), k)) for k in range(4)
            ]
        else:
            found = _columns(builder, rows)
        return context.make_tuple(builder, sig.return_type, found)

    return types.UniTuple(kind, 4)(address, index, further), codegen


def _columns(builder, rows):
    """Transpose rows of four numbers, one for each of eight lanes, to four vectors of lanes."""

    def picked(a, b, *order):
        return builder.shuffle_vector(
            a, b, ir.Constant(ir.VectorType(ir.IntType(32), len(order)), order)
        )

    a, b, c, d = (picked(rows[i], rows[i + 4], *range(8)) for i in range(4))
    even, odd = (0, 8, 2, 10, 4, 12, 6, 14), (1, 9, 3, 11, 5, 13, 7, 15)
    first, second = (0, 1, 8, 9, 4, 5, 12, 13), (2, 3, 10, 11, 6, 7, 14, 15)
    pairs = [(picked(a, b, *half), picked(c, d, *half)) for half in (even, odd)]
    return [picked(*pair, *half) for half in (first, second) for pair in pairs]


@intrinsic
def bit(typingctx, shifted, position):
    """Return whether a bit of the integer in the last bits of a float is set (see `functions.SHIFT`)."""

    def codegen(context, builder, sig, args):
        bits = _bits(context, builder, shifted, args[0])
        one = ir.Constant(ir.IntType(64), 1)
        place = context.cast(builder, args[1], sig.args[1], types.int64)
        mask = _same(builder, shifted, builder.shl(one, place))
        return builder.icmp_unsigned("!=", builder.and_(bits, mask), ir.Constant(bits.type, None))

    return (Mask(shifted.width) if isinstance(shifted, Lanes) else types.boolean)(
        shifted, position
    ), codegen


@intrinsic
def power_of_two(typingctx, shifted):
    """Return 2^(k - 1023) for the integer k, 1 to 2046, in the last bits of a float, by moving it to the exponent."""

    def codegen(context, builder, sig, args):
        bits = _bits(context, builder, shifted, args[0])
        places = _same(builder, shifted, ir.Constant(ir.IntType(64), 52))
        return builder.bitcast(builder.shl(bits, places), args[0].type)

    return shifted(shifted), codegen


def _bits(context, builder, kind, value):
    word = ir.IntType(64)
    return builder.bitcast(
        value, ir.VectorType(word, kind.width) if isinstance(kind, Lanes) else word
    )


def _same(builder, kind, scalar):
    """Return a scalar for a single lane, or a vector with the scalar in all lanes."""
    return (
        _splat(builder, ir.VectorType(scalar.type, kind.width), scalar)
        if isinstance(kind, Lanes)
        else scalar
    )


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
            if len(inner.args) < len(
                lane_values
            ):  # arguments of a function of *numbers are one tuple
                lane_values = [context.make_tuple(builder, inner.args[0], lane_values)]
            got = cgutils.unpack_tuple(builder, call(builder, lane_values))
            for j, (value, result) in enumerate(zip(got, results, strict=True)):
                scalar = context.cast(builder, value, result, _alone(kind))
                columns[j] = _with_lane(context, builder, kind, columns[j], scalar, lane)
        return context.make_tuple(builder, out, columns)

    return out(function, arguments), codegen


def _alone(kind):
    """Return the type of a single lane."""
    if isinstance(kind, Duals):
        return Duals(kind.dtype, 1)
    return kind.dtype if isinstance(kind, Lanes) else kind


def _picked_lane(context, builder, kind, value, lane):
    at = ir.Constant(ir.IntType(32), lane)
    if isinstance(kind, Duals):
        parts = parted(context, builder, kind, kind, value)
        return joined(
            context, builder, _alone(kind), [builder.extract_element(part, at) for part in parts]
        )
    return builder.extract_element(value, at) if isinstance(kind, Lanes) else value


def _with_lane(context, builder, kind, value, scalar, lane):
    at = ir.Constant(ir.IntType(32), lane)
    if not isinstance(kind, Duals):
        return builder.insert_element(value, scalar, at)
    parts = parted(context, builder, kind, kind, value)
    new = parted(context, builder, _alone(kind), _alone(kind), scalar)
    return joined(
        context,
        builder,
        kind,
        [builder.insert_element(*p, at) for p in zip(parts, new, strict=True)],
    )
