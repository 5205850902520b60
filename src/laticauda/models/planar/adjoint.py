"""Derivatives of a run backward in time: from those to samples of its log to those to all rows at its begin.

The discrete adjoint of `stepping.run` with RK5, for prescribed joints in water without a flow. It
costs a few runs however many rows there are, where a run with duals costs three for each.

`G` holds the bars: the derivative of what is differentiated with respect to row `q` is ``G[q]``.
Bars of what a stage computes anew stand in the same rows of `G` as the numbers in `S`, as scratch.
What single formulas do backward is not written here: pullbacks of the very formulas that the run
uses (`laticauda.compiling.pullbacks`, `reverse.write_pullbacks`). Written here is how they hang
together.

The accelerations follow from sum X_i^T w_i = 0 over all bodies, where w_i = I_i a_i + p_i is the
wrench on body i alone, and X_i takes accelerations from the tail end of body 0 to that of body i
(letters as in `recursion`). The multiplier of this balance is a motion `nu` of the chain: that of
body 0 solves (sum X^T I X) nu_0 = -(bar of a_0), and nu_i = X_i nu_0 + (the bars of the torques of
all joints up to body i, as rates of these joints) is the bar of w_i. Since the wrenches are in
balance, the sum over the bodies ahead of a joint is minus that over the bodies behind it; the same
is true of the bars of their accelerations.

A template (see `templates`), loaded anew for every drag law and number of lanes.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false, reportGeneralTypeIssues=false

from laticauda.compiling import entry, kernel, lane_types
from laticauda.compiling.lanes import any_lane
from laticauda.compiling.pullbacks import compile_pullback
from laticauda.compiling.templates import bindings
from laticauda.models.planar.rows import *

_specialization = bindings(__name__)
rows_of = lane_types.rows_of(_specialization["n_lanes"])
loads = _specialization["loads"]
recursion = _specialization["recursion"]
drives = _specialization["drives"]
prescribed = _specialization["prescribed"]
stepping = _specialization["stepping"]
kept_run = _specialization["kept_run"]
adjoint_references = _specialization["adjoint_references"]
WEIGHTS = stepping.WEIGHTS
RK5_STAGES = stepping.RK5_STAGES
SAME_TIME = stepping.SAME_TIME
LAST_STAGE = kept_run.LAST_STAGE

_pullbacks = dict(_specialization["pullbacks"])
pull_wrench = compile_pullback(_pullbacks["wrench"])
pull_strip = compile_pullback(_pullbacks["strip"])
pull_plate = compile_pullback(_pullbacks["plate"])
pull_tether = compile_pullback(_pullbacks["tether"])
pull_slender_edge = compile_pullback(_pullbacks["slender_edge"])
pull_finite_span = compile_pullback(_pullbacks["finite_span"])
pull_power = compile_pullback(_pullbacks["power"])
pull_electrical_power = compile_pullback(_pullbacks["electrical_power"])


@entry
def pull_segment(
    flat,
    bars,
    n,
    first_strip,
    first_plate,
    law,
    tail_link,
    has_extras,
    steps,
    dt,
    every,
    first_step,
    is_last,
    with_work,
    stages,
    moments,
    seeds,
):
    """Take the bars back from the end of a segment to its begin, which `kept_run` has run just before.

    The first call is for the last segment, with zeros in `bars`. Each call leaves there what the call
    for the segment before begins with, and the last one the bars of all rows at the begin of the run.

    Args:
        flat: Rows as the segment's run has left them.
        bars: Bars of all rows.
        n: Number of bodies.
        first_strip: Strips first_strip[i] to first_strip[i + 1] are rigidly attached to body i.
        first_plate: The same for pectoral fins.
        law: Joint law at the tail end of each body.
        tail_link: Index of the body that is the robot's tail link.
        has_extras: Whether any body has loads in addition to its own drag.
        steps: Steps of the segment.
        dt: Time step.
        every: Steps between two samples.
        first_step: Steps of the run before the segment.
        is_last: Whether the run ends with the segment.
        with_work: Whether any work has a seed.
        stages: What was kept of the stages.
        moments: What was kept of the moments of the generator.
        seeds: Bars of the samples of the whole run: samples, `reverse.SEED_ROWS`, lanes.
    """
    S = rows_of(flat)
    G = rows_of(bars)
    generator_step = stepping.QUARTER * dt
    end = steps * RK5_STAGES
    if is_last:
        end += 1
    chain = n, first_strip, first_plate, law, tail_link, has_extras
    for evaluation in range(end - 1, -1, -1):
        step, stage = evaluation // RK5_STAGES, evaluation % RK5_STAGES
        if stage == LAST_STAGE:
            begin_step(G, dt)
        elif step < steps and stage != SAME_TIME:
            moment = rows_of(moments[step, kept_run.moment_of(stage)])
            adjoint_references.go_back_to_moment(S, G, n, law, tail_link, generator_step, moment)
        run_step = first_step + step
        sample = rows_of(seeds[run_step // every])
        is_sample = stage == 0 and run_step % every == 0
        counts = with_work and kept_run.counts_work(stage)
        if counts:
            seed_powers(G, sample, is_sample, run_step, dt)
        begin_stage(G, stage)
        kept = rows_of(stages[step, stage])
        pull_stage(S, G, *chain, kept, stage, counts)
        end_stage(G, dt, stage)
        if is_sample:
            seed_state(G, sample)
    if first_step == 0:
        adjoint_references.pull_references(S, G, n, law, tail_link)
        G[BANDWIDTH] -= generator_step * S[DECAY] * G[DECAY]


# ---- a step ------------------------------------------------------------------------------------------


@kernel
def begin_step(G, dt):
    """Hand the bars of the state at the end of a step on to that at its begin, and to the slopes of all stages."""
    for r in range(BASE_ROWS):
        bar = G[HEADING + r]
        G[SAVED + r] = bar
        for stage in range(RK5_STAGES):
            G[SLOPES + BASE_ROWS * stage + r] = dt * WEIGHTS[LAST_STAGE][stage] * bar


@kernel
def begin_stage(G, stage):
    """Set the bars of a stage's state to those of its rates, which are slopes of the positions."""
    slope = SLOPES + BASE_ROWS * stage
    zero = drives.zero_like(G[slope])
    for r in range(N_FREEDOMS):
        G[HEADING + r] = zero
        G[HEADING_RATE + r] = G[slope + r]
    G[EDGE_MEMORY] = zero


