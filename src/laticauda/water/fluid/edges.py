"""Trailing edge of a rigid plate of any shape between slender and broad.

A plate of height h and chord c stands upright, its root (the leading edge) ahead, and swims along its
chord. With A = h/c, m' = rho pi C_A h^2/4 the added mass per length of a slender plate [kg/m], and x
counted aft from the root, four functions of A say what its finite span does:

    k       its added mass is M = k m' c, spread evenly over the chord
    k_r     its added moment of inertia about mid-chord is k_r m' c^3/12
    k_s     the slope of its steady lift is that of G = k_s m', k_s = 1 for a slender plate
    x_ac    its steady lift acts at x_ac (aerodynamic center)

and from them follow chi = 1 - k_s/2, b = 1/(2 - k_s), and x_w = c - x_ac, where by the flow reversal
theorem the speed across the plate decides on its lift. The lag is l = c (1 + A/9), at most 3 c.
`finite_span` has the law.

`TABLE` comes from a vortex lattice (`laticauda.water.fluid.lattice`). Between its rows,
logarithms are interpolated by a monotone cubic over log A. Beyond them the functions reach their
limits: for A -> 0 k, k_s, k_r -> 1 and x_ac -> 0, Lighthill's slender plate; for A -> infinity
k -> c/h, k_s -> 4 c/h, k_r -> 3 c/(8 h) and x_ac -> c/4, Theodorsen's and Garrick's flat plate.
"""

import math
from typing import NamedTuple

import numpy as np

from laticauda.values import magnitude, where

SLENDER = 0.98
"""Slope k_s from which on a body that ends in an edge counts as slender: Lighthill's law, without a state."""
NO_CAP = 1e9
"""Cap of a plate whose flow stays attached at any incidence [-]."""
_AT_REST = 1e-30
"""Keeps the speed of an edge differentiable at rest; far below any relevant speed [m^2/s^2]."""
LAG_OF_SPAN = 9.0
"""The lag is l = c (1 + A/9), the only number that was read off the unsteady lattice."""
LONGEST_LAG = 3.0
"""Largest lag in chords, that of the state that comes closest to Theodorsen's function."""


class PlateFunctions(NamedTuple):
    """What its finite span does to a plate, all relative to a slender one."""

    added_mass: float
    """k [-]."""
    lift: float
    """k_s [-]."""
    rotary: float
    """k_r [-]."""
    center: float
    """x_ac/c, from the root [-]."""


TABLE = (
    (0.04, PlateFunctions(0.9792, 0.9999, 0.9396, 0.0109)),
    (0.08, PlateFunctions(0.9582, 0.9998, 0.8821, 0.0210)),
    (0.12, PlateFunctions(0.9375, 0.9994, 0.8293, 0.0311)),
    (0.16, PlateFunctions(0.9171, 0.9990, 0.7804, 0.0409)),
    (0.24, PlateFunctions(0.8771, 0.9974, 0.6940, 0.0596)),
    (0.35, PlateFunctions(0.8242, 0.9936, 0.5965, 0.0830)),
    (0.5, PlateFunctions(0.7571, 0.9847, 0.4952, 0.1102)),
    (0.7, PlateFunctions(0.6776, 0.9665, 0.3997, 0.1382)),
    (1.0, PlateFunctions(0.5792, 0.9294, 0.3070, 0.1669)),
    (1.4, PlateFunctions(0.4802, 0.8724, 0.2330, 0.1903)),
    (2.0, PlateFunctions(0.3785, 0.7875, 0.1704, 0.2095)),
    (2.8, PlateFunctions(0.2931, 0.6889, 0.1252, 0.2225)),
    (4.0, PlateFunctions(0.2180, 0.5748, 0.0895, 0.2320)),
    (5.6, PlateFunctions(0.1620, 0.4681, 0.0648, 0.2379)),
    (8.0, PlateFunctions(0.1168, 0.3649, 0.0458, 0.2420)),
    (11.3, PlateFunctions(0.0844, 0.2796, 0.0327, 0.2446)),
    (16.0, PlateFunctions(0.0604, 0.2097, 0.0232, 0.2464)),
    (32.0, PlateFunctions(0.0307, 0.1134, 0.0117, 0.2483)),
)
"""A = h/c, and the functions of a rectangular plate there."""


def broad_plate(aspect: float) -> PlateFunctions:
    """Return the limits of the functions for a plate much higher than long.

    Args:
        aspect: A = h/c [-].
    """
    return PlateFunctions(
        added_mass=1.0 / aspect, lift=4.0 / aspect, rotary=0.375 / aspect, center=0.25
    )


def slender_plate() -> PlateFunctions:
    """Return the limits of the functions for a plate much longer than high."""
    return PlateFunctions(added_mass=1.0, lift=1.0, rotary=1.0, center=0.0)


def plate_functions(aspect: float) -> PlateFunctions:
    """Return the functions of a rectangular plate.

    Args:
        aspect: A = h/c [-].

    Example:
        >>> round(plate_functions(1.0).added_mass, 4)
        0.5792
    """
    lowest, first = TABLE[0]
    highest, last = TABLE[-1]
    if aspect < lowest:
        return _approach(slender_plate(), slender_plate(), first, aspect / lowest)
    if aspect > highest:
        return _approach(broad_plate(aspect), broad_plate(highest), last, highest / aspect)
    log_aspect = math.log(aspect)
    return PlateFunctions(*np.exp(_interpolate(log_aspect)).tolist())


def _approach(
    limit: PlateFunctions, limit_at_end: PlateFunctions, at_end: PlateFunctions, share: float
) -> PlateFunctions:
    """Return the limit of the functions, off by a share of their relative distance from it at the table's end."""
    values: list[float] = []
    for at_limit, at_limit_at_end, value in zip(limit, limit_at_end, at_end, strict=True):
        if at_limit_at_end == 0.0:
            values.append(value * share)
        else:
            values.append(at_limit * (1.0 + share * (value / at_limit_at_end - 1.0)))
    return PlateFunctions(*values)


