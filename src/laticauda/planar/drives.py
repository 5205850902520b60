"""How the joints are driven: the reference generator, the joint laws, and the work they do.

A template (see `specialize`): `S` is the flat array of `rows`; the scalar laws come from `gaits.reference` and
`actuation.laws`. Joint laws are told apart by `law`, one number per joint (LOCKED ... PASSIVE).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

from typing import no_type_check

import numpy as np

from laticauda.actuation import laws
from laticauda.compiling import compiled, kernel
from laticauda.fluid import laws as fluid_laws
from laticauda.gaits import reference
from laticauda.planar.rows import *
from laticauda.planar.specialize import bindings

_names = bindings(__name__)
W = _names["WIDTH"]
sincos = _names["loads"].sincos
magnitude = compiled(fluid_laws.magnitude)
filter_step = compiled(reference.filter_step)
filter_acceleration = compiled(reference.filter_acceleration)
smooth_start = compiled(reference.smooth_start)
ramped = compiled(reference.ramped)
joint_reference = compiled(reference.joint_reference)
pd = compiled(laws.pd)
servo = compiled(laws.servo)
servo_power = compiled(laws.servo_power)


@kernel
@no_type_check
def advance_reference(S, n, law, dt):
    """Move the generator on by dt and set the reference there."""
    for k in range(W):
        w = S[BANDWIDTH * W + k]
        decay = np.exp(-w * dt)
        for value, target in ((AMPLITUDE_NOW, AMPLITUDE), (PHASE_SHIFT_NOW, PHASE_SHIFT), (OFFSET_NOW, OFFSET)):
            y, rate, _ = filter_step(S[value * W + k], S[(value + 1) * W + k], S[target * W + k], w, decay, dt)
            S[value * W + k] = y
            S[(value + 1) * W + k] = rate
        y, rate, turned = filter_step(
            S[FREQUENCY_NOW * W + k], S[FREQUENCY_RATE * W + k], S[FREQUENCY * W + k], w, decay, dt
        )
        S[FREQUENCY_NOW * W + k] = y
        S[FREQUENCY_RATE * W + k] = rate
        S[PHASE * W + k] += turned
        before, due = S[TIME * W + k], dt - S[TIME_REST * W + k]
        S[TIME * W + k] = before + due
        S[TIME_REST * W + k] = (S[TIME * W + k] - before) - due
    set_reference(S, n, law)


@kernel
@no_type_check
def set_reference(S, n, law):
    """phi_ref of every driven joint, and its derivatives, from the generator's state."""
    for k in range(W):
        w = S[BANDWIDTH * W + k]
        ramp, ramp_1, ramp_2 = smooth_start(S[TIME * W + k], S[RAMP * W + k])
        amplitude, rate = S[AMPLITUDE_NOW * W + k], S[AMPLITUDE_RATE * W + k]
        second = filter_acceleration(amplitude, rate, S[AMPLITUDE * W + k], w)
        a0, a1, a2 = ramped(amplitude, rate, second, ramp, ramp_1, ramp_2)
        S[AMP * W + k] = a0
        S[AMP_1 * W + k] = a1
        S[AMP_2 * W + k] = a2
        # The phase is the integral of the filtered frequency, so its second derivative is that one's first.
        S[FREQUENCY_2 * W + k] = S[FREQUENCY_RATE * W + k]
        S[SHIFT_2 * W + k] = filter_acceleration(
            S[PHASE_SHIFT_NOW * W + k], S[PHASE_SHIFT_RATE * W + k], S[PHASE_SHIFT * W + k], w
        )
        S[OFFSET_2 * W + k] = filter_acceleration(S[OFFSET_NOW * W + k], S[OFFSET_RATE * W + k], S[OFFSET * W + k], w)
        s, c = sincos(S[PHASE * W + k])
        S[SIN_PHASE * W + k] = s
        S[COS_PHASE * W + k] = c
        s, c = sincos(S[PHASE_SHIFT_NOW * W + k])
        S[SIN_SHIFT * W + k] = s
        S[COS_SHIFT * W + k] = c
    joint = 0.0
    for i in range(1, n):
        if law[i] != LOCKED and law[i] != PASSIVE:
            one_reference(S, HEADER_ROWS + i * BODY_ROWS, joint, law[i])
            joint += 1.0


@kernel
@no_type_check
def one_reference(S, b, joint, law):
    """The reference of one joint; the sine of the next joint's phase follows by rotation."""
    for k in range(W):
        s, c = S[SIN_PHASE * W + k], S[COS_PHASE * W + k]
        angle, rate, acceleration = joint_reference(
            s,
            c,
            S[(b + ENVELOPE) * W + k],
            S[AMP * W + k],
            S[AMP_1 * W + k],
            S[AMP_2 * W + k],
            S[FREQUENCY_NOW * W + k] + joint * S[PHASE_SHIFT_RATE * W + k],
            S[FREQUENCY_2 * W + k] + joint * S[SHIFT_2 * W + k],
            S[OFFSET_NOW * W + k],
            S[OFFSET_RATE * W + k],
            S[OFFSET_2 * W + k],
        )
        S[(b + REFERENCE) * W + k] = angle
        S[(b + REFERENCE_1) * W + k] = rate
        S[(b + REFERENCE_2) * W + k] = acceleration
        if law == PRESCRIBED:
            S[(b + ANGLE) * W + k] = angle
            S[(b + RATE) * W + k] = rate
        S[SIN_PHASE * W + k] = s * S[COS_SHIFT * W + k] + c * S[SIN_SHIFT * W + k]
        S[COS_PHASE * W + k] = c * S[COS_SHIFT * W + k] - s * S[SIN_SHIFT * W + k]


