"""How the joints are driven: the reference generator, the joint laws, and the work they do.

A template (see `specialize`): `S` is the flat array of `rows`; the scalar laws come from `gaits.reference` and
`actuation.laws`. Joint laws are told apart by `law`, one number per joint (LOCKED ... PASSIVE).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

from typing import no_type_check

from laticauda.actuation import laws
from laticauda.actuation.kernels import actuator_of
from laticauda.compiling import compiled, kernel
from laticauda.compiling.formulas import rows_from
from laticauda.compiling.lanes import any_lane, magnitude
from laticauda.compiling.templates import bindings
from laticauda.gaits import reference
from laticauda.planar.functions import expm1, sincos
from laticauda.planar.rows import *

filter_step = compiled(reference.filter_step)
filter_acceleration = compiled(reference.filter_acceleration)
smooth_start = compiled(reference.smooth_start)
ramped = compiled(reference.ramped)
joint_reference = compiled(reference.joint_reference)
motor_power = compiled(laws.motor_power)
_own = bindings(__name__)["joint_law"]
by_law = actuator_of(_own)
law_numbers = rows_from(JOINT_LAW, 0 if _own is None else len(_own.fields))


@kernel
@no_type_check
def set_decay(S, dt):
    """What `advance_reference` needs to know about its step."""
    S[DECAY] = 1.0 + expm1(-S[BANDWIDTH] * dt)


@kernel
@no_type_check
def advance_reference(S, n, law, tail_link, dt):
    """Move the generator on by dt, the step that `set_decay` was told, and set the reference there."""
    w, decay = S[BANDWIDTH], S[DECAY]
    if has_driven_fin(law, tail_link):
        advance_fin(S, dt)
    for value, target in ((AMPLITUDE_NOW, AMPLITUDE), (PHASE_SHIFT_NOW, PHASE_SHIFT), (OFFSET_NOW, OFFSET)):
        y, rate, _ = filter_step(S[value], S[value + 1], S[target], w, decay, dt)
        S[value] = y
        S[value + 1] = rate
    y, rate, turned = filter_step(S[FREQUENCY_NOW], S[FREQUENCY_RATE], S[FREQUENCY], w, decay, dt)
    S[FREQUENCY_NOW] = y
    S[FREQUENCY_RATE] = rate
    S[PHASE] += turned
    before, due = S[TIME], dt - S[TIME_REST]
    S[TIME] = before + due
    S[TIME_REST] = (S[TIME] - before) - due
    set_reference(S, n, law, tail_link)


@kernel
@no_type_check
def has_driven_fin(law, tail_link):
    """Whether the joint between fin and tail link has an actuator."""
    return tail_link > 0 and law[tail_link] != LOCKED and law[tail_link] != PASSIVE


@kernel
@no_type_check
def advance_fin(S, dt):
    """Move a driven fin's own generator on by dt."""
    w, decay = S[BANDWIDTH], S[DECAY]
    for value, target in ((FIN_AMPLITUDE_NOW, FIN_AMPLITUDE), (FIN_OFFSET_NOW, FIN_OFFSET)):
        y, rate, _ = filter_step(S[value], S[value + 1], S[target], w, decay, dt)
        S[value] = y
        S[value + 1] = rate
    y, rate, turned = filter_step(S[FIN_FREQUENCY_NOW], S[FIN_FREQUENCY_RATE], S[FIN_FREQUENCY], w, decay, dt)
    S[FIN_FREQUENCY_NOW] = y
    S[FIN_FREQUENCY_RATE] = rate
    S[FIN_PHASE] += turned