def _interpolate(log_aspect: float) -> np.ndarray:
    """Return the logarithms of all functions at log A, by cubics that are monotone where the table is."""
    places = np.log([aspect for aspect, _ in TABLE])
    logarithms = np.log([functions for _, functions in TABLE])
    gaps = np.diff(places)
    secants = np.diff(logarithms, axis=0) / gaps[:, np.newaxis]
    k = min(int(np.searchsorted(places, log_aspect, side="right")) - 1, gaps.size - 1)
    begin, end = _slope_at(k, gaps, secants), _slope_at(k + 1, gaps, secants)
    s = (log_aspect - places[k]) / gaps[k]
    curve = (3.0 - 2.0 * s) * s * s
    bend = s * (1.0 - s) * gaps[k]
    return (
        (1.0 - curve) * logarithms[k]
        + curve * logarithms[k + 1]
        + bend * ((1.0 - s) * begin - s * end)
    )


def _slope_at(k: int, gaps: np.ndarray, secants: np.ndarray) -> np.ndarray:
    """Return the slopes at a row of the table (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984)."""
    if k == 0:
        return secants[0]
    if k == len(gaps):
        return secants[-1]
    secant_left = secants[k - 1]
    secant_right = secants[k]
    heavy, light = 2.0 * gaps[k] + gaps[k - 1], gaps[k] + 2.0 * gaps[k - 1]
    product = secant_left * secant_right
    divisor = heavy * secant_right + light * secant_left
    has_slope = product > 0.0
    return np.where(has_slope, (heavy + light) * product / np.where(has_slope, divisor, 1.0), 0.0)


class Plate(NamedTuple):
    """A plate with a trailing edge, as the law needs it."""

    lift_mass: float
    """G = k_s m' [kg/m]."""
    added_mass: float
    """M, of the whole plate [kg]."""
    lever: float
    """Distance from x_w forward to x_ac, x_w - x_ac [m]."""
    suction: float
    """chi [-]."""
    instant: float
    """b, share of the lift that comes at once [-]."""
    cap: float
    """A0, most of |y| over the speed of the edge, beyond which the flow separates [-]."""
    lag: float
    """l, length of the way over which the rest comes [m]."""


def build_plate(
    functions: PlateFunctions,
    *,
    mass_per_length: float,
    chord: float,
    height: float,
    cap: float = NO_CAP,
) -> Plate:
    """Return the numbers of a plate.

    Args:
        functions: Its functions of h/c.
        mass_per_length: m' [kg/m].
        chord: c [m].
        height: h at the edge [m].
        cap: A0, most of |y| over the speed of the edge [-].
    """
    return Plate(
        lift_mass=functions.lift * mass_per_length,
        added_mass=functions.added_mass * mass_per_length * chord,
        lever=chord * (1.0 - 2.0 * functions.center),
        suction=1.0 - 0.5 * functions.lift,
        instant=1.0 / (2.0 - functions.lift),
        cap=cap,
        lag=min(chord + height / LAG_OF_SPAN, LONGEST_LAG * chord),
    )


def finite_span(
    u: float,
    w: float,
    turning: float,
    memory: float,
    lift_mass: float,
    added_mass: float,
    lever: float,
    suction: float,
    instant: float,
    cap: float,
    lag: float,
) -> tuple[float, float, float, float]:
    """Return the load of a trailing edge, and the rate of its state.

    With w and theta' at x_w, w_ac = w + lever theta' and the state z, while u > 0,

        y   = b w + (1 - b) z                    dz/dt = (u / l) (w - z)
        f_n = -u G y at x_ac, and the couple u M w, which takes the Munk moment of M off again
        f_t = chi G y^2 - G y (w - w_ac) - M w theta'

    and for u <= 0 no load and dz/dt = -(|u| / l) z. The added mass must have the form `kirchhoff`. The
    edge never gives energy: with V = G l b z^2 / 2, its power is at most -dV/dt, for any motion.

    The flow separates where |y| > A0 sqrt(u^2 + w^2): y is held there, and the wake takes up the w
    that gives this y. That is passive, too.

    Args:
        u: Velocity along the plate, relative to the water [m/s].
        w: Velocity across it, to its left, at x_w [m/s].
        turning: theta', rate of turning to the left [rad/s].
        memory: z, the speed across that the wake remembers [m/s].
        lift_mass: G [kg/m].
        added_mass: M [kg].
        lever: x_w - x_ac [m].
        suction: chi [-].
        instant: b [-].
        cap: A0 [-].
        lag: l [m].

    Returns:
        f_t [N], f_n [N], moment about x_w [N m], dz/dt [m/s^2].
    """
    zero = 0.0 * u
    ahead = where(u.real > 0.0, u, zero)
    is_ahead = where(u.real > 0.0, zero + 1.0, zero)
    remembered = (1.0 - instant) * memory
    attached = instant * w + remembered
    most = cap * (u * u + w * w + _AT_REST) ** 0.5
    y = where(attached.real > most.real, most, attached)
    y = where(attached.real < -most.real, -most, y)
    is_separated = magnitude(attached).real > most.real
    w_of_wake = where(is_separated, (y - remembered) / instant, w)
    lift = lift_mass * y
    f_n = -ahead * lift
    f_t = is_ahead * (lift * (suction * y + lever * turning) - added_mass * w * turning)
    moment = lever * f_n + ahead * added_mass * w
    return f_t, f_n, moment, (ahead * w_of_wake - magnitude(u) * memory) / lag
