"""sin, cos and tanh without branches, so that lanes stay in vector registers; a single lane is faster too.

Floats, complex steps and lanes use the same source. A complex step does not go through the
polynomials: the derivative of a sine is the cosine, which is there already.
"""

# pyright: basic
# pyright: reportCallIssue=false

import math

import numpy as np
from numba.extending import overload

from laticauda.compiling.inner import INLINED, inlined
from laticauda.compiling.lane_types import Lanes
from laticauda.compiling.lanes import bit, chained, power_of_two, where

SHIFT = 6755399441055744.0
"""1.5 * 2^52: adding it to a number below 2^51 rounds to an integer, which the last bits of the sum then hold."""
TWO_PER_PI = 0.6366197723675814
"""2 / pi."""
HALF_PI = 1.5707963267341256
"""pi / 2 to its first 33 bits, so that its product with a small integer is exact."""
HALF_PI_REST = 6.077100506303966e-11
"""The next 33 bits of pi / 2."""
HALF_PI_REST_OF_REST = 2.0222662487959506e-21
"""What is left of pi / 2."""
SINE = (
    1.58969099521155010221e-10,
    -2.50507602534068634195e-08,
    2.75573137070700676789e-06,
    -1.98412698298579493134e-04,
    8.33333333332248946124e-03,
    -1.66666666666666324348e-01,
)
"""(sin(x) / x - 1) / x^2 as a polynomial of x^2 for |x| < pi / 4, highest power first.

The minimax polynomial S1 to S6 of `k_sin.c` in fdlibm (Sun Microsystems, 1993).
"""
COSINE = (
    -1.13596475577881948265e-11,
    2.08757232129817482790e-09,
    -2.75573143513906633035e-07,
    2.48015872894767294178e-05,
    -1.38888888888741095749e-03,
    4.16666666666666019037e-02,
)
"""(cos(x) - 1 + x^2 / 2) / x^4 as a polynomial of x^2 for |x| < pi / 4, highest power first.

The minimax polynomial C1 to C6 of `k_cos.c` in fdlibm (Sun Microsystems, 1993).
"""
HYPERBOLIC_SINE = (21.0, 1260.0, 10395.0)
"""Numerator of tanh(y) / y as a ratio of two polynomials of y^2, highest power first."""
HYPERBOLIC_COSINE = (1.0, 210.0, 4725.0, 10395.0)
"""Its denominator: the sixth convergent of Lambert's continued fraction, right to 1e-18 for |y| < ln 2 / 4."""
TWO_PER_LN_2 = 2.8853900817779268
"""2 / ln 2."""
HALF_LN_2 = 0.34657359027997264
"""ln 2 / 2."""
TANH_IS_ONE = 20.0
"""From here on tanh is 1 to the last digit."""
EXPONENTIAL = tuple(1.0 / math.factorial(k) for k in range(13, 0, -1))
"""Power series of (exp(x) - 1) / x, highest power first."""


@inlined
def polynomial(x, coefficients):
    """Evaluate a polynomial by Horner's rule."""
    p = coefficients[0]
    for coefficient in coefficients[1:]:
        p = p * x + coefficient
    return p


@inlined
def sincos(x):
    """Return sin and cos to 2e-16 for |x| < 1e5.

    Reduction by multiples of pi/2 in three parts (Cody and Waite), then polynomials.
    """
    number = x.real
    shifted = number * TWO_PER_PI + SHIFT
    q = shifted - SHIFT
    y = number - q * HALF_PI
    y = y - q * HALF_PI_REST
    y = y - q * HALF_PI_REST_OF_REST
    z = y * y
    s = y + y * z * polynomial(z, SINE)
    c = 1.0 - 0.5 * z + z * z * polynomial(z, COSINE)
    # The quadrant is q modulo 4.
    odd = bit(shifted, 0)
    low = bit(shifted, 1)
    sine = where(odd, c, s)
    cosine = where(odd, s, c)
    sine = where(low, -sine, sine)
    cosine = where(low ^ odd, -cosine, cosine)
    return chained(sine, cosine, x), chained(cosine, -sine, x)


@inlined
def expm1(x):
    """Return exp(x) - 1, x clipped to -700 ... 700, to 3e-16 relative to exp(x), or to x if x is small.

    Reduction by multiples of ln 2 in two parts, then the power series, whose first omitted term is
    below 1e-17.
    """
    x = where(x.real < 700.0, x, 700.0 + 0.0 * x)
    x = where(x.real > -700.0, x, -700.0 + 0.0 * x)
    number = x.real
    q = (number * 1.4426950408889634 + SHIFT) - SHIFT
    r = number - q * 0.6931471803691238
    r = r - q * 1.9082149292705877e-10
    scale = power_of_two(q + (SHIFT + 1023.0))
    growth = scale * (polynomial(r, EXPONENTIAL) * r) + (scale - 1.0)
    return chained(growth, growth + 1.0, x)


@inlined
def tanh(x):
    """Return tanh to 5e-16, by its addition theorem, as that of k ln 2 / 2 + y with |y| < ln 2 / 4.

    Of the former it is (2^k - 1) / (2^k + 1), of the latter a ratio of two polynomials, so that a single
    division remains, and the operations before it wait for few others.
    """
    number = where(x.real < TANH_IS_ONE, x.real, TANH_IS_ONE)
    number = where(number > -TANH_IS_ONE, number, -TANH_IS_ONE)
    k = (number * TWO_PER_LN_2 + SHIFT) - SHIFT
    y = number - k * HALF_LN_2
    z = y * y
    sine = y * polynomial(z, HYPERBOLIC_SINE)
    cosine = polynomial(z, HYPERBOLIC_COSINE)
    power = power_of_two(k + (SHIFT + 1023.0))
    below, above = power - 1.0, power + 1.0
    value = (below * cosine + above * sine) / (above * cosine + below * sine)
    return chained(value, 1.0 - value * value, x)


def _for_lanes(function, of_lanes):
    """Define a NumPy function for lanes; with plain numbers it is unchanged."""

    @overload(function, jit_options=INLINED)
    def choose(x):
        if isinstance(x, Lanes):
            return of_lanes
        return None


_for_lanes(np.sin, lambda x: sincos(x)[0])
_for_lanes(np.cos, lambda x: sincos(x)[1])
_for_lanes(np.exp, lambda x: 1.0 + expm1(x))
_for_lanes(np.tanh, lambda x: tanh(x))
