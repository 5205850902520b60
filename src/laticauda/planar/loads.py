"""What the water (or the ground) and the effectors do to the bodies of the chain.

Forces are in the axes of the link, moments about its tail end. A template (see `templates`): `S` is the flat array of
`rows`, `b` the first row of a body's record.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import compiled, kernel
from laticauda.compiling.formulas import in_rows, rows_from
from laticauda.compiling.lanes import magnitude, where
from laticauda.compiling.templates import bindings
from laticauda.fluid.laws import MOTION, Element, plate
from laticauda.planar.functions import sincos
from laticauda.planar.rows import *

_names = bindings(__name__)
law = in_rows(_names["law"], Element, MOTION)
law_numbers = rows_from(LAW, len(_names["law"].fields))
plate_law = compiled(plate)
plate_numbers = rows_from(PLATE_LAW, PLATE_ROWS - PLATE_LAW)


@kernel
def element_drag(S, b, e):
    """Drag of one element rigid on body b, link axes, and its moment about the tail end of b.

    `e` is the first of the element's five rows: its distance from the tail end, c_t, c_n, lambda_2, lambda_3. A body's
    own (from CENTER on) and a strip's (from STRIP_POSITION on) stand in the same order.
    """
    rate = S[b + LINK_RATE]
    x = S[e]
    v_n = S[b + V_N] + x * rate
    f_t, f_n, tau = law(S[b + V_T], v_n, magnitude(v_n), rate, S[e + 1], S[e + 2], S[e + 3], S[e + 4], *law_numbers(S))
    return f_t, f_n, tau + x * f_n


@kernel
def added_mass_velocity_terms(S, b):
    """Velocity-dependent part of the added-mass force (link axes) and its moment about the tail end."""
    rate = S[b + LINK_RATE]
    v_t, v_n = S[b + V_T], S[b + V_N]
    mu_t, mu_n = S[b + MU_T], S[b + MU_N]
    moment_t, moment_n = S[b + MOMENT_T], S[b + MOMENT_N]
    # The classic form sees the current only: its velocity is -V where the others have v - V.
    own, keep = S[OWN_VELOCITY], S[KIRCHHOFF]
    c, s = S[b + COS], S[b + SIN]
    V_t = c * S[CURRENT_X] + s * S[CURRENT_Y]
    V_n = c * S[CURRENT_Y] - s * S[CURRENT_X]
    seen_t = own * (v_t + V_t) - V_t
    seen_n = own * (v_n + V_n) - V_n
    momentum_n = mu_n * v_n + moment_n * rate
    f_t = rate * (keep * momentum_n - mu_t * seen_n)
    f_n = rate * (mu_n * seen_t - keep * mu_t * v_t)
    munk = -keep * v_t * (momentum_n - mu_t * v_n - moment_t * rate)
    return f_t, f_n, munk + rate * (moment_n * seen_t - keep * moment_t * v_t)


@kernel
def extra_loads(S, n, first_strip, first_plate, tail_link):
    """Thrusters, fin strips, pectoral fins, tether and trailing edge: loads that only some bodies have."""
    H = HEADER_ROWS
    for i in range(n):
        b = H + i * BODY_ROWS
        S[b + EXTRA_T] = S[b + THRUST_T]
        S[b + EXTRA_N] = S[b + THRUST_N]
        S[b + EXTRA_MOMENT] = S[b + THRUST_MOMENT]
        for e in range(first_strip[i], first_strip[i + 1]):
            strip_drag(S, b, H + n * BODY_ROWS + e * STRIP_ROWS)
        for e in range(first_plate[i], first_plate[i + 1]):
            plate_load(S, b, H + n * BODY_ROWS + first_strip[n] * STRIP_ROWS + e * PLATE_ROWS)
    tether(S, H + tail_link * BODY_ROWS)
    trailing_edge(S)


@kernel
def strip_drag(S, b, e):
    """Drag of one strip, rigid on body b at its own distance from the tail end."""
    f_t, f_n, moment = element_drag(S, b, e + STRIP_POSITION)
    S[b + EXTRA_T] += f_t
    S[b + EXTRA_N] += f_n
    S[b + EXTRA_MOMENT] += moment


@kernel
def plate_load(S, b, e):
    """Lift and drag of one pectoral fin mounted on body b."""
    rate = S[b + LINK_RATE]
    x = S[e + PLATE_X]
    y = S[e + PLATE_Y]
    v_t = S[b + V_T] - y * rate
    v_n = S[b + V_N] + x * rate
    s, c = sincos(S[e + PLATE_ANGLE])
    f_chord, f_normal = plate_law(c * v_t + s * v_n, c * v_n - s * v_t, *plate_numbers(S, e))
    f_t = c * f_chord - s * f_normal
    f_n = s * f_chord + c * f_normal
    S[b + EXTRA_T] += f_t
    S[b + EXTRA_N] += f_n
    S[b + EXTRA_MOMENT] += x * f_n - y * f_t


@kernel
def tether(S, b):
    """F = -k |v| v + constant, at the tail end of the tail link."""
    c, s = S[b + COS], S[b + SIN]
    v_t, v_n = S[b + V_T], S[b + V_N]
    drag = S[TETHER_DRAG] * (v_t * v_t + v_n * v_n) ** 0.5
    S[b + EXTRA_T] += c * S[TETHER_FORCE_X] + s * S[TETHER_FORCE_Y] - drag * v_t
    S[b + EXTRA_N] += c * S[TETHER_FORCE_Y] - s * S[TETHER_FORCE_X] - drag * v_n


@kernel
def trailing_edge(S):
    """Momentum that leaves with the wake (Lighthill 1971): m'/2 w^2 t - m' u w n while u > 0."""
    b = HEADER_ROWS
    x = S[WAKE_POSITION]
    u = S[b + V_T]
    w = S[b + V_N] + x * S[b + LINK_RATE]
    shed = where(u.real > 0.0, S[WAKE_MASS], 0.0 * u)
    f_n = -shed * u * w
    S[b + EXTRA_T] += 0.5 * shed * w * w
    S[b + EXTRA_N] += f_n
    S[b + EXTRA_MOMENT] += x * f_n


@kernel
def body_forces(S, n, first_strip, force):
    """Drag, added-mass and effector force on every body, world axes, once the accelerations are known.

    `force` holds two rows per body, x and y: of all bodies the drag, then the added mass, then the effectors.
    """
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        drag, added_mass, effector = 2 * i, 2 * (n + i), 2 * (2 * n + i)
        extra_t, extra_n = S[b + EXTRA_T], S[b + EXTRA_N]
        # Strips add to the extra loads: collect theirs alone, and move them from effectors to drag.
        S[b + EXTRA_T] = 0.0
        S[b + EXTRA_N] = 0.0
        for e in range(first_strip[i], first_strip[i + 1]):
            strip_drag(S, b, HEADER_ROWS + n * BODY_ROWS + e * STRIP_ROWS)
        f_t, f_n, _ = element_drag(S, b, b + CENTER)
        put_force(S, b, force, drag, f_t + S[b + EXTRA_T], f_n + S[b + EXTRA_N])
        put_force(S, b, force, effector, extra_t - S[b + EXTRA_T], extra_n - S[b + EXTRA_N])
        f_t, f_n = added_mass_force(S, b)
        put_force(S, b, force, added_mass, f_t, f_n)


@kernel
def put_force(S, b, force, row, f_t, f_n):
    """Store a force given in link axes of body b in world axes."""
    c, s = S[b + COS], S[b + SIN]
    force[row] = c * f_t - s * f_n
    force[row + 1] = s * f_t + c * f_n


@kernel
def added_mass_force(S, b):
    """The whole added-mass force on body b, link axes: what its acceleration and its velocity call for."""
    f_t, f_n, _ = added_mass_velocity_terms(S, b)
    c, s = S[b + COS], S[b + SIN]
    rate = S[b + LINK_RATE]
    a_t = c * S[b + QX] + s * S[b + QY]
    a_n = c * S[b + QY] - s * S[b + QX]
    # In all forms but the classic one the centripetal part along the body cancels.
    left = (1.0 - S[OWN_VELOCITY]) * S[b + MOMENT_T] * rate * rate
    f_t += left - S[b + MU_T] * a_t
    f_n -= S[b + MU_N] * a_n + S[b + MOMENT_N] * S[b + LINK_ACCELERATION]
    return f_t, f_n
