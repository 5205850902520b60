"""March a planar run through time: the reference, the joint laws, and two fixed-step integrators.

- Prescribed joints: classic Runge-Kutta of order 4 for the three degrees of freedom that are left.
- Any free joint (pd, servo, hinge): ROS2 (Verwer, Spee, Blom and Hundsdorfer, SIAM J. Sci. Comput. 20, 1999), a
  Rosenbrock W-method of order 2 with gamma = 1 - 1/sqrt(2), L-stable. Its approximate Jacobian is the joint law's own,
  so all that an implicit step adds to the recursion is gamma h K_d + (gamma h)^2 K_p on each joint's own inertia.

A template (see `specialize`). Joint laws are told apart by `law`, one number per joint (LOCKED ... PASSIVE).
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

from typing import no_type_check

import numpy as np

from laticauda.actuation import laws
from laticauda.fluid import laws as fluid_laws
from laticauda.gaits import reference
from laticauda.planar.rows import *  # noqa: F403  (the table of rows is this module's vocabulary)
from laticauda.planar.specialize import bindings, compiled, entry, kernel, routine

_names = bindings(__name__)
W = _names["WIDTH"]
_recursion = _names["recursion"]
accelerations = _recursion.accelerations
body_forces = _recursion.body_forces
sincos = _recursion.sincos
magnitude = compiled(fluid_laws.magnitude)
filter_step = compiled(reference.filter_step)
filter_acceleration = compiled(reference.filter_acceleration)
smooth_start = compiled(reference.smooth_start)
ramped = compiled(reference.ramped)
joint_reference = compiled(reference.joint_reference)
pd = compiled(laws.pd)
servo = compiled(laws.servo)
servo_power = compiled(laws.servo_power)

LOCKED, PRESCRIBED, PD, SERVO, PASSIVE = 0, 1, 2, 3, 4
FIRST_FREE = PD
GAMMA = 1.0 - 0.5**0.5
BASE_ROWS = 6  # HEADING ... VY are contiguous


@entry
@no_type_check
def run(S, n, first_strip, first_plate, law, tether_body, has_extras, implicit, steps, dt, every, log):
    """Advance the lanes in S by `steps` steps of `dt` and log every `every`-th one, the first and the last included.

    `log` has shape (1 + steps // every, LOG_HEADER + 4 joints, W). Returns the number of samples written: fewer than
    asked for if a lane's numbers left the finite range.
    """
    is_free = law >= FIRST_FREE
    set_reference(S, n, law)
    written = 0
    for step in range(steps + 1):
        if implicit:
            joint_torques(S, n, law, GAMMA * dt)
        accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras)
        count_work(S, n, law, dt if step > 0 else 0.0)
        if step % every == 0:
            write_sample(S, n, log[step // every])
            written += 1
            if not all_finite(S, n):
                return written - 1
        if step == steps:
            break
        if implicit:
            finish_ros2(S, n, first_strip, first_plate, law, is_free, tether_body, has_extras, dt)
        else:
            finish_rk4(S, n, first_strip, first_plate, law, is_free, tether_body, has_extras, dt)
    return written


@entry
@no_type_check
def evaluate(S, n, first_strip, first_plate, is_free, tether_body, has_extras):
    """Accelerations for the state in S, given REFERENCE_2 of prescribed and TOTAL_TORQUE of free joints."""
    accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras)


@entry
@no_type_check
def link_forces(S, n, first_strip, first_plate, law, tether_body, has_extras, log, force):
    """Force on every body at every sample of a log, in world axes: drag, added mass, effectors.

    `force` has shape (n_samples, 3, n, 2, W).
    """
    is_free = law >= FIRST_FREE
    for sample in range(len(log)):
        read_sample(S, n, log[sample])
        set_reference(S, n, law)
        joint_torques(S, n, law, 0.0)
        accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras)
        body_forces(S, n, first_strip, force[sample])


# --- the reference --------------------------------------------------------------------------------------------------


@routine
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


@routine
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


# --- joint laws and work --------------------------------------------------------------------------------------------


@routine
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


# --- prescribed joints: Runge-Kutta 4 ---------------------------------------------------------------------------------


@kernel
@no_type_check
def finish_rk4(S, n, first_strip, first_plate, law, is_free, tether_body, has_extras, dt):
    """Stages 2 to 4; the first one's accelerations are in S already."""
    for k in range(W):
        for r in range(BASE_ROWS):
            S[(SAVED + r) * W + k] = S[(HEADING + r) * W + k]
            S[(SUM + r) * W + k] = 0.0
    next_stage(S, dt / 6.0, dt / 2.0)
    advance_reference(S, n, law, 0.5 * dt)
    accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras)
    next_stage(S, dt / 3.0, dt / 2.0)
    accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras)
    next_stage(S, dt / 3.0, dt)
    advance_reference(S, n, law, 0.5 * dt)
    accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras)
    next_stage(S, dt / 6.0, 0.0)
    for k in range(W):
        for r in range(BASE_ROWS):
            S[(HEADING + r) * W + k] = S[(SAVED + r) * W + k] + S[(SUM + r) * W + k]


@kernel
@no_type_check
def next_stage(S, weight, ahead):
    """Add the slope at hand to the step's sum, and set the base where the next stage looks."""
    for k in range(W):
        for r in range(3):
            rate = S[(HEADING_RATE + r) * W + k]
            acceleration = S[(HEADING_ACCELERATION + r) * W + k]
            S[(SUM + r) * W + k] += weight * rate
            S[(SUM_3 + r) * W + k] += weight * acceleration
            S[(HEADING + r) * W + k] = S[(SAVED + r) * W + k] + ahead * rate
            S[(HEADING_RATE + r) * W + k] = S[(SAVED_3 + r) * W + k] + ahead * acceleration


