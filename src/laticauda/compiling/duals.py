"""Arithmetic of numbers with an imaginary part whose square is negligible: a complex step, to rounding.

A number is a pair: its value, and its derivative times the step; the derivative is None if it is
known to be 0. The value is computed as if there were no derivative. Functions get the builder of
LLVM instructions, and `emit`, which emits the value; values may be floats or vectors of floats. A
derivative may be a vector of several times as many, for as many directions (`lane_types.Duals`).

A function with a kink is differentiated on the side where the number lies. Roots and powers of 0,
whose slope is unbounded, get the slope 0, because the models use them in products that have that
slope (|v| v).
"""

# pyright: basic

from llvmlite import ir


def add(builder, emit, a, b):
    """a + b."""
    return emit(a[0], b[0]), _sum(builder, a[1], b[1])


def subtract(builder, emit, a, b):
    """a - b."""
    return emit(a[0], b[0]), _sum(builder, a[1], _negative(builder, b[1]))


def multiply(builder, emit, a, b):
    """a b."""
    return emit(a[0], b[0]), _sum(builder, _times(builder, a[1], b[0]), _times(builder, b[1], a[0]))


def divide(builder, emit, a, b):
    """a / b; a' / b - (a / b) b' / b."""
    value = emit(a[0], b[0])
    if b[1] is None:
        if a[1] is None:
            return value, None
        return value, emit(a[1], repeated(builder, b[0], a[1]))
    share = builder.fneg(_times(builder, b[1], value))
    return value, emit(_sum(builder, a[1], share), repeated(builder, b[0], b[1]))


def negate(builder, emit, a):
    """-a."""
    return emit(a[0]), _negative(builder, a[1])


def magnitude(builder, emit, a):
    """|a|, based on the sign of its real part."""
    negative = builder.fcmp_ordered("<", a[0], ir.Constant(a[0].type, None))
    return tuple(part and choose(builder, negative, builder.fneg(part), part) for part in a)


def step(builder, emit, a):
    """Apply a function that is constant except where it jumps."""
    return emit(a[0]), None


def square_root(builder, emit, a):
    """Square root of a; a' / (2 root)."""
    root = emit(a[0])
    return root, _slope_or_none(builder, root, builder.fadd(root, root), a[1])


def power(builder, emit, a, b):
    """a to the power of b; b a^b a' / a. The derivative with respect to the exponent is not supported."""
    value = emit(a[0], b[0])
    if b[1] is not None:
        raise NotImplementedError(
            "the exponent of a power must not depend on what is differentiated"
        )
    if a[1] is None:
        return value, None
    change = _times(builder, a[1], builder.fmul(b[0], value))
    return value, _slope_or_none(builder, a[0], a[0], change)


def pick(sign):
    """Return a function that picks one of a and b: a if `a sign b` holds, else b."""

    def of_two(builder, emit, a, b):
        is_first = builder.fcmp_ordered(sign, a[0], b[0])
        value = builder.select(is_first, a[0], b[0])
        if a[1] is None and b[1] is None:
            return value, None
        zero = ir.Constant((a[1] or b[1]).type, None)
        return value, choose(builder, is_first, a[1] or zero, b[1] or zero)

    return of_two


def repeated(builder, number, derivative):
    """Return a number, or a condition, as often as there are derivatives of each number.

    Args:
        builder: Builder of LLVM instructions.
        number: A number or a truth value, or a vector of them.
        derivative: Derivatives, of as many numbers.
    """
    is_vector = isinstance(number.type, ir.VectorType)
    width = number.type.count if is_vector else 1
    count = derivative.type.count if isinstance(derivative.type, ir.VectorType) else 1
    if count == width:
        return number
    index = ir.IntType(32)
    if not is_vector:
        vector = ir.Constant(ir.VectorType(number.type, 1), ir.Undefined)
        number = builder.insert_element(vector, number, ir.Constant(index, 0))
    order = ir.Constant(ir.VectorType(index, count), [k % width for k in range(count)])
    return builder.shuffle_vector(number, ir.Constant(number.type, ir.Undefined), order)


def choose(builder, condition, a, b):
    """Return the numbers or derivatives `a` where a condition holds, else `b`."""
    return builder.select(repeated(builder, condition, a), a, b)


def _sum(builder, a, b):
    if a is None or b is None:
        return a or b
    return builder.fadd(a, b)


def _times(builder, derivative, factor):
    if derivative is None:
        return None
    return builder.fmul(derivative, repeated(builder, factor, derivative))


def _negative(builder, derivative):
    if derivative is None:
        return None
    return builder.fneg(derivative)


def _slope_or_none(builder, value, divisor, derivative):
    """derivative / divisor, but 0 where `value` is 0."""
    if derivative is None:
        return None
    is_zero = builder.fcmp_ordered("==", value, ir.Constant(value.type, None))
    slope = builder.fdiv(derivative, repeated(builder, divisor, derivative))
    return choose(builder, is_zero, ir.Constant(slope.type, None), slope)