@kernel
def end_stage(G, dt, stage):
    """Hand the bars of a stage's state on to the state at the begin of the step, and to the slopes before the stage."""
    if stage == 0:
        for r in range(BASE_ROWS):
            G[HEADING + r] += G[SAVED + r]
    else:
        for r in range(BASE_ROWS):
            bar = G[HEADING + r]
            G[SAVED + r] += bar
            for before in range(stage):
                G[SLOPES + BASE_ROWS * before + r] += dt * WEIGHTS[stage - 1][before] * bar


@kernel
def seed_state(G, sample):
    """Add the bars of a sample to those of the state."""
    for r in range(BASE_ROWS):
        G[HEADING + r] += sample[r]


@kernel
def seed_powers(G, sample, is_sample, run_step, dt):
    """Set the bars of the powers at a moment at which work is counted, by the trapezoidal rule of `drives.count_work`.

    If a sample is taken at this moment, its works have more bars than those after it.
    """
    half = 0.5 * stepping.HALF * dt
    for k in range(N_WORKS):
        after = G[WORK_ABSOLUTE + k]
        before = after
        if is_sample:
            before = after + sample[BASE_ROWS + k]
            G[WORK_ABSOLUTE + k] = before
            if run_step == 0:
                before = drives.zero_like(after)
        G[POWER_ABSOLUTE + k] = half * (before + after)


# ---- a stage --------------------------------------------------------------------------------------------


@kernel
def pull_stage(S, G, n, first_strip, first_plate, law, tail_link, has_extras, kept, stage, counts):
    """Take the bars of a stage's slope, and if work counts those of its powers, back to its state and all parameters.

    The references of the moment, and the inertia, must be in S.
    """
    kept_run.read_stage(S, kept)
    recursion.velocities(S, n)
    if has_extras:
        loads.extra_loads(S, n, first_strip, first_plate, tail_link)
    slope = SLOPES + BASE_ROWS * stage + N_FREEDOMS
    heading_bar, ax_bar, ay_bar = G[slope], G[slope + 1], G[slope + 2]
    G[EDGE_MEMORY_RATE] = G[slope + N_FREEDOMS]
    center_x, center_y = accelerate(S, n, kept)
    turning, push_x, push_y = heading_bar + center_x * ay_bar - center_y * ax_bar, ax_bar, ay_bar
    if counts:
        pull_powers(S, G, n)
        e0, e1, e2 = inertia_of_torques(S, G, n)
        turning, push_x, push_y = turning + e0, push_x + e1, push_y + e2
    nu = base_motion(S, turning, push_x, push_y)
    vx_bar, vy_bar = pull_loads(
        S, G, n, first_strip, first_plate, tail_link, has_extras, nu, ax_bar, ay_bar, counts
    )
    pull_velocities(S, G, n, heading_bar, vx_bar, vy_bar)


