"""Derivatives of scalar laws in two ways that share nothing."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

Law = Callable[..., Any]


def by_complex_step(law: Law, arguments: Sequence[float], which: int) -> np.ndarray:
    """d law / d arguments[which], to rounding."""
    step = 1e-30
    moved = [a + 1j * step if i == which else a for i, a in enumerate(arguments)]
    return np.imag(np.atleast_1d(np.array(law(*moved)))) / step


def by_differences(
    law: Law, arguments: Sequence[float], which: int, step: float = 1e-4
) -> np.ndarray:
    """The same by central differences of order four."""

    def at(offset: float) -> np.ndarray:
        return np.atleast_1d(
            np.array(law(*(a + offset * (i == which) for i, a in enumerate(arguments))))
        )

    return (8.0 * (at(step) - at(-step)) - at(2.0 * step) + at(-2.0 * step)) / (12.0 * step)


def check_complex_steps(law: Law, arguments: Sequence[float]) -> None:
    """Both ways agree for every argument, and the complex step leaves the value alone."""
    value = np.atleast_1d(np.array(law(*arguments)))
    perturbed = np.atleast_1d(np.array(law(*(a + 1e-30j for a in arguments))))
    np.testing.assert_allclose(np.real(perturbed), value, rtol=1e-13, atol=1e-13)
    for which in range(len(arguments)):
        expected = by_differences(law, arguments, which)
        scale = 1.0 + np.abs(expected).max() + np.abs(value).max()
        np.testing.assert_allclose(
            by_complex_step(law, arguments, which), expected, atol=1e-7 * scale
        )


def check_compiled(law: Law, arguments: Sequence[float]) -> None:
    """Compiled as the kernels do it, for real and for complex numbers, the law gives what Python gives."""
    fast = _compile(law)
    for kind in (float, complex):
        numbers = [kind(a) for a in arguments]
        np.testing.assert_allclose(
            np.array(fast(*numbers)), np.array(law(*numbers)), rtol=1e-13, atol=1e-15
        )


@cache
def _compile(law: Law) -> Law:
    """Compile a law once for all arguments that it is tried with."""
    from laticauda.compiling import compile_scalar, for_python

    return for_python(compile_scalar(law))
