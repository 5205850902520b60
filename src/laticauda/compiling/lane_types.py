"""Numba types behind `lanes`: the rows of the kernels and their memory layout."""

# pyright: basic

import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typeconv.castgraph import Conversion
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable


class Lanes(types.Type):
    """One float per lane."""

    def __init__(self, dtype, width):
        self.dtype, self.width = dtype, width
        super().__init__(f"Lanes({dtype}, {width})")

    def can_convert_from(self, typingctx, other):
        """Convert a plain number to lanes that all hold it.

        Args:
            typingctx: Numba's typing context.
            other: Type to convert to lanes.
        """
        return Conversion.safe if isinstance(other, types.Float | types.Integer) else None

    def unify(self, typingctx, other):
        """Make a variable that holds a plain number first and lanes later hold lanes.

        Args:
            typingctx: Numba's typing context.
            other: Other type of the variable.
        """
        return self if isinstance(other, types.Float | types.Integer) else None


class Duals(Lanes):
    """A float and its derivatives times a step, `n_slopes` of them, per lane; comparisons use the floats only.

    The derivatives are together in one vector, the first of all lanes first. What is computed for the
    values alone is thereby shared by all derivatives.
    """

    def __init__(self, dtype, width, n_slopes=1):
        super().__init__(dtype, width)
        self.n_slopes = n_slopes
        self.part = _lanes_or_number(dtype, width)
        self.slopes = _lanes_or_number(dtype, width * n_slopes)
        self.name = f"Duals({dtype}, {width}, {n_slopes})"

    def can_convert_from(self, typingctx, other):
        """Convert numbers without an imaginary part to numbers whose derivative is 0."""
        return Conversion.safe if other == self.part else super().can_convert_from(typingctx, other)

    def unify(self, typingctx, other):
        """Unify as for `Lanes`."""
        return self if other == self.part else super().unify(typingctx, other)


def _lanes_or_number(dtype, width):
    if width == 1:
        return dtype
    return Lanes(dtype, width)


class Mask(types.Type):
    """One truth value per lane."""

    def __init__(self, width):
        self.width = width
        super().__init__(f"Mask({width})")

    def can_convert_from(self, typingctx, other):
        """Convert a plain truth value to a mask with that value in all lanes."""
        return Conversion.safe if other == types.boolean else None

    def unify(self, typingctx, other):
        """Unify as for `Lanes`."""
        return self if other == types.boolean else None


class Rows(types.Type):
    """The flat array of `rows`: item `q` is row `q` of all lanes."""

    def __init__(self, dtype, width):
        self.dtype, self.width = dtype, width
        if width == 1:
            self.item = dtype
        elif isinstance(dtype, types.Record):
            slopes: Any = dtype.fields[SLOPES].type
            n_slopes, _ = slopes.shape
            self.item = Duals(types.float64, width, n_slopes)
        else:
            self.item = Lanes(dtype, width)
        super().__init__(f"Rows({dtype}, {width})")


def vector(kind):
    """Return the LLVM vector type of a register for lanes of this kind."""
    if isinstance(kind, Mask):
        return ir.VectorType(ir.IntType(1), kind.width)
    return ir.VectorType(
        ir.FloatType() if kind.dtype == types.float32 else ir.DoubleType(), kind.width
    )


@register_model(Lanes)
@register_model(Mask)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, vector(fe_type))


@register_model(Duals)
class _DualsModel(models.StructModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, [("real", fe_type.part), ("imag", fe_type.slopes)])


@register_model(Rows)
class _RowsModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        item = fe_type.item
        if isinstance(item, Duals):
            item = item.part
        super().__init__(dmm, fe_type, ir.PointerType(dmm[item].get_data_type()))


# ---- rows ----------------------------------------------------------------------------------------


def rows_of(width):
    """Return the compiled function that interprets the data at an address, or in an array, as `Rows`.

    The data must be contiguous, with the lanes of a row next to each other; those of numbers with
    derivatives are records of `dual_row`.
    """

    @intrinsic
    def as_rows(typingctx, array):
        kind = Rows(array.dtype, width)

        def codegen(context, builder, sig, args):
            if width > 1:
                align_stack(builder.function)
            is_address = isinstance(array, types.CPointer)
            data = (
                args[0] if is_address else context.make_array(array)(context, builder, args[0]).data
            )
            return builder.bitcast(data, context.get_value_type(kind))

        return kind(array), codegen

    return as_rows


REGISTER_SIZE = 64
"""Size of the largest vector registers [B]."""


