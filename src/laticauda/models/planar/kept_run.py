"""A run with prescribed joints that keeps what `adjoint` needs to go back through it.

The same run as that of `stepping`, from the same functions. Two kinds of numbers are kept, of every
stage the state of the base and what follows from it, and of every moment of the reference generator
what depends on the time alone: stages at the same time share it.

A template (see `templates`), loaded anew for every drag law and number of lanes.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import entry, kernel, lane_types
from laticauda.compiling.formulas import rows_from
from laticauda.compiling.lanes import any_lane, where
from laticauda.compiling.templates import bindings
from laticauda.models.planar.rows import *
from laticauda.motion.gaits import WaveState

_specialization = bindings(__name__)
rows_of = lane_types.rows_of(_specialization["n_lanes"])
loads = _specialization["loads"]
recursion = _specialization["recursion"]
drives = _specialization["drives"]
prescribed = _specialization["prescribed"]
stepping = _specialization["stepping"]
WEIGHTS = stepping.WEIGHTS
RK5_STAGES = stepping.RK5_STAGES
SAME_TIME = stepping.SAME_TIME
MIDDLE_STAGE = stepping.MIDDLE + 1
"""Stage in the middle of the step, where work is counted."""
LAST_STAGE = RK5_STAGES - 1

N_WAVE = len(WaveState._fields)
N_FIN_WAVE = len(FIN_WAVE)
N_INERTIA = 6
body_wave = rows_from(PHASE, N_WAVE)
fin_wave = rows_from(FIN_PHASE, N_FIN_WAVE)

# What is kept of a stage.
KEPT_HEADING = 0
KEPT_RATE = 1
KEPT_VX = 2
KEPT_VY = 3
KEPT_MEMORY = 4
KEPT_ACCELERATION = 5  # of body 0, in its own axes
STAGE_ROWS = 8
"""Numbers that are kept of a stage."""
# What is kept of a moment of the reference generator.
KEPT_TIME = 0
KEPT_INERTIA = 1  # of the stiff robot, as in STIFF_INERTIA
KEPT_BODY_WAVE = KEPT_INERTIA + N_INERTIA
KEPT_FIN_WAVE = KEPT_BODY_WAVE + N_WAVE  # of a driven fin
MOMENT_ROWS = KEPT_FIN_WAVE + N_FIN_WAVE
"""Numbers that are kept of a moment of the generator."""
MOMENTS = 4
"""Moments of the generator in a step."""


@entry
def run_and_keep(
    flat,
    n,
    first_strip,
    first_plate,
    law,
    tail_link,
    has_extras,
    steps,
    dt,
    every,
    is_last,
    log,
    stages,
    moments,
):
    """Run a segment of a run from the state in `flat`, log it as `stepping.run` does, and keep its stages and moments.

    If the run ends with the segment, the first stage of the step that would follow is kept, too, and
    the last sample is logged.

    One loop over all stages, because a stage is compiled into every place that calls it.

    Args:
        flat: Rows with the state at the begin of the segment.
        n: Number of bodies.
        first_strip: Strips first_strip[i] to first_strip[i + 1] are rigidly attached to body i.
        first_plate: The same for pectoral fins.
        law: Joint law at the tail end of each body.
        tail_link: Index of the body that is the robot's tail link.
        has_extras: Whether any body has loads in addition to its own drag.
        steps: Steps of the segment.
        dt: Time step.
        every: Steps between two samples.
        is_last: Whether the run ends with the segment.
        log: Room for the samples: 1 + steps // every, numbers of a sample, lanes.
        stages: Room for what is kept of the stages: steps + 1, RK5_STAGES, STAGE_ROWS, lanes.
        moments: Room for what is kept of the generator: steps, MOMENTS, MOMENT_ROWS, lanes.
    """
    S = rows_of(flat)
    generator_step = stepping.QUARTER * dt
    is_free = stepping.free_joints(law)
    loads.note_still_water(S)
    is_still = loads.is_known_still(S)
    prescribed.prepare(S, n)
    drives.set_decay(S, generator_step)
    drives.set_reference(S, n, law, tail_link)
    S[WELL] = 1.0
    S[SAMPLES] = 0.0
    end = steps * RK5_STAGES
    if is_last:
        end += 1
    for evaluation in range(end):
        step, stage = evaluation // RK5_STAGES, evaluation % RK5_STAGES
        is_later = stage != 0 and stage != SAME_TIME + 1
        if is_later:
            drives.advance_reference(S, n, law, tail_link, generator_step)
        if is_later or evaluation == 0:
            prescribed.compute_shape(S, n)
        if step < steps and is_first_of_moment(stage):
            keep_moment(S, law, tail_link, rows_of(moments[step, moment_of(stage)]))
        counts = counts_work(stage)
        if has_extras:
            recursion.accelerations(
                S, n, first_strip, first_plate, is_free, tail_link, has_extras, counts
            )
        else:
            prescribed.accelerations(S, n, is_still, counts)
        keep_stage(S, has_extras, rows_of(stages[step, stage]))
        if counts:
            if has_extras:
                recursion.holding_torques(S, n, is_free)
            else:
                prescribed.holding_torques(S, n)
            since_counted = stepping.HALF * dt
            if evaluation == 0:
                since_counted = 0.0
            drives.count_work(S, n, law, since_counted)
        if stage == 0:
            if step % every == 0:
                stepping.write_sample(S, n, rows_of(log[step // every]), log.shape[1])
                S[WELL] = where(stepping.is_within_bounds(S, n), S[WELL], 0.0)
                if not any_lane(S[WELL] > 0.0):
                    break
                S[SAMPLES] += S[WELL]
            for r in range(BASE_ROWS):
                S[SAVED + r] = S[HEADING + r]
        if step < steps:
            stepping.keep_slope(S, stage)
            stepping.step_ahead(S, dt, WEIGHTS[stage], stage + 1)


@kernel
def counts_work(stage):
    """Return whether work is counted at a stage."""
    return stage == 0 or stage == MIDDLE_STAGE


@kernel
def moment_of(stage):
    """Return the moment of the generator at which a stage lies, counted from the begin of the step."""
    if stage < SAME_TIME + 1:
        return stage
    return stage - 1


@kernel
def is_first_of_moment(stage):
    """Return whether a stage is the first one at its moment, and not at the end of the step."""
    return stage != SAME_TIME + 1 and stage != LAST_STAGE


@kernel
def keep_moment(S, law, tail_link, kept):
    """Store the state of the generator, and the inertia."""
    kept[KEPT_TIME] = S[TIME]
    for row in range(N_INERTIA):
        kept[KEPT_INERTIA + row] = S[STIFF_INERTIA + row]
    for row in range(N_WAVE):
        kept[KEPT_BODY_WAVE + row] = S[PHASE + row]
    if drives.has_driven_fin(law, tail_link):
        for row in range(N_FIN_WAVE):
            kept[KEPT_FIN_WAVE + row] = S[FIN_PHASE + row]


@kernel
def read_moment(S, law, tail_link, kept):
    """Set the state of the generator, and the inertia, to stored ones."""
    S[TIME] = kept[KEPT_TIME]
    for row in range(N_INERTIA):
        S[STIFF_INERTIA + row] = kept[KEPT_INERTIA + row]
    for row in range(N_WAVE):
        S[PHASE + row] = kept[KEPT_BODY_WAVE + row]
    if drives.has_driven_fin(law, tail_link):
        for row in range(N_FIN_WAVE):
            S[FIN_PHASE + row] = kept[KEPT_FIN_WAVE + row]


@kernel
def keep_stage(S, has_extras, kept):
    """Store the state of the base and the acceleration of body 0.

    In world axes, as `recursion` has it, the acceleration is turned into those of body 0.
    """
    b = HEADER_ROWS
    kept[KEPT_HEADING] = S[HEADING]
    kept[KEPT_RATE] = S[HEADING_RATE]
    kept[KEPT_VX] = S[VX]
    kept[KEPT_VY] = S[VY]
    kept[KEPT_MEMORY] = S[EDGE_MEMORY]
    q_x = S[b + QX]
    q_y = S[b + QY]
    if has_extras:
        q_x, q_y = prescribed.turned(S[b + COS], S[b + SIN], q_x, q_y)
    kept[KEPT_ACCELERATION] = S[b + LINK_ACCELERATION]
    kept[KEPT_ACCELERATION + 1] = q_x
    kept[KEPT_ACCELERATION + 2] = q_y


@kernel
def read_stage(S, kept):
    """Set the state of the base to a stored one."""
    S[HEADING] = kept[KEPT_HEADING]
    S[HEADING_RATE] = kept[KEPT_RATE]
    S[VX] = kept[KEPT_VX]
    S[VY] = kept[KEPT_VY]
    S[EDGE_MEMORY] = kept[KEPT_MEMORY]


@kernel
def acceleration_of_last(S, kept):
    """Return the stored acceleration of body 0, in world axes, once SIN and COS are known."""
    b = HEADER_ROWS
    q_x, q_y = prescribed.turned(
        S[b + COS], -S[b + SIN], kept[KEPT_ACCELERATION + 1], kept[KEPT_ACCELERATION + 2]
    )
    return kept[KEPT_ACCELERATION], q_x, q_y
