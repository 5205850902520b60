"""Pullbacks of formulas: from the derivatives of a function to its results to those to its arguments.

The backward half of what `duals` does forward, for the same operations and with the same rules where
a function has a kink. A formula is called once with numbers that note what is done with them
(`Traced`); from these notes follows the source text of its pullback, one line per operation, which is
compiled like any other kernel function. Whatever calls the formula in a kernel stays the one place
that says the physics.

In a pullback, `bar` is the derivative of what is differentiated with respect to a number.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false

import math
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import FunctionType
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from laticauda.compiling import Target, kernel, lanes
from laticauda.compiling.functions import sincos, tanh
from laticauda.values import LaticaudaError, scalars

Operand: TypeAlias = "Traced | float"


class NotTraceable(LaticaudaError, TypeError):
    """Raised if a formula does more with its numbers than arithmetic: it branches, for instance."""


class Rule(NamedTuple):
    """How an operation is written in source text: forward, and what each of its operands gets back."""

    forward: str
    """The result of operands a, b and c."""
    backward: tuple[str | None, ...]
    """The bar of each operand, from the bar d of the result y; None: none, as for a condition."""


RULES: Mapping[str, Rule] = {
    "add": Rule("{a} + {b}", ("{d}", "{d}")),
    "subtract": Rule("{a} - {b}", ("{d}", "-{d}")),
    "multiply": Rule("{a} * {b}", ("{d} * {b}", "{d} * {a}")),
    "divide": Rule("{a} / {b}", ("{d} / {b}", "-({d} / {b}) * {y}")),
    "negate": Rule("-{a}", ("-{d}",)),
    "magnitude": Rule("magnitude({a})", ("where({a} < 0.0, -{d}, {d})",)),
    "square_root": Rule("{a} ** 0.5", ("where({y} == 0.0, 0.0, {d} / ({y} + {y}))",)),
    "power": Rule("{a} ** {b}", ("where({a} == 0.0, 0.0, {d} * {b} * {y} / {a})", None)),
    "sine": Rule("sincos({a})[0]", ("{d} * sincos({a})[1]",)),
    "cosine": Rule("sincos({a})[1]", ("-{d} * sincos({a})[0]",)),
    "tanh": Rule("tanh({a})", ("{d} * (1.0 - {y} * {y})",)),
    "exponential": Rule("np.exp({a})", ("{d} * {y}",)),
    "where": Rule("where({a}, {b}, {c})", (None, "where({a}, {d}, 0.0)", "where({a}, 0.0, {d})")),
    "less": Rule("{a} < {b}", (None, None)),
    "less_or_equal": Rule("{a} <= {b}", (None, None)),
    "both": Rule("{a} & {b}", (None, None)),
    "either": Rule("{a} | {b}", (None, None)),
}
"""Roots and powers of 0, whose slope is unbounded, have the slope 0, as in `duals`."""

UFUNCS: Mapping[Any, str] = {
    np.sin: "sine",
    np.cos: "cosine",
    np.tanh: "tanh",
    np.exp: "exponential",
    np.sqrt: "square_root",
    np.absolute: "magnitude",
}
"""Functions of NumPy that a formula may call."""
ARITHMETIC: Mapping[Any, Callable[[Any, Any], Any]] = {
    np.add: operator.add,
    np.subtract: operator.sub,
    np.multiply: operator.mul,
    np.divide: operator.truediv,
}
"""Arithmetic with one of NumPy's own numbers, which NumPy calls by these functions."""


