"""The motion of water that is the sum of many parts, as a function that kernels call."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false

from collections.abc import Sequence
from typing import Any

from laticauda.compiling import first_lane, kernel
from laticauda.compiling.formulas import in_rows, rows_from
from laticauda.formulas import Formula

PLACE = 4
"""Numbers that a flow gets before its own: x, y, z, t."""


def summed(kinds: Sequence[Formula], count: int) -> Any:
    """A kernel function of the rows S, where a flow's numbers begin, and x, y, z, t: the sum of all parts.

    Args:
        kinds: The formulas of the parts; for each, the rows hold how many parts there are, then the numbers of each.
        count: How many numbers a formula returns.
    """

    @kernel
    def total(S, at, x, y, z, t):
        return at, zeros(0.0 * (x + y + z + t))

    zeros = kernel(eval(f"lambda zero: ({'zero, ' * count})"))
    for formula in kinds:
        total = _after(total, formula, count)
    last = total

    @kernel
    def motion(S, at, x, y, z, t):
        return last(S, at, x, y, z, t)[1]

    return motion


def _after(before: Any, formula: Formula, count: int) -> Any:
    """The same with the parts of one more kind."""
    part, size, first = in_rows(formula, None, PLACE), len(formula.fields), first_lane()
    numbers = rows_from(0, size)
    plus = kernel(eval(f"lambda a, b: ({''.join(f'a[{k}] + b[{k}], ' for k in range(count))})"))

    @kernel
    def total(S, at, x, y, z, t):
        at, sums = before(S, at, x, y, z, t)
        n = int(first(S[at].real))
        at += 1
        for _ in range(n):
            sums = plus(sums, part(x, y, z, t, *numbers(S, at)))
            at += size
        return at, sums

    return total
