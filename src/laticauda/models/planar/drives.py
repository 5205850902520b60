"""Drives of the joints: the reference generator, the joint laws, and the work of the joints.

The generator has a state of its own, the waves of body and fin. It advances in equal steps, which
may be shorter than a step of the run: `set_decay` prepares for steps of one length, and
`advance_reference` performs one of them.

`S` is the flat array of `rows`, `b` the first row of a body's record. The joint law is identified by
`law`, one number per joint (LOCKED ... OWN_DRIVEN). `shared` holds the scalar laws that both models
call (`dynamics.shared_laws`). Types of numbers: see `number_types`.

A template (see `templates`): this file is loaded anew for every joint law of one's own and number of
lanes. `bindings` holds that of this loading, under the name that `model.TEMPLATES` lists.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import compile_scalar, kernel
from laticauda.compiling.formulas import rows_from
from laticauda.compiling.functions import expm1, sincos
from laticauda.compiling.lanes import any_lane, first_lane
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics.shared_laws import compile_shared_laws
from laticauda.models.planar import number_types
from laticauda.models.planar.rows import *
from laticauda.motion.gaits import reference
from laticauda.motion.joints import laws
from laticauda.motion.joints.kernels import actuator_of

_own_law = bindings(__name__)["joint_law"]

shared = compile_shared_laws()
zero_like = compile_scalar(number_types.zero_like)
body_wave = rows_from(PHASE, len(reference.WaveState._fields))
body_target = rows_from(AMPLITUDE, OFFSET + 1 - AMPLITUDE)
fin_wave_before_offset = rows_from(FIN_PHASE, FIN_OFFSET_NOW - FIN_PHASE)
follow_law = actuator_of(_own_law)
drive_of = rows_from(DRIVE, len(laws.Drive._fields))
motor_of = rows_from(MOTOR, STALL_POWER + 1 - MOTOR)
law_numbers = rows_from(JOINT_LAW, 0 if _own_law is None else len(_own_law.fields))


@kernel
def set_decay(S, dt):
    """Prepare the generator for steps of `dt`: set the decay of its filters over one of them."""
    S[DECAY] = 1.0 + expm1(-S[BANDWIDTH] * dt)


@kernel
def advance_reference(S, n, law, tail_link, dt):
    """Advance the generator by one step, and set the reference; dt must be what `set_decay` was given last."""
    w, decay = S[BANDWIDTH], S[DECAY]
    if has_driven_fin(law, tail_link):
        fin = shared.advance_wave(fin_wave(S), fin_target(S), w, decay, dt)
        phase, amplitude, amplitude_rate, frequency, frequency_rate, _, _, offset, offset_rate = fin
        before_offset = phase, amplitude, amplitude_rate, frequency, frequency_rate
        for row, value in enumerate((*before_offset, offset, offset_rate)):
            S[FIN_PHASE + row] = value
    body = shared.advance_wave(body_wave(S), body_target(S), w, decay, dt)
    for row, value in enumerate(body):
        S[PHASE + row] = value
    S[TIME], S[TIME_REST] = shared.advance_time(S[TIME], S[TIME_REST], dt)
    set_reference(S, n, law, tail_link)


@kernel
def has_driven_fin(law, tail_link):
    """Return whether the joint between fin and tail link has an actuator."""
    return tail_link > 0 and law[tail_link] != LOCKED and law[tail_link] != PASSIVE


@kernel
def fin_wave(S):
    """Return the state of a driven fin's wave, which has one joint and no phase shift."""
    zero = zero_like(S[FIN_PHASE])
    return (*fin_wave_before_offset(S), zero, zero, S[FIN_OFFSET_NOW], S[FIN_OFFSET_RATE])


@kernel
def fin_target(S):
    """Return the target of a driven fin's wave."""
    return S[FIN_AMPLITUDE], S[FIN_FREQUENCY], zero_like(S[FIN_FREQUENCY]), S[FIN_OFFSET]


@kernel
def set_reference(S, n, law, tail_link):
    """Set phi_ref and its derivatives for every driven joint from the generator's state."""
    ramp = shared.smooth_start(S[TIME], S[RAMP])
    if has_driven_fin(law, tail_link):
        b = HEADER_ROWS + tail_link * BODY_ROWS
        wave = shared.wave_motion(fin_wave(S), fin_target(S), S[BANDWIDTH], ramp)
        s, c = sincos(S[FIN_PHASE] + S[FIN_LEAD])
        take_reference(
            S, b, law[tail_link], shared.wave_reference(s, c, S[b + ENVELOPE], 0.0, wave)
        )
    wave = shared.wave_motion(body_wave(S), body_target(S), S[BANDWIDTH], ramp)
    S[SIN_PHASE], S[COS_PHASE] = sincos(S[PHASE])
    S[SIN_SHIFT], S[COS_SHIFT] = sincos(S[PHASE_SHIFT_NOW])
    k = 0.0
    for i in range(tail_link + 1, n):
        if law[i] != LOCKED and law[i] != PASSIVE:
            b = HEADER_ROWS + i * BODY_ROWS
            s, c = S[SIN_PHASE], S[COS_PHASE]
            take_reference(S, b, law[i], shared.wave_reference(s, c, S[b + ENVELOPE], k, wave))
            # Rotate to the next joint; stored in rows, so that the compiler rounds the products one
            # at a time.
            S[SIN_PHASE] = s * S[COS_SHIFT] + c * S[SIN_SHIFT]
            S[COS_PHASE] = c * S[COS_SHIFT] - s * S[SIN_SHIFT]
            k += 1.0
    if first_lane(S[KNOTS].real) > 0.0:
        add_recorded(S, n, law, tail_link)