class Traced:
    """A number, or a condition, of a formula that is being traced."""

    def __init__(
        self, trace: "Trace", operation: str, operands: tuple[Operand, ...], name: str
    ) -> None:
        self.trace = trace
        self.operation = operation
        self.operands = operands
        self.name = name

    @property
    def real(self) -> "Traced":
        """The number itself, of which conditions are made."""
        return self

    def __add__(self, operand: Operand) -> Operand:
        """self + operand."""
        if _is(operand, 0.0):
            return self
        return self.trace.note("add", self, operand)

    __radd__ = __add__

    def __sub__(self, operand: Operand) -> Operand:
        """self - operand."""
        if _is(operand, 0.0):
            return self
        return self.trace.note("subtract", self, operand)

    def __rsub__(self, operand: float) -> Operand:
        """operand - self."""
        if _is(operand, 0.0):
            return -self
        return self.trace.note("subtract", operand, self)

    def __mul__(self, operand: Operand) -> Operand:
        """self operand."""
        if _is(operand, 0.0):
            return 0.0
        if _is(operand, 1.0):
            return self
        return self.trace.note("multiply", self, operand)

    __rmul__ = __mul__

    def __truediv__(self, operand: Operand) -> Operand:
        """self / operand."""
        return self.trace.note("divide", self, operand)

    def __rtruediv__(self, operand: float) -> Operand:
        """operand / self."""
        if _is(operand, 0.0):
            return 0.0
        return self.trace.note("divide", operand, self)

    def __neg__(self) -> "Traced":
        """-self."""
        return self.trace.note("negate", self)

    def __pow__(self, exponent: Operand) -> "Traced":
        """Return self to the power of a constant: as in `duals`, an exponent has no derivative."""
        if isinstance(exponent, Traced):
            raise NotTraceable("The exponent of a power depends on what is differentiated.")
        if exponent == 0.5:
            return self.trace.note("square_root", self)
        return self.trace.note("power", self, float(exponent))

    def __abs__(self) -> "Traced":
        """|self|."""
        return self.trace.note("magnitude", self)

    def __lt__(self, operand: Operand) -> "Traced":
        """self < operand."""
        return self.trace.note("less", self, operand)

    def __le__(self, operand: Operand) -> "Traced":
        """self <= operand."""
        return self.trace.note("less_or_equal", self, operand)

    def __gt__(self, operand: Operand) -> "Traced":
        """self > operand."""
        return self.trace.note("less", operand, self)

    def __ge__(self, operand: Operand) -> "Traced":
        """self >= operand."""
        return self.trace.note("less_or_equal", operand, self)

    def __and__(self, operand: "Traced") -> "Traced":
        """Return whether both hold."""
        return self.trace.note("both", self, operand)

    def __or__(self, operand: "Traced") -> "Traced":
        """Return whether either holds."""
        return self.trace.note("either", self, operand)

    def __bool__(self) -> bool:
        """Refuse to decide: which way a formula goes must not depend on its numbers."""
        raise NotTraceable("The formula branches: it asks for the truth of a condition.")

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        """Note a function of NumPy, or NumPy's arithmetic with one of its own numbers."""
        if ufunc in UFUNCS and method == "__call__" and not options:
            return self.trace.note(UFUNCS[ufunc], self)
        if ufunc in ARITHMETIC and method == "__call__" and not options:
            numbers = [x if isinstance(x, Traced) else float(x) for x in inputs]
            return ARITHMETIC[ufunc](*numbers)
        raise NotTraceable(f"The formula calls {ufunc.__name__} of NumPy.")


def _is(operand: Operand, constant: float) -> bool:
    return not isinstance(operand, Traced) and operand == constant


class Place(NamedTuple):
    """A row of the kernels' array, relative to the begin of a record."""

    record: str
    """Name of the variable that holds the record's first row."""
    row: int = 0
    """Row from there."""

    def __add__(self, rows: int) -> "Place":  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return the place `rows` rows later."""
        return Place(self.record, self.row + rows)

    __radd__ = __add__

    def __str__(self) -> str:
        """Return the place in source text."""
        return f"{self.record} + {self.row}"


class Trace:
    """What a formula does with its numbers: the kernels' rows, of which it notes the first reading, and others."""

    def __init__(self) -> None:
        self.numbers: list[Traced] = []
        """All numbers, in the order of their computation."""
        self.read: dict[Any, Traced] = {}
        """Rows that were read before they were written."""
        self.written: dict[Any, Operand] = {}
        """Rows that were written, with their last value."""
        self._noted: dict[Any, Traced] = {}

    def note(self, operation: str, *operands: Operand) -> Traced:
        """Return the result of an operation; the same one if it was noted before."""
        key = (operation, *(id(x) if isinstance(x, Traced) else float(x) for x in operands))
        if key not in self._noted:
            name = f"v{len(self.numbers)}"
            number = Traced(self, operation, operands, name)
            self.numbers.append(number)
            self._noted[key] = number
        return self._noted[key]

    def argument(self, name: str) -> Traced:
        """Return an argument of the formula."""
        return Traced(self, "argument", (), name)

    def __getitem__(self, row: Any) -> Operand:
        """Return what is in a row."""
        if row in self.written:
            return self.written[row]
        if row not in self.read:
            self.read[row] = self.argument(f"x{len(self.read)}")
        return self.read[row]

    def __setitem__(self, row: Any, value: Operand) -> None:
        """Write a row."""
        self.written[row] = value


def where(condition: Any, a: Operand, b: Operand) -> Operand:
    """Return `a` if the condition holds, else `b`, also of traced numbers."""
    if not isinstance(condition, Traced):
        return a if condition else b
    return condition.trace.note("where", condition, a, b)


def _itself(function: Any) -> Any:
    return function


def _tanh(x: Any) -> Any:
    return np.tanh(x)


def _sincos(x: Any) -> Any:
    if isinstance(x, Traced):
        return np.sin(x), np.cos(x)
    return math.sin(x), math.cos(x)


TRACING = Target(
    kernel=_itself,
    entry=_itself,
    in_lanes=_itself,
    formulas={
        scalars.where: where,
        scalars.magnitude: abs,
        scalars.first_lane: _itself,
        scalars.tanh: _tanh,
    },
    replacements={
        "where": where,
        "magnitude": abs,
        "first_lane": _itself,
        "sincos": _sincos,
    },
)
"""Target whose kernels stay plain Python, to be called with traced numbers."""


