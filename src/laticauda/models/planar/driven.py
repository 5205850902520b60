"""Steps of a robot with free joints, by a semi-implicit Runge-Kutta method of order 3 (`dynamics.semi_implicit`).

A joint that a law drives is stiff: its rate is where the law wants it within a thousandth of a
second. Every stage therefore has two states. The *explicit* one follows from the slopes of the
stages before; in it, the loads and the inertias are those that `recursion` always computes. The
*implicit* one contains the slope of the stage itself; the laws of the joints, their skins and their
references belong to it:

    explicit    y + h sum_j<i e_ij k_j
    implicit    y + h sum_j<i m_ij k_j + h gamma k_i,    k_i = (rate in the implicit state, acceleration)

Before a stage is solved, a joint can be seen *coasting*: in its implicit state if it did not
accelerate. With its acceleration a it is at coast angle + (gamma h)^2 a and coast rate + gamma h a.
Along this line the torque of its law is approximated by a tangent, at the acceleration of the stage
before, which `recursion` takes as a torque and an inertia. Where the solution is so far away that
the law is off its tangent, the tangent becomes a chord, and the stage is solved again.

The works of the joints are integrated by the same method: their slopes are the powers in the implicit
states, with the torques that the stages were solved with.

`S` is the flat array of `rows`, `b` the first row of a body's record. A template (see `templates`),
loaded anew for every specialization of `stepping`.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

from laticauda.compiling import kernel
from laticauda.compiling.lanes import any_lane, first_lane, magnitude
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics.semi_implicit import (
    EXPLICIT_WEIGHTS,
    GAMMA,
    IMPLICIT_WEIGHTS,
    N_STAGES,
    NODES,
    WEIGHTS,
)
from laticauda.models.planar.rows import *

_specialization = bindings(__name__)
recursion = _specialization["recursion"]
drives = _specialization["drives"]

LAST = N_STAGES - 1
"""The last stage, whose implicit state is that at the end of the step."""
NEAR = 0.01
"""Change of a joint's rate by which no law departs much from its tangent; an error that is tolerated [rad/s]."""
MOST_SOLUTIONS = 6
"""How often a stage is solved at most."""


@kernel
def count_parts(S, dt):
    """Return into how many parts a step of `dt` is divided: more than one soon after time 0, the same in all lanes.

    There, joints at rest meet references that move (`semi_implicit.length_of_part`). Lanes that are
    not at the same time were started anew one by one, and their steps are not divided.
    """
    time = first_lane(S[TIME].real)
    if any_lane(S[TIME].real != time):
        return 1
    return drives.shared.count_parts(time, dt)


@kernel
def advance(S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, holds, dt):
    """Advance by one step; `holds`: some joint is prescribed, whose torque does work."""
    keep_state(S, n)
    gamma_dt = GAMMA * dt
    for stage in range(N_STAGES):
        explicit = lengths(EXPLICIT_WEIGHTS[stage], dt)
        implicit = lengths(IMPLICIT_WEIGHTS[stage], dt)
        drives.go_to_stage(S, n, law, tail_link, stage, NODES[stage] * dt)
        place_base(S, explicit)
        place_joints(S, n, law, explicit, implicit, stage, gamma_dt)
        for _ in range(MOST_SOLUTIONS):
            recursion.accelerations(
                S, n, first_strip, first_plate, is_free, tail_link, has_extras, holds
            )
            if not turn_tangents(S, n, law, gamma_dt):
                break
        keep_slopes(S, n, is_free, implicit, stage, gamma_dt)
        if holds:
            recursion.holding_torques(S, n, is_free)
        drives.add_work(S, n, law, gamma_dt, WEIGHTS[stage] * dt)
    finish(S, n, is_free, lengths(IMPLICIT_WEIGHTS[LAST], dt), gamma_dt)


@kernel
def lengths(weights, dt):
    """Return the times for which the slopes of the first three stages act; 0 for those that are not yet known."""
    first, second, third = weights
    return dt * first, dt * second, dt * third


@kernel
def moved(S, saved, slope, stride, lengths):
    """Return the number in row `saved` after three slopes have acted, whose rows are so far apart."""
    first, second, third = lengths
    change = first * S[slope]
    change += second * S[slope + stride]
    change += third * S[slope + 2 * stride]
    return S[saved] + change


