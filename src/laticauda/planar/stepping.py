"""March a planar run through time, with two fixed-step integrators.

- Prescribed joints: classic Runge-Kutta of order 4 for the three degrees of freedom that are left.
- Any free joint (pd, servo, hinge): ROS2 (Verwer, Spee, Blom and Hundsdorfer, SIAM J. Sci. Comput. 20, 1999), a
  Rosenbrock W-method of order 2 with gamma = 1 - 1/sqrt(2), L-stable. Its approximate Jacobian is the joint law's own,
  so all that an implicit step adds to the recursion is gamma h K_d + (gamma h)^2 K_p on each joint's own inertia.

A template (see `specialize`); its entry points are what Python calls.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false

from typing import no_type_check

import numpy as np

from laticauda.compiling import kernel
from laticauda.planar.rows import *
from laticauda.planar.specialize import bindings, entry

_names = bindings(__name__)
W = _names["WIDTH"]
body_forces = _names["loads"].body_forces
accelerations = _names["recursion"].accelerations
_drives = _names["drives"]
advance_reference = _drives.advance_reference
set_reference = _drives.set_reference
joint_torques = _drives.joint_torques
second_torques = _drives.second_torques
count_work = _drives.count_work

GAMMA = 1.0 - 0.5**0.5
BASE_ROWS = 6  # HEADING ... VY are contiguous


@entry
@no_type_check
def run(S, n, first_strip, first_plate, law, tether_body, has_extras, implicit, steps, dt, every, log):
    """Advance the lanes in S by `steps` steps of `dt` and log every `every`-th one, the first and the last included.

    `log` has shape (1 + steps // every, LOG_STATE + 4 joints, W). Returns the number of samples written: fewer than
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
    """Whether positions, rates, joint rates and torques are still numbers that a swimming robot can have."""
    for k in range(W):
        for r in range(BASE_ROWS):
            if not np.abs(S[(HEADING + r) * W + k]) < 1e6:
                return False
        for i in range(1, n):
            b = HEADER_ROWS + i * BODY_ROWS
            if not np.abs(S[(b + RATE) * W + k]) < 1e6 or not np.abs(S[(b + TORQUE) * W + k]) < 1e12:
                return False
    return True