def write_pullback(
    name: str,
    formula: Callable[..., Sequence[Operand]],
    *,
    records: Sequence[str] = (),
    arguments: Sequence[str] = (),
    returned: Sequence[Any] = (),
    constant: Iterable[Any] = (),
    with_values: bool = False,
) -> str:
    """Return the source text of a pullback.

    The pullback is called with the array of rows, that of their bars, the first rows of the records,
    the arguments, and the bars of the results. It returns the bars of the arguments that vary and of
    the `returned` rows, and adds those of all other rows that the formula reads to their bars.

    Args:
        name: Name of the pullback.
        formula: Function of the rows, `records` and `arguments` that returns numbers.
        records: Names of the arguments that are first rows of records.
        arguments: Names of the arguments that are numbers.
        returned: Rows whose bars are returned; those of a record are a `Place`.
        constant: Rows and names of arguments that do not vary.
        with_values: Whether the results of the formula are returned, too, before all bars.

    Raises:
        NotTraceable: If the formula does more than arithmetic.
    """
    trace = Trace()
    numbers = [trace.argument(argument) for argument in arguments]
    results = formula(trace, *(Place(record) for record in records), *numbers)
    writer = _Writer(trace)
    bars = [f"bar{k}" for k in range(len(results))]
    constants = set(constant)
    varying = [number for number in numbers if number.name not in constants]
    inputs = {number.name for number in varying}
    inputs.update(number.name for row, number in trace.read.items() if row not in constants)
    writer.pull(results, bars, inputs)
    for row, number in trace.read.items():
        if row not in returned and number.name in writer.bar_of:
            writer.lines.append(f"G[{row}] += {writer.bar_of[number.name]}")
    zero = f"0.0 * {bars[0]}"
    answers: list[str] = []
    if with_values:
        answers += [writer.value(result) for result in results]
    answers += [writer.bar_of.get(number.name, zero) for number in varying]
    for row in returned:
        number = trace.read.get(row)
        answers.append(zero if number is None else writer.bar_of.get(number.name, zero))
    reads = [f"{number.name} = S[{row}]" for row, number in trace.read.items()]
    head = f"def {name}({', '.join(['S', 'G', *records, *arguments, *bars])}):"
    lines = [*reads, *writer.lines]
    if answers:
        lines.append(f"return ({', '.join(answers)},)")
    return "\n    ".join([head, *lines]) + "\n"


class _Writer:
    """Writes the lines of a pullback: forward only what the bars need, then the bars from last to first."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.lines: list[str] = []
        """Lines so far."""
        self.bar_of: dict[str, str] = {}
        """Source text of the bar of each number that has one."""
        self._computed: set[str] = set()

    def pull(self, results: Sequence[Operand], bars: Sequence[str], inputs: set[str]) -> None:
        """Write the bars of all numbers that depend on some of the inputs."""
        depends = set(inputs)
        for number in self.trace.numbers:
            names = {operand.name for operand in number.operands if isinstance(operand, Traced)}
            if names & depends:
                depends.add(number.name)
        parts: dict[str, list[str]] = {}
        for result, bar in zip(results, bars, strict=True):
            if isinstance(result, Traced):
                parts.setdefault(result.name, []).append(bar)
        for number in reversed(self.trace.numbers):
            if number.name not in parts:
                continue
            bar = self._sum(number.name, parts.pop(number.name))
            for operand, text in zip(
                number.operands, RULES[number.operation].backward, strict=True
            ):
                if text is None or not isinstance(operand, Traced) or operand.name not in depends:
                    continue
                parts.setdefault(operand.name, []).append(self._fill(text, number, d=bar))
        for name, texts in parts.items():
            if name in inputs:
                self.bar_of[name] = self._sum(name, texts)

    def value(self, operand: Operand) -> str:
        """Return the source text of a number, after the lines that compute it."""
        if not isinstance(operand, Traced):
            return repr(float(operand))
        if operand.operation != "argument" and operand.name not in self._computed:
            text = self._fill(RULES[operand.operation].forward, operand)
            self.lines.append(f"{operand.name} = {text}")
            self._computed.add(operand.name)
        return operand.name

    def _fill(self, text: str, number: Traced, d: str = "") -> str:
        texts = {"d": d}
        for letter, operand in zip("abc", number.operands, strict=False):
            if f"{{{letter}}}" in text:
                texts[letter] = self.value(operand)
        if "{y}" in text:
            texts["y"] = self.value(number)
        return text.format(**texts)

    def _sum(self, name: str, texts: Sequence[str]) -> str:
        if len(texts) == 1 and texts[0].isidentifier():
            return texts[0]
        self.lines.append(f"d_{name} = {' + '.join(texts)}")
        return f"d_{name}"


def compile_pullback(source: str) -> Any:
    """Return a pullback as a function that kernels call.

    Args:
        source: Its source text, from `write_pullback`.
    """
    names: dict[str, Any] = {
        "np": np,
        "where": lanes.where,
        "magnitude": lanes.magnitude,
        "sincos": sincos,
        "tanh": tanh,
        "__name__": __name__,
    }
    exec(source, names)
    name = source[len("def ") : source.index("(")]
    function = names[name]
    assert isinstance(function, FunctionType)
    return kernel(function)
