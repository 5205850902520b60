"""Vectors as three numbers and rotations as nine, row by row, for compiled code; and arrays at addresses."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportCallIssue=false

import numpy as np
from numba import carray  # pyright: ignore[reportPrivateImportUsage]

from laticauda.compiling import kernel
from laticauda.mujoco_water.native import pointer, word_at


@kernel
def integers(where, n):
    """The `n` integers at an address."""
    return carray(pointer(where), (n,), np.int64)


@kernel
def numbers(where, n):
    """The `n` numbers at an address."""
    return carray(pointer(where), (n,), np.float64)


@kernel
def field(data, offset, n):
    """The `n` numbers of a field of the data."""
    return numbers(word_at(data + offset), n)


@kernel
def three(values, k):
    """Three numbers from place `k` on."""
    return values[k], values[k + 1], values[k + 2]


@kernel
def plus(a, b):
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def scaled(k, a):
    """k a, for a number k."""
    return k * a[0], k * a[1], k * a[2]


@kernel
def times(a, b):
    """a and b multiplied axis by axis."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


@kernel
def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def to_world(R, v):
    """R v: from element to world axes; R is nine numbers, row by row."""
    return (
        R[0] * v[0] + R[1] * v[1] + R[2] * v[2],
        R[3] * v[0] + R[4] * v[1] + R[5] * v[2],
        R[6] * v[0] + R[7] * v[1] + R[8] * v[2],
    )


@kernel
def to_own(R, v):
    """R^T v: from world to element axes."""
    return (
        R[0] * v[0] + R[3] * v[1] + R[6] * v[2],
        R[1] * v[0] + R[4] * v[1] + R[7] * v[2],
        R[2] * v[0] + R[5] * v[1] + R[8] * v[2],
    )


@kernel
def nine(values, k):
    """Nine numbers from place `k` on."""
    return (*three(values, k), *three(values, k + 3), *three(values, k + 6))
