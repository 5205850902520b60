"""Inner functions: compiled into what calls them, once for all constants, and as able as any other."""

import numpy as np
import pytest
from numba import njit

from laticauda.compiling import inner


def test_a_function_is_compiled_once_whatever_constants_are_passed():
    @inner.inlined
    def scaled(x, whole, count):
        return count * x if whole else x

    @njit(**inner.OPTIONS)
    def kernel(x, whole):
        return scaled(x, True, 2) + scaled(x, False, 3) + scaled(x, whole, 4)

    assert kernel(1.5, False) == 2 * 1.5 + 1.5 + 1.5
    assert kernel(1.5, True) == 2 * 1.5 + 1.5 + 4 * 1.5
    assert len(scaled.signatures) == 1


def test_one_that_raises_tells_python_so():
    @inner.inlined
    def positive(x):
        if x < 0.0:
            raise ValueError("must not be negative")
        return x

    @inner.inlined
    def root(x):
        return positive(x) ** 0.5

    @njit(**inner.OPTIONS)
    def kernel(x):
        return root(x)

    assert kernel(4.0) == 2.0
    with pytest.raises(ValueError, match="must not be negative"):
        kernel(-4.0)


def test_one_may_hand_arrays_on():
    @inner.inlined
    def doubled(values):
        return values * 2.0

    @njit(**inner.OPTIONS)
    def kernel(values):
        return doubled(doubled(values)).sum()

    assert kernel(np.arange(4.0)) == 24.0
