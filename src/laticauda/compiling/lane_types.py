"""Numba types behind `lanes`: the rows of the kernels and their memory layout."""

# pyright: basic

import operator

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
    """A float and an imaginary part, its derivative times a step, per lane; comparisons use the floats only."""

    def __init__(self, dtype, width):
        super().__init__(dtype, width)
        self.part = dtype if width == 1 else Lanes(dtype, width)
        self.name = f"Duals({dtype}, {width})"

    def can_convert_from(self, typingctx, other):
        """Convert numbers without an imaginary part to numbers whose derivative is 0."""
        return Conversion.safe if other == self.part else super().can_convert_from(typingctx, other)

    def unify(self, typingctx, other):
        """Unify as for `Lanes`."""
        return self if other == self.part else super().unify(typingctx, other)


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
        elif isinstance(dtype, types.Complex):
            self.item = Duals(dtype.underlying_float, width)
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
        super().__init__(dmm, fe_type, [("real", fe_type.part), ("imag", fe_type.part)])


@register_model(Rows)
class _RowsModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, ir.PointerType(dmm[fe_type.item].get_data_type()))


# ---- rows ----------------------------------------------------------------------------------------


def rows_of(width):
    """Return the compiled function that interprets the data at an address, or in an array, as `Rows`.

    The data must be contiguous, with the lanes of a row next to each other.

    A row of several complex numbers holds all real parts, then all imaginary parts (see `split`).
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


def split(flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return views of the real and imaginary parts of an array that the kernels take as rows of complex numbers."""
    parts = flat.view(np.real(flat).dtype).reshape(*flat.shape[:-1], 2, flat.shape[-1])
    return parts[..., 0, :], parts[..., 1, :]


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
    return builder.gep(args[0], [index], inbounds=True)


@lower_builtin(operator.getitem, Rows, types.Integer)
def _getitem(context, builder, sig, args):
    rows = sig.args[0]
    address = _address(context, builder, sig, args)
    if rows.width == 1:
        return context.unpack_value(builder, rows.item, address)
    if isinstance(rows.item, Duals):
        parts = [cgutils.gep_inbounds(builder, address, 0, k) for k in range(2)]
        return joined(context, builder, rows.item, [builder.load(part, align=8) for part in parts])
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
        for k, part in enumerate(parted(context, builder, rows.item, rows.item, value)):
            builder.store(part, cgutils.gep_inbounds(builder, address, 0, k), align=8)
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
    pair.imag = ir.Constant(parts[0].type, None) if parts[1] is None else parts[1]
    return pair._getvalue()
