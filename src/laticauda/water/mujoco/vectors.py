"""Vectors as three numbers and rotations as nine, row by row, for compiled code; and arrays at addresses."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportCallIssue=false

import numpy as np
from numba import carray  # pyright: ignore[reportPrivateImportUsage]

from laticauda.compiling import kernel
from laticauda.water.mujoco.native import pointer, word_at


@kernel
def integers(address, n):
    """Return the `n` integers at an address."""
    return carray(pointer(address), (n,), np.int64)


@kernel
def numbers(address, n):
    """Return the `n` numbers at an address."""
    return carray(pointer(address), (n,), np.float64)


@kernel
def field(data, offset, n):
    """Return the `n` numbers of a field of the data."""
    return numbers(word_at(data + offset), n)


@kernel
def three(values, k):
    """Return three numbers, starting at index `k`."""
    return values[k], values[k + 1], values[k + 2]


@kernel
def plus(a, b):
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def scaled(k, a):
    """Return k a, for a number k."""
    return k * a[0], k * a[1], k * a[2]


@kernel
def times(a, b):
    """Return the elementwise product of a and b."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


@kernel
def cross(a, b):
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def to_world(R, v):
    """Return R v, from element to world axes; R is nine numbers, row by row."""
    return (
        R[0] * v[0] + R[1] * v[1] + R[2] * v[2],
        R[3] * v[0] + R[4] * v[1] + R[5] * v[2],
        R[6] * v[0] + R[7] * v[1] + R[8] * v[2],
    )


@kernel
def to_own(R, v):
    """Return R^T v, from world to element axes."""
    return (
        R[0] * v[0] + R[3] * v[1] + R[6] * v[2],
        R[1] * v[0] + R[4] * v[1] + R[7] * v[2],
        R[2] * v[0] + R[5] * v[1] + R[8] * v[2],
    )


@kernel
def nine(values, k):
    """Return nine numbers, starting at index `k`."""
    return (*three(values, k), *three(values, k + 3), *three(values, k + 6))
