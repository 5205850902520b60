"""Semi-implicit Runge-Kutta method of order 3 for stiff joints: its coefficients, and its first step.

For y' = f(y, y), whose second argument is stiff, with four stages:

    k_i = f(y + h sum_j<i e_ij k_j, y + h sum_j<i m_ij k_j + h gamma k_i),
    y(t + h) = y + h sum_i b_i k_i

f need not be linear in the second argument, and a time on which it depends belongs to that. The last
row of m is b: the method is stiffly accurate, and its implicit half L-stable. With c = e 1 and
d = m 1 (gamma included), the conditions of order 3 are sum b = 1, b c = b d = 1/2, b c^2 = b c d =
b d^2 = 1/3 and b X z = 1/6 for X in (e, m), z in (c, d). Two more keep the order if what is stiff is
stiff beyond measure, where the slopes of the stages are m^-1 d^2 instead of 2 d in the second
moment: b e m^-1 d^2 = 1/3, b (c m^-1 d^2) = 2/3 (products by element). Coefficients were found by
least squares from random starts: those that leave the smallest errors of order 4.

Semi-implicit methods of this form: Boscarino, Filbet and Russo, J. Sci. Comput. 68, 2016.
"""

GAMMA = 0.275
"""Weight of its own slope in the implicit state of a stage."""
EXPLICIT_WEIGHTS = (
    (0.0, 0.0, 0.0),
    (0.3153978020353625, 0.0, 0.0),
    (0.33707782945031384, 0.09707063975687723, 0.0),
    (-0.09223286462745073, -0.8031619923413928, 1.7649234763739972),
)
"""e, weights of the slopes of earlier stages in the explicit state of a stage."""
IMPLICIT_WEIGHTS = (
    (0.0, 0.0, 0.0),
    (0.29450703821763713, 0.0, 0.0),
    (0.3061959703435137, -0.16135726978693044, 0.0),
    (0.21283834257067477, -0.3244228518588305, 0.8365845092881556),
)
"""m, weights of the slopes of earlier stages in the implicit state of a stage; the last row begins b."""
WEIGHTS = (*IMPLICIT_WEIGHTS[-1], GAMMA)
"""b, weights of the slopes in the state at the end of the step."""
N_STAGES = len(WEIGHTS)
NODES = (*(sum(weights) + GAMMA for weights in IMPLICIT_WEIGHTS[:-1]), 1.0)
"""d, shares of the step after which the implicit states lie.

The last sum is 1 but for rounding, which clocks would count."""
N_HALVINGS = 8
"""The first part of the first step of a run is so often the half of it."""
PARTS_PER_HALVING = 4
"""Parts of equal length until the time since the start has doubled."""
N_PARTS = 1 + N_HALVINGS * PARTS_PER_HALVING
"""Parts of the first step."""

CLOSE = 1e-6
"""Shares of a step that are nothing."""


def count_parts(time: float, dt: float) -> int:
    """Return into how many parts a step is divided: more than one soon after time 0 (`length_of_part`).

    Args:
        time: Time at its begin [s].
        dt: The step [s].
    """
    if time >= PARTS_PER_HALVING * dt:
        return 1
    if time == 0.0:
        return N_PARTS
    return 1 + int(PARTS_PER_HALVING * dt / time - CLOSE)


def length_of_part(part: int, n_parts: int, dt: float) -> float:
    """Return the length of a part of a step [s].

    A joint that starts at rest, while its reference moves, is at its rate within a thousandth of a
    second, and does up to a hundredth of the work of half a minute in that time. Steps soon after
    the start are therefore divided: each part is a quarter of the time before it, at most.

    Args:
        part: Which one, from 0.
        n_parts: Number of parts of the step; N_PARTS: it is the first one of the run, whose parts
            grow. Parts of others are equal.
        dt: The step [s].
    """
    if n_parts != N_PARTS:
        return dt / n_parts
    # Shifted, not raised to a power: Numba's power of integers can raise an exception, for which
    # kernels without Python have no place.
    if part == 0:
        return dt / (1 << N_HALVINGS)
    halvings = N_HALVINGS - (part - 1) // PARTS_PER_HALVING
    return dt / (1 << halvings) / PARTS_PER_HALVING


def implicit_inertia(slope_p: float, slope_d: float, gamma_dt: float) -> float:
    """Return the inertia that stands for the slopes of a joint's law in an implicit state [kg m^2].

    Args:
        slope_p: Total K_p at the joint [N m/rad].
        slope_d: Total K_d at the joint [N m s/rad].
        gamma_dt: gamma h [s].
    """
    return gamma_dt * (slope_d + gamma_dt * slope_p)
