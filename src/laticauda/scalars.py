"""Functions of single numbers that hold for whatever the kernels compute with: floats, complex steps, lanes.

Laws of fluids, joints and gaits are plain Python functions of numbers, and the kernels compile them: for floats, for
complex numbers (whose imaginary part carries a derivative) and for lanes (one number per trial, side by side in a
vector register). Neither of the last two can be compared by `if`: a law picks with `where`, looks at real parts, and
takes the functions below. What the kernels put in their place gives the same numbers.
"""

from typing import Any, cast

import numpy as np


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