@kernel
def moved_base(S, r, lengths):
    """Return row `r` of the base's state after such slopes."""
    return moved(S, SAVED + r, SLOPES + r, BASE_ROWS, lengths)


@kernel
def moved_angle(S, b, lengths):
    """Return the angle of a joint after such slopes."""
    return moved(S, b + SAVED_ANGLE, b + STAGE_RATES, 1, lengths)


@kernel
def moved_rate(S, b, lengths):
    """Return the rate of a joint after such slopes."""
    return moved(S, b + SAVED_RATE, b + STAGE_ACCELERATIONS, 1, lengths)


@kernel
def keep_state(S, n):
    """Store the state at the begin of the step."""
    drives.keep_generator(S)
    for r in range(BASE_ROWS):
        S[SAVED + r] = S[HEADING + r]
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        S[b + SAVED_ANGLE] = S[b + ANGLE]
        S[b + SAVED_RATE] = S[b + RATE]


@kernel
def place_base(S, explicit):
    """Put the base into its explicit state."""
    for r in range(BASE_ROWS):
        S[HEADING + r] = moved_base(S, r, explicit)


@kernel
def place_joints(S, n, law, explicit, implicit, stage, gamma_dt):
    """Put every free joint into its explicit state, and lay the tangent to its law for its implicit one."""
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            rate = moved_rate(S, b, implicit)
            S[b + COAST_RATE] = rate
            S[b + COAST_ANGLE] = moved_angle(S, b, implicit) + gamma_dt * rate
            S[b + ANGLE] = moved_angle(S, b, explicit)
            S[b + RATE] = moved_rate(S, b, explicit)
            guess = drives.zero_like(rate)
            if stage > 0:
                guess = S[b + STAGE_ACCELERATIONS + stage - 1]
            S[b + GUESS] = guess
            drives.lay_tangent(S, b, law[i], gamma_dt)


@kernel
def turn_tangents(S, n, law, gamma_dt):
    """Turn tangents that laws are off into chords; return whether there were any."""
    is_any_off = False
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if drives.is_curved(law[i]):
            acceleration = S[b + ACCELERATION]
            change = gamma_dt * (acceleration - S[b + GUESS])
            if any_lane(magnitude(change).real > NEAR):
                torque = drives.torque_along(S, b, law[i], acceleration, gamma_dt)
                error = torque - drives.torque_on_tangent(S, b, acceleration)
                inertia = magnitude(S[b + IMPLICIT]) + S[b + INERTIA]
                is_off = gamma_dt * magnitude(error).real > NEAR * inertia.real
                if any_lane(is_off):
                    drives.lay_chord(S, b, is_off, torque)
                    is_any_off = True
    return is_any_off


@kernel
def keep_slopes(S, n, is_free, implicit, stage, gamma_dt):
    """Store the slopes of the stage: rates in the implicit state, and accelerations."""
    slope = SLOPES + BASE_ROWS * stage
    for r in range(N_FREEDOMS):
        acceleration = S[HEADING_ACCELERATION + r]
        coast_rate = moved_base(S, N_FREEDOMS + r, implicit)
        S[slope + r] = coast_rate + gamma_dt * acceleration
        S[slope + N_FREEDOMS + r] = acceleration
    S[slope + EDGE_MEMORY - HEADING] = S[EDGE_MEMORY_RATE]
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if is_free[i]:
            acceleration = S[b + ACCELERATION]
            S[b + STAGE_RATES + stage] = S[b + COAST_RATE] + gamma_dt * acceleration
            S[b + STAGE_ACCELERATIONS + stage] = acceleration


@kernel
def finish(S, n, is_free, implicit, gamma_dt):
    """Put base and joints into the implicit state of the last stage, where the step ends."""
    for r in range(BASE_ROWS):
        last = S[SLOPES + BASE_ROWS * LAST + r]
        S[HEADING + r] = moved_base(S, r, implicit) + gamma_dt * last
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if is_free[i]:
            S[b + ANGLE] = moved_angle(S, b, implicit) + gamma_dt * S[b + STAGE_RATES + LAST]
            S[b + RATE] = S[b + STAGE_RATES + LAST]
