"""Functions of single numbers that are valid for every number type of the kernels: floats, complex steps, lanes.

Laws of fluids, joints and gaits are plain Python functions of numbers. The kernels compile them for
floats, for complex numbers (whose imaginary part carries a derivative) and for lanes (one number
per trial, side by side in a vector register). The last two cannot be compared in an `if`: a law
selects with `where`, inspects real parts, and uses the functions below. The kernels replace these
with versions that give the same numbers.
"""

from typing import Any, cast
from weakref import WeakValueDictionary

import numpy as np

_tables: WeakValueDictionary[int, np.ndarray] = WeakValueDictionary()


def where(condition: Any, a: float, b: float) -> float:
    """Return `a` if the condition holds, else `b`; both are evaluated, so both must be valid. Arrays work elementwise.

    Args:
        condition: Condition on real parts, as in ``x.real > 0.0``; combine two with ``|`` and
            ``&``.
        a: Any number.
        b: Number of the same kind: ``0.0 * x``, not ``0.0``, if `a` depends on an `x` that may be
            complex.

    Returns:
        One of the two numbers.
    """
    if isinstance(condition, np.ndarray):
        return cast(Any, np.where(cast("np.ndarray", condition), a, b))
    return a if condition else b


def magnitude(x: float) -> float:
    """Return |x|, also for complex-step derivatives, where `x` is negated depending on the sign of its real part.

    Args:
        x: Real number, or real number with an imaginary perturbation.

    Returns:
        |x| in the unit of x; its real part is never negative.
    """
    return where(x.real >= 0.0, x, -x)


def tanh(x: float) -> float:
    """Return the hyperbolic tangent; branch-free in kernels and several times as fast as NumPy's, which also works.

    Args:
        x: Number or numbers.
    """
    return np.tanh(x)


def table_address(table: np.ndarray) -> float:
    """Return a table's address for `table_row`, as a number in a law; valid in this process while the table exists.

    Args:
        table: 64-bit floats in contiguous rows of four, shape (n, 4).
    """
    _tables[table.ctypes.data] = table
    return float(table.ctypes.data)  # addresses have 48 bits, floats 53


def table_row(address: float, index: Any, further: float) -> Any:
    """Return the four numbers of a table row, elementwise for index arrays; they do not vary with the index.

    Args:
        address: Address of the table from `table_address`, the same for all; its real part if it
            may be complex.
        index: Index of a row, a whole number as a float; kernels do not check whether the row
            exists.
        further: Number of rows to add to the index; the same for all that run side by side, see
            `first_lane`.
    """
    return tuple(np.moveaxis(_tables[int(address)][np.asarray(index + further, dtype=int)], -1, 0))


def first_lane(x: float) -> float:
    """Return a number that is the same in all lanes as a single number.

    Args:
        x: A number in a law.
    """
    return x