@kernel
def accelerate(S, n, kept):
    """Set accelerations and positions of all tail ends; return the position of the center of mass.

    The positions PX and PY are those from the tail end of body 0 here.
    """
    spin, qx, qy = kept_run.acceleration_of_last(S, kept)
    px, py, center_x, center_y = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        if i > 0:
            a = b - BODY_ROWS
            pull_x, pull_y = recursion.centripetal(S, a)
            turn = S[a + LENGTH] * spin
            qx += pull_x - turn * S[a + SIN]
            qy += pull_y + turn * S[a + COS]
            px += S[a + LENGTH] * S[a + COS]
            py += S[a + LENGTH] * S[a + SIN]
            spin += S[b + REFERENCE_2]
        S[b + LINK_ACCELERATION] = spin
        S[b + QX] = qx
        S[b + QY] = qy
        S[b + PX] = px
        S[b + PY] = py
        center_x += S[b + MASS_SHARE] * px + S[b + FIRST_MOMENT_SHARE] * S[b + COS]
        center_y += S[b + MASS_SHARE] * py + S[b + FIRST_MOMENT_SHARE] * S[b + SIN]
    return center_x, center_y


@kernel
def base_motion(S, turning, push_x, push_y):
    """Return nu of body 0, from the bars of its acceleration: I nu + bars = 0, with I in axes of body 0."""
    c, s = S[HEADER_ROWS + COS], S[HEADER_ROWS + SIN]
    push_t, push_n = prescribed.turned(c, s, push_x, push_y)
    inertia = prescribed.stiff_inertia(S)
    rotation, nu_t, nu_n = recursion.solved((*inertia, turning, push_t, push_n))
    nu_x, nu_y = prescribed.turned(c, -s, nu_t, nu_n)
    return rotation, nu_x, nu_y


@kernel
def pull_powers(S, G, n):
    """Take the bars of the powers back to the torques of all joints: their bars go to TOTAL_TORQUE."""
    moment, force_x, force_y = 0.0, 0.0, 0.0
    for i in range(n - 1, 0, -1):
        b = HEADER_ROWS + i * BODY_ROWS
        across = S[b + COS] * force_y - S[b + SIN] * force_x
        w0, fx, fy = wrench(S, b)
        moment += S[b + LENGTH] * across + w0
        force_x += fx
        force_y += fy
        powers = G[POWER_ABSOLUTE], G[POWER_NET], G[POWER_POSITIVE]
        bar = pull_power(S, G, b, moment, *powers)[0]
        if any_lane(S[b + STALL_POWER] > 0.0):
            bar += pull_electrical_power(S, G, b, moment, G[POWER_ELECTRICAL])[0]
        G[b + TOTAL_TORQUE] = bar
    G[ACTIVE_POWER] += G[POWER_ELECTRICAL]


@kernel
def wrench(S, b):
    """Return I a + p of one body."""
    a00, a01, a02, a11, a12, a22, p0, p1, p2 = recursion.of_body(S, b)
    spin, qx, qy = S[b + LINK_ACCELERATION], S[b + QX], S[b + QY]
    return (
        a00 * spin + a01 * qx + a02 * qy + p0,
        a01 * spin + a11 * qx + a12 * qy + p1,
        a02 * spin + a12 * qx + a22 * qy + p2,
    )