@kernel
@no_type_check
def set_reference(S, n, law, tail_link):
    """phi_ref of every driven joint, and its derivatives, from the generator's state."""
    w = S[BANDWIDTH]
    ramp, ramp_1, ramp_2 = smooth_start(S[TIME], S[RAMP])
    amplitude, rate = S[AMPLITUDE_NOW], S[AMPLITUDE_RATE]
    second = filter_acceleration(amplitude, rate, S[AMPLITUDE], w)
    a0, a1, a2 = ramped(amplitude, rate, second, ramp, ramp_1, ramp_2)
    S[AMP] = a0
    S[AMP_1] = a1
    S[AMP_2] = a2
    # The phase is the integral of the filtered frequency, so its second derivative is that one's first.
    S[FREQUENCY_2] = S[FREQUENCY_RATE]
    S[SHIFT_2] = filter_acceleration(S[PHASE_SHIFT_NOW], S[PHASE_SHIFT_RATE], S[PHASE_SHIFT], w)
    S[OFFSET_2] = filter_acceleration(S[OFFSET_NOW], S[OFFSET_RATE], S[OFFSET], w)
    s, c = sincos(S[PHASE])
    S[SIN_PHASE] = s
    S[COS_PHASE] = c
    s, c = sincos(S[PHASE_SHIFT_NOW])
    S[SIN_SHIFT] = s
    S[COS_SHIFT] = c
    if has_driven_fin(law, tail_link):
        fin_reference(S, HEADER_ROWS + tail_link * BODY_ROWS, law[tail_link], ramp, ramp_1, ramp_2)
    joint = 0.0
    for i in range(tail_link + 1, n):
        if law[i] != LOCKED and law[i] != PASSIVE:
            one_reference(S, HEADER_ROWS + i * BODY_ROWS, joint, law[i])
            joint += 1.0


@kernel
@no_type_check
def fin_reference(S, b, law, ramp, ramp_1, ramp_2):
    """The reference of a driven fin, whose joint is that of record b."""
    w = S[BANDWIDTH]
    amplitude, rate = S[FIN_AMPLITUDE_NOW], S[FIN_AMPLITUDE_RATE]
    second = filter_acceleration(amplitude, rate, S[FIN_AMPLITUDE], w)
    a0, a1, a2 = ramped(amplitude, rate, second, ramp, ramp_1, ramp_2)
    s, c = sincos(S[FIN_PHASE] + S[FIN_LEAD])
    offset, offset_rate = S[FIN_OFFSET_NOW], S[FIN_OFFSET_RATE]
    offset_2 = filter_acceleration(offset, offset_rate, S[FIN_OFFSET], w)
    angle, rate, acceleration = joint_reference(
        s,
        c,
        S[b + ENVELOPE],
        a0,
        a1,
        a2,
        S[FIN_FREQUENCY_NOW],
        S[FIN_FREQUENCY_RATE],
        offset,
        offset_rate,
        offset_2,
    )
    take_reference(S, b, law, angle, rate, acceleration)


@kernel
@no_type_check
def one_reference(S, b, joint, law):
    """The reference of one joint; the sine of the next joint's phase follows by rotation."""
    s, c = S[SIN_PHASE], S[COS_PHASE]
    angle, rate, acceleration = joint_reference(
        s,
        c,
        S[b + ENVELOPE],
        S[AMP],
        S[AMP_1],
        S[AMP_2],
        S[FREQUENCY_NOW] + joint * S[PHASE_SHIFT_RATE],
        S[FREQUENCY_2] + joint * S[SHIFT_2],
        S[OFFSET_NOW],
        S[OFFSET_RATE],
        S[OFFSET_2],
    )
    take_reference(S, b, law, angle, rate, acceleration)
    S[SIN_PHASE] = s * S[COS_SHIFT] + c * S[SIN_SHIFT]
    S[COS_PHASE] = c * S[COS_SHIFT] - s * S[SIN_SHIFT]


@kernel
@no_type_check
def take_reference(S, b, law, angle, rate, acceleration):
    """Store a joint's reference, which a prescribed joint follows at once."""
    S[b + REFERENCE] = angle
    S[b + REFERENCE_1] = rate
    S[b + REFERENCE_2] = acceleration
    if law == PRESCRIBED:
        S[b + ANGLE] = angle
        S[b + RATE] = rate


