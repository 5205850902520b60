"""Integrate a planar run in time with one of two fixed-step methods, which `implicit` chooses.

- False, all joints prescribed: RK5, Butcher's Runge-Kutta method of order 5 for the three remaining
  degrees of freedom. Its six stages lie at quarters of the step, so the reference is needed only
  four times per step; at an error of 1e-6 it takes three quarters of the evaluations of the classic
  method of order 4. Work is counted twice per step.
- True, any joint free (pd, servo, hinge): a semi-implicit method of order 3 with four stages
  (`driven`), which integrates the works too. The first step of a run is divided into parts.

`run` is the loop. `S` is the flat array of `rows`, and types of its numbers are a matter of
`number_types`; the arguments from `n` to `has_extras` are the shape of the chain of bodies
(`layout.Layout.chain`).

A template (see `templates`): this file is loaded anew for every drag law, joint law, kind of flow and
number of lanes. `bindings` holds those of this loading and the templates loaded before it, under the
names that `model.TEMPLATES` lists. Python calls its entry points.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

from laticauda.compiling import compile_scalar, entry, kernel, lane_types
from laticauda.compiling.lane_types import keep_until_here, uncounted
from laticauda.compiling.lanes import any_lane, first_lane, magnitude, where
from laticauda.compiling.templates import bindings
from laticauda.models.dynamics.bounds import FARTHEST, STRONGEST
from laticauda.models.planar import sample_format
from laticauda.models.planar.rows import *

_specialization = bindings(__name__)
rows_of = lane_types.rows_of(_specialization["n_lanes"])
loads = _specialization["loads"]
recursion = _specialization["recursion"]
drives = _specialization["drives"]
prescribed = _specialization["prescribed"]
driven = _specialization["driven"]

column_of_joint = compile_scalar(sample_format.column_of_joint)
QUARTER = 0.25
"""Share of a step of RK5 between two moments at which its stages lie."""
HALF = 0.5
"""Share of a step of RK5 after which work is counted, too."""
SAME_TIME = 1
"""Row of `WEIGHTS` that leads to a stage at the same time as the one before."""
MIDDLE = 2
"""Row of `WEIGHTS` that leads to the middle of the step."""
WEIGHTS = (
    (1 / 4, 0.0, 0.0, 0.0, 0.0, 0.0),
    (1 / 8, 1 / 8, 0.0, 0.0, 0.0, 0.0),
    (0.0, -1 / 2, 1.0, 0.0, 0.0, 0.0),
    (3 / 16, 0.0, 0.0, 9 / 16, 0.0, 0.0),
    (-3 / 7, 2 / 7, 12 / 7, -12 / 7, 8 / 7, 0.0),
    (7 / 90, 0.0, 32 / 90, 12 / 90, 32 / 90, 7 / 90),
)
"""Weights of the slopes of RK5: to each further stage, and to the end (Butcher, J. Aust. Math. Soc. 4, 1964)."""
RK5_STAGES = len(WEIGHTS)
"""Stages of RK5; their slopes must have room in SLOPES (`rows.MOST_STAGES`)."""


@entry
def run(
    flat, n, first_strip, first_plate, law, tail_link, has_extras, implicit, steps, dt, every, log
):
    """Advance the lanes in `flat` by `steps` steps of `dt`; log every `every`-th step, including the first and last.

    `log` has shape (1 + steps // every, numbers of a sample, lanes); with fewer rows, only the first
    numbers of each sample are logged. A lane whose numbers leave the finite range stops counting its SAMPLES at
    that point; the others are unaffected. Returns the largest number of samples that any lane
    counted.

    Where RESUMES is set and some joint is free, the first sample is not logged, but counts: a run before
    has logged it.

    A sample holds no accelerations, and where all joints are free none are computed for it; a figure that
    needs those of the state is computed afterwards, as `link_forces` does.
    """
    is_free = free_joints(law)
    written = march(
        rows_of(flat),
        n,
        uncounted(first_strip),
        uncounted(first_plate),
        uncounted(law),
        uncounted(is_free),
        tail_link,
        has_extras,
        implicit,
        steps,
        dt,
        every,
        log,
    )
    keep_until_here(is_free)
    return written


@kernel
def march(
    S,
    n,
    first_strip,
    first_plate,
    law,
    is_free,
    tail_link,
    has_extras,
    implicit,
    steps,
    dt,
    every,
    log,
):
    """Do what `run` does, with addresses in place of arrays."""
    loads.note_still_water(S)
    holds = any_prescribed(law, n)
    is_any_held = not are_all_free(is_free, n)
    drives.set_decay(S, QUARTER * dt)
    drives.set_reference(S, n, law, tail_link)
    drives.note_rest(S, law, tail_link)
    # With prescribed joints alone, the first sample is also the first stage of a step.
    resumes = implicit and first_lane(S[RESUMES].real) > 0.0
    S[RESUMES] = 0.0
    written = int(resumes)
    S[WELL] = 1.0
    S[SAMPLES] = float(written)
    length_prepared = 0.0
    for step in range(steps + 1):
        # The state: its torques and powers; with prescribed joints alone, this is the first stage of
        # the step, and work is counted.
        is_sample = step % every == 0 and not (resumes and step == 0)
        if is_sample or not implicit:
            if implicit:
                drives.joint_torques(S, n, law)
            if is_any_held or not implicit:
                recursion.accelerations(
                    S, n, first_strip, first_plate, is_free, tail_link, has_extras, True
                )
                recursion.holding_torques(S, n, is_free)
            if implicit:
                drives.set_powers(S, n, law)
            else:
                drives.count_work(S, n, law, 0.0 if step == 0 else HALF * dt)
        if is_sample:
            write_sample(S, n, rows_of(log[step // every]), log.shape[1])
            S[WELL] = where(is_within_bounds(S, n), S[WELL], 0.0)
            if not any_lane(S[WELL].real > 0.0):
                break
            S[SAMPLES] += S[WELL]
            written += 1
        if step == steps:
            break
        if not implicit:
            finish_rk5(S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, dt)
            continue
        n_parts = driven.count_parts(S, dt)
        for part in range(n_parts):
            length = drives.shared.length_of_part(part, n_parts, dt)
            if length != length_prepared:
                drives.set_stage_decays(S, length)
                length_prepared = length
            driven.advance(
                S,
                n,
                first_strip,
                first_plate,
                law,
                is_free,
                tail_link,
                has_extras,
                holds,
                length,
            )
    return written


@entry
def run_prescribed(
    flat, n, first_strip, first_plate, law, tail_link, has_extras, implicit, steps, dt, every, log
):
    """Do what `run` does, for runs that `prescribed` can do; the numbers agree to rounding."""
    S = rows_of(flat)
    laws = uncounted(law)
    prescribed.prepare(S, n)
    if loads.is_still(S):
        return march_prescribed(S, n, laws, tail_link, True, steps, dt, every, log)
    return march_prescribed(S, n, laws, tail_link, False, steps, dt, every, log)


@kernel
def march_prescribed(S, n, law, tail_link, is_still, steps, dt, every, log):
    """Run RK5 as `run` does; one loop over all stages, because a stage is compiled into every place that calls it."""
    generator_step = QUARTER * dt
    drives.set_decay(S, generator_step)
    drives.set_reference(S, n, law, tail_link)
    S[WELL] = 1.0
    S[SAMPLES] = 0.0
    written = 0
    for evaluation in range(RK5_STAGES * steps + 1):
        step, stage = evaluation // RK5_STAGES, evaluation % RK5_STAGES
        is_later = stage != 0 and stage != SAME_TIME + 1
        if is_later:
            drives.advance_reference(S, n, law, tail_link, generator_step)
        if is_later or evaluation == 0:
            prescribed.compute_shape(S, n)
        counts = stage == 0 or stage == MIDDLE + 1
        prescribed.accelerations(S, n, is_still, counts)
        if counts:
            prescribed.holding_torques(S, n)
            since_counted = HALF * dt
            if evaluation == 0:
                since_counted = 0.0
            drives.count_work(S, n, law, since_counted)
        if stage == 0:
            if step % every == 0:
                write_sample(S, n, rows_of(log[step // every]), log.shape[1])
                S[WELL] = where(is_within_bounds(S, n), S[WELL], 0.0)
                if not any_lane(S[WELL].real > 0.0):
                    break
                S[SAMPLES] += S[WELL]
                written += 1
            for r in range(BASE_ROWS):
                S[SAVED + r] = S[HEADING + r]
        if step < steps:
            keep_slope(S, stage)
            step_ahead(S, dt, WEIGHTS[stage], stage + 1)
    return written


@entry
def evaluate(flat, n, first_strip, first_plate, is_free, tail_link, has_extras):
    """Compute accelerations and torques of the state in `flat` from REFERENCE_2 (prescribed) or TOTAL_TORQUE (free)."""
    S = rows_of(flat)
    loads.note_still_water(S)
    recursion.accelerations(S, n, first_strip, first_plate, is_free, tail_link, has_extras, True)
    recursion.holding_torques(S, n, is_free)


@entry
def link_forces(flat, n, first_strip, first_plate, law, tail_link, has_extras, log, force):
    """Compute the force on every body at every sample of a log, in world axes: drag, added mass, effectors.

    The accelerations are those of the state: the pattern for any figure that needs them.

    `force` has shape (n_samples, 3, n, 2, lanes). With no log, it is the force in the state in `flat`.
    """
    is_free = free_joints(law)
    forces_of_samples(
        rows_of(flat),
        n,
        uncounted(first_strip),
        uncounted(first_plate),
        uncounted(law),
        uncounted(is_free),
        tail_link,
        has_extras,
        log,
        force,
    )
    keep_until_here(is_free)


@kernel
def forces_of_samples(
    S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, log, force
):
    """Do what `link_forces` does, with addresses in place of arrays."""
    loads.note_still_water(S)
    for sample in range(len(force)):
        if len(log) > 0:
            read_sample(S, n, rows_of(log[sample]))
        drives.set_reference(S, n, law, tail_link)
        drives.joint_torques(S, n, law)
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
    """Return whether any joint is prescribed, whose torque does work; that of a locked one does none."""
    for i in range(1, n):
        if law[i] == PRESCRIBED:
            return True
    return False


@kernel
def are_all_free(is_free, n):
    """Return whether the torques of all joints are known: those of others follow from accelerations."""
    for i in range(1, n):
        if not is_free[i]:
            return False
    return True


@kernel
def finish_rk5(S, n, first_strip, first_plate, law, is_free, tail_link, has_extras, dt):
    """Run stages 2 to 6, at 1/4, 1/4, 1/2, 3/4 and 1 of the step; S already holds the first stage's accelerations."""
    for r in range(BASE_ROWS):
        S[SAVED + r] = S[HEADING + r]
    for stage in range(RK5_STAGES - 1):
        keep_slope(S, stage)
        step_ahead(S, dt, WEIGHTS[stage], stage + 1)
        if stage != SAME_TIME:
            drives.advance_reference(S, n, law, tail_link, QUARTER * dt)
        recursion.accelerations(
            S, n, first_strip, first_plate, is_free, tail_link, has_extras, stage == MIDDLE
        )
        if stage == MIDDLE:
            recursion.holding_torques(S, n, is_free)
            drives.count_work(S, n, law, HALF * dt)
    keep_slope(S, RK5_STAGES - 1)
    step_ahead(S, dt, WEIGHTS[RK5_STAGES - 1], RK5_STAGES)


@kernel
def keep_slope(S, stage):
    """Store the slope of the base's state at this stage."""
    slope = SLOPES + BASE_ROWS * stage
    for r in range(N_FREEDOMS):
        S[slope + r] = S[HEADING_RATE + r]
        S[slope + N_FREEDOMS + r] = S[HEADING_ACCELERATION + r]
    S[slope + EDGE_MEMORY - HEADING] = S[EDGE_MEMORY_RATE]


@kernel
def step_ahead(S, dt, weights, n_stages):
    """Set the base to its saved state plus dt times the weighted slopes of the stages so far."""
    for r in range(BASE_ROWS):
        slope = weights[0] * S[SLOPES + r]
        for stage in range(1, n_stages):
            slope += weights[stage] * S[SLOPES + BASE_ROWS * stage + r]
        S[HEADING + r] = S[SAVED + r] + dt * slope


@kernel
def write_sample(S, n, sample, n_rows):
    """Write a sample (`sample_format`), or only the first `n_rows` of its numbers."""
    joints = n - 1
    for r in range(min(n_rows, LOG_STATE)):
        sample[r] = S[TIME + r]
    for i in range(joints if n_rows > LOG_STATE else 0):
        b = HEADER_ROWS + (i + 1) * BODY_ROWS
        for k, row in enumerate(LOGGED_OF_JOINT):
            sample[column_of_joint(k, i, joints)] = S[b + row]


@kernel
def read_sample(S, n, sample):
    """Set the state from a sample."""
    joints = n - 1
    for r in range(LOG_STATE):
        S[TIME + r] = sample[r]
    for i in range(joints):
        b = HEADER_ROWS + (i + 1) * BODY_ROWS
        for k, row in enumerate(STATE_OF_JOINT):
            S[b + row] = sample[column_of_joint(k, i, joints)]


@kernel
def is_within_bounds(S, n):
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