@kernel
def add_recorded(S, n, law, tail_link):
    """Add the angles of a recording to the references of the body's joints.

    A knot is the time, then angle and rate of every joint.
    """
    width = 1 + 2 * (n - 1 - tail_link)
    before = recorded_knot(S, width)
    after = before + width
    for i in range(tail_link + 1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        at_angle = 2 * (i - tail_link) - 1
        at_rate = at_angle + 1
        angle, rate, acceleration = shared.between_knots(
            S[TIME],
            S[before],
            S[after],
            S[before + at_angle],
            S[before + at_rate],
            S[after + at_angle],
            S[after + at_rate],
        )
        reference = (
            S[b + REFERENCE] + angle,
            S[b + REFERENCE_1] + rate,
            S[b + REFERENCE_2] + acceleration,
        )
        take_reference(S, b, law[i], reference)


@kernel
def recorded_knot(S, width):
    """Return the first row of the last knot before the current time, the same in all lanes."""
    first, last = int(first_lane(S[KNOTS].real)), int(first_lane(S[N_KNOTS].real)) - 2
    k, time = int(first_lane(S[KNOT].real)), first_lane(S[TIME].real)
    while k < last and time >= first_lane(S[first + (k + 1) * width].real):
        k += 1
    while k > 0 and time < first_lane(S[first + k * width].real):
        k -= 1
    S[KNOT] = float(k)
    return first + k * width


@kernel
def take_reference(S, b, law, reference):
    """Store a joint's reference, which a prescribed joint follows immediately."""
    angle, rate, acceleration = reference
    S[b + REFERENCE] = angle
    S[b + REFERENCE_1] = rate
    S[b + REFERENCE_2] = acceleration
    if law == PRESCRIBED:
        S[b + ANGLE] = angle
        S[b + RATE] = rate


@kernel
def joint_torques(S, n, law, gamma_dt):
    """Set torque and slopes of every free joint in the state in S, and what an implicit step makes of them.

    With gamma_dt = 0 there are no implicit terms: the accelerations that follow are those of the
    state itself. Otherwise they are that of k1 in the method of `dynamics.stages`, which differs
    from them by a share of the order of dt. TORQUE is that of the state in both cases.
    """
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            torque, slope_p, slope_d = actuator(S, b, law[i])
            slope_p += S[b + STIFFNESS]
            slope_d += S[b + DAMPING]
            S[b + TORQUE] = torque
            S[b + SLOPE_P] = slope_p
            S[b + SLOPE_D] = slope_d
            S[b + IMPLICIT] = shared.implicit_inertia(slope_p, slope_d, gamma_dt)
            total = torque - skin(S, b) - gamma_dt * slope_p * S[b + RATE]
            S[b + TOTAL_TORQUE] = total


@kernel
def second_torques(S, n, law, gamma_dt):
    """Set the torques of the second stage of an implicit step, by `stages.second_torque`.

    With them, `recursion.accelerations` solves this stage for a = k2 + 2 k1 instead of for k2, which
    would need a product of the mass matrix and k1; `stages.combined` takes 2 k1 away again.
    """
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            torque, _, _ = actuator(S, b, law[i])
            torque -= skin(S, b)
            inertia, k1_rate, k1 = S[b + IMPLICIT], S[b + SLOPE_ANGLE], S[b + SLOPE_RATE]
            S[b + TOTAL_TORQUE] = shared.second_torque(
                torque, S[b + SLOPE_P], inertia, S[b + RATE], k1_rate, k1, gamma_dt
            )


@kernel
def skin(S, b):
    """Return the torque of the skin (or a hinge) against the joint's angle and rate."""
    return S[b + STIFFNESS] * S[b + ANGLE] + S[b + DAMPING] * S[b + RATE]


@kernel
def actuator(S, b, law):
    """Return the torque of the joint's actuator and its slopes."""
    motion = S[b + ANGLE], S[b + RATE], S[b + REFERENCE], S[b + REFERENCE_1], S[b + REFERENCE_2]
    return follow_law(law, motion, drive_of(S, b), law_numbers(S))


@kernel
def count_work(S, n, law, dt):
    """Set the torques that the actuators deliver, and add the work since work was counted last, dt ago.

    By the trapezoidal rule: the powers of that time are still in their rows. The actuator of a joint
    whose motion is known delivers what `recursion.holding_torques` found, and the torque of its
    skin. A locked joint has neither rate nor skin: it does no work.
    """
    absolute = zero_like(S[TIME])
    net, positive = absolute, absolute
    electrical = absolute + S[ACTIVE_POWER]
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] < FIRST_FREE:
            S[b + TORQUE] = S[b + TOTAL_TORQUE] + skin(S, b)
        magnitude, signed, delivered = shared.joint_powers(S[b + TORQUE], S[b + RATE])
        if any_lane(S[b + STALL_POWER].real > 0.0):
            electrical += shared.motor_power(S[b + TORQUE], S[b + RATE], *motor_of(S, b))
        absolute += magnitude
        net += signed
        positive += delivered
    half = 0.5 * dt
    for k, power in enumerate((absolute, net, positive, electrical)):
        S[WORK_ABSOLUTE + k] += half * (S[POWER_ABSOLUTE + k] + power)
        S[POWER_ABSOLUTE + k] = power
