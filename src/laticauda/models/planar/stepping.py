"""Integrate a planar run in time with two fixed-step methods.

- Prescribed joints: Butcher's Runge-Kutta method of order 5 for the three remaining degrees of
  freedom. Its six stages lie at quarters of the step, so the reference is needed only four times
  per step; at an error of 1e-6 it takes three quarters of the evaluations of the classic method of
  order 4.
- Any free joint (pd, servo, hinge): ROS2, of order 2 and linearly implicit
  (`laticauda.models.dynamics.stages`).

A template (see `templates`); Python calls its entry points.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

from laticauda.compiling import compile_scalar, entry, kernel, lane_types
from laticauda.compiling.lanes import any_lane, magnitude, where
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics import stages
from laticauda.models.dynamics.stages import FARTHEST, GAMMA, STRONGEST
from laticauda.models.planar.rows import *

_names = bindings(__name__)
rows_of = lane_types.rows_of(_names["WIDTH"])
loads, recursion, drives = _names["loads"], _names["recursion"], _names["drives"]

combined = compile_scalar(stages.combined)
BASE_ROWS = 6
"""Rows of the three degrees of freedom and their rates: HEADING ... VY are contiguous."""
WEIGHTS = (
    (1 / 4, 0.0, 0.0, 0.0, 0.0, 0.0),
    (1 / 8, 1 / 8, 0.0, 0.0, 0.0, 0.0),
    (0.0, -1 / 2, 1.0, 0.0, 0.0, 0.0),
    (3 / 16, 0.0, 0.0, 9 / 16, 0.0, 0.0),
    (-3 / 7, 2 / 7, 12 / 7, -12 / 7, 8 / 7, 0.0),
    (7 / 90, 0.0, 32 / 90, 12 / 90, 32 / 90, 7 / 90),
)
"""Weights of the slopes for each further stage, and for the end (J. C. Butcher, J. Aust. Math. Soc. 4, 1964)."""


@entry
def run(
    flat, n, first_strip, first_plate, law, tail_link, has_extras, implicit, steps, dt, every, log
):
    """Advance the lanes in `flat` by `steps` steps of `dt`; log every `every`-th step, including the first and last.

    `log` has shape (1 + steps // every, LOG_STATE + 4 joints, lanes); with fewer rows, only the
    first ones are logged. A lane whose numbers leave the finite range stops counting its SAMPLES at
    that point; the others are unaffected. Returns the largest number of samples that any lane
    counted.
    """
    S = rows_of(flat)
    is_free = free_joints(law)
    drives.set_decay(S, dt if implicit else 0.25 * dt)
    drives.set_reference(S, n, law, tail_link)
    two_ways = implicit and any_prescribed(law, n)
    S[WELL] = 1.0
    S[SAMPLES] = 0.0
    written = 0
    for step in range(steps + 1):
        if implicit:
            drives.joint_torques(S, n, law, 0.0 if two_ways else GAMMA * dt)
        recursion.accelerations(
            S, n, first_strip, first_plate, is_free, tail_link, has_extras, True
        )
        recursion.holding_torques(S, n, is_free)
        drives.count_work(S, n, law, 0.0 if step == 0 else dt if implicit else 0.5 * dt)
        if step % every == 0:
            write_sample(S, n, rows_of(log[step // every]), log.shape[1])
            S[WELL] = where(finite(S, n), S[WELL], 0.0)
            if not any_lane(S[WELL].real > 0.0):
                break
            S[SAMPLES] += S[WELL]
            written += 1
        if step == steps:
            break
        if two_ways:
            # The torques above follow from accelerations, which must not include implicit terms.
            drives.joint_torques(S, n, law, GAMMA * dt)
            recursion.accelerations(
                S, n, first_strip, first_plate, is_free, tail_link, has_extras, False
            )
        if implicit:
            finish_ros2(S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, dt)
        else:
            finish_rk5(S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, dt)
    return written


@entry
def evaluate(flat, n, first_strip, first_plate, is_free, tail_link, has_extras):
    """Compute accelerations and torques of the state in `flat` from REFERENCE_2 (prescribed) or TOTAL_TORQUE (free)."""
    S = rows_of(flat)
    recursion.accelerations(S, n, first_strip, first_plate, is_free, tail_link, has_extras, True)
    recursion.holding_torques(S, n, is_free)


@entry
def link_forces(flat, n, first_strip, first_plate, law, tail_link, has_extras, log, force):
    """Compute the force on every body at every sample of a log, in world axes: drag, added mass, effectors.

    `force` has shape (n_samples, 3, n, 2, lanes).
    """
    S = rows_of(flat)
    is_free = free_joints(law)
    for sample in range(len(log)):
        read_sample(S, n, rows_of(log[sample]))
        drives.set_reference(S, n, law, tail_link)
        drives.joint_torques(S, n, law, 0.0)
        recursion.accelerations(
            S, n, first_strip, first_plate, is_free, tail_link, has_extras, True
        )
        loads.body_forces(S, n, first_strip, rows_of(force[sample]))


@kernel
def free_joints(law):
    """Return which joints are free, one boolean per joint."""
    return law >= FIRST_FREE


@kernel
def any_prescribed(law, n):
    """Return whether any joint is prescribed."""
    for i in range(1, n):
        if law[i] == PRESCRIBED:
            return True
    return False


@kernel
def finish_rk5(S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, dt):
    """Run stages 2 to 6, at 1/4, 1/4, 1/2, 3/4 and 1 of the step; S already holds the first stage's accelerations."""
    for r in range(BASE_ROWS):
        S[SAVED + r] = S[HEADING + r]
    for stage in range(5):
        keep_slope(S, stage)
        step_ahead(S, dt, WEIGHTS[stage], stage + 1)
        if stage != 1:
            drives.advance_reference(S, n, law, tail_link, 0.25 * dt)
        recursion.accelerations(
            S, n, first_strip, first_plate, is_free, tail_link, has_extras, stage == 2
        )
        if stage == 2:  # the midpoint of the step, where work is counted
            recursion.holding_torques(S, n, is_free)
            drives.count_work(S, n, law, 0.5 * dt)
    keep_slope(S, 5)
    step_ahead(S, dt, WEIGHTS[5], 6)


@kernel
def keep_slope(S, stage):
    """Store the slope of the base's state at this stage."""
    for r in range(3):
        S[SLOPES + BASE_ROWS * stage + r] = S[HEADING_RATE + r]
        S[SLOPES + BASE_ROWS * stage + 3 + r] = S[HEADING_ACCELERATION + r]


@kernel
def step_ahead(S, dt, weights, n_stages):
    """Set the base to its saved state plus dt times the weighted slopes of the stages so far."""
    for r in range(BASE_ROWS):
        slope = weights[0] * S[SLOPES + r]
        for stage in range(1, n_stages):
            slope += weights[stage] * S[SLOPES + BASE_ROWS * stage + r]
        S[HEADING + r] = S[SAVED + r] + dt * slope


@kernel
def finish_ros2(S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, dt):
    """Finish the step, y + h (3/2 k1 + 1/2 k2); S already holds the accelerations of k1."""
    gamma_dt = GAMMA * dt
    keep_first_slope(S, n, is_free, dt, gamma_dt)
    drives.advance_reference(S, n, law, tail_link, dt)
    drives.second_torques(S, n, law, gamma_dt)
    recursion.accelerations(S, n, first_strip, first_plate, is_free, tail_link, has_extras, False)
    for r in range(3):
        first_rate, first = S[SLOPES + r], S[SLOPES + 3 + r]
        slope = combined(
            S[HEADING_RATE + r], S[HEADING_ACCELERATION + r], first_rate, first, gamma_dt
        )
        S[HEADING + r] = S[SAVED + r] + dt * slope[0]
        S[HEADING_RATE + r] = S[SAVED + 3 + r] + dt * slope[1]
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if is_free[i]:
            first_rate, first = S[b + SLOPE_ANGLE], S[b + SLOPE_RATE]
            slope = combined(S[b + RATE], S[b + ACCELERATION], first_rate, first, gamma_dt)
            S[b + ANGLE] = S[b + SAVED_ANGLE] + dt * slope[0]
            S[b + RATE] = S[b + SAVED_RATE] + dt * slope[1]


@kernel
def keep_first_slope(S, n, is_free, dt, gamma_dt):
    """Store y and k1, and move the state to y + h k1."""
    for r in range(3):
        acceleration = S[HEADING_ACCELERATION + r]
        slope = S[HEADING_RATE + r] + gamma_dt * acceleration
        S[SAVED + r] = S[HEADING + r]
        S[SAVED + 3 + r] = S[HEADING_RATE + r]
        S[SLOPES + r] = slope
        S[SLOPES + 3 + r] = acceleration
        S[HEADING + r] += dt * slope
        S[HEADING_RATE + r] += dt * acceleration
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        if is_free[i]:
            acceleration = S[b + ACCELERATION]
            slope = S[b + RATE] + gamma_dt * acceleration
            S[b + SAVED_ANGLE] = S[b + ANGLE]
            S[b + SAVED_RATE] = S[b + RATE]
            S[b + SLOPE_ANGLE] = slope
            S[b + SLOPE_RATE] = acceleration
            S[b + ANGLE] += dt * slope
            S[b + RATE] += dt * acceleration


@kernel
def write_sample(S, n, sample, n_rows):
    """Write the header's state rows, then angle, rate, reference and torque of every joint; or the first rows only."""
    joints = n - 1
    for r in range(min(n_rows, LOG_STATE)):
        sample[r] = S[TIME + r]
    for i in range(joints if n_rows > LOG_STATE else 0):
        b = HEADER_ROWS + (i + 1) * BODY_ROWS
        for k, row in enumerate((ANGLE, RATE, REFERENCE, TORQUE)):
            sample[LOG_STATE + k * joints + i] = S[b + row]


@kernel
def read_sample(S, n, sample):
    """Set the state from a sample."""
    joints = n - 1
    for r in range(LOG_STATE):
        S[TIME + r] = sample[r]
    for i in range(joints):
        b = HEADER_ROWS + (i + 1) * BODY_ROWS
        S[b + ANGLE] = sample[LOG_STATE + i]
        S[b + RATE] = sample[LOG_STATE + joints + i]


@kernel
def finite(S, n):
    """Return whether positions, rates, joint rates and torques are still plausible for a swimming robot."""
    well = magnitude(S[HEADING]).real < FARTHEST
    for r in range(1, BASE_ROWS):
        well = well & (magnitude(S[HEADING + r]).real < FARTHEST)
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        well = (
            well
            & (magnitude(S[b + RATE]).real < FARTHEST)
            & (magnitude(S[b + TORQUE]).real < STRONGEST)
        )
    return well