@kernel
def inertia_of_torques(S, G, n):
    """Return sum X^T I nu over all bodies for the part of nu that the bars of the torques make."""
    nu_0, nu_x, nu_y = 0.0, 0.0, 0.0
    turning, push_x, push_y = 0.0, 0.0, 0.0
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        a = b - BODY_ROWS
        nu_x -= S[a + LENGTH] * S[a + SIN] * nu_0
        nu_y += S[a + LENGTH] * S[a + COS] * nu_0
        nu_0 += G[b + TOTAL_TORQUE]
        a00, a01, a02, a11, a12, a22 = recursion.own_inertia(S, b)
        x = a01 * nu_0 + a11 * nu_x + a12 * nu_y
        y = a02 * nu_0 + a12 * nu_x + a22 * nu_y
        turning += a00 * nu_0 + a01 * nu_x + a02 * nu_y + S[b + PX] * y - S[b + PY] * x
        push_x += x
        push_y += y
    return turning, push_x, push_y


@kernel
def pull_loads(
    S, G, n, first_strip, first_plate, tail_link, has_extras, nu, ax_bar, ay_bar, counts
):
    """Take the bars of wrenches and accelerations back to velocities; return the sum of those of the velocities.

    The bars of a body's angle, rate and angular acceleration go to SIN, LINK_RATE and
    LINK_ACCELERATION, those of the velocity of its tail end to UX and UY.
    """
    nu_0, nu_x, nu_y = nu
    force_x, force_y = 0.0, 0.0  # minus the sum of the forces on the bodies ahead
    push_x, push_y = 0.0, 0.0  # minus the sum of the bars of their accelerations
    sum_x, sum_y = 0.0, 0.0
    for i in range(n):
        b = HEADER_ROWS + i * BODY_ROWS
        if i > 0:
            a = b - BODY_ROWS
            nu_x -= S[a + LENGTH] * S[a + SIN] * nu_0
            nu_y += S[a + LENGTH] * S[a + COS] * nu_0
            if counts:
                nu_0 += G[b + TOTAL_TORQUE]
        c, s, rate, spin = S[b + COS], S[b + SIN], S[b + LINK_RATE], S[b + LINK_ACCELERATION]
        pulled = pull_wrench(S, G, b, spin, S[b + QX], S[b + QY], nu_0, nu_x, nu_y)
        _, fx, fy = pulled[:3]
        spin_bar, qx_bar, qy_bar = pulled[3:6]
        c_bar, s_bar, rate_bar, t_bar, n_bar = pulled[6:11]
        if has_extras:
            c_more, s_more, rate_more, t_more, n_more = pull_extras(
                S, G, n, i, first_strip, first_plate, tail_link, pulled[11:]
            )
            c_bar, s_bar, rate_bar = c_bar + c_more, s_bar + s_more, rate_bar + rate_more
            t_bar, n_bar = t_bar + t_more, n_bar + n_more
        share, first_moment, length = S[b + MASS_SHARE], S[b + FIRST_MOMENT_SHARE], S[b + LENGTH]
        G[b + MASS_SHARE] += S[b + QX] * ax_bar + S[b + QY] * ay_bar
        force_x += fx
        force_y += fy
        push_x += qx_bar + share * ax_bar
        push_y += qy_bar + share * ay_bar
        # In link axes: the force ahead, and what accelerates with the rotation of this body.
        force_t, force_n = c * force_x + s * force_y, c * force_y - s * force_x
        push_t, push_n = c * push_x + s * push_y, c * push_y - s * push_x
        center_t, center_n = c * ax_bar + s * ay_bar, c * ay_bar - s * ax_bar
        turned_t = first_moment * center_t - length * push_t
        turned_n = first_moment * center_n - length * push_n
        G[b + LENGTH] += rate * rate * push_t - spin * push_n - nu_0 * force_n
        G[b + FIRST_MOMENT_SHARE] += spin * center_n - rate * rate * center_t
        angle_bar = c * s_bar - s * c_bar + t_bar * S[b + V_N] - n_bar * S[b + V_T]
        angle_bar += length * nu_0 * force_t - spin * turned_t - rate * rate * turned_n
        G[b + SIN] = angle_bar
        G[b + LINK_RATE] = rate_bar - 2.0 * rate * turned_t
        G[b + LINK_ACCELERATION] = spin_bar + turned_n
        u_bar, v_bar = c * t_bar - s * n_bar, s * t_bar + c * n_bar
        G[b + UX] = u_bar
        G[b + UY] = v_bar
        sum_x += u_bar
        sum_y += v_bar
    return sum_x, sum_y