@kernel
@no_type_check
def joint_torques(S, n, law, gamma_dt):
    """Torque of every free joint for the first stage of an implicit step, and what that step adds to its inertia."""
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            torque, slope_p, slope_d = actuator(S, b, law[i])
            slope_p += S[b + STIFFNESS]
            slope_d += S[b + DAMPING]
            S[b + TORQUE] = torque
            S[b + SLOPE_P] = slope_p
            S[b + SLOPE_D] = slope_d
            S[b + IMPLICIT] = gamma_dt * (slope_d + gamma_dt * slope_p)
            total = torque - skin(S, b) - gamma_dt * slope_p * S[b + RATE]
            S[b + TOTAL_TORQUE] = total


@kernel
@no_type_check
def second_torques(S, n, law, gamma_dt):
    """Right-hand side of the second stage for a = k2 + 2 k1, so that the mass matrix is not needed."""
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            torque, _, _ = actuator(S, b, law[i])
            slope_p = S[b + SLOPE_P]
            rest = S[b + RATE] - 2.0 * S[b + SLOPE_ANGLE]
            implicit = 2.0 * S[b + IMPLICIT] * S[b + SLOPE_RATE]
            S[b + TOTAL_TORQUE] = torque - skin(S, b) - gamma_dt * slope_p * rest + implicit


@kernel
@no_type_check
def skin(S, b):
    """Torque that the skin (or a hinge) sets against the joint's angle and rate."""
    return S[b + STIFFNESS] * S[b + ANGLE] + S[b + DAMPING] * S[b + RATE]


@kernel
@no_type_check
def actuator(S, b, law):
    """Torque of the joint's actuator, and its slopes."""
    motion = S[b + ANGLE], S[b + RATE], S[b + REFERENCE], S[b + REFERENCE_1], S[b + REFERENCE_2]
    drive = (
        S[b + PROPORTIONAL_GAIN],
        S[b + DERIVATIVE_GAIN],
        S[b + SERVO_GAIN],
        S[b + STALL_TORQUE],
        S[b + NO_LOAD_SPEED],
        S[b + FRICTION_TORQUE],
        S[b + VISCOUS_FRICTION],
    )
    return by_law(law, motion, drive, law_numbers(S))


@kernel
@no_type_check
def electrical_power(S, b):
    """What the joint's motor draws from the supply."""
    return motor_power(
        S[b + TORQUE],
        S[b + RATE],
        S[b + STALL_TORQUE],
        S[b + NO_LOAD_SPEED],
        S[b + FRICTION_TORQUE],
        S[b + VISCOUS_FRICTION],
        S[b + STALL_POWER],
    )


@kernel
@no_type_check
def count_work(S, n, law, dt):
    """Joint torques as the actuators see them, and the work since the last step by the trapezoidal rule."""
    absolute = 0.0 * S[TIME]
    net, positive = absolute, absolute
    electrical = absolute + S[ACTIVE_POWER]
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] < FIRST_FREE:
            S[b + TORQUE] = S[b + TOTAL_TORQUE] + skin(S, b)
        power = S[b + TORQUE] * S[b + RATE]
        if any_lane(S[b + STALL_POWER].real > 0.0):
            electrical += electrical_power(S, b)
        absolute += magnitude(power)
        net += power
        positive += 0.5 * (power + magnitude(power))
    half = 0.5 * dt
    S[WORK_ABSOLUTE] += half * (S[POWER_ABSOLUTE] + absolute)
    S[WORK_NET] += half * (S[POWER_NET] + net)
    S[WORK_POSITIVE] += half * (S[POWER_POSITIVE] + positive)
    S[WORK_ELECTRICAL] += half * (S[POWER_ELECTRICAL] + electrical)
    S[POWER_ABSOLUTE] = absolute
    S[POWER_NET] = net
    S[POWER_POSITIVE] = positive
    S[POWER_ELECTRICAL] = electrical