# --- free joints: ROS2 ------------------------------------------------------------------------------------------------


@kernel
@no_type_check
def finish_ros2(S, n, first_strip, first_plate, law, is_free, tether_body, has_extras, dt):
    """Both stages' slopes combined: y + h (3/2 k1 + 1/2 k2); k1's accelerations are in S already."""
    gamma_dt = GAMMA * dt
    keep_first_slope(S, n, is_free, dt, gamma_dt)
    advance_reference(S, n, law, dt)
    second_torques(S, n, law, gamma_dt)
    accelerations(S, n, first_strip, first_plate, is_free, tether_body, has_extras)
    for k in range(W):
        for r in range(3):
            rate = S[(HEADING_RATE + r) * W + k]
            first_rate, first = S[(SUM + r) * W + k], S[(SUM_3 + r) * W + k]
            second = S[(HEADING_ACCELERATION + r) * W + k] - 2.0 * first
            second_rate = rate - 2.0 * first_rate + gamma_dt * second
            S[(HEADING + r) * W + k] = S[(SAVED + r) * W + k] + dt * (1.5 * first_rate + 0.5 * second_rate)
            S[(HEADING_RATE + r) * W + k] = S[(SAVED_3 + r) * W + k] + dt * (1.5 * first + 0.5 * second)
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if is_free[i]:
            for k in range(W):
                first_rate, first = S[(b + SLOPE_ANGLE) * W + k], S[(b + SLOPE_RATE) * W + k]
                second = S[(b + ACCELERATION) * W + k] - 2.0 * first
                second_rate = S[(b + RATE) * W + k] - 2.0 * first_rate + gamma_dt * second
                S[(b + ANGLE) * W + k] = S[(b + SAVED_ANGLE) * W + k] + dt * (1.5 * first_rate + 0.5 * second_rate)
                S[(b + RATE) * W + k] = S[(b + SAVED_RATE) * W + k] + dt * (1.5 * first + 0.5 * second)


@kernel
@no_type_check
def keep_first_slope(S, n, is_free, dt, gamma_dt):
    """Store y and k1, and move the state to y + h k1."""
    for k in range(W):
        for r in range(3):
            acceleration = S[(HEADING_ACCELERATION + r) * W + k]
            slope = S[(HEADING_RATE + r) * W + k] + gamma_dt * acceleration
            S[(SAVED + r) * W + k] = S[(HEADING + r) * W + k]
            S[(SAVED_3 + r) * W + k] = S[(HEADING_RATE + r) * W + k]
            S[(SUM + r) * W + k] = slope
            S[(SUM_3 + r) * W + k] = acceleration
            S[(HEADING + r) * W + k] += dt * slope
            S[(HEADING_RATE + r) * W + k] += dt * acceleration
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if is_free[i]:
            for k in range(W):
                acceleration = S[(b + ACCELERATION) * W + k]
                slope = S[(b + RATE) * W + k] + gamma_dt * acceleration
                S[(b + SAVED_ANGLE) * W + k] = S[(b + ANGLE) * W + k]
                S[(b + SAVED_RATE) * W + k] = S[(b + RATE) * W + k]
                S[(b + SLOPE_ANGLE) * W + k] = slope
                S[(b + SLOPE_RATE) * W + k] = acceleration
                S[(b + ANGLE) * W + k] += dt * slope
                S[(b + RATE) * W + k] += dt * acceleration


@routine
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


# --- the log ----------------------------------------------------------------------------------------------------------


@kernel
@no_type_check
def write_sample(S, n, sample):
    """One sample: the header's state rows and accelerations, then angle, rate, reference and torque of every joint."""
    joints = n - 1
    for k in range(W):
        for r in range(LOG_STATE):
            sample[r, k] = S[(TIME + r) * W + k]
        for i in range(joints):
            b = HEADER_ROWS + (i + 1) * BODY_ROWS
            sample[LOG_STATE + i, k] = S[(b + ANGLE) * W + k]
            sample[LOG_STATE + joints + i, k] = S[(b + RATE) * W + k]
            sample[LOG_STATE + 2 * joints + i, k] = S[(b + REFERENCE) * W + k]
            sample[LOG_STATE + 3 * joints + i, k] = S[(b + TORQUE) * W + k]


@kernel
@no_type_check
def read_sample(S, n, sample):
    """Set the state from a sample."""
    joints = n - 1
    for k in range(W):
        for r in range(LOG_STATE):
            S[(TIME + r) * W + k] = sample[r, k]
        for i in range(joints):
            b = HEADER_ROWS + (i + 1) * BODY_ROWS
            S[(b + ANGLE) * W + k] = sample[LOG_STATE + i, k]
            S[(b + RATE) * W + k] = sample[LOG_STATE + joints + i, k]


@kernel
@no_type_check
def all_finite(S, n):
    """Whether positions, rates and joint rates are still numbers a swimming robot can have."""
    for k in range(W):
        for r in range(BASE_ROWS):
            if not np.abs(S[(HEADING + r) * W + k]) < 1e6:
                return False
        for i in range(1, n):
            if not np.abs(S[(HEADER_ROWS + i * BODY_ROWS + RATE) * W + k]) < 1e6:
                return False
    return True