@kernel
@no_type_check
def joint_torques(S, n, law, gamma_dt):
    """Torque of every free joint for the first stage of an implicit step, and what that step adds to its inertia."""
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            for k in range(W):
                torque, slope_p, slope_d, _ = actuator(S, b, law[i], k)
                slope_p += S[(b + STIFFNESS) * W + k]
                slope_d += S[(b + DAMPING) * W + k]
                S[(b + TORQUE) * W + k] = torque
                S[(b + SLOPE_P) * W + k] = slope_p
                S[(b + SLOPE_D) * W + k] = slope_d
                S[(b + IMPLICIT) * W + k] = gamma_dt * (slope_d + gamma_dt * slope_p)
                total = torque - skin(S, b, k) - gamma_dt * slope_p * S[(b + RATE) * W + k]
                S[(b + TOTAL_TORQUE) * W + k] = total


@kernel
@no_type_check
def second_torques(S, n, law, gamma_dt):
    """Right-hand side of the second stage for a = k2 + 2 k1, so that the mass matrix is not needed."""
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if law[i] >= FIRST_FREE:
            for k in range(W):
                torque, _, _, _ = actuator(S, b, law[i], k)
                slope_p = S[(b + SLOPE_P) * W + k]
                rest = S[(b + RATE) * W + k] - 2.0 * S[(b + SLOPE_ANGLE) * W + k]
                implicit = 2.0 * S[(b + IMPLICIT) * W + k] * S[(b + SLOPE_RATE) * W + k]
                S[(b + TOTAL_TORQUE) * W + k] = torque - skin(S, b, k) - gamma_dt * slope_p * rest + implicit


@kernel
@no_type_check
def skin(S, b, k):
    """Torque that the skin (or a hinge) sets against the joint's angle and rate."""
    return S[(b + STIFFNESS) * W + k] * S[(b + ANGLE) * W + k] + S[(b + DAMPING) * W + k] * S[(b + RATE) * W + k]


@kernel
@no_type_check
def actuator(S, b, law, k):
    """Torque of the joint's actuator, its slopes, and its electrical power."""
    angle, rate = S[(b + ANGLE) * W + k], S[(b + RATE) * W + k]
    power = 0.0 * angle
    if law == PD:
        torque, slope_p, slope_d = pd(
            angle,
            rate,
            S[(b + REFERENCE) * W + k],
            S[(b + REFERENCE_1) * W + k],
            S[(b + REFERENCE_2) * W + k],
            S[(b + LAW_0) * W + k],
            S[(b + LAW_1) * W + k],
        )
    elif law == SERVO:
        torque, slope_p, slope_d, duty = servo(
            angle,
            rate,
            S[(b + REFERENCE) * W + k],
            S[(b + LAW_0) * W + k],
            S[(b + LAW_1) * W + k],
            S[(b + LAW_2) * W + k],
            S[(b + LAW_3) * W + k],
            S[(b + LAW_4) * W + k],
        )
        power = servo_power(duty, rate, S[(b + LAW_2) * W + k], S[(b + LAW_5) * W + k])
    else:
        torque = 0.0 * angle
        slope_p = 0.0 * angle
        slope_d = 0.0 * angle
    return torque, slope_p, slope_d, power


@kernel
@no_type_check
def count_work(S, n, law, dt):
    """Joint torques as the actuators see them, and the work since the last step by the trapezoidal rule."""
    for k in range(W):
        absolute = 0.0 * S[TIME * W + k]
        net, positive, electrical = absolute, absolute, absolute
        for i in range(1, n):
            b = HEADER_ROWS + i * BODY_ROWS
            if law[i] < FIRST_FREE:
                S[(b + TORQUE) * W + k] = S[(b + TOTAL_TORQUE) * W + k] + skin(S, b, k)
            elif law[i] == SERVO:
                electrical += actuator(S, b, law[i], k)[3]
            power = S[(b + TORQUE) * W + k] * S[(b + RATE) * W + k]
            absolute += magnitude(power)
            net += power
            positive += 0.5 * (power + magnitude(power))
        half = 0.5 * dt
        S[WORK_ABSOLUTE * W + k] += half * (S[POWER_ABSOLUTE * W + k] + absolute)
        S[WORK_NET * W + k] += half * (S[POWER_NET * W + k] + net)
        S[WORK_POSITIVE * W + k] += half * (S[POWER_POSITIVE * W + k] + positive)
        S[WORK_ELECTRICAL * W + k] += half * (S[POWER_ELECTRICAL * W + k] + electrical)
        S[POWER_ABSOLUTE * W + k] = absolute
        S[POWER_NET * W + k] = net
        S[POWER_POSITIVE * W + k] = positive
        S[POWER_ELECTRICAL * W + k] = electrical