def align_stack(function: ir.Function) -> None:
    """Make a function keep registers on its stack where each lies in one line of the cache.

    Without it LLVM aligns the stack to 16 bytes: most registers then lie in two lines, and some in two
    pages, which takes a hundred times as long.

    Args:
        function: Function that is being compiled.
    """
    function.attributes.alignstack = REGISTER_SIZE
    function.attributes.add("nounwind")  # it is so anyway; llvmlite writes no alignment alone


VALUE = "value"
"""Field of a record that holds the values of a row."""
SLOPES = "slopes"
"""Field of a record that holds their derivatives: the first of all lanes, then the second, and so on."""


def dual_row(width: int, n_slopes: int) -> np.dtype[np.void]:
    """Return the type of a row of numbers with derivatives, a record of VALUE and SLOPES.

    Args:
        width: Number of lanes.
        n_slopes: Number of derivatives in every lane.
    """
    return np.dtype([(VALUE, float, (width,)), (SLOPES, float, (n_slopes, width))])


@intrinsic
def uncounted(typingctx, array):
    """Return the address of an array's numbers, which is indexed like the array, or an address itself.

    Numba counts the owners of arrays: in the loops of kernels, the counting waits for all stores before it, and took
    up to a tenth of the time. Addresses have no owners; somebody else must keep the array.
    """
    if isinstance(array, types.CPointer):
        return array(array), lambda context, builder, sig, args: args[0]

    def codegen(context, builder, sig, args):
        return context.make_array(array)(context, builder, args[0]).data

    dtype = types.uint8 if array.dtype == types.boolean else array.dtype
    return types.CPointer(dtype)(array), codegen


@intrinsic
def keep_until_here(typingctx, array):
    """Keep an array that a kernel has made: Numba frees it after it was used last, which addresses do not tell."""
    return types.none(array), lambda context, builder, sig, args: context.get_dummy_value()


def _is_row(rows, index):
    return isinstance(rows, Rows) and isinstance(index, types.Integer)


@type_callable(operator.getitem)
def _type_getitem(context):
    return lambda rows, index: rows.item if _is_row(rows, index) else None


@type_callable(operator.setitem)
def _type_setitem(context):
    return lambda rows, index, value: types.none if _is_row(rows, index) else None


def _address(context, builder, sig, args):
    index = context.cast(builder, args[1], sig.args[1], types.intp)
    item = sig.args[0].item
    if isinstance(item, Duals):
        index = builder.mul(index, ir.Constant(index.type, 1 + item.n_slopes))
    return builder.gep(args[0], [index], inbounds=True)


def _address_of_slopes(context, builder, kind, address):
    after_value = cgutils.gep_inbounds(builder, address, 1)
    return builder.bitcast(after_value, context.get_value_type(kind.slopes).as_pointer())


@lower_builtin(operator.getitem, Rows, types.Integer)
def _getitem(context, builder, sig, args):
    rows = sig.args[0]
    address = _address(context, builder, sig, args)
    if rows.width == 1:
        return context.unpack_value(builder, rows.item, address)
    if isinstance(rows.item, Duals):
        of_slopes = _address_of_slopes(context, builder, rows.item, address)
        parts = [builder.load(place, align=8) for place in (address, of_slopes)]
        return joined(context, builder, rows.item, parts)
    return builder.load(
        address, align=8
    )  # alignment of a lane: arrays need not be aligned to whole rows


@lower_builtin(operator.setitem, Rows, types.Integer, types.Any)
def _setitem(context, builder, sig, args):
    rows = sig.args[0]
    address = _address(context, builder, sig, args)
    value = context.cast(builder, args[2], sig.args[2], rows.item)
    if rows.width == 1:
        context.pack_value(builder, rows.item, value, address)
    elif isinstance(rows.item, Duals):
        real, slopes = parted(context, builder, rows.item, rows.item, value)
        builder.store(real, address, align=8)
        of_slopes = _address_of_slopes(context, builder, rows.item, address)
        builder.store(slopes, of_slopes, align=8)
    else:
        builder.store(value, address, align=8)


# ---- duals ---------------------------------------------------------------------------------------


def parted(context, builder, fromty, kind, value):
    """Return real and imaginary part (None if missing) of a complex number, or of anything convertible to duals."""
    if isinstance(fromty, types.Complex | Duals):
        pair = cgutils.create_struct_proxy(fromty)(context, builder, value=value)
        return pair.real, pair.imag
    return context.cast(builder, value, fromty, kind.part), None


def joined(context, builder, kind, parts):
    """Return duals, or a complex number, made of a real and an imaginary part; the latter may be None."""
    pair = cgutils.create_struct_proxy(kind)(context, builder)
    pair.real = parts[0]
    pair.imag = ir.Constant(pair.imag.type, None) if parts[1] is None else parts[1]
    return pair._getvalue()