@kernel
def pull_extras(S, G, n, i, first_strip, first_plate, tail_link, bars):
    """Take the bars of the extra loads of body i back; return those of COS, SIN, LINK_RATE, V_T and V_N."""
    b = HEADER_ROWS + i * BODY_ROWS
    f_t, f_n, moment = bars
    G[b + THRUST_T] += f_t
    G[b + THRUST_N] += f_n
    G[b + THRUST_MOMENT] += moment
    zero = drives.zero_like(f_t)
    c_bar, s_bar, rate_bar, t_bar, n_bar = zero, zero, zero, zero, zero
    for strip in range(first_strip[i], first_strip[i + 1]):
        rate_more, t_more, n_more = pull_strip(S, G, b, loads.strip_row(n, strip), f_t, f_n, moment)
        rate_bar, t_bar, n_bar = rate_bar + rate_more, t_bar + t_more, n_bar + n_more
    for fin in range(first_plate[i], first_plate[i + 1]):
        e = loads.plate_row(n, first_strip[n], fin)
        rate_more, t_more, n_more = pull_plate(S, G, b, e, f_t, f_n, moment)
        rate_bar, t_bar, n_bar = rate_bar + rate_more, t_bar + t_more, n_bar + n_more
    if i == tail_link:
        c_bar, s_bar, t_more, n_more = pull_tether(S, G, b, f_t, f_n)
        t_bar, n_bar = t_bar + t_more, n_bar + n_more
    if i == 0:
        if loads.has_finite_span(S):
            memory_rate_bar = G[EDGE_MEMORY_RATE]
            rate_more, t_more, n_more = pull_finite_span(S, G, f_t, f_n, moment, memory_rate_bar)
        else:
            rate_more, t_more, n_more = pull_slender_edge(S, G, f_t, f_n, moment)
        rate_bar, t_bar, n_bar = rate_bar + rate_more, t_bar + t_more, n_bar + n_more
    return c_bar, s_bar, rate_bar, t_bar, n_bar


@kernel
def pull_velocities(S, G, n, heading_bar, sum_x, sum_y):
    """Take the bars of all bodies' motion back to joints and base.

    Args:
        S: Rows.
        G: Their bars.
        n: Number of bodies.
        heading_bar: Bar of the acceleration of the heading.
        sum_x: Sum of the bars of all velocities, along x.
        sum_y: The same along y.
    """
    G[VX] += sum_x
    G[VY] += sum_y
    G[CURRENT_X] -= sum_x
    G[CURRENT_Y] -= sum_y
    ahead_x, ahead_y = 0.0, 0.0
    angle_bar, rate_bar, spin_bar = 0.0, 0.0, 0.0
    for i in range(n - 1, -1, -1):
        b = HEADER_ROWS + i * BODY_ROWS
        c, s, rate = S[b + COS], S[b + SIN], S[b + LINK_RATE]
        share, first_moment, length = S[b + MASS_SHARE], S[b + FIRST_MOMENT_SHARE], S[b + LENGTH]
        ahead_t, ahead_n = c * ahead_x + s * ahead_y, c * ahead_y - s * ahead_x
        sum_t, sum_n = c * sum_x + s * sum_y, c * sum_y - s * sum_x
        turned_t = length * ahead_t - first_moment * sum_t
        turned_n = length * ahead_n - first_moment * sum_n
        G[b + LENGTH] += rate * ahead_n
        G[b + FIRST_MOMENT_SHARE] -= rate * sum_n
        G[b + MASS_SHARE] -= S[b + UX] * sum_x + S[b + UY] * sum_y
        angle_bar += G[b + SIN] - rate * turned_t
        rate_bar += G[b + LINK_RATE] + turned_n
        spin_bar += G[b + LINK_ACCELERATION]
        ahead_x += G[b + UX] - share * sum_x
        ahead_y += G[b + UY] - share * sum_y
        if i > 0:
            G[b + ANGLE] += angle_bar
            G[b + RATE] += rate_bar
            G[b + REFERENCE_2] += spin_bar
    G[HEADING] += angle_bar
    G[HEADING_RATE] += rate_bar
    for i in range(1, n):
        b = HEADER_ROWS + i * BODY_ROWS
        share = S[b + HEADING_SHARE]
        G[b + ANGLE] -= share * angle_bar
        G[b + RATE] -= share * rate_bar
        G[b + REFERENCE_2] += share * heading_bar
