"""Formulas of laws (`laticauda.values.formulas`) as functions that kernels call with plain numbers or with lanes.

The motion of water is the sum of the formulas of many parts (`summed`).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false, reportUntypedNamedTuple=false
# pyright: reportUnknownMemberType=false

import functools
import math
from collections import namedtuple
from collections.abc import Callable, Sequence
from typing import Any, cast

from numba.core.errors import NumbaError

from laticauda.compiling import compile_scalar, current_target, fingerprint, for_python, kernel
from laticauda.values import Formula, first_lane

_checked: set[str] = set()


def digest_of(formula: Formula) -> str:
    """Return what a formula's machine code depends on: its code and what that calls, names and order of its fields.

    Args:
        formula: Formula of a law; what a user's formula calls may be redefined at run time, unlike
            laticauda's own.
    """
    if formula.is_own:
        return _digest_of_ours(formula)
    return _digest(formula)


def _digest(formula: Formula) -> str:
    return " ".join([fingerprint(formula.function), *formula.fields])


_digest_of_ours = functools.cache(_digest)


def in_numbers(formula: Formula, record: type | None, n_first: int) -> Any:
    """Return a formula as a compiled function of plain numbers.

    Args:
        formula: Formula that takes `n_first` numbers and a `record`.
        record: NamedTuple type of the kernel's data about the object that the law acts on; None: no
            record.
        n_first: Count of the numbers before those of the record, which the law's own numbers
            follow.
    """
    inner = compile_scalar(formula.function)
    last = n_first + _size(record)
    # A tuple of no numbers is no type for Numba.
    numbers_of_law: Any = namedtuple("Numbers", formula.fields or ("nothing",))
    padding: tuple[float, ...] = ()
    if not formula.fields:
        padding = (0.0,)

    def call_without_record(*numbers: float) -> Any:
        return inner(numbers_of_law(*numbers[last:], *padding), *numbers[:n_first])

    if record is None:
        return compile_scalar(call_without_record)

    def call_with_record(*numbers: float) -> Any:
        return inner(
            numbers_of_law(*numbers[last:], *padding),
            *numbers[:n_first],
            record(*numbers[n_first:last]),
        )

    return compile_scalar(call_with_record)


def _size(record: Any) -> int:
    if record is None:
        return 0
    return len(record._fields)


def in_rows(formula: Formula, record: type | None, n_first: int) -> Any:
    """Return a formula as `in_numbers` does, but also for lanes; made once for all kernels of a target."""
    target = current_target()
    key = (digest_of(formula), record, n_first)
    if key not in target.functions:
        target.functions[key] = target.in_lanes(in_numbers(formula, record, n_first))
    return target.functions[key]


def check(
    formula: Formula,
    numbers: tuple[float, ...],
    record: type | None,
    example: tuple[float, ...],
    count: int,
    results: str,
) -> None:
    """Reject a formula that cannot be compiled or does not return finite numbers; laticauda's own are not checked.

    Args:
        formula: Formula of a law.
        numbers: The law's own numbers.
        record: NamedTuple type that the formula takes last; None: numbers only.
        example: Example arguments, with the record's numbers at the end.
        count: Count of the numbers that it must return.
        results: Description of the results.

    Raises:
        ValueError: If the formula is rejected; the message gives the reason.
    """
    if formula.is_own:
        return
    digest = digest_of(formula)
    if digest in _checked:
        return
    try:
        compiled = for_python(in_numbers(formula, record, len(example) - _size(record)))
        result: Any = compiled(*example, *numbers)
    except (NumbaError, TypeError) as err:
        raise ValueError(
            f"`{formula.name}` must have a formula that Numba can compile: {reason_of(err)}"
        ) from err
    values: tuple[object, ...] = ()
    if isinstance(result, tuple):
        values = cast("tuple[object, ...]", result)
    are_finite = [isinstance(value, float) and math.isfinite(value) for value in values]
    if are_finite != [True] * count:
        shown_count = {3: "three"}.get(count, count)
        raise ValueError(
            f"`{formula.name}` must return {shown_count} finite numbers, {results}, got {result}."
        )
    _checked.add(digest)


TELLING_LINES = (
    "No implementation",
    "Unknown attribute",
    "missing a required",
    "too many",
    "Invalid use",
)
"""Beginnings of the lines of Numba's messages that state a problem."""


def reason_of(error: Exception) -> str:
    """Return the line of Numba's long error message that states the problem.

    Args:
        error: Error of a compilation.
    """
    lines = [line.strip(" :") for line in str(error).splitlines() if line.strip()]
    for line in lines:
        if line.startswith(TELLING_LINES):
            return line
    if lines:
        return lines[-1]
    return type(error).__name__


def rows_from(first: int, count: int) -> Callable[..., tuple[Any, ...]]:
    """Return a kernel function of the rows S and a record's start: a tuple of `count` rows from its row `first`."""
    # Numba knows the length of a tuple only if it is written out.
    rows = "".join(f"rows[begin + {row}], " for row in range(first, first + count))
    return kernel(eval(f"lambda rows, begin=0: ({rows})"))


PLACE = 4
"""Count of the arguments of a flow before its own numbers: x, y, z, t."""


def summed(kinds: Sequence[Formula], count: int) -> Any:
    """Return a kernel function for the sum of all parts of a flow, given the rows S, its first row, and x, y, z, t.

    Args:
        kinds: Formulas of the parts; for each formula, the rows hold the number of parts, then the
            numbers of each.
        count: Count of the numbers that a formula returns.
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
    """Return the sum function `before` extended by the parts of one more kind."""
    part = in_rows(formula, None, PLACE)
    size = len(formula.fields)
    first = current_target().formulas[first_lane]
    numbers = rows_from(0, size)
    terms = "".join(f"a[{k}] + b[{k}], " for k in range(count))
    plus = kernel(eval(f"lambda a, b: ({terms})"))

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
