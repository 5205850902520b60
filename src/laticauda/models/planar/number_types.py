"""The types that a number of the kernels can have, and what kernels must therefore keep to.

The same kernels are compiled, or run as plain Python, with ``S[q]`` of several types:

float          a single run
complex        a single run with derivatives: the imaginary part is a small step times the derivative
lanes          eight runs side by side (`compiling.lanes`)
dual lanes     the same with one or two derivatives of each number (`compiling.lane_types.Duals`)

From this follows what the kernels do:

- A comparison is made with the real part, ``S[q].real < limit``. Its result is one truth value per lane:
  choose between numbers by `where`; for an ``if``, ask `any_lane` about it.
- What must be an index or the bound of a loop is the same in all lanes: ``int(first_lane(S[q].real))``.
- A variable has one type throughout. Where one branch sets it to a constant and another one to a number
  of `S`, the constant is written `zero_like` a number of `S`, or is added to it. (A constant that only
  starts a sum may be a plain 0.0: Numba then takes the type of the sum.)
- A number that is 0 may have a derivative: what may be left out only without one is told by `differs`.
- No ``abs``, ``max`` or ``math``: `magnitude`, `where`, and `compiling.functions` exist for all types.
"""

from typing import Any


def zero_like(number: Any) -> Any:
    """Return 0 of the type of a finite number: as many lanes, and complex if it is."""
    return 0.0 * number
