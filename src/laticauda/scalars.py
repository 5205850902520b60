"""Functions of single numbers that hold for whatever the kernels compute with: floats, complex steps, lanes.

Laws of fluids, joints and gaits are plain Python functions of numbers, and the kernels compile them: for floats, for
complex numbers (whose imaginary part carries a derivative) and for lanes (one number per trial, side by side in a
vector register). Neither of the last two can be compared by `if`: a law picks with `where`, looks at real parts, and
takes the functions below. What the kernels put in their place gives the same numbers.
"""

from typing import Any, cast
from weakref import WeakValueDictionary

import numpy as np

_tables: WeakValueDictionary[int, np.ndarray] = WeakValueDictionary()


def where(condition: Any, a: float, b: float) -> float:
    """`a` if the condition holds, else `b`; both are computed, so both must be harmless. Arrays go element by element.

    Args:
        condition: Of real parts, as in ``x.real > 0.0``; join two by ``|`` and ``&``.
        a: Any number.
        b: Of the same kind: ``0.0 * x``, not ``0.0``, beside a number `x` that may be complex.

    Returns:
        One of the two.
    """
    if isinstance(condition, np.ndarray):
        return cast(Any, np.where(cast("np.ndarray", condition), a, b))
    return a if condition else b


def magnitude(x: float) -> float:
    """|x|, also for complex-step derivatives, where `x` is negated or not by the sign of its real part.

    Args:
        x: Real number, or real number with an imaginary perturbation.

    Returns:
        |x| in the unit of x; its real part is never negative.
    """
    return where(x.real >= 0.0, x, -x)


def tanh(x: float) -> float:
    """The hyperbolic tangent; in kernels without branches, several times as fast as that of NumPy, which goes as well.

    Args:
        x: Number, or numbers.
    """
    return np.tanh(x)


def table_address(table: np.ndarray) -> float:
    """Where a table lies, for `table_row`: a number of a law, good in this process while somebody holds the table.

    Args:
        table: Floats of 64 bits, one row of four after the other, shape (n, 4).
    """
    _tables[table.ctypes.data] = table
    return float(table.ctypes.data)  # addresses have 48 bits, floats 53


def table_row(address: float, index: Any, further: float) -> Any:
    """A row of a table, its four numbers; arrays of indices go element by element. It does not vary with the index.

    Args:
        address: Of the table, as `table_address` gives it, the same for all; its real part where it may be complex.
        index: Of a row, a whole number as a float; kernels do not check whether there is such a row.
        further: How many rows behind that; the same for all that run side by side, see `first_lane`.
    """
    return tuple(np.moveaxis(_tables[int(address)][np.asarray(index + further, dtype=int)], -1, 0))


def first_lane(x: float) -> float:
    """A number that is the same in all lanes, as one number.

    Args:
        x: A number of a law.
    """
    return x
