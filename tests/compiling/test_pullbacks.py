"""Pullbacks are the derivatives of the formulas that they were traced from, by the complex step in plain Python."""

import math

import numpy as np
import pytest

from laticauda.compiling import compile_scalar, compiling_for
from laticauda.compiling.pullbacks import RULES, TRACING, NotTraceable, Place, write_pullback
from laticauda.values import magnitude, tanh, where

STEP = 1e-100
PLAIN = {
    "where": where,
    "magnitude": magnitude,
    "np": np,
    "sincos": lambda x: (math.sin(x), math.cos(x)),
    "tanh": math.tanh,
}


def every_operation(x, y):
    share = where((x.real > 0.0) & (y.real <= 2.0) | (y.real < -9.0), x / y, -y)
    root = (x * x + 3.0 - y) ** 0.5 - y**3.0
    return share * root, tanh(x) + np.exp(-y) * np.sin(x), magnitude(y - 5.0) - 2.0 * np.cos(x * y)


def by_complex_steps(bars, numbers):
    slopes = []
    for k in range(len(numbers)):
        stepped = [complex(number) for number in numbers]
        stepped[k] += 1j * STEP
        slopes.append(np.imag(every_operation(*stepped)) @ bars / STEP)
    return slopes


def traced(formula):
    with compiling_for(TRACING):
        return compile_scalar(formula)


def called(source, *arguments):
    names = dict(PLAIN)
    exec(source, names)
    return names["pull"](*arguments)


def test_every_rule_is_that_of_the_complex_step():
    formula = traced(every_operation)
    source = write_pullback("pull", lambda S, x, y: formula(x, y), arguments=("x", "y"))
    bars = np.array([0.3, -1.2, 0.7])
    for numbers in ((0.4, 1.3), (-0.4, 1.3), (0.4, 2.3)):
        found = called(source, None, None, *numbers, *bars)
        np.testing.assert_allclose(found, by_complex_steps(bars, numbers), rtol=1e-14)
    assert set(RULES) == {
        *("add", "subtract", "multiply", "divide", "negate", "magnitude", "square_root", "power"),
        *("sine", "cosine", "tanh", "exponential", "where", "less", "less_or_equal"),
        *("both", "either"),
    }  # a rule that is added needs a place in `every_operation`


def test_bars_of_rows_are_added_to_what_is_there_and_those_of_others_returned():
    def formula(S, b, x):
        return (S[7] * S[b + 2] * x + S[b + 3],)

    returned = [Place("b") + 3]
    source = write_pullback(
        "pull",
        formula,
        records=("b",),
        arguments=("x",),
        returned=returned,
        constant=(7,),
        with_values=True,
    )
    S, G = {7: 2.0, 12: 3.0, 13: 5.0}, {12: 100.0}
    assert called(source, S, G, 10, 4.0, 0.5) == (29.0, 3.0, 0.5)
    assert G == {12: 104.0}


def test_the_slope_of_a_root_of_zero_is_zero():
    source = write_pullback("pull", lambda S, x: ((x * x) ** 0.5,), arguments=("x",))
    with np.errstate(invalid="ignore", divide="ignore"):
        found = called(source, None, None, np.float64(0.0), np.float64(1.0))
    assert found == (0.0,)


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        (lambda S, x, y: (x if x > y else y,), "asks for the truth of a condition"),
        (lambda S, x, y: (x**y,), "exponent of a power depends"),
        (lambda S, x, y: (np.arctan(x),), "calls arctan of NumPy"),
    ],
    ids=["branch", "exponent", "function"],
)
def test_what_is_no_arithmetic_is_refused_with_the_reason(formula, message):
    with pytest.raises(NotTraceable, match=message):
        write_pullback("pull", formula, arguments=("x", "y"))
